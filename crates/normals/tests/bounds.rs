//! Bounds of eigenvalues against the eigen-solver.

use glam::{DQuat, DVec3};
use proptest::prelude::*;
use terrace_normals::{EigenvalueBounds, symmetric_eigen};
use terrace_stats::{Moments, SymmetricMatrix3, UncertainVector};

/// The scatter of places in a box of these sizes, turned.
fn scatter(places: &[[f64; 3]], sizes: DVec3, turn: [f64; 3]) -> SymmetricMatrix3 {
    let axis = DVec3::from(turn).try_normalize().unwrap_or(DVec3::X);
    let rotation = DQuat::from_axis_angle(axis, 3.0 * turn[0]);
    let mut moments = Moments::EMPTY;
    for place in places {
        moments.push(&UncertainVector::exact((rotation * (DVec3::from(*place) * sizes)).to_array()));
    }
    moments.covariance().unwrap_or(SymmetricMatrix3::ZERO)
}

proptest! {
    /// From a line to a ball, of any thickness, turned in any way.
    #[test]
    fn bounds_hold_and_tell(
        places in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 3..40),
        sizes in prop::array::uniform3(-6.0..0.0_f64),
        turn in prop::array::uniform3(-1.0..1.0_f64),
        normal in prop::array::uniform3(-1.0..1.0_f64),
        near in 0.0..0.3_f64,
        flat in any::<bool>(),
    ) {
        let sizes = if flat { DVec3::new(1.0, 0.7, 10_f64.powf(sizes[2])) } else { sizes.map(|s| 10_f64.powf(s)).into() };
        let c = scatter(&places, sizes, turn);
        let eigen = symmetric_eigen(&c);
        let [l0, l1, l2] = eigen.values;
        let rounding = 1e-14 * (l0 + l1 + l2);
        let bounds = EigenvalueBounds::of(&c);
        // Beside others, which take more steps or fewer.
        let others = [SymmetricMatrix3::ZERO, SymmetricMatrix3::diagonal([1.0, 0.99, 0.98])];
        prop_assert_eq!(EigenvalueBounds::of_all(&[others[0], c, others[1]])[1], bounds);
        let EigenvalueBounds { least, middle, most } = bounds;
        prop_assert!(least[0] <= l0 + rounding && l0 <= least[1] + rounding, "{least:?} {l0}");
        prop_assert!(middle[0] <= l1 + rounding && l1 <= middle[1] + rounding, "{middle:?} {l1}");
        prop_assert!(most <= l2 + rounding);
        // Of a plane they tell nearly all.
        let is_plane = l0 < 0.1 * l1 && l1 > 0.01 * l2;
        if is_plane {
            prop_assert!(middle[1] - middle[0] <= 1e-3 * l1 && least[1] - least[0] <= 1e-5 * l1);
        }
        // Directions close to the normal and far from it.
        let first = DVec3::from(eigen.vectors[0]);
        for direction in [DVec3::from(normal), first + near * DVec3::from(normal)] {
            let direction = direction.try_normalize().unwrap_or(DVec3::Z);
            let sine_squared = direction.cross(first).length_squared();
            let along = c.quadratic_form(direction.to_array());
            for angle in [0.1_f64, 0.3] {
                let within = bounds.is_within(along, angle.sin().powi(2));
                prop_assert!(!within || sine_squared <= angle.sin().powi(2) * (1.0 + 1e-9));
                // What is closer by more than the longer axis can hide is told.
                prop_assert!(within || !is_plane || sine_squared * l2 > 0.9 * angle.sin().powi(2) * l1);
            }
        }
    }
}

#[test]
fn what_is_no_plane_has_wide_bounds_that_hold() {
    for diagonal in [[0.0; 3], [1.0; 3], [1.0, 0.0, 0.0], [1e-300; 3], [1e-8, 1.0, 1e-8]] {
        let EigenvalueBounds { least, middle, most } =
            EigenvalueBounds::of(&SymmetricMatrix3::diagonal(diagonal));
        let mut values = diagonal;
        values.sort_by(f64::total_cmp);
        assert!(least[0] <= values[0] && values[0] <= least[1], "{diagonal:?} {least:?}");
        assert!(middle[0] <= values[1] && values[1] <= middle[1], "{diagonal:?} {middle:?}");
        assert!(most <= values[2], "{diagonal:?} {most}");
    }
    let nan = EigenvalueBounds::of(&SymmetricMatrix3([f64::NAN; 6]));
    assert!(!nan.is_within(0.0, 0.5));
}
