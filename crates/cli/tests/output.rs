//! What becomes of a run whose standard output goes nowhere.

#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::fs::File;
use std::process::{Command, Stdio};

#[test]
fn the_work_is_done_when_no_one_reads_what_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let mut run = Command::new(env!("CARGO_BIN_EXE_terrace"))
        .args(["synth", "table", "--points", "2000", "--quiet", "--out"])
        .arg(folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(run.stdout.take());
    let ended = run.wait_with_output().unwrap();
    assert_eq!((ended.status.code(), ended.stderr.as_slice()), (Some(0), &b""[..]));
    assert!(folder.path().join("points.ply").is_file());
}

#[cfg(target_os = "linux")]
#[test]
fn what_cannot_be_written_down_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("points.xyz"), "0 0 0\n1 0 0\n").unwrap();
    let ended = Command::new(env!("CARGO_BIN_EXE_terrace"))
        .arg("info")
        .arg(folder.path().join("points.xyz"))
        .stdout(File::options().write(true).open("/dev/full").unwrap())
        .output()
        .unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert_eq!(ended.status.code(), Some(1));
    assert!(said.starts_with("terrace: standard output: "), "{said}");
}
