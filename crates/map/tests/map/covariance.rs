//! The covariance of extracted planes against the truth of scenes with known noise.

use terrace::{Estimate, ExtractedPlane, Frame, Mapper, Params, PlaneEstimate, Pose, PoseNoise, Scan, Sigma};
use terrace_calibration::{Calibration, squared_mahalanobis};
use terrace_noise::SensorNoise;
use terrace_synth::{Scene, TruePlane, misplaced, perturbed, stated};

use crate::common::{angle, cloud, dot, map, rough, square, tenth, unknown};

/// Squared error of tilt and offset in units of their covariance.
fn squared_error(found: &PlaneEstimate, truth: &TruePlane) -> f64 {
    let normal = found.plane.normal();
    let sign = dot(truth.plane.normal(), normal).signum();
    let along = sign * dot(truth.plane.normal(), normal);
    let tilts = found.axes.map(|axis| sign * dot(truth.plane.normal(), axis) / along);
    let offset = -sign * truth.plane.signed_distance(found.centroid);
    squared_mahalanobis([tilts[0], tilts[1], offset], found.tilt_offset).unwrap()
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

/// Planes found in both ways have covariances.
const ESTIMATED: [fn() -> Params; 2] = [Params::default, Params::clusters];

/// Of the planes of noisy copies of a scene that have a fiftieth of its points.
fn over_copies(
    preset: fn() -> Params,
    exact: &[Scan],
    truth: &[TruePlane],
    copies: u64,
    insert: impl Fn(&mut Mapper, &Scan, u64, u64),
) -> (Calibration, Vec<PlaneEstimate>) {
    let mut found = Calibration::new(3).unwrap();
    let mut estimates = Vec::new();
    for copy in 0..copies {
        let mut mapper = Mapper::new(preset()).unwrap();
        for (scan, stream) in exact.iter().zip(0..) {
            insert(&mut mapper, &perturbed(scan, copy, stream), copy, stream);
        }
        let map = mapper.extract().unwrap();
        for plane in map.planes.iter().filter(|p| 50 * p.points > map.labels.len() as u64) {
            let Some((estimate, truth)) = matched(plane, truth) else { continue };
            found.push(squared_error(&estimate, truth)).unwrap();
            estimates.push(estimate);
        }
    }
    (found, estimates)
}

fn plainly(mapper: &mut Mapper, scan: &Scan, _: u64, _: u64) {
    mapper.insert(scan).unwrap();
}

/// Exact points, and the errors that are told and drawn.
fn white(scene: &Scene, points: usize, sigma: f64) -> (Vec<Scan>, Vec<TruePlane>) {
    let params = terrace_synth::Params { points: Some(points), sigma: Some(0.0), seed: 1 };
    let made = scene.generate(&params).unwrap();
    let state = |s: terrace_synth::LabelledScan| s.scan.with_sigma(Sigma::Uniform(sigma)).unwrap();
    (made.scans.into_iter().map(state).collect(), made.planes)
}

/// Exact points of a room, with the errors of a Kinect.
fn room_seen_by_a_camera(points: usize) -> (Vec<Scan>, Vec<TruePlane>) {
    let scene = Scene::room();
    let params = terrace_synth::Params { points: Some(points), sigma: Some(0.0), seed: 1 };
    let made = scene.generate(&params).unwrap();
    let kinect: SensorNoise = "kinect".parse().unwrap();
    let state = |s: &terrace_synth::LabelledScan| stated(&s.scan, &kinect, scene.optical_axis()).unwrap();
    (made.scans.iter().map(state).collect(), made.planes)
}

/// Each value of χ² of three degrees by three scatters by √(2/3); four standard errors of their mean.
fn tolerance(found: &Calibration) -> f64 {
    4.0 * (2.0 / 3.0 / found.count() as f64).sqrt()
}

/// White noise of 4 mm and 1 cm on surfaces that touch at their edges, turned against the grid, and along it.
#[test]
fn planes_are_as_far_off_as_they_say() {
    for (scene, sigma) in [(Scene::table(), 0.004), (Scene::desk(), 0.01)] {
        let (exact, truth) = white(&scene, 30_000, sigma);
        for preset in ESTIMATED {
            let (found, estimates) = over_copies(preset, &exact, &truth, 40, plainly);
            assert!(found.count() > 100, "{}", found.count());
            let nees = found.nees().unwrap();
            assert!((nees - 1.0).abs() < tolerance(&found) + 0.05, "{}: {nees}", scene.kind().name());
            assert!(estimates.iter().all(|e| (e.reduced_chi_squared - 1.0).abs() < 0.3));
            let grown = estimates.iter().filter(|e| e.growth > 1.0).count();
            assert!(20 * grown < estimates.len(), "{grown}");
        }
    }
}

/// A camera's errors lie mostly along its rays, and a door stands a hand's breadth behind its wall.
#[test]
fn planes_seen_along_rays_are_as_far_off_as_they_say() {
    let (exact, truth) = room_seen_by_a_camera(150_000);
    for preset in ESTIMATED {
        let (found, _) = over_copies(preset, &exact, &truth, 12, plainly);
        assert!(found.count() > 80, "{}", found.count());
        let nees = found.nees().unwrap();
        assert!((nees - 1.0).abs() < tolerance(&found) + 0.1, "{nees}");
    }
}

/// NEES of the planes of a room whose scans are off as a whole, and how far it may be from 1; told so, or not.
fn nees_with_wrong_poses(preset: fn() -> Params, told: bool) -> (f64, f64) {
    let (exact, truth) = white(&Scene::room(), 100_000, 0.005);
    let noise = PoseNoise::from_degrees(0.01, 0.3).unwrap();
    let insert = |mapper: &mut Mapper, scan: &Scan, copy: u64, stream: u64| {
        let moved = misplaced(scan, &noise, copy, stream).unwrap();
        mapper.insert_from(&moved, told.then_some(noise)).unwrap();
    };
    let (found, _) = over_copies(preset, &exact, &truth, 12, insert);
    assert!(found.count() > 60, "{}", found.count());
    (found.nees().unwrap(), tolerance(&found))
}

/// Told so, planes are less sure, untold they are too sure by far.
#[test]
fn the_error_of_a_pose_counts_once_for_a_scan() {
    let (told, tolerance) = nees_with_wrong_poses(Params::clusters, true);
    assert!((told - 1.0).abs() < tolerance + 0.15, "{told}");
    for preset in ESTIMATED {
        let (untold, _) = nees_with_wrong_poses(preset, false);
        assert!(untold > 3.0, "{untold}");
    }
}

/// Scans that are off against each other by several times the errors of their points see one wall, if that is told.
#[test]
fn a_wall_that_scans_see_apart_is_one_plane_where_errors_of_poses_are_told() {
    let pose = PoseNoise::from_degrees(0.05, 0.0).unwrap();
    let scans: Vec<Scan> = (0..6_u8)
        .map(|k| {
            // Each goes on where the one before ends, and sees a third of that.
            let wall = |i: u16| [f64::from(i % 60) * 0.025 + f64::from(k), f64::from(i / 60) * 0.025, 2.0];
            let points: Vec<[f64; 3]> = (0..60 * 60).map(wall).collect();
            let frame = Frame::Sensor { pose: Pose::IDENTITY };
            let exact = Scan::new(points, Sigma::Uniform(0.01), frame).unwrap();
            misplaced(&perturbed(&exact, 5, k.into()), &pose, 5, k.into()).unwrap()
        })
        .collect();
    let found = |told: Option<PoseNoise>| {
        let mut mapper = Mapper::new(Params::default()).unwrap();
        for scan in &scans {
            mapper.insert_from(scan, told).unwrap();
        }
        let map = mapper.extract().unwrap();
        (map.planes.len(), map.summary().labelled as f64 / map.labels.len() as f64)
    };
    let ((planes, labelled), (untold, _)) = (found(Some(pose)), found(None));
    assert!(planes == 1 && labelled > 0.98 && untold > 2, "{planes} {labelled} {untold}");
}

#[test]
fn the_error_of_a_pose_counts_once_for_a_scan_where_regions_are_grown() {
    let (told, tolerance) = nees_with_wrong_poses(Params::default, true);
    assert!((told - 1.0).abs() < tolerance + 0.15, "{told}");
}

/// Residuals of flat places tell how large errors are that nobody stated.
#[test]
fn unknown_errors_are_found_out() {
    let (exact, truth) = white(&Scene::table(), 30_000, 0.008);
    let unstated = |mapper: &mut Mapper, scan: &Scan, _: u64, _: u64| {
        mapper.insert(&scan.clone().with_sigma(Sigma::Unknown).unwrap()).unwrap();
        let level = mapper.extract().unwrap().noise.unwrap();
        assert!((level.at(None).0 / 0.008 - 1.0).abs() < 0.1, "{level:?}");
    };
    for preset in ESTIMATED {
        let (found, _) = over_copies(preset, &exact, &truth, 30, unstated);
        let nees = found.nees().unwrap();
        assert!((nees - 1.0).abs() < tolerance(&found) + 0.1, "{nees}");
    }
}

/// Nor does a board that leans at a wall take what scatters at its edges for noise: its columns are few, and most hold something else.
#[test]
fn errors_that_are_found_out_are_those_of_the_plane_alone() {
    let (exact, truth) = room_seen_by_a_camera(300_000);
    let board = truth.iter().find(|plane| plane.name == "board").unwrap();
    let mut found = Calibration::new(3).unwrap();
    for copy in 0..12 {
        let mut mapper = Mapper::new(Params::default()).unwrap();
        for (scan, stream) in exact.iter().zip(0..) {
            mapper.insert(&perturbed(scan, copy, stream).with_sigma(Sigma::Unknown).unwrap()).unwrap();
        }
        for plane in &mapper.extract().unwrap().planes {
            if let Some((estimate, _)) = matched(plane, std::slice::from_ref(board)) {
                found.push(squared_error(&estimate, board)).unwrap();
            }
        }
    }
    let nees = found.nees().unwrap();
    assert!(found.count() > 4 && (nees - 1.0).abs() < tolerance(&found) + 0.1, "{} {nees}", found.count());
}

/// As a function of the distance, where it is known from where points were seen.
#[test]
fn unknown_errors_are_found_out_by_distance() {
    let scene = Scene::room();
    let made =
        scene.generate(&terrace_synth::Params { points: Some(150_000), sigma: None, seed: 3 }).unwrap();
    for preset in ESTIMATED {
        let mut mapper = Mapper::new(preset()).unwrap();
        for scan in &made.scans {
            mapper.insert(&scan.scan.clone().with_sigma(Sigma::Unknown).unwrap()).unwrap();
        }
        let level = mapper.extract().unwrap().noise.unwrap();
        assert!(level.knots.len() > 3 && level.knots.is_sorted_by(|a, b| a.range <= b.range), "{level:?}");
        // Along the rays, and there alone, it is 6.1 mm at 2 m of depth and 14 mm at 3 m; the range is up to a quarter more.
        let [near, far] = [2.2, 3.3].map(|range| level.at(Some(range)));
        assert!((0.004..0.008).contains(&near.0) && (0.009..0.018).contains(&far.0), "{near:?} {far:?}");
        assert!(near.1 < 0.5 * near.0 && far.1 < 0.5 * far.0, "{near:?} {far:?}");
    }
}

#[test]
fn unasked_for_exact_points_and_in_the_papers_way_there_is_no_estimate() {
    for preset in ESTIMATED {
        let flat = map(tenth(preset), &[&unknown(&square(0.75))]);
        assert!(!flat.planes.is_empty() && flat.planes.iter().all(|plane| plane.estimate.is_none()));
        assert_eq!(flat.noise, None);
    }
    let known = cloud(rough(0.7), Sigma::Uniform(1e-3));
    let asked = Some(Estimate::default());
    let without = ESTIMATED.map(|preset| map(Params { estimate: None, ..tenth(preset) }, &[&known]));
    let paper = map(Params { estimate: asked, ..tenth(Params::paper) }, &[&known]);
    for of in without.into_iter().chain([paper]) {
        assert!(!of.planes.is_empty() && of.planes.iter().all(|plane| plane.estimate.is_none()));
    }
    for scan in [known, unknown(&rough(0.7))] {
        for preset in ESTIMATED {
            let found = map(tenth(preset), &[&scan]);
            assert_eq!(found.noise.is_some(), *scan.sigma() == Sigma::Unknown);
        }
    }
}

/// However many points there are, below the floor nothing is known; a floor that is none is refused.
#[test]
fn a_floor_does_not_average_out() {
    let scan = cloud(rough(0.7), Sigma::Uniform(1e-3));
    for preset in ESTIMATED {
        let of = |floor: f64| {
            let params = Params { estimate: Some(Estimate { floor }), ..tenth(preset) };
            map(params, &[&scan]).planes[0].estimate.unwrap().tilt_offset
        };
        let (without, with) = (of(0.0), of(0.01));
        assert!((with[2][2] - without[2][2] - 1e-4).abs() < 1e-5);
        // A square of 2 m has an rms extent of 2/√12 m; less where its border is left out.
        assert!((1e-2..3e-2).contains(&with[0][0].sqrt()) && without[0][0].sqrt() < 1e-3);
    }
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(
            Mapper::new(Params { estimate: Some(Estimate { floor: bad }), ..Params::default() }).is_err()
        );
    }
}

/// A surface bent by more than its errors: its residuals show it, and it is less sure than a flat one.
#[test]
fn a_bent_surface_is_less_sure() {
    for preset in ESTIMATED {
        let of = |bend: f64| {
            let bent = |[x, y, z]: [f64; 3]| [x, y, z + bend * (x - 1.0) * (x - 1.0)];
            let scan = cloud(rough(0.7).into_iter().map(bent).collect(), Sigma::Uniform(6e-4));
            map(tenth(preset), &[&scan]).planes[0].estimate.unwrap()
        };
        let (flat, bent) = (of(0.0), of(0.01));
        assert!(flat.growth < 1.1, "{flat:?}");
        assert!(bent.growth > 10.0 && bent.reduced_chi_squared > 5.0 * flat.reduced_chi_squared, "{bent:?}");
        assert!(bent.tilt_offset[2][2] > 5.0 * flat.tilt_offset[2][2]);
    }
}

/// Around each interior cell of a flat surface there is a plane, as far off as it says, within its min-max.
#[test]
fn planes_around_cells_are_as_far_off_as_they_say() {
    let (exact, truth) = white(&Scene::table(), 30_000, 0.008);
    let mut found = Calibration::new(3).unwrap();
    let (mut components, mut exceeded) = (0, 0);
    for copy in 0..10 {
        let mut mapper = Mapper::new(Params::default()).unwrap();
        mapper.insert(&perturbed(&exact[0], copy, 0)).unwrap();
        for cell in mapper.cell_planes().unwrap() {
            let Some(estimate) = cell.estimate.filter(|e| e.columns == 9 && e.reduced_chi_squared < 1.3)
            else {
                continue;
            };
            // Off the edges, where there is one true plane near.
            let near = |t: &&TruePlane| t.plane.signed_distance(estimate.centroid).abs() < 0.15;
            let mut planes = truth.iter().filter(near);
            let (Some(plane), None) = (planes.next(), planes.next()) else { continue };
            found.push(squared_error(&estimate, plane)).unwrap();
            let sign = dot(plane.plane.normal(), estimate.plane.normal()).signum();
            for i in 0..3 {
                components += 1;
                let off = (estimate.plane.normal()[i] - sign * plane.plane.normal()[i]).abs();
                exceeded += i32::from(off > estimate.min_max.unwrap()[i]);
            }
        }
    }
    // Neighbours share points, so that there are fewer independent ones than there are.
    assert!(found.count() > 1000, "{}", found.count());
    let nees = found.nees().unwrap();
    assert!((nees - 1.0).abs() < 0.15, "{nees}");
    assert!(200 * exceeded < components, "{exceeded} of {components}");
}

/// The covariance of the coefficients is that of tilt and offset, seen from the origin.
#[test]
fn the_offset_at_the_centroid_follows_from_the_coefficients() {
    let params = terrace_synth::Params { points: Some(30_000), sigma: Some(0.004), seed: 1 };
    let made = Scene::table().generate(&params).unwrap();
    let mut mapper = Mapper::new(Params::default()).unwrap();
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
