//! How far planes reach: `extents.json`, areas and meshes of `terrace extract`.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use std::fmt::Write;
use std::path::{Path, PathBuf};

use serde_json::Value;
use terrace_io::planes_json::PlaneRecord;
use terrace_tests::{planes, terrace};

type Point = [f64; 2];

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// A synthetic scene in `folder`, and where its planes are to go.
fn scene(folder: &Path, name: &str, points: &str) -> (PathBuf, PathBuf) {
    let scan = folder.join("scan");
    let _ = terrace(["synth", name, "--points", points, "--out", text(&scan)]).ended_with(0);
    (scan.join("points.ply"), folder.join("out"))
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    let numbers: Vec<f64> = value.as_array().unwrap().iter().map(number).collect();
    numbers.try_into().unwrap()
}

/// Polygons of rings of points of N numbers.
fn polygons<const N: usize>(value: &Value) -> Vec<Vec<Vec<[f64; N]>>> {
    let each = |value: &Value| value.as_array().unwrap().clone();
    let ring = |ring: &Value| each(ring).iter().map(numbers).collect();
    each(value).iter().map(|polygon| each(polygon).iter().map(ring).collect()).collect()
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn cross(a: Point, b: Point, c: Point) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
}

/// Area of a closed ring, positive when it runs counter-clockwise.
fn ring_area(ring: &[Point]) -> f64 {
    ring.windows(3).map(|w| cross(ring[0], w[1], w[2])).sum::<f64>() / 2.0
}

fn assert_simple(ring: &[Point]) {
    assert!(ring.len() >= 4, "{ring:?}");
    assert!(ring.first() == ring.last(), "not closed: {ring:?}");
    let edges: Vec<_> = ring.windows(2).map(|w| (w[0], w[1])).collect();
    for (k, &(a, b)) in edges.iter().enumerate() {
        for &(c, d) in &edges[..k] {
            let apart = cross(a, b, c) * cross(a, b, d) >= 0.0 || cross(c, d, a) * cross(c, d, b) >= 0.0;
            assert!(apart, "{a:?} {b:?} crosses {c:?} {d:?}");
        }
    }
}

/// The area of a plane of `extents.json`, after a look at all that it must hold.
fn checked(plane: &Value, record: &PlaneRecord) -> f64 {
    assert!(number(&plane["resolution"]) > 0.0);
    let frame = &plane["frame"];
    let (origin, normal) = (numbers::<3>(&frame["origin"]), numbers::<3>(&frame["normal"]));
    let axes = [0, 1].map(|k| numbers::<3>(&frame["axes"][k]));
    for (a, b, expected) in [
        (axes[0], axes[0], 1.0),
        (axes[1], axes[1], 1.0),
        (axes[0], axes[1], 0.0),
        (axes[0], normal, 0.0),
        (axes[1], normal, 0.0),
    ] {
        assert!((dot(a, b) - expected).abs() < 1e-12, "{frame}");
    }
    let [a, b, c, d] = record.coefficients;
    assert!((dot([a, b, c], normal) - 1.0).abs() < 1e-12);
    assert!((dot(normal, origin) + d).abs() < 1e-9);

    assert_eq!(plane["polygons"]["type"], "MultiPolygon");
    let flat = polygons::<2>(&plane["polygons"]["coordinates"]);
    let world = polygons::<3>(&plane["world"]);
    assert!(!flat.is_empty());
    let mut area = 0.0;
    for (polygon, placed) in flat.iter().zip(&world) {
        for (k, (ring, placed)) in polygon.iter().zip(placed).enumerate() {
            assert_simple(ring);
            let own = ring_area(ring);
            assert!((k == 0) == (own > 0.0), "outer rings turn left, holes turn right");
            area += own;
            assert_eq!(ring.len(), placed.len());
            for (p, q) in ring.iter().zip(placed) {
                let at = [0, 1, 2].map(|i| origin[i] + p[0] * axes[0][i] + p[1] * axes[1][i]);
                assert!((0..3).all(|i| (at[i] - q[i]).abs() < 1e-9), "{at:?} is not {q:?}");
            }
        }
    }
    let told = number(&plane["area"]);
    assert!((area - told).abs() < 1e-9 * told, "{area} m² is told as {told} m²");
    assert!(record.area.is_some_and(|area| (area - told).abs() < 1e-12), "{:?} is not {told}", record.area);
    told
}

#[test]
fn the_top_of_the_table_has_its_area_and_meshes_agree() {
    let folder = tempfile::tempdir().unwrap();
    let (cloud, out) = scene(folder.path(), "table", "30000");
    let meshes = ["m.ply", "m.OBJ", "deep/m.glb"].map(|name| folder.path().join(name));
    let mut arguments = vec!["extract", text(&cloud), "--out", text(&out), "--extent"];
    arguments.extend(meshes.iter().flat_map(|mesh| ["--mesh", text(mesh)]));
    let run = terrace(arguments).ended_with(0);
    assert!(run.stdout.contains("area m2") && run.stdout.contains("m.glb"), "{}", run.stdout);

    let (file, extents) = (planes(&out), json(&out.join("extents.json")));
    assert_eq!(extents["format"], "terrace-extents");
    assert_eq!(extents["version"], 1);
    assert!(number(&extents["gap"]) > number(&extents["spacing"]) && number(&extents["spacing"]) > 0.0);
    assert!(file.timings_seconds.unwrap().extent.is_some());
    let mut total = 0.0;
    let mut ids = Vec::new();
    for plane in extents["planes"].as_array().unwrap() {
        let record = file.planes.iter().find(|record| plane["id"] == record.id).unwrap();
        total += checked(plane, record);
        ids.push(record.id);
    }
    assert!(ids.is_sorted() && ids.len() >= 3, "{ids:?}");

    let truth = planes(cloud.parent().unwrap());
    for (name, expected) in [("top", 1.2), ("side_x", 0.75), ("side_y", 0.9)] {
        let [a, b, c, _] =
            truth.planes.iter().find(|p| p.name.as_deref() == Some(name)).unwrap().coefficients;
        let along =
            |record: &&PlaneRecord| dot([a, b, c], numbers(&Value::from(&record.coefficients[..3]))).abs();
        let found = file.planes.iter().max_by(|p, q| along(p).total_cmp(&along(q))).unwrap();
        let area = found.area.unwrap();
        assert!((area / expected - 1.0).abs() < 0.1, "{name} has {area} m² and not {expected} m²");
    }

    let [ply, obj, glb] = meshes.map(|path| std::fs::read(path).unwrap());
    let obj = String::from_utf8(obj).unwrap();
    let names: Vec<_> = obj.lines().filter_map(|line| line.strip_prefix("o ")).collect();
    assert_eq!(names, ids.iter().map(|id| format!("plane_{id}")).collect::<Vec<_>>());
    let vertices = obj.lines().filter(|line| line.starts_with("v ")).count();
    let triangles = obj.lines().filter(|line| line.starts_with("f ")).count();
    assert!(triangles > 0 && (obj_area(&obj) - total).abs() < 1e-6, "{} is not {total}", obj_area(&obj));
    let header = String::from_utf8_lossy(&ply[..400]);
    assert!(header.starts_with("ply\nformat binary_little_endian 1.0\n"), "{header}");
    assert!(header.contains(&format!("element vertex {vertices}\n")), "{header}");
    assert!(header.contains(&format!("element face {triangles}\n")), "{header}");
    assert!(glb.starts_with(b"glTF\x02\0\0\0"));
    let size = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!(size(8), glb.len());
    let document: Value = serde_json::from_slice(&glb[20..20 + size(12)]).unwrap();
    assert_eq!(document["accessors"][0]["count"], vertices);
    assert_eq!(document["accessors"][3]["count"], 3 * triangles);
}

/// Area of the triangles of an OBJ.
fn obj_area(obj: &str) -> f64 {
    let rows = |start: &'static str| obj.lines().filter_map(move |line| line.strip_prefix(start));
    let vertices: Vec<[f64; 3]> = rows("v ")
        .map(|row| {
            let parts: Vec<f64> = row.split(' ').take(3).map(|x| x.parse().unwrap()).collect();
            parts.try_into().unwrap()
        })
        .collect();
    let area = |row: &str| {
        let corner = |part: &str| vertices[part.split('/').next().unwrap().parse::<usize>().unwrap() - 1];
        let corners: Vec<_> = row.split(' ').map(corner).collect();
        let [p, q] = [1, 2].map(|k| [0, 1, 2].map(|i| corners[k][i] - corners[0][i]));
        (dot(p, p) * dot(q, q) - dot(p, q).powi(2)).max(0.0).sqrt() / 2.0
    };
    rows("f ").map(area).sum()
}

#[test]
fn extents_repeat_to_the_byte_on_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let (cloud, _) = scene(folder.path(), "room", "40000");
    let results = ["1", "2", "3"].map(|threads| {
        let out = folder.path().join(threads);
        let meshes = ["m.ply", "m.obj", "m.glb"].map(|name| out.join(name));
        let mut arguments =
            vec!["extract", text(&cloud), "--out", text(&out), "--extent", "--threads", threads];
        arguments.extend(meshes.iter().flat_map(|mesh| ["--mesh", text(mesh)]));
        let _ = terrace(arguments).ended_with(0);
        let areas: Vec<_> = planes(&out).planes.iter().map(|plane| plane.area).collect();
        assert!(areas.iter().flatten().count() >= 5);
        let files = meshes.into_iter().chain([out.join("extents.json")]);
        (areas, files.map(|path| std::fs::read(path).unwrap()).collect::<Vec<_>>())
    });
    assert!(results[1..].iter().all(|other| *other == results[0]));
}

#[test]
fn a_mesh_alone_gives_areas_and_without_both_there_are_none() {
    let folder = tempfile::tempdir().unwrap();
    let (cloud, out) = scene(folder.path(), "table", "9000");
    let mesh = folder.path().join("mesh.ply");
    let _ = terrace(["extract", text(&cloud), "--out", text(&out), "--mesh", text(&mesh), "--quiet"])
        .ended_with(0);
    assert!(mesh.is_file() && !out.join("extents.json").exists());
    assert!(planes(&out).planes[0].area.is_some());
    let run = terrace(["extract", text(&cloud), "--out", text(&out)]).ended_with(0);
    assert!(!run.stdout.contains("area"), "{}", run.stdout);
    assert!(planes(&out).planes.iter().all(|plane| plane.area.is_none()));
    assert!(planes(&out).timings_seconds.unwrap().extent.is_none());
}

#[test]
fn planes_of_too_few_points_have_no_extent() {
    let folder = tempfile::tempdir().unwrap();
    let (cloud, out) = (folder.path().join("sparse.xyz"), folder.path().join("out"));
    // One point in every second cell, as on a chessboard: several times as far apart as is usual for such cells.
    let mut points = String::new();
    for k in (0..800).filter(|k| (k % 28 + k / 28) % 2 == 0) {
        writeln!(points, "{} {} 0.25", 0.25 + 0.5 * f64::from(k % 28), 0.25 + 0.5 * f64::from(k / 28))
            .unwrap();
    }
    std::fs::write(&cloud, points).unwrap();
    let run =
        terrace(["extract", text(&cloud), "--out", text(&out), "--extent", "--cell", "0.5", "--tau", "1"])
            .ended_with(0);
    assert!(!run.stderr.contains("warning"), "{}", run.stderr);
    let found = planes(&out).planes;
    assert!(found.len() == 1 && found[0].area.is_none(), "{found:?}");
    assert_eq!(json(&out.join("extents.json"))["planes"], Value::Array(vec![]));
}

#[test]
fn names_of_meshes_tell_the_format() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    for name in ["x.foo", "mesh", ".glb"] {
        let run = terrace(["extract", "scan.ply", "--out", text(&out), "--mesh", "ok.obj", "--mesh", name])
            .ended_with(2);
        assert!([".ply", ".obj", ".glb"].iter().all(|format| run.stderr.contains(format)), "{}", run.stderr);
        assert!(!out.exists());
    }
    let help = terrace(["extract", "--help"]).ended_with(0).stdout;
    for part in ["--extent", "--mesh <FILE>", "extents.json", ".ply", ".obj", ".glb"] {
        assert!(help.contains(part), "{help}");
    }
}
