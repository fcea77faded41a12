//! The covariance of extracted planes against the truth of scenes with known noise.

use terrace::{ExtractedPlane, Mapper, Params, PlaneEstimate, Sigma};
use terrace_synth::{Scene, TruePlane};

use crate::common::{PRESETS, angle, cloud, dot, map, rough, tenth, unknown};

fn asked(params: Params) -> Params {
    Params { estimate: true, ..params }
}

/// Squared error of tilt and offset in units of their covariance, by the three degrees of freedom.
fn nees(found: &PlaneEstimate, truth: &TruePlane) -> f64 {
    let normal = found.plane.normal();
    let sign = dot(truth.plane.normal(), normal).signum();
    let along = sign * dot(truth.plane.normal(), normal);
    let tilts = found.axes.map(|axis| sign * dot(truth.plane.normal(), axis) / along);
    let error = [tilts[0], tilts[1], -sign * truth.plane.signed_distance(found.centroid)];
    let [a, b, c] = found.tilt_offset;
    let minor = |i: usize, j: usize, rows: [[f64; 3]; 3]| {
        let [r, s] = [(i + 1) % 3, (i + 2) % 3];
        let [t, u] = [(j + 1) % 3, (j + 2) % 3];
        rows[r][t] * rows[s][u] - rows[r][u] * rows[s][t]
    };
    let rows = [a, b, c];
    let determinant: f64 = (0..3).map(|j| rows[0][j] * minor(0, j, rows)).sum();
    let mut sum = 0.0;
    for i in 0..3 {
        for j in 0..3 {
            sum += error[i] * error[j] * minor(j, i, rows) / determinant;
        }
    }
    sum / 3.0
}

/// The true plane that a plane with an estimate is, if it is one: within three degrees and five centimetres.
fn matched<'t>(plane: &ExtractedPlane, truth: &'t [TruePlane]) -> Option<(PlaneEstimate, &'t TruePlane)> {
    let found = plane.estimate?;
    let near = |t: &&TruePlane| {
        angle(t.plane.normal(), found.plane.normal()) < 0.05
            && t.plane.signed_distance(found.centroid).abs() < 0.05
    };
    Some((found, truth.iter().find(near)?))
}

/// The mean over all planes of a scene that have a fiftieth of its points, and how many they are.
fn over_seeds(scene: &Scene, points: usize, sigma: f64, seeds: u64) -> (f64, f64, usize) {
    let (mut sum, mut chi, mut count) = (0.0, 0.0, 0);
    for seed in 0..seeds {
        let params = terrace_synth::Params { points: Some(points), sigma: Some(sigma), seed };
        let made = scene.generate(&params).unwrap();
        let mut mapper = Mapper::new(asked(Params::default())).unwrap();
        for scan in &made.scans {
            mapper.insert(&scan.scan).unwrap();
        }
        for plane in mapper.extract().unwrap().planes.iter().filter(|p| p.points > points as u64 / 50) {
            let Some((found, truth)) = matched(plane, &made.planes) else { continue };
            sum += nees(&found, truth);
            chi += found.reduced_chi_squared;
            count += 1;
        }
    }
    (sum / count as f64, chi / count as f64, count)
}

/// White noise of 4 mm and 1 cm on surfaces that touch at their edges, turned against the grid, and along it.
#[test]
fn planes_are_as_far_off_as_they_say() {
    for (scene, points, sigma) in [(Scene::table(), 30_000, 0.004), (Scene::desk(), 30_000, 0.01)] {
        let (nees, chi, planes) = over_seeds(&scene, points, sigma, 40);
        assert!(planes > 100, "{planes}");
        // Five standard errors of the mean of so many χ² of three degrees, by three, are 0.37.
        assert!((0.7..1.37).contains(&nees), "{}: {nees} over {planes} planes", scene.kind().name());
        assert!((chi - 1.0).abs() < 0.02, "{chi}");
    }
}

#[test]
fn unasked_without_known_errors_or_in_the_papers_way_there_is_no_estimate() {
    for preset in PRESETS {
        let unknown = map(asked(tenth(preset)), &[&unknown(&rough(0.7))]);
        assert!(!unknown.planes.is_empty() && unknown.planes.iter().all(|plane| plane.estimate.is_none()));
    }
    let known = cloud(rough(0.7), Sigma::Uniform(1e-3));
    assert!(
        map(asked(tenth(Params::default)), &[&known]).planes.iter().all(|plane| plane.estimate.is_some())
    );
    assert!(map(tenth(Params::default), &[&known]).planes.iter().all(|plane| plane.estimate.is_none()));
    assert!(map(asked(tenth(Params::paper)), &[&known]).planes.iter().all(|plane| plane.estimate.is_none()));
}

/// The covariance of the coefficients is that of tilt and offset, seen from the origin.
#[test]
fn the_offset_at_the_centroid_follows_from_the_coefficients() {
    let params = terrace_synth::Params { points: Some(30_000), sigma: Some(0.004), seed: 1 };
    let made = Scene::table().generate(&params).unwrap();
    let mut mapper = Mapper::new(asked(Params::default())).unwrap();
    mapper.insert(&made.scans[0].scan).unwrap();
    let map = mapper.extract().unwrap();
    let estimates: Vec<PlaneEstimate> = map.planes.iter().filter_map(|plane| plane.estimate).collect();
    assert!(estimates.len() >= 3);
    for (plane, found) in map.planes.iter().filter_map(|plane| Some((plane, plane.estimate?))) {
        assert!(dot(plane.plane.normal(), found.plane.normal()) > 0.99);
        assert!(found.plane.signed_distance(found.centroid).abs() < 1e-9);
        // g C gᵀ with g = (x, y, z, 1) of the centroid: the variance of the signed distance there.
        let [x, y, z] = found.centroid;
        let at = [x, y, z, 1.0];
        let mut variance = 0.0;
        for i in 0..4 {
            for j in 0..4 {
                variance += at[i] * found.coefficients[i][j] * at[j];
            }
        }
        assert!((variance / found.tilt_offset[2][2] - 1.0).abs() < 1e-6);
    }
}
