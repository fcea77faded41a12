//! Planes of least squares: exact ones found again, moved ones moved, merged statistics, and every degenerate case.

// A test has no caller to report to, and exact values are exact.
#![allow(clippy::unwrap_used, clippy::float_cmp)]

mod motion;

use motion::{Motion, motion};
use proptest::prelude::*;
use terrace_normals::{Degenerate, FitTo, PlaneFit, estimate, fit_centres, fit_plane, fit_planes};
use terrace_stats::{Moments, Stats, UncertainVector};

fn stats(anchor: [f64; 3], points: &[[f64; 3]]) -> Stats {
    let mut stats = Stats::new(anchor);
    for p in points {
        stats.push(&UncertainVector::exact(*p));
    }
    stats
}

fn cells(points: &[[f64; 3]]) -> Vec<Stats> {
    points.iter().map(|p| stats(*p, &[*p])).collect()
}

proptest! {
    #[test]
    fn planes_side_by_side_are_those_one_by_one(
        all in prop::collection::vec(prop::collection::vec(prop::array::uniform3(-3.0..3.0_f64), 0..9), 8),
        bad in 0..8_usize,
    ) {
        let mut all: Vec<Stats> = all.iter().map(|points| stats([1.0, 0.0, -1.0], points)).collect();
        // Points on a line, and one that is no number, beside the others.
        all[bad] = stats([0.0; 3], &[[0.0; 3], [1.0; 3], [2.0; 3], [4.0; 3]]);
        all[(bad + 3) % 8].push(&UncertainVector::exact([f64::NAN, 0.0, 0.0]));
        let fits = fit_planes::<8>(all.first_chunk().unwrap());
        for (fit, stats) in fits.iter().zip(&all) {
            prop_assert_eq!(format!("{fit:?}"), format!("{:?}", fit_plane(stats)));
        }
    }
}

/// What each way to a plane says.
fn every_way(points: &[[f64; 3]]) -> [Result<PlaneFit, Degenerate>; 5] {
    let cells = cells(points);
    [
        fit_centres(points),
        fit_plane(&stats([0.0; 3], points)),
        fit_plane(&stats(points.first().copied().unwrap_or_default(), points)),
        estimate(&cells, FitTo::Centres).map(|n| n.fit),
        estimate(&cells, FitTo::Points).map(|n| n.fit),
    ]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The largest difference of two normals whose signs mean nothing.
fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    let sign = dot(a, b).signum();
    (0..3).map(|i| (a[i] - sign * b[i]).abs()).fold(0.0, f64::max)
}

#[test]
fn no_one_and_two_points_are_too_few() {
    let points = [[1.0, 2.0, 3.0], [4.0, 5.0, 7.0]];
    for found in 0..3 {
        for result in every_way(&points[..found]) {
            assert_eq!(result, Err(Degenerate::TooFew { found }));
        }
    }
    let weightless = Stats::from_moments([0.0; 3], Moments::EMPTY);
    assert_eq!(estimate(&[weightless; 5], FitTo::Points), Err(Degenerate::TooFew { found: 0 }));
    let mut weightless = Stats::new([0.0; 3]);
    (0..4).for_each(|_| weightless.push_weighted(&UncertainVector::exact([1.0; 3]), 0.0));
    assert_eq!(fit_plane(&weightless), Err(Degenerate::TooFew { found: 0 }));
}

#[test]
fn duplicates_are_coincident() {
    for place in [[0.0; 3], [0.1, 0.2, 0.3], [1e7 + 0.1, -1e7, 3.3], [1e-5, 1e-7, 0.0], [1e3, 0.0, 0.0]] {
        for count in [3, 9, 1000] {
            for result in every_way(&vec![place; count]) {
                assert!(matches!(result, Err(Degenerate::Coincident { .. })), "{place:?} {count} {result:?}");
            }
        }
    }
}

#[test]
fn lines_are_collinear_along_axes_and_rotated() {
    let directions = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.1, -0.7, 0.3]];
    for direction in directions {
        for offset in [[0.0; 3], [0.3, 0.7, -0.1], [1e7, 5e6, 100.0]] {
            for step in [0.01, 1.0, 50.0] {
                let at = |i: i32| [0, 1, 2].map(|k: usize| offset[k] + step * f64::from(i) * direction[k]);
                let line: Vec<_> = (0..9).map(at).collect();
                // Far from the anchor of its sums the plain statistics see nothing but rounding.
                let ways = every_way(&line);
                for result in [&ways[0], &ways[2], &ways[3], &ways[4]] {
                    assert!(matches!(result, Err(Degenerate::Collinear { .. })), "{line:?} {result:?}");
                }
                assert!(ways[1].is_err());
            }
        }
    }
}

#[test]
fn centres_in_a_row_have_no_normal_even_when_their_points_make_a_plane() {
    let cell = |x: f64| stats([x, 0.0, 0.0], &[[x, -0.5, 0.0], [x, 0.5, 0.0], [x + 0.1, 0.0, 0.0]]);
    let row: Vec<_> = (0..4).map(|i| cell(f64::from(i))).collect();
    let mut all = Stats::new([0.0; 3]);
    for cell in &row {
        all.merge(cell);
    }
    assert!(fit_plane(&all).is_ok());
    assert!(matches!(estimate(&row, FitTo::Points), Err(Degenerate::Collinear { .. })));
}

#[test]
fn numbers_that_are_not_finite_are_named() {
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for place in 0..12 {
            let mut points = square;
            points[place / 3][place % 3] = bad;
            for result in every_way(&points) {
                assert_eq!(result, Err(Degenerate::NotFinite), "{points:?}");
            }
        }
        // An error without a value would else count as no error.
        let mut cells = cells(&square);
        cells[2].push(&UncertainVector { value: square[2], error: [0.0, bad, 0.0] });
        for to in [FitTo::Centres, FitTo::Points] {
            assert_eq!(estimate(&cells, to), Err(Degenerate::NotFinite));
        }
        let mut weighted = stats([0.0; 3], &square);
        weighted.push_weighted(&UncertainVector::exact(square[1]), bad.abs());
        assert_eq!(fit_plane(&weighted), Err(Degenerate::NotFinite));
        assert_eq!(
            estimate(&[cells[0], cells[1], cells[3], weighted], FitTo::Points),
            Err(Degenerate::NotFinite)
        );
    }
    let huge = square.map(|p| p.map(|x| x * 1e200));
    assert!(every_way(&huge).iter().all(|result| *result == Err(Degenerate::NotFinite)));
}

#[test]
fn exactly_flat_and_along_the_axes_is_exact() {
    for axis in 0..3 {
        let point = |i: i32| {
            let mut p = [f64::from(i % 3), f64::from(i / 3), f64::from(i / 3)];
            p.swap(0, (axis + 1) % 3);
            p[axis] = 7.0;
            p
        };
        let points: Vec<_> = (0..9).map(point).collect();
        for fit in every_way(&points).map(Result::unwrap) {
            let mut normal = [0.0; 3];
            normal[axis] = 1.0;
            assert_eq!(fit.normal.map(f64::abs), normal);
            assert_eq!((fit.rms(), fit.centroid[axis]), (0.0, 7.0));
        }
    }
}

/// Points up to half a metre apart in u and v, at `thickness` times w from the plane z = 0.
fn patch(thickness: f64) -> impl Strategy<Value = Vec<[f64; 3]>> {
    let corner = |u: f64, v: f64| move |w: f64| [u, v, w * thickness];
    // Four corners make sure that it is no line.
    let corners = [corner(0.5, 0.5), corner(-0.5, 0.5), corner(0.5, -0.5), corner(-0.5, -0.5)];
    let inner = prop::collection::vec([-0.5..0.5, -0.5..0.5, -1.0..1.0f64], 0..30);
    (prop::array::uniform4(-1.0..1.0f64), inner).prop_map(move |(heights, inner)| {
        let corners = corners.iter().zip(heights).map(|(corner, w)| corner(w));
        corners.chain(inner.into_iter().map(|[u, v, w]| [u, v, w * thickness])).collect()
    })
}

proptest! {
    /// Up to ten thousand kilometres away; there coordinates are rounded to 2e-9 m.
    #[test]
    fn exact_planes_are_found(points in patch(0.0), motion in motion(1e7)) {
        let moved: Vec<_> = points.iter().map(|p| motion.point(*p)).collect();
        let ways = every_way(&moved);
        for fit in [&ways[0], &ways[2], &ways[3], &ways[4]] {
            let fit = (*fit).unwrap();
            prop_assert!(apart(fit.normal, motion.vector([0.0, 0.0, 1.0])) < 2e-8);
            // The root of a rounding of the variances.
            prop_assert!(fit.rms() < 5e-8);
            let height = dot(motion.back(fit.centroid), [0.0, 0.0, 1.0]);
            prop_assert!(height.abs() < 1e-8, "{height}");
        }
    }

    #[test]
    fn moving_the_points_moves_the_plane_and_nothing_else(points in patch(0.05), motion in motion(1e7)) {
        let moved: Vec<_> = points.iter().map(|p| motion.point(*p)).collect();
        let (still, moved) = (fit_centres(&points).unwrap(), fit_centres(&moved).unwrap());
        prop_assert!(apart(motion.vector(still.normal), moved.normal) < 1e-7);
        for k in 0..3 {
            prop_assert!((motion.point(still.centroid)[k] - moved.centroid[k]).abs() < 1e-8);
            prop_assert!((still.variances[k] - moved.variances[k]).abs() < 1e-8);
        }
        for [a, b] in [[moved.normal, moved.axes[0]], [moved.normal, moved.axes[1]], moved.axes] {
            prop_assert!(dot(a, b).abs() < 1e-14 && (dot(a, a) - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn merged_statistics_give_the_plane_of_the_raw_points(
        points in patch(0.05),
        motion in motion(100.0),
        parts in 1..5usize,
    ) {
        let points: Vec<_> = points.iter().map(|p| motion.point(*p)).collect();
        let mut all = Stats::new(motion.point([0.3, 0.0, 0.1]));
        for part in 0..parts {
            let own: Vec<_> = points.iter().skip(part).step_by(parts).copied().collect();
            all.merge(&stats(own.first().copied().unwrap_or_default(), &own));
        }
        let (merged, raw) = (fit_plane(&all).unwrap(), fit_centres(&points).unwrap());
        prop_assert!(apart(merged.normal, raw.normal) < 1e-10);
        for k in 0..3 {
            prop_assert!((merged.centroid[k] - raw.centroid[k]).abs() < 1e-12);
            prop_assert!((merged.variances[k] - raw.variances[k]).abs() < 1e-12);
        }
        // The mean squared distance from the plane, from the points.
        let height = |p: &[f64; 3]| dot([0, 1, 2].map(|k| p[k] - raw.centroid[k]), raw.normal);
        let mean_square = points.iter().map(|p| height(p).powi(2)).sum::<f64>() / points.len() as f64;
        prop_assert!((mean_square - raw.variances[0]).abs() < 1e-12);
    }
}

#[test]
fn the_motion_of_these_tests_is_rigid() {
    let motion = Motion::new([0.3, -0.2, 0.9, 0.1], [1.0, 2.0, 3.0]);
    let p = [0.3, 0.4, 1.2];
    assert!(dot(motion.vector(p), motion.vector(p)) - 1.69 < 1e-15);
    assert!((0..3).all(|k| (motion.back(motion.point(p))[k] - p[k]).abs() < 1e-15));
}
