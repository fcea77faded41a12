//! Files of more points than are held at once.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use std::path::{Path, PathBuf};

use tempfile::TempDir;
use terrace_tests::{labels, planes, planes_without_times, terrace};

/// Points that are read at once.
const CHUNK: usize = 1 << 17;
/// More than are held of a first file, and not whole chunks of them.
const POINTS: usize = (1 << 20) + (1 << 19) + LEFT;
const LEFT: usize = 1000;

struct Room {
    folder: TempDir,
}

impl Room {
    fn new() -> Self {
        Self::of(POINTS)
    }

    fn of(points: usize) -> Self {
        let room = Self { folder: tempfile::tempdir().unwrap() };
        let out = room.path("room");
        let points = points.to_string();
        let _ =
            terrace(["synth", "room", "--points", &points, "--seed", "3", "--out", text(&out)]).ended_with(0);
        room
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn cloud(&self) -> PathBuf {
        self.path("room/points.ply")
    }

    /// The same with a standard error below zero in the last record.
    fn damaged(&self) -> PathBuf {
        let mut bytes = std::fs::read(self.cloud()).unwrap();
        let header = String::from_utf8_lossy(&bytes[..400]).into_owned();
        assert!(header.contains("property float z\nproperty float sigma\nproperty uchar red"), "{header}");
        let sigma = bytes.len() - size_of::<[u8; 7]>() - size_of::<f32>();
        bytes[sigma..sigma + 4].copy_from_slice(&(-1_f32).to_le_bytes());
        let path = self.path("damaged.ply");
        std::fs::write(&path, bytes).unwrap();
        path
    }
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

#[test]
fn all_points_have_the_label_of_their_plane() {
    let room = Room::new();
    let outs = ["1", "2"].map(|threads| {
        let out = room.path(threads);
        let _ = terrace(
            ["extract", text(&room.cloud()), "--threads", threads, "--picture", "--extent"]
                .iter()
                .chain(&["--out", text(&out)]),
        )
        .ended_with(0);
        out
    });
    for name in ["labels.npy", "points.ply", "planes.png", "extents.json"] {
        let [one, other] = outs.each_ref().map(|out| std::fs::read(out.join(name)).unwrap());
        assert!(one == other, "{name}");
    }
    assert_eq!(planes_without_times(&outs[0]), planes_without_times(&outs[1]));

    let (file, found) = (planes(&outs[0]), labels(&outs[0]));
    assert_eq!(found.len(), POINTS);
    for plane in &file.planes {
        let label = i32::try_from(plane.id).unwrap();
        assert_eq!(found.iter().filter(|found| **found == label).count() as u64, plane.points);
    }
    assert_eq!(file.parameters["inputs_in_part"], serde_json::json!([]));
    // Nine in ten points of large planes are found, in the first chunks and in the last.
    let truth = labels(&room.path("room"));
    for half in [0..1 << 20, 1 << 20..POINTS] {
        for plane in [1, 3] {
            let overlap = terrace_tests::best_overlap(&truth[half.clone()], &found[half.clone()], plane);
            assert!(overlap > 0.9, "plane {plane}: {overlap}");
        }
    }
}

#[test]
fn a_first_file_of_some_chunks_has_the_cell_size_of_the_whole() {
    for points in [CHUNK, CHUNK + 1, 3 * CHUNK + 17] {
        let room = Room::of(points);
        let out = room.path("out");
        let _ = terrace(["extract", text(&room.cloud()), "--out", text(&out)]).ended_with(0);
        let source = terrace_io::Source::new(room.cloud());
        let scan = terrace_io::read_scan(&source, &terrace_io::ReadOptions::default()).unwrap();
        let mut mapper = terrace::Mapper::new(terrace::Params::default()).unwrap();
        mapper.insert(&scan).unwrap();
        let map = mapper.extract().unwrap();
        let (file, used) = (planes(&out), map.used.chosen.unwrap());
        assert_eq!(labels(&out).len(), points);
        assert_eq!(file.parameters["cell_size"], map.used.cell_size);
        assert_eq!(file.parameters["cell_size_from"]["spacing"], used.spacing);
        assert_eq!(file.parameters["cell_size_from"]["sigma"], used.sigma);
        assert_eq!(file.planes.len(), map.planes.len());
    }
}

#[test]
fn of_a_file_that_is_damaged_the_chunks_before_are_used() {
    let room = Room::new();
    let (damaged, out) = (room.damaged(), room.path("out"));
    let run = terrace(["extract", text(&damaged), "--cell", "0.1", "--out", text(&out)]).ended_with(0);
    let used = POINTS - LEFT;
    assert!(used.is_multiple_of(CHUNK));
    assert!(run.stderr.contains("damaged.ply") && run.stderr.contains(&used.to_string()), "{}", run.stderr);
    assert_eq!(labels(&out).len(), used);
    let file = planes(&out);
    let part = &file.parameters["inputs_in_part"][0];
    assert_eq!((&part["input"], &part["points"]), (&text(&damaged).into(), &used.into()));
    assert!(part["reason"].as_str().unwrap().contains("damaged.ply"));
    assert_eq!(
        (&file.parameters["inputs"], &file.parameters["inputs_skipped"]),
        (&1.into(), &serde_json::json!([]))
    );
    assert!(file.planes.len() > 5);
}

#[test]
fn a_first_file_that_is_damaged_shows_no_cell_size_and_is_left_out() {
    let room = Room::new();
    let (damaged, small, out) = (room.damaged(), room.path("small"), room.path("out"));
    let _ = terrace(["synth", "table", "--points", "5000", "--out", text(&small)]).ended_with(0);
    let good = small.join("points.ply");
    let run = terrace(["extract", text(&damaged), text(&good), "--out", text(&out)]).ended_with(0);
    assert!(run.stderr.contains("left out") && run.stderr.contains("damaged.ply"), "{}", run.stderr);
    let file = planes(&out);
    assert_eq!(file.parameters["inputs_skipped"][0]["input"], text(&damaged));
    assert_eq!((labels(&out).len(), &file.parameters["inputs"]), (5000, &1.into()));
}
