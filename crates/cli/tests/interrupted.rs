//! A run that is interrupted leaves nothing half-written.

#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::path::Path;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

/// Interrupts a run as soon as `begun` holds, and waits for its end.
fn interrupt(mut run: Child, signal: &str, begun: impl Fn() -> bool) {
    let started = Instant::now();
    while !begun() {
        assert!(started.elapsed() < Duration::from_secs(60) && run.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(Command::new("kill").args([signal, &run.id().to_string()]).status().unwrap().success());
    assert_eq!(run.wait().unwrap().code(), Some(130));
}

#[test]
fn nothing_stays_of_an_interrupted_extraction() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, out) = (folder.path().join("scene"), folder.path().join("out"));
    let made = Command::new(env!("CARGO_BIN_EXE_terrace"))
        .args(["synth", "room", "--points", "3000000", "--quiet", "--out"])
        .arg(&scene)
        .status();
    assert!(made.unwrap().success());
    // What was there stays as it was.
    std::fs::create_dir(&out).unwrap();
    std::fs::write(out.join("labels.npy"), "those of before").unwrap();
    let run = Command::new(env!("CARGO_BIN_EXE_terrace"))
        .args(["extract", "--quiet", "--out"])
        .args([&out, &scene.join("points.ply")])
        .spawn()
        .unwrap();
    interrupt(run, "-INT", || names(&out).len() == 3);
    assert_eq!(names(&out), ["labels.npy"]);
    assert_eq!(std::fs::read(out.join("labels.npy")).unwrap(), b"those of before");
}

#[cfg(feature = "parquet")]
#[test]
fn nothing_stays_of_an_interrupted_map() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, maps) = (folder.path().join("scene"), folder.path().join("maps"));
    let made = Command::new(env!("CARGO_BIN_EXE_terrace"))
        .args(["synth", "room", "--points", "2000000", "--quiet", "--out"])
        .arg(&scene)
        .status();
    assert!(made.unwrap().success());
    let run = Command::new(env!("CARGO_BIN_EXE_terrace"))
        .args(["extract", "--quiet", "--out"])
        .args([&folder.path().join("out"), &scene.join("points.ply")])
        .arg("--save-map")
        .arg(maps.join("map.parquet"))
        .spawn()
        .unwrap();
    interrupt(run, "-INT", || names(&maps).len() == 1);
    assert_eq!(names(&maps), [""; 0]);
}

#[test]
fn nothing_stays_of_an_interrupted_scene() {
    for signal in ["-INT", "-TERM"] {
        let folder = tempfile::tempdir().unwrap();
        // More points than are made before the signal comes.
        let run = Command::new(env!("CARGO_BIN_EXE_terrace"))
            .args(["synth", "room", "--points", "1000000000", "--quiet", "--out"])
            .arg(folder.path())
            .spawn()
            .unwrap();
        interrupt(run, signal, || {
            let names = names(folder.path());
            assert!(names.iter().all(|name| name.starts_with(".terrace-")));
            names.len() == 2
        });
        assert_eq!(names(folder.path()), [""; 0]);
    }
}
