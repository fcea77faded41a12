//! What a plane says of itself against the points labelled with it.

use terrace::{Frame, Params, PlaneMap, Scan, Sigma};
use terrace_normals::fit_centres;
use terrace_synth::{LabelledScan, Scene};

use crate::common::{angle, check_sound, dot, map, map_of, rough, scans, square, tenth, turned, unknown};

fn points_of(scans: &[LabelledScan], map: &PlaneMap, index: usize) -> Vec<[f64; 3]> {
    let points = scans.iter().flat_map(|s| s.scan.world_points());
    let labelled = points.zip(&map.labels).filter(|(_, l)| l.is_some_and(|id| id.index() == index));
    labelled.map(|(p, _)| p.unwrap().position).collect()
}

#[test]
fn planes_of_regions_are_near_those_of_the_labelled_points() {
    for scene in [Scene::room(), Scene::corridor(), Scene::table()] {
        let scans = scans(&scene, 60_000, 2);
        for estimate in [None, Params::default().estimate] {
            let found = map_of(Params { estimate, ..Params::default() }, &scans);
            check_sound(&found);
            assert!(found.planes.len() >= 3);
            for (index, plane) in found.planes.iter().enumerate() {
                let fit = fit_centres(&points_of(&scans, &found, index)).unwrap();
                // The least squares, and those from the plane of the region, which was fitted to whole cells.
                let ratio = plane.rms / fit.rms();
                assert!(ratio > 1.0 - 1e-6 && ratio < 1.25, "{} {}", fit.rms(), plane.rms);
                // Places of points are kept with 16 bits, within their cell.
                assert!((0..3).all(|i| (fit.centroid[i] - plane.centroid[i]).abs() < 1e-6));
                let turned = if plane.points > 2_000 { 0.005 } else { 0.03 };
                assert!(angle(fit.normal, plane.plane.normal()) < turned, "{} points", plane.points);
                assert!(plane.plane.signed_distance(fit.centroid).abs() < 0.35 * plane.rms);
            }
        }
    }
}

#[test]
fn without_an_estimate_clusters_have_the_coefficients_of_the_labelled_points() {
    for scene in [Scene::room(), Scene::corridor(), Scene::table()] {
        let scans = scans(&scene, 60_000, 2);
        let found = map_of(Params { estimate: None, ..Params::clusters() }, &scans);
        check_sound(&found);
        assert!(found.planes.len() >= 3);
        for (index, plane) in found.planes.iter().enumerate() {
            let fit = fit_centres(&points_of(&scans, &found, index)).unwrap();
            assert!(angle(fit.normal, plane.plane.normal()) < 1e-6);
            assert!((fit.rms() - plane.rms).abs() < 1e-9);
            assert!((0..3).all(|i| (fit.centroid[i] - plane.centroid[i]).abs() < 1e-9));
            assert!(plane.plane.signed_distance(fit.centroid).abs() < 1e-9);
        }
    }
}

#[test]
fn normals_face_the_sensors() {
    let scans = scans(&Scene::room(), 60_000, 2);
    let sensors: Vec<_> = scans
        .iter()
        .flat_map(|s| std::iter::repeat_n(s.scan.sensor_position().unwrap(), s.scan.len()))
        .collect();
    for params in [Params::default(), Params::clusters()] {
        let found = map_of(params, &scans);
        for plane in &found.planes {
            let (mut before, mut behind) = (0, 0);
            for (sensor, label) in sensors.iter().zip(&found.labels) {
                if *label == Some(plane.id) {
                    let side = plane.plane.signed_distance(*sensor);
                    if side > 0.0 { before += 1 } else { behind += 1 }
                }
            }
            assert!(before > behind, "plane {} of {} points: {before} {behind}", plane.id, plane.points);
        }
    }
}

fn seen_from(points: Vec<[f64; 3]>, sensor: Option<[f64; 3]>) -> Scan {
    Scan::new(points, Sigma::Unknown, Frame::World { sensor }).unwrap()
}

#[test]
fn the_side_of_a_floor_is_that_of_its_sensor() {
    let cases = [
        (Some([1.0, 1.0, 1.0]), 1.0),
        (Some([1.0, 1.0, -1.0]), -1.0),
        // Beside the floor, and in its plane, which decides nothing: the largest component is positive.
        (Some([50.0, 1.0, -0.5]), -1.0),
        (Some([1.0, 1.0, 0.05]), 1.0),
        (None, 1.0),
    ];
    for (sensor, sign) in cases {
        for preset in [Params::default, Params::clusters] {
            let found = map(tenth(preset), &[&seen_from(square(0.05), sensor)]);
            assert_eq!(found.planes[0].plane.normal(), [0.0, 0.0, sign], "{sensor:?}");
        }
    }
}

#[test]
fn planes_seen_by_more_points_from_one_side_face_that_side() {
    // The two sensors saw different halves; the one above saw two thirds.
    let (near, far): (Vec<_>, Vec<_>) = square(0.05).into_iter().partition(|p| p[0] < 1.3);
    let above = seen_from(near, Some([1.0, 1.0, 2.0]));
    let below = seen_from(far, Some([1.0, 1.0, -2.0]));
    for order in [[&above, &below], [&below, &above]] {
        for preset in [Params::default, Params::clusters] {
            let found = map(tenth(preset), &order);
            assert_eq!(found.planes.len(), 1);
            assert_eq!(found.planes[0].plane.normal(), [0.0, 0.0, 1.0]);
        }
    }
}

#[test]
fn small_clusters_are_no_planes() {
    let scans = scans(&Scene::room(), 60_000, 2);
    let mut last = usize::MAX;
    for min_cells in [1, 5, 20, 100] {
        let found = map_of(Params { min_cells, ..Params::clusters() }, &scans);
        check_sound(&found);
        assert!(found.planes.iter().all(|p| p.cells >= min_cells));
        assert!(found.planes.len() < last, "{min_cells}");
        last = found.planes.len();
    }
}

#[test]
fn the_summary_adds_up() {
    let scans = scans(&Scene::room(), 30_000, 2);
    for params in [Params::default(), Params::clusters()] {
        let found = map_of(params, &scans);
        let summary = found.summary();
        assert_eq!((summary.points, summary.planes), (30_000, found.planes.len()));
        assert_eq!(summary.labelled as u64, found.planes.iter().map(|p| p.points).sum::<u64>());
        let mean = summary.normal_uncertainty_mean.unwrap();
        for i in 0..3 {
            let total: f64 = found.planes.iter().map(|p| p.normal_uncertainty.unwrap()[i]).sum();
            assert!((mean[i] - total / found.planes.len() as f64).abs() < 1e-15);
        }
        for plane in &found.planes {
            assert_eq!(found.plane(plane.id), Some(plane));
        }
        let beyond = terrace::PlaneId::from_index(found.planes.len()).unwrap();
        assert_eq!(found.plane(beyond), None);
    }
}

#[test]
fn tau_is_a_tenth_of_the_median_density_and_at_least_four() {
    let dense = map(tenth(Params::default), &[&unknown(&square(0.05)); 8]);
    // 25 points of a lattice of 2 cm in a cell of 10 cm, eight times.
    assert_eq!(dense.used.tau, 20);
    assert_eq!(map(tenth(Params::default), &[&unknown(&square(0.05))]).used.tau, 4);
    let given = Params { tau: Some(26), ..tenth(Params::default) };
    let none = map(given, &[&unknown(&square(0.05))]);
    assert_eq!((none.used.tau, none.cell_counts.dense), (26, 0));
}

#[test]
fn poses_take_points_to_the_world() {
    let pose = terrace::Pose::from_quaternion([0.3, -0.2, 0.7], [0.3, -0.5, 0.2, 0.7]).unwrap();
    let posed = Scan::new(rough(0.05), Sigma::Uniform(0.001), Frame::Sensor { pose }).unwrap();
    let world: Vec<_> = rough(0.05).into_iter().map(turned).collect();
    let sensor = Some(pose.translation());
    let moved = Scan::new(world, Sigma::Uniform(0.001), Frame::World { sensor }).unwrap();
    for params in [tenth(Params::default), tenth(Params::clusters)] {
        assert_eq!(map(params, &[&posed]), map(params, &[&moved]));
        let found = map(params, &[&posed]);
        assert!(
            dot(found.planes[0].plane.normal(), pose.rotate([0.0, 0.0, 1.0])) < -0.999,
            "the sensor is below"
        );
    }
}
