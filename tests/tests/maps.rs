//! Maps that are saved in parts and merged.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use std::path::{Path, PathBuf};

use terrace_io::planes_json::{PlaneRecord, PlanesFile};
use terrace_tests::{Folder, Run, planes, terrace};

/// The points of a room in three files of unequal length.
fn room_in_parts(folder: &Folder) -> [String; 3] {
    let out = folder.path("room");
    let _ = terrace(["synth", "room", "--points", "150000", "--seed", "4", "--out", &out]).ended_with(0);
    let bytes = std::fs::read(format!("{out}/points.ply")).unwrap();
    let end = b"end_header\n";
    let begin = bytes.windows(end.len()).position(|text| text == end).unwrap() + end.len();
    let header = String::from_utf8(bytes[..begin].to_vec()).unwrap();
    let stride = (bytes.len() - begin) / 150_000;
    [("1.ply", 0..40_000), ("2.ply", 40_000..50_000), ("3.ply", 50_000..150_000)].map(|(name, points)| {
        let mut part = header.replace("vertex 150000", &format!("vertex {}", points.len())).into_bytes();
        part.extend(&bytes[begin + points.start * stride..begin + points.end * stride]);
        let path = folder.path(name);
        std::fs::write(&path, part).unwrap();
        path
    })
}

fn merged(folder: &Folder, maps: &[&str], out: &str) -> PlanesFile {
    let out = folder.path(out);
    let _ = terrace(["merge", "--out", &out].iter().chain(maps)).ended_with(0);
    planes(Path::new(&out))
}

/// Extracts a part and saves its map beside it.
fn save(part: &str, more: &[&str]) -> String {
    let (map, out) = (part.replace(".ply", ".parquet"), part.replace(".ply", ""));
    let fixed = ["extract", part, "--no-points", "--quiet", "--out", &out, "--save-map", &map];
    let _ = terrace(fixed.iter().chain(more)).ended_with(0);
    map
}

fn near(a: f64, b: f64, by: f64) -> bool {
    (a - b).abs() <= by
}

/// The same planes but for the rounding of sums, their points up to this share: what samples tell of them.
fn assert_same(found: &[PlaneRecord], expected: &[PlaneRecord], share: f64) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert!((0..4).all(|i| near(a.coefficients[i], b.coefficients[i], 1e-9)), "{a:?} {b:?}");
        let (of_a, of_b) = (a.covariance, b.covariance);
        assert_eq!(of_a.is_some(), of_b.is_some());
        for (row_a, row_b) in of_a.iter().flatten().zip(of_b.iter().flatten()) {
            let largest = of_b.iter().flatten().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
            assert!(row_a.iter().zip(row_b).all(|(a, b)| near(*a, *b, 1e-6 * largest)), "{a:?} {b:?}");
        }
        assert!(near(a.points as f64, b.points as f64, share * b.points as f64), "{} {}", a.points, b.points);
        assert_eq!(a.cells, b.cells);
    }
}

#[test]
fn the_merged_map_of_parts_has_the_planes_of_one_run() {
    let folder = Folder::new();
    let parts = room_in_parts(&folder);
    // Samples of regions tell some of the points near where planes meet otherwise; clusters have those of their cells.
    for (preset, points) in [("default", 0.002), ("clusters", 0.0)] {
        let options = ["--cell", "0.1", "--preset", preset];
        let whole = folder.path("whole");
        let _ = terrace(
            ["extract", "--quiet", "--out", &whole]
                .iter()
                .chain(&options)
                .copied()
                .chain(parts.iter().map(String::as_str)),
        )
        .ended_with(0);
        let expected = planes(Path::new(&whole));
        assert!(expected.planes.len() > 8);
        let maps = parts.each_ref().map(|part| save(part, &options));
        let [a, b, c] = maps.each_ref().map(String::as_str);

        let all = folder.path("all.parquet");
        let found = merged(&folder, &[a, b, c, "--save-map", &all], "merged");
        assert_same(&found.planes, &expected.planes, points);
        assert_eq!(found.summary.unwrap().points, 150_000);
        assert_eq!(found.parameters["inputs"], 3);
        assert_eq!(found.parameters["maps"].as_array().unwrap().len(), 3);
        for name in ["cell_size", "tau", "cells_occupied", "cells_dense", "estimate", "min_cells", "phi"] {
            assert_eq!(found.parameters[name], expected.parameters[name], "{name}");
        }
        // Another order, other parts, or the merged map alone.
        assert_same(&merged(&folder, &[c, a, b], "other").planes, &expected.planes, points);
        assert_eq!(merged(&folder, &[&all], "again").planes, found.planes);
    }
}

#[test]
fn settings_can_be_changed_when_maps_are_merged() {
    let folder = Folder::new();
    let [_, part, _] = room_in_parts(&folder);
    let map = save(&part, &["--cell", "0.1"]);
    let found = merged(&folder, &[&map, "--join", "coplanar", "--tau", "7", "--min-points", "900"], "out");
    let regions = &found.parameters["regions"];
    assert_eq!((&regions["join"], &found.parameters["tau"]), (&"coplanar".into(), &7.into()));
    assert!(!found.planes.is_empty() && found.planes.iter().all(|plane| plane.points >= 800));
    let none = merged(&folder, &[&map, "--no-covariance"], "out");
    assert!(none.planes.iter().all(|plane| plane.covariance.is_none()));
    // Where planes were saved without a join, and others with one, an option decides.
    let joined = folder.path("joined.parquet");
    let _ = merged(&folder, &[&map, "--join", "coplanar", "--save-map", &joined], "out");
    let refused = merge(&[&map, &joined], &folder).ended_with(1);
    assert!(
        refused.stderr.contains("regions.join") && refused.stderr.contains("Coplanar"),
        "{}",
        refused.stderr
    );
    let _ = merged(&folder, &[&map, &joined, "--join", "touching"], "out");
}

fn merge(arguments: &[&str], folder: &Folder) -> Run {
    terrace(["merge", "--out", &folder.path("none")].iter().chain(arguments))
}

#[test]
fn maps_that_do_not_fit_are_told() {
    let folder = Folder::new();
    let [one, other, _] = room_in_parts(&folder);
    let map = save(&one, &["--cell", "0.1"]);
    let told = |file: &str, words: &[&str]| {
        let run = merge(&[&map, file], &folder).ended_with(1);
        assert!(words.iter().all(|word| run.stderr.contains(word)), "{}", run.stderr);
        assert!(!PathBuf::from(folder.path("none")).exists());
    };
    told(&save(&other, &["--cell", "0.12"]), &["2.parquet", "0.1 m", "0.12 m", "--cell"]);
    told(&save(&other, &["--cell", "0.1", "--preset", "clusters"]), &["regions", "--preset"]);
    let unknown = folder.path("unknown.xyz");
    let floor: String =
        (0..2500).map(|k| format!("{} {} 0\n", 0.02 * f64::from(k % 50), 0.02 * f64::from(k / 50))).collect();
    std::fs::write(&unknown, floor).unwrap();
    let without = folder.path("unknown.parquet");
    let extract =
        ["extract", &unknown, "--cell", "0.1", "--out", &folder.path("unknown"), "--save-map", &without];
    let _ = terrace(extract).ended_with(0);
    told(&without, &["unknown.parquet", "stated in one map and unknown in the other"]);
    told(&one, &["1.ply", "Parquet"]);
    told(&folder.path("missing.parquet"), &["missing.parquet"]);

    let bytes = std::fs::read(&map).unwrap();
    let cut = folder.path("cut.parquet");
    std::fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    told(&cut, &["cut.parquet", "damaged"]);
    let run = terrace(["info", &cut, &map]).ended_with(1);
    assert!(run.stderr.contains("cut.parquet") && run.stdout.contains("1.parquet"), "{}", run.stderr);

    // Options for another kind of map.
    let run = merge(&[&map, "--phi", "0.2"], &folder).ended_with(2);
    assert!(run.stderr.contains("--phi") && run.stderr.contains("regions"), "{}", run.stderr);
    let _ = merge(&[], &folder).ended_with(2);
    // Points are not in a map.
    let out = folder.path("none");
    let run = terrace(["extract", &map, "--out", &out]).ended_with(1);
    assert!(run.stderr.contains("terrace merge"), "{}", run.stderr);
}

#[test]
fn maps_that_do_not_add_up_are_not_saved() {
    let folder = Folder::new();
    let [_, part, _] = room_in_parts(&folder);
    let (map, out) = (folder.path("paper.parquet"), folder.path("out"));
    let run =
        terrace(["extract", &part, "--preset", "paper", "--out", &out, "--save-map", &map]).ended_with(2);
    assert!(run.stderr.contains("--save-map") && run.stderr.contains("--preset paper"), "{}", run.stderr);
    assert!(!PathBuf::from(map).exists() && !PathBuf::from(out).exists());
}

#[test]
fn info_tells_what_a_map_holds() {
    let folder = Folder::new();
    let cloud = folder.path("cloud.xyz");
    std::fs::write(&cloud, "0.01 0.02 0.03\nnan nan nan\n1e300 0 0\n").unwrap();
    let (map, out) = (folder.path("one.parquet"), folder.path("out"));
    let extract = ["extract", &cloud, "--cell", "0.1", "--out", &out, "--save-map", &map];
    let _ = terrace(extract).ended_with(0);
    let run = terrace(["info", &map]).ended_with(0);
    for line in
        ["points     3", "absent     1", "left out   1", "cell size  0.1 m, given", "cells      1 of 0.05 m"]
    {
        assert!(run.stdout.contains(line), "{}", run.stdout);
    }
    assert!(run.stdout.contains("0.0000 to 0.0500 m"), "{}", run.stdout);
    let found = merged(&folder, &[&map], "merged");
    assert!(found.planes.is_empty() && found.summary.unwrap().points == 3);
}
