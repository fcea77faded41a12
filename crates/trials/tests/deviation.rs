//! The error of an estimate does not depend on where the world is and which way the normal points.

#![allow(clippy::unwrap_used, reason = "tests")]

use glam::{DQuat, DVec3};
use proptest::prelude::*;
use terrace::{Mapper, Params, PlaneEstimate};
use terrace_trials::Deviation;
use terrace_types::{Frame, Plane, Scan, Sigma};

/// An estimate as the mapper makes it, of a plane of 1 × 1 m.
fn estimate() -> PlaneEstimate {
    let at = |k: u32| 0.01 * f64::from(k) + 0.003;
    let noise = |i: u32, j: u32| 0.002 * f64::from((i * 7919 + j * 104_729) % 200) / 100.0 - 0.002;
    let points = (0..100).flat_map(|i| (0..100).map(move |j| [at(i), at(j), 0.05 + noise(i, j)]));
    let frame = Frame::World { sensor: None };
    let scan = Scan::new(points.collect(), Sigma::Uniform(0.0012), frame).unwrap();
    let mut mapper = Mapper::new(Params { cell_size: Some(0.1), ..Params::default() }).unwrap();
    mapper.insert(&scan).unwrap();
    mapper.extract().unwrap().planes[0].estimate.unwrap()
}

fn moved(estimate: &PlaneEstimate, turn: DQuat, shift: DVec3) -> PlaneEstimate {
    let centroid = (turn * DVec3::from(estimate.centroid) + shift).to_array();
    let normal = (turn * DVec3::from(estimate.plane.normal())).to_array();
    PlaneEstimate {
        plane: Plane::through(centroid, normal).unwrap(),
        centroid,
        axes: estimate.axes.map(|axis| (turn * DVec3::from(axis)).to_array()),
        ..*estimate
    }
}

/// The estimate tilted and shifted, as the truth.
fn truth(estimate: &PlaneEstimate, tilts: [f64; 2], offset: f64) -> Plane {
    let normal = DVec3::from(estimate.plane.normal());
    let tilted = normal - tilts[0] * DVec3::from(estimate.axes[0]) - tilts[1] * DVec3::from(estimate.axes[1]);
    let point = DVec3::from(estimate.centroid) - offset * normal;
    Plane::through(point.to_array(), tilted.to_array()).unwrap()
}

#[test]
fn the_truth_itself_has_no_error() {
    let estimate = estimate();
    for plane in [estimate.plane, estimate.plane.flipped()] {
        let deviation = Deviation::of(&estimate, &plane);
        assert!(deviation.squared.unwrap() < 1e-20 && deviation.tilt_offset.iter().all(|e| e.abs() < 1e-15));
    }
}

#[test]
fn a_covariance_without_an_inverse_is_refused() {
    let estimate = PlaneEstimate { tilt_offset: [[0.0; 3]; 3], ..estimate() };
    assert_eq!(Deviation::of(&estimate, &estimate.plane).squared, None);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn motions_and_flips_change_nothing(
        tilts in prop::array::uniform2(-0.01..0.01),
        offset in -0.01..0.01,
        axis in prop::array::uniform3(-1.0..1.0).prop_filter("no axis", |a| DVec3::from(*a).length() > 0.1),
        angle in -3.0..3.0,
        shift in prop::array::uniform3(-100.0..100.0),
    ) {
        let estimate = estimate();
        let truth = truth(&estimate, tilts, offset);
        let deviation = Deviation::of(&estimate, &truth);
        // As it was made, to first order: the offset is along another normal.
        let made = [tilts[0], tilts[1], offset];
        for (found, made) in deviation.tilt_offset.iter().zip(made) {
            prop_assert!((found - made).abs() < 1e-4, "{found} {made}");
        }
        let (turn, shift) = (DQuat::from_axis_angle(DVec3::from(axis).normalize(), angle), DVec3::from(shift));
        let there = moved(&estimate, turn, shift);
        let normal = (turn * DVec3::from(truth.normal())).to_array();
        let on = DVec3::from(estimate.centroid) - truth.signed_distance(estimate.centroid) * DVec3::from(truth.normal());
        let true_there = Plane::through((turn * on + shift).to_array(), normal).unwrap();
        let squared = deviation.squared.unwrap();
        for truth in [true_there, true_there.flipped()] {
            let moved = Deviation::of(&there, &truth).squared.unwrap();
            prop_assert!((moved - squared).abs() <= 1e-6 * (1.0 + squared), "{moved} {squared}");
        }
        let turned_round = PlaneEstimate { plane: estimate.plane.flipped(), ..estimate };
        let other_side = Deviation::of(&turned_round, &truth).squared.unwrap();
        prop_assert!((other_side - squared).abs() <= 1e-9 * (1.0 + squared));
    }

    #[test]
    fn twice_the_covariance_is_half_the_square(
        tilts in prop::array::uniform2(-0.01..0.01),
        offset in -0.01..0.01,
    ) {
        let estimate = estimate();
        let truth = truth(&estimate, tilts, offset);
        let doubled =
            PlaneEstimate { tilt_offset: estimate.tilt_offset.map(|row| row.map(|c| 2.0 * c)), ..estimate };
        let [once, twice] = [estimate, doubled].map(|e| Deviation::of(&e, &truth).squared.unwrap());
        prop_assert!((once - 2.0 * twice).abs() <= 1e-9 * once);
    }
}
