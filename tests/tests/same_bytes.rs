//! The same input, parameters and seed give the same files, on any number of threads.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use std::path::Path;

use terrace_tests::{planes, planes_without_times, terrace};

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

fn runs_agree(preset: &str) {
    let folder = tempfile::tempdir().unwrap();
    let room = folder.path().join("room");
    let _ = terrace(["synth", "room", "--points", "60000", "--out", text(&room)]).ended_with(0);
    let cloud = room.join("points.ply");

    let outs = [("1", "a"), ("1", "b"), ("2", "c"), ("2", "d")].map(|(threads, name)| {
        let out = folder.path().join(name);
        let _ = terrace([
            "extract",
            text(&cloud),
            "--out",
            text(&out),
            "--preset",
            preset,
            "--seed",
            "7",
            "--threads",
            threads,
            "--picture",
        ])
        .ended_with(0);
        out
    });
    assert!(planes(&outs[0]).planes.len() >= 3, "a room without planes shows nothing");
    for other in &outs[1..] {
        for name in ["labels.npy", "points.ply", "planes.png"] {
            let [first, again] = [&outs[0], other].map(|out| std::fs::read(out.join(name)).unwrap());
            assert!(!first.is_empty());
            assert!(first == again, "{name} differs between {} and {}", outs[0].display(), other.display());
        }
        assert_eq!(planes_without_times(&outs[0]), planes_without_times(other));
    }
}

#[test]
fn default_preset_repeats_to_the_byte() {
    runs_agree("default");
}

#[test]
fn clusters_preset_repeats_to_the_byte() {
    runs_agree("clusters");
}

#[test]
fn paper_preset_repeats_to_the_byte() {
    runs_agree("paper");
}

#[test]
fn synthetic_scans_repeat_to_the_byte_and_follow_the_seed() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b, c] = [("a", "3"), ("b", "3"), ("c", "4")].map(|(name, seed)| {
        let out = folder.path().join(name);
        let _ = terrace(["synth", "table", "--points", "5000", "--seed", seed, "--out", text(&out)])
            .ended_with(0);
        ["points.ply", "labels.npy", "planes.json"].map(|file| std::fs::read(out.join(file)).unwrap())
    });
    assert!(a == b, "one seed, two scans");
    assert!(a[0] != c[0], "two seeds, one scan");
}
