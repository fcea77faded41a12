//! Rigid motion of the input moves the output and changes nothing else.

use terrace::{Params, PlaneMap, Pose};
use terrace_synth::Scene;

use crate::common::{PRESETS, angle, check_sound, map_of, scans};

/// A power of two, so that ten million metres are a whole number of cells.
const CELL: f64 = 0.125;
const FAR: f64 = 1e7;

fn params(preset: fn() -> Params) -> Params {
    Params { cell_size: Some(CELL), ..preset() }
}

fn shifted(offset: [f64; 3]) -> Pose {
    Pose::from_quaternion(offset, [0.0, 0.0, 0.0, 1.0]).unwrap()
}

#[test]
fn whole_numbers_of_cells_move_the_planes_and_change_no_label() {
    // Coordinates of ten million metres are rounded to 2e-9 m. Cells hold at least four points on 0.125 m, which turns a
    // rounding into an angle of less than 1e-7.
    let room = Scene::room();
    for preset in PRESETS {
        let still = map_of(params(preset), &scans(&room, 60_000, 4));
        // Regions are looked for at resolutions up to four cells: those are to be moved by whole numbers as well.
        let near = if preset().regions.is_some() { [12.5, -3.5, 0.0] } else { [12.5, -3.75, 0.0] };
        for offset in [[FAR, -FAR, FAR], [-FAR, 0.0, 2.5 * FAR], near] {
            let moved =
                map_of(params(preset), &scans(&room.transformed(&shifted(offset)).unwrap(), 60_000, 4));
            check_sound_far(&moved);
            assert!(moved.labels == still.labels, "{offset:?}");
            assert_eq!(moved.cell_counts, still.cell_counts);
            for (a, b) in still.planes.iter().zip(&moved.planes) {
                assert_eq!((a.points, a.cells), (b.points, b.cells));
                assert_eq!(a.phi.is_some(), b.phi.is_some());
                let phis = a.phi.zip(b.phi);
                assert!(
                    phis.is_none_or(|(a, b)| (a - b).abs() < 1e-7),
                    "the ends of a step are distances of normals"
                );
                assert!(angle(a.plane.normal(), b.plane.normal()) < 1e-7);
                for i in 0..3 {
                    assert!((a.centroid[i] + offset[i] - b.centroid[i]).abs() < 1e-8);
                    let [s, t] = [a, b].map(|plane| plane.normal_uncertainty.unwrap()[i]);
                    assert!((s - t).abs() < 1e-6);
                }
                // The offset d is a product with numbers of 1e7, rounded like them.
                let on_it = b.estimate.map_or(b.centroid, |estimate| estimate.centroid);
                assert!(b.plane.signed_distance(on_it).abs() < 2e-8);
                assert!((a.rms - b.rms).abs() < 1e-8);
            }
        }
    }
}

fn check_sound_far(map: &PlaneMap) {
    check_sound(map);
    assert!(map.planes.len() > 5);
}

/// For every plane of `still` of at least a twentieth of the points, the largest share of its points that one plane of
/// `moved` holds, and how far that one is off, as an angle and a distance.
fn compare(still: &PlaneMap, moved: &PlaneMap, pose: &Pose) -> Vec<(f64, f64, f64)> {
    let large = still.planes.iter().filter(|p| p.points * 20 > still.labels.len() as u64);
    large
        .map(|plane| {
            let mut shared = vec![0_u64; moved.planes.len()];
            for (a, b) in still.labels.iter().zip(&moved.labels) {
                if let (true, Some(b)) = (*a == Some(plane.id), b) {
                    shared[b.index()] += 1;
                }
            }
            let best = (0..shared.len()).max_by_key(|i| shared[*i]).unwrap();
            let found = &moved.planes[best];
            let turned = angle(pose.rotate(plane.plane.normal()), found.plane.normal());
            let away = found.plane.signed_distance(pose.transform(plane.centroid)).abs();
            (shared[best] as f64 / plane.points as f64, turned, away)
        })
        .collect()
}

#[test]
fn any_motion_keeps_the_large_planes() {
    // Cells cut the surfaces elsewhere, so that borders differ: by a tenth of the points at most.
    let room = Scene::room();
    let poses = [
        Pose::from_quaternion([0.05, -0.031, 0.077], [0.0, 0.0, 0.0, 1.0]).unwrap(),
        Pose::from_quaternion([0.0; 3], [0.0, 0.0, 0.5_f64.sqrt(), 0.5_f64.sqrt()]).unwrap(),
        Pose::from_quaternion([3.3, -7.7, 100.1], [0.1, 0.2, -0.3, 0.9]).unwrap(),
        Pose::from_quaternion([FAR, 1.1 * FAR, -0.7 * FAR], [-0.5, 0.1, 0.6, 0.3]).unwrap(),
    ];
    for preset in [Params::default, Params::clusters] {
        let still = map_of(params(preset), &scans(&room, 100_000, 4));
        for pose in &poses {
            let moved = map_of(params(preset), &scans(&room.transformed(pose).unwrap(), 100_000, 4));
            check_sound(&moved);
            let pairs = compare(&still, &moved, pose);
            assert!(pairs.len() >= 6, "{} large planes", pairs.len());
            for (share, turned, away) in pairs {
                assert!(
                    share > 0.9 && turned < 0.01 && away < 0.01,
                    "{share} {turned} {away} after {pose:?}"
                );
            }
        }
    }
}
