//! A run that is interrupted leaves nothing half-written.

#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

#[test]
fn nothing_stays_of_an_interrupted_scene() {
    for signal in ["-INT", "-TERM"] {
        let folder = tempfile::tempdir().unwrap();
        // More points than are made before the signal comes.
        let mut run = Command::new(env!("CARGO_BIN_EXE_terrace"))
            .args(["synth", "room", "--points", "1000000000", "--quiet", "--out"])
            .arg(folder.path())
            .spawn()
            .unwrap();
        let begun = Instant::now();
        while names(folder.path()).len() < 2 {
            assert!(begun.elapsed() < Duration::from_secs(60) && run.try_wait().unwrap().is_none());
            std::thread::sleep(Duration::from_millis(5));
        }
        assert!(names(folder.path()).iter().all(|name| name.starts_with(".terrace-")));
        assert!(Command::new("kill").args([signal, &run.id().to_string()]).status().unwrap().success());
        assert_eq!(run.wait().unwrap().code(), Some(130));
        assert_eq!(names(folder.path()), [""; 0]);
    }
}
