//! Covariances of planes on the command line: they are there, they hold, and they can be left out.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use std::fmt::Write as _;
use std::path::Path;

use serde_json::{Value, json};
use terrace_io::planes_json::{PlaneRecord, TiltOffset};
use terrace_synth::{Params, Scene, SceneKind};
use terrace_tests::{Folder, Run, planes, planes_without_times, terrace};
use terrace_types::Frame;

/// The squared distance of three coordinates in their standard deviations that no honest estimate passes in these scenes:
/// that of five standard deviations of one.
const TOO_FAR: f64 = 25.0;

/// The table, scanned.
fn table() -> Folder {
    let folder = Folder::new();
    let _ = terrace(["synth", "table", "--seed", "5", "--out", &folder.path("truth")]).ended_with(0);
    folder
}

fn extract(folder: &Folder, scan: &str, arguments: &[&str]) -> Run {
    let (scan, out) = (folder.path(scan), folder.path("out"));
    terrace(["extract", &scan, "--out", &out, "--no-points"].iter().chain(arguments)).ended_with(0)
}

fn planes_in(folder: &Folder, name: &str) -> Vec<PlaneRecord> {
    planes(Path::new(&folder.path(name))).planes
}

fn parameter(folder: &Folder, name: &str) -> Value {
    planes(Path::new(&folder.path("out"))).parameters[name].clone()
}

/// The plane found that has most points of all within a tenth of a radian of a true one.
fn found(folder: &Folder, truth: &PlaneRecord) -> PlaneRecord {
    let alike = |plane: &PlaneRecord| dot(normal(plane), normal(truth)).abs() > 0.995;
    let found = planes_in(folder, "out").into_iter().find(alike);
    found.unwrap_or_else(|| panic!("{:?} is not found", truth.name))
}

fn normal(plane: &PlaneRecord) -> [f64; 3] {
    let [a, b, c, _] = plane.coefficients;
    [a, b, c]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn own(plane: &PlaneRecord) -> TiltOffset {
    plane.tilt_offset_covariance.expect("a covariance")
}

/// How far a true plane is from the one found, by its covariance: the squared distance in standard deviations.
fn squared_distance(found: &PlaneRecord, truth: &PlaneRecord) -> f64 {
    let TiltOffset { at, axes: [e1, e2], matrix } = own(found);
    let n = normal(truth);
    let cosine = dot(n, normal(found));
    let offset = -(dot(n, at) + truth.coefficients[3]) / cosine;
    let side = cosine.signum();
    let off = [side * dot(n, e1), side * dot(n, e2), offset];
    // Whitened by the Cholesky factor, which is there only when the matrix is positive definite.
    let factor = cholesky(matrix);
    let mut white = [0.0; 3];
    for i in 0..3 {
        let known: f64 = (0..i).map(|j| factor[i][j] * white[j]).sum();
        white[i] = (off[i] - known) / factor[i][i];
    }
    dot(white, white)
}

fn cholesky(m: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let mut factor = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..=i {
            let rest = m[i][j] - (0..j).map(|k| factor[i][k] * factor[j][k]).sum::<f64>();
            factor[i][j] = if i == j { rest.sqrt() } else { rest / factor[j][j] };
        }
        assert!(factor[i][i] > 0.0, "not positive definite: {m:?}");
    }
    factor
}

/// That both covariances are covariances, and of the same plane.
fn check(plane: &PlaneRecord) {
    let of_coefficients = plane.covariance.expect("a covariance");
    let TiltOffset { at, axes: [e1, e2], matrix } = own(plane);
    let n = normal(plane);
    for (value, expected) in [
        (dot(e1, e1), 1.0),
        (dot(e2, e2), 1.0),
        (dot(e1, e2), 0.0),
        (dot(n, e1), 0.0),
        (dot(n, e2), 0.0),
        (dot(n, at) + plane.coefficients[3], 0.0),
    ] {
        assert!((value - expected).abs() < 1e-9, "{plane:?}");
    }
    let _ = cholesky(matrix);
    // What the coefficients change by, for each tilt and the offset.
    let changes =
        [[e1[0], e1[1], e1[2], -dot(e1, at)], [e2[0], e2[1], e2[2], -dot(e2, at)], [0.0, 0.0, 0.0, -1.0]];
    let largest = of_coefficients.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
    for i in 0..4 {
        for j in 0..4 {
            let told: f64 = (0..3)
                .flat_map(|k| (0..3).map(move |l| (k, l)))
                .map(|(k, l)| changes[k][i] * matrix[k][l] * changes[l][j])
                .sum();
            assert!((of_coefficients[i][j] - told).abs() < 1e-9 * largest, "[{i}][{j}]: {plane:?}");
            assert!((of_coefficients[i][j] - of_coefficients[j][i]).abs() < 1e-12 * largest);
        }
        let along: f64 = (0..3).map(|j| of_coefficients[i][j] * n[j]).sum();
        assert!(along.abs() < 1e-9 * largest, "rank 3, and the length of the normal is sure: {plane:?}");
    }
    assert!(plane.growth.expect("growth") >= 1.0 && plane.reduced_chi_squared.expect("χ²") > 0.0);
    assert!(plane.min_max.is_none_or(|most| most.iter().all(|m| *m > 0.0)));
}

#[test]
fn the_true_planes_are_where_the_covariance_says() {
    let folder = table();
    for preset in ["default", "clusters"] {
        let run = extract(&folder, "truth/points.ply", &["--preset", preset]);
        assert!(run.stdout.contains("tilt deg   off mm"), "{}", run.stdout);
        assert!(!run.stdout.contains("standard errors of the points"), "{}", run.stdout);
        assert!(run.stdout.lines().all(|line| line.chars().count() <= 120), "{}", run.stdout);
        for truth in planes_in(&folder, "truth") {
            let found = found(&folder, &truth);
            check(&found);
            let distance = squared_distance(&found, &truth);
            assert!(distance < TOO_FAR, "{:?}: {distance}", truth.name);
            // A centimetre of noise on thousands of points.
            assert!((1e-5..2e-3).contains(&own(&found).offset()), "{found:?}");
            assert!((1e-5..5e-3).contains(&own(&found).largest_tilt()), "{found:?}");
            assert!((0.9..1.1).contains(&found.reduced_chi_squared.unwrap()), "{found:?}");
            assert!(found.min_max.is_some());
        }
        for plane in planes_in(&folder, "out").iter().filter(|plane| plane.covariance.is_some()) {
            check(plane);
        }
        assert_eq!(parameter(&folder, "estimate"), json!({ "floor": 0.0 }));
        assert_eq!(parameter(&folder, "noise_found"), json!(null));
    }
}

#[test]
fn covariances_can_be_left_out() {
    let folder = table();
    for arguments in
        [&["--no-covariance"][..], &["--no-covariance", "--preset", "clusters"], &["--preset", "paper"]]
    {
        let run = extract(&folder, "truth/points.ply", arguments);
        assert!(run.stdout.contains("s_z") && !run.stdout.contains("tilt"), "{}", run.stdout);
        let file = planes_without_times(Path::new(&folder.path("out")));
        assert_eq!([&file["parameters"]["estimate"], &file["parameters"]["noise_found"]], [&json!(null); 2]);
        let planes = file["planes"].as_array().unwrap();
        assert!(planes.len() >= 3);
        for field in ["covariance", "tilt_offset_covariance", "reduced_chi_squared", "growth", "min_max"] {
            assert!(planes.iter().all(|plane| plane.get(field).is_none()), "{arguments:?}: {field}");
        }
    }
}

#[test]
fn a_floor_is_added_to_the_offset() {
    let folder = table();
    let _ = extract(&folder, "truth/points.ply", &["--floor", "0.01"]);
    assert_eq!(parameter(&folder, "estimate"), json!({ "floor": 0.01 }));
    for truth in planes_in(&folder, "truth") {
        let found = found(&folder, &truth);
        check(&found);
        assert!((0.01..0.0101).contains(&own(&found).offset()), "{found:?}");
        assert!(own(&found).largest_tilt() > 0.01, "{found:?}");
    }
}

#[test]
fn a_floor_that_makes_no_sense_is_refused() {
    let folder = table();
    let (scan, out) = (folder.path("truth/points.ply"), folder.path("out"));
    for (arguments, told) in [
        (&["--floor", "-0.01"][..], "floor is -0.01"),
        (&["--floor", "nan"], "floor is NaN"),
        (&["--floor", "thick"], "--floor"),
        (&["--floor", "0.01", "--no-covariance"], "--no-covariance"),
        (&["--floor", "0.01", "--preset", "paper"], "--preset paper"),
    ] {
        let run = terrace(["extract", &scan, "--out", &out].iter().chain(arguments)).ended_with(2);
        assert!(run.stderr.contains(told), "{arguments:?}: {}", run.stderr);
    }
}

fn lines(points: &[[f64; 3]]) -> String {
    points.iter().fold(String::new(), |mut text, [x, y, z]| {
        writeln!(text, "{x} {y} {z}").unwrap();
        text
    })
}

#[test]
fn errors_that_nobody_stated_are_found_and_told() {
    let folder = table();
    let scans = Scene::new(SceneKind::Table).generate(&Params { seed: 5, ..Params::default() }).unwrap();
    std::fs::write(folder.path("bare.xyz"), lines(scans.merged().scan.points())).unwrap();
    let run = extract(&folder, "bare.xyz", &[]);
    assert!(run.stdout.contains("found from the residuals of"), "{}", run.stdout);
    assert_eq!(parameter(&folder, "errors"), json!(null));
    let noise = parameter(&folder, "noise_found");
    assert!(noise["places"].as_u64().unwrap() > 50, "{noise}");
    let knots = noise["knots"].as_array().unwrap();
    assert!(knots.iter().all(|knot| knot["range"].is_null()), "nobody told where the sensor was: {noise}");
    // The table has white noise of a centimetre.
    let middle = knots[knots.len() / 2]["along"].as_f64().unwrap();
    assert!((0.009..0.011).contains(&middle), "{noise}");
    for truth in planes_in(&folder, "truth") {
        let found = found(&folder, &truth);
        check(&found);
        let distance = squared_distance(&found, &truth);
        assert!(distance < TOO_FAR, "{:?}: {distance}", truth.name);
    }

    let run = extract(&folder, "bare.xyz", &["--no-covariance", "--preset", "clusters"]);
    assert!(run.stdout.contains("are unknown (--sigma, --sensor): "), "{}", run.stdout);
    assert_eq!(parameter(&folder, "noise_found"), json!(null));
    // Regions cannot do without.
    let run = extract(&folder, "bare.xyz", &["--no-covariance"]);
    assert!(run.stdout.contains("found from the residuals of"), "{}", run.stdout);
    let knots = &parameter(&folder, "noise_found")["knots"];
    let middle = knots[knots.as_array().unwrap().len() / 2]["along"].as_f64().unwrap();
    assert!((0.009..0.011).contains(&middle), "{knots}");
}

#[test]
fn points_without_noise_have_no_covariance() {
    let folder = Folder::new();
    let points: Vec<_> =
        (0..4000).map(|i| [f64::from(i % 80) * 0.02, 4.0, f64::from(i / 80) * 0.02]).collect();
    std::fs::write(folder.path("exact.xyz"), lines(&points)).unwrap();
    let _ = extract(&folder, "exact.xyz", &[]);
    assert_eq!(planes_in(&folder, "out").len(), 1);
    assert!(planes_in(&folder, "out").iter().all(|plane| plane.covariance.is_none()));
}

/// The views of the room as files of their own, with their poses.
fn views(folder: &Folder) -> [String; 2] {
    let params = Params { points: Some(60_000), seed: 2, ..Params::default() };
    let scans = Scene::new(SceneKind::Room).generate(&params).unwrap();
    let mut poses = String::new();
    for (number, labelled) in scans.scans.iter().enumerate() {
        std::fs::write(folder.path(&format!("view{number:02}.xyz")), lines(labelled.scan.points())).unwrap();
        let Frame::Sensor { pose } = labelled.scan.frame() else { panic!("a view has a pose") };
        let rows = pose.rotation().into_iter().zip(pose.translation());
        let row: Vec<_> = rows.map(|([a, b, c], t)| format!("{a} {b} {c} {t}")).collect();
        writeln!(poses, "{}", row.join(" ")).unwrap();
    }
    std::fs::write(folder.path("poses.txt"), poses).unwrap();
    ["view*.xyz", "poses.txt"].map(|name| folder.path(name))
}

#[test]
fn a_posed_sequence_tells_errors_by_distance_and_those_of_poses() {
    let folder = Folder::new();
    let [_, poses] = views(&folder);
    let run = extract(&folder, "view*.xyz", &["--poses", &poses]);
    assert!(run.stdout.contains("along rays"), "{}", run.stdout);
    let noise = parameter(&folder, "noise_found");
    let knots = noise["knots"].as_array().unwrap();
    assert!(knots.iter().all(|knot| knot["range"].as_f64().unwrap() > 0.0), "{noise}");
    let sure = planes_in(&folder, "out").swap_remove(0);
    check(&sure);

    let _ = extract(&folder, "view*.xyz", &["--poses", &poses, "--pose-sigma", "0.02,0deg"]);
    let unsure = planes_in(&folder, "out").swap_remove(0);
    check(&unsure);
    // Two centimetres that all points of a view share, and at most fourteen views.
    assert!(own(&unsure).offset() > 0.02 / 14_f64.sqrt() && own(&unsure).offset() < 0.03, "{unsure:?}");
    assert!(own(&unsure).offset() > 3.0 * own(&sure).offset(), "{sure:?}");
}
