//! A sphere and a cylinder, without noise. Where cells are clustered, patches of them pass for planes, and what is said of them
//! tells: they are small, and less certain than a square with noise. Grown regions are seen to be bent, but for a narrow strip.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

use terrace::Params;

use crate::common::{CLUSTERED, check_sound, rough, tenth_map};

const POINTS: usize = 40_000;

fn sphere() -> Vec<[f64; 3]> {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    (0..POINTS)
        .map(|_| {
            let z: f64 = rng.random_range(-1.0..1.0);
            let (sin, cos) = rng.random_range(0.0..std::f64::consts::TAU).sin_cos();
            let across = (1.0 - z * z).sqrt();
            [across * cos, across * sin, z]
        })
        .collect()
}

fn cylinder() -> Vec<[f64; 3]> {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    (0..POINTS)
        .map(|_| {
            let (sin, cos) = rng.random_range(0.0..std::f64::consts::TAU).sin_cos();
            [0.7 * cos, 0.7 * sin, rng.random_range(0.0..3.0)]
        })
        .collect()
}

#[test]
fn patches_of_curved_things_are_small_and_uncertain() {
    for preset in CLUSTERED {
        let (_, flat) = tenth_map(preset, &rough(0.05));
        for points in [sphere(), cylinder()] {
            let (_, found) = tenth_map(preset, &points);
            check_sound(&found);
            for patch in &found.planes {
                assert!(patch.points < POINTS as u64 / 8, "{}", patch.points);
                let worst = |s: [f64; 3]| s.into_iter().fold(0.0, f64::max);
                let [curved, straight] =
                    [patch, &flat.planes[0]].map(|plane| plane.normal_uncertainty.unwrap());
                assert!(worst(curved) > 2.0 * worst(straight), "{curved:?} {straight:?}");
            }
        }
    }
}

#[test]
fn a_twentieth_of_curved_things_passes_for_planes_where_regions_are_grown() {
    for points in [sphere(), cylinder()] {
        let (_, found) = tenth_map(Params::default, &points);
        check_sound(&found);
        let labelled = found.summary().labelled;
        assert!(labelled <= POINTS / 20, "{labelled} points of {} planes", found.planes.len());
    }
}
