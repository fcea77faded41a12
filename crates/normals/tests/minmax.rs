//! The min-max uncertainty against refits of moved cells: the plain way, all of them, and at random.

// A test has no caller to report to, and zero is zero.
#![allow(clippy::unwrap_used, clippy::float_cmp)]

mod motion;

use motion::{Motion, motion};
use proptest::prelude::*;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace_normals::{
    Degenerate, FitTo, PlaneFit, Summary, UncertainNormal, estimate, fit_centres, fit_plane,
};
use terrace_stats::{Stats, UncertainVector};

const BOTH: [FitTo; 2] = [FitTo::Centres, FitTo::Points];

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn sigma(cell: &Stats, normal: [f64; 3]) -> f64 {
    cell.covariance_of_mean().unwrap().quadratic_form(normal).max(0.0).sqrt()
}

/// The plain way: merges and fits whole statistics.
fn fit(cells: &[Stats], to: FitTo) -> Result<PlaneFit, Degenerate> {
    let centres: Vec<_> = cells.iter().filter_map(Stats::mean).collect();
    let through_centres = fit_centres(&centres)?;
    if to == FitTo::Centres {
        return Ok(through_centres);
    }
    let mut all = Stats::new(through_centres.centroid);
    for cell in cells {
        all.merge(cell);
    }
    fit_plane(&all)
}

/// How the normal changes when cell i is moved by `by[i]` along it.
fn change(cells: &[Stats], to: FitTo, plane: &PlaneFit, by: &[f64]) -> Result<[f64; 3], Degenerate> {
    let moved = |(cell, by): (&Stats, &f64)| {
        let anchor = [0, 1, 2].map(|k| cell.anchor()[k] + by * plane.normal[k]);
        Stats::from_moments(anchor, *cell.moments())
    };
    let moved: Vec<_> = cells.iter().zip(by).map(moved).collect();
    let normal = fit(&moved, to)?.normal;
    let sign = if dot(normal, plane.normal) < 0.0 { -1.0 } else { 1.0 };
    Ok(minus(normal.map(|x| sign * x), plane.normal))
}

/// `(centre − c)·g` for the direction g along which centres turn the normal towards `axis`, any positive factor off.
fn arm(plane: &PlaneFit, centre: [f64; 3], axis: [f64; 3]) -> f64 {
    let [thickness, across, along] = plane.variances;
    let from = minus(centre, plane.centroid);
    let share = |e: [f64; 3], variance: f64| dot(from, e) * dot(e, axis) / (variance - thickness);
    share(plane.axes[0], along) + share(plane.axes[1], across)
}

/// Definition 3 word by word: no shortcut of `estimate`.
fn plain(cells: &[Stats], to: FitTo) -> Result<UncertainNormal, Degenerate> {
    let plane = fit(cells, to)?;
    let mut uncertainty = [0.0f64; 3];
    for axis in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
        for sign in [1.0, -1.0] {
            let by = |cell: &Stats| {
                let arm = arm(&plane, cell.mean().unwrap(), axis);
                // On the axis to rounding: stays.
                if arm.abs() < 1e-7 { 0.0 } else { sign * sigma(cell, plane.normal).copysign(arm) }
            };
            let by: Vec<_> = cells.iter().map(by).collect();
            let change = change(cells, to, &plane, &by)?;
            uncertainty = [0, 1, 2].map(|k| uncertainty[k].max(change[k].abs()));
        }
    }
    Ok(UncertainNormal { fit: plane, uncertainty })
}

/// `side` × `side` cells a decimetre apart on the plane z = 0, moved; each has one point known to `error`.
fn square(side: i32, error: f64, motion: &Motion) -> Vec<Stats> {
    let cell = |i: i32| {
        let place = motion.point([0.1 * f64::from(i % side), 0.1 * f64::from(i / side), 0.0]);
        let mut cell = Stats::new(place);
        cell.push(&UncertainVector::isotropic(place, error));
        cell
    };
    (0..side * side).map(cell).collect()
}

const STILL: [f64; 4] = [1.0, 0.0, 0.0, 0.0];

/// Cells of one to five points each, at most `rough` off a plane of any direction, three of them at corners.
fn neighbourhood(cells: std::ops::Range<usize>, rough: f64, error: f64) -> impl Strategy<Value = Vec<Stats>> {
    let point = ([-0.05..0.05, -0.05..0.05, -1.0..1.0f64], 0.1..1.0f64);
    let points = prop::collection::vec(point, 1..6);
    let corners = [[0.15, 0.15], [-0.15, 0.15], [0.0, -0.2]];
    let places = prop::collection::vec([-0.2..0.2, -0.2..0.2f64], cells);
    let all = (places, prop::collection::vec(points, 3 + 9), motion(1000.0));
    all.prop_map(move |(places, points, motion)| {
        let places = corners.into_iter().chain(places);
        let cell = |(place, points): ([f64; 2], &Vec<([f64; 3], f64)>)| {
            let mut cell = Stats::new(motion.point([place[0], place[1], 0.0]));
            for (p, size) in points {
                let p = motion.point([place[0] + p[0], place[1] + p[1], rough * p[2]]);
                cell.push(&UncertainVector::isotropic(p, size * error));
            }
            cell
        };
        places.zip(&points).map(cell).collect()
    })
}

proptest! {
    #[test]
    fn summaries_give_the_same_to_the_bit(cells in neighbourhood(1..9, 0.03, 0.01), weightless in 0..3_usize) {
        let mut cells = cells;
        cells.truncate(12 - 3 * weightless);
        cells.insert(weightless, Stats::new([0.1; 3]));
        let summaries: Vec<Summary> = cells.iter().map(Summary::of).collect();
        for to in BOTH {
            prop_assert_eq!(estimate(&summaries, to), estimate(&cells, to));
        }
    }

    #[test]
    fn as_the_plain_way_to_rounding(cells in neighbourhood(1..9, 0.03, 0.01)) {
        for to in BOTH {
            match (estimate(&cells, to), plain(&cells, to)) {
                (Ok(fast), Ok(plain)) => {
                    let flip = dot(fast.fit.normal, plain.fit.normal).signum();
                    let gap = plain.fit.variances[1] - plain.fit.variances[0];
                    // Eigenvectors are only as good as their eigenvalues are apart, also after the perturbation.
                    prop_assume!(gap > 0.1 * plain.fit.variances[1] && plain.total() < 0.5);
                    for k in 0..3 {
                        prop_assert!((fast.fit.normal[k] - flip * plain.fit.normal[k]).abs() < 1e-9);
                        let apart = (fast.uncertainty[k] - plain.uncertainty[k]).abs();
                        prop_assert!(apart < 1e-8, "{to:?} {fast:?} {plain:?}");
                    }
                }
                (fast, plain) => prop_assert_eq!(fast.is_err(), plain.is_err()),
            }
        }
    }

    /// Errors that make the points thicker than they are wide leave the normal to the solver.
    #[test]
    fn as_the_plain_way_with_errors_larger_than_the_patch(cells in neighbourhood(1..9, 0.03, 0.5)) {
        for to in BOTH {
            match (estimate(&cells, to), plain(&cells, to)) {
                (Ok(fast), Ok(plain)) => {
                    let gap = plain.fit.variances[1] - plain.fit.variances[0];
                    prop_assume!(gap > 0.1 * plain.fit.variances[1]);
                    for k in 0..3 {
                        let apart = (fast.uncertainty[k] - plain.uncertainty[k]).abs();
                        prop_assert!(apart < 1e-6, "{to:?} {fast:?} {plain:?}");
                    }
                }
                (fast, plain) => prop_assert_eq!(fast.is_err(), plain.is_err()),
            }
        }
    }

    /// The change of a component is never above its uncertainty by more than terms of second order, here 3 % for errors
    /// below 0.2 % of the extent; and the worst of all ways comes as near from below.
    #[test]
    fn no_errors_of_these_sizes_turn_the_normal_further(
        cells in neighbourhood(1..6, 0.0005, 0.0005),
        seed in any::<u64>(),
    ) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        for to in BOTH {
            let bound = estimate(&cells, to).unwrap();
            let sigmas: Vec<_> = cells.iter().map(|cell| sigma(cell, bound.fit.normal)).collect();
            let mut worst = [0.0f64; 3];
            // Every choice of signs, and as many errors in between.
            for signs in 0..1u32 << cells.len() {
                let corner = sigmas.iter().enumerate().map(|(i, s)| if signs >> i & 1 == 1 { *s } else { -s });
                let between = sigmas.iter().map(|s| s * rng.random_range(-1.0..1.0));
                for by in [corner.collect::<Vec<_>>(), between.collect()] {
                    let change = change(&cells, to, &bound.fit, &by).unwrap();
                    worst = [0, 1, 2].map(|k| worst[k].max(change[k].abs()));
                }
            }
            for k in 0..3 {
                let (worst, bound) = (worst[k], bound.uncertainty[k]);
                // A component along the normal itself changes in the second order only.
                let second_order = 0.03 * bound + 2e-5;
                prop_assert!((worst - bound).abs() <= second_order, "{to:?} {k}: {worst} {bound}");
            }
        }
    }

    #[test]
    fn grows_in_proportion_to_the_errors(cells in neighbourhood(1..9, 0.0, 0.0002), factor in 1.0..4.0f64) {
        let larger: Vec<_> = cells.iter().map(|cell| {
            // The same points on the plane, with larger errors.
            let mut larger = Stats::new(cell.mean().unwrap());
            let d = cell.count() as f64;
            let errors = cell.moments().error().map(|e| factor * e.sqrt() / d);
            larger.push(&UncertainVector { value: cell.mean().unwrap(), error: errors });
            larger
        }).collect();
        let (small, large) =
            (estimate(&cells, FitTo::Centres).unwrap(), estimate(&larger, FitTo::Centres).unwrap());
        for k in 0..3 {
            let expected = factor * small.uncertainty[k];
            prop_assert!((large.uncertainty[k] - expected).abs() < 0.02 * expected + 1e-5);
        }
    }

    /// The uncertainty of component j of a moved plane is that of the unmoved one along the direction moved to axis j.
    #[test]
    fn rigid_motion_turns_the_uncertainty_with_the_plane(motion in motion(1e7)) {
        let still = square(3, 1e-4, &Motion::new(STILL, [0.0; 3]));
        let plane = estimate(&still, FitTo::Centres).unwrap().fit;
        let moved = estimate(&square(3, 1e-4, &motion), FitTo::Centres).unwrap();
        let origin = motion.back([0.0; 3]);
        for j in 0..3 {
            let mut axis = [0.0; 3];
            axis[j] = 1.0;
            let axis = minus(motion.back(axis), origin);
            let expected: f64 =
                still.iter().map(|cell| arm(&plane, cell.mean().unwrap(), axis).abs() * 1e-4 / 9.0).sum();
            prop_assert!((moved.uncertainty[j] - expected).abs() < 2e-5, "{j} {moved:?} {expected}");
        }
    }

    #[test]
    fn order_and_mirror_image_do_not_matter(cells in neighbourhood(1..9, 0.01, 0.005), turns in 1..5usize) {
        for to in BOTH {
            let Ok(one) = estimate(&cells, to) else { continue };
            let gap = one.fit.variances[1] - one.fit.variances[0];
            prop_assume!(gap > 0.1 * one.fit.variances[1]);
            let mut turned = cells.clone();
            turned.rotate_left(turns.min(cells.len()));
            let mirrored: Vec<_> = cells.iter().map(|cell| {
                let mut mirrored = Stats::new(cell.mean().unwrap().map(|x| -x));
                // The covariance of the mean is the same for a point reflection, so that its errors can stand for it.
                let c = cell.covariance_of_mean().unwrap().quadratic_form(one.fit.normal).max(0.0).sqrt();
                mirrored.push(&UncertainVector::isotropic(mirrored.anchor(), c));
                mirrored
            }).collect();
            let same = estimate(&turned, to).unwrap();
            prop_assert!((0..3).all(|k| (same.uncertainty[k] - one.uncertainty[k]).abs() < 1e-9));
            if to == FitTo::Centres {
                let same = estimate(&mirrored, to).unwrap();
                prop_assert!((0..3).all(|k| (same.uncertainty[k] - one.uncertainty[k]).abs() < 1e-9));
            }
        }
    }

    #[test]
    fn exact_points_on_a_plane_along_the_axes_are_certain(side in 2..6i32, offset in prop::array::uniform3(-1e6..1e6)) {
        for to in BOTH {
            let certain = estimate(&square(side, 0.0, &Motion::new(STILL, offset)), to).unwrap();
            prop_assert_eq!(certain.uncertainty, [0.0; 3]);
        }
    }
}

#[test]
fn turning_about_the_axes_of_the_plane_alone_would_miss_a_third() {
    // Three by three cells in a square: every direction in the plane is an axis of it, so that these are a choice.
    let cells = square(3, 1e-4, &Motion::new(STILL, [0.0; 3]));
    let found = estimate(&cells, FitTo::Centres).unwrap();
    let half = 0.5f64.sqrt();
    let mut largest = 0.0f64;
    for axis in [[half, half, 0.0], [half, -half, 0.0]] {
        let arm = |cell: &Stats| dot(minus(cell.mean().unwrap(), found.fit.centroid), axis);
        let by = |cell: &Stats| if arm(cell).abs() < 1e-9 { 0.0 } else { 1e-4f64.copysign(arm(cell)) };
        let by: Vec<_> = cells.iter().map(by).collect();
        largest = largest.max(change(&cells, FitTo::Centres, &found.fit, &by).unwrap()[0].abs());
    }
    // Known answers: errors of 0.1 mm over a lever of 10 cm, and two thirds of that.
    assert!((found.uncertainty[0] - 1e-3).abs() < 1e-6 && (found.uncertainty[1] - 1e-3).abs() < 1e-6);
    assert!((largest / found.uncertainty[0] - 2.0 / 3.0).abs() < 1e-3, "{largest}");
}

#[test]
fn gaussian_errors_rarely_turn_the_normal_further() {
    // The bound is all errors conspiring at one sigma: for three by three cells it is √6 standard deviations of the
    // tilt about one axis (six arms of one), for five by five √18.
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut gauss = || {
        (-2.0 * rng.random_range(f64::MIN_POSITIVE..1.0).ln()).sqrt()
            * (std::f64::consts::TAU * rng.random_range(0.0..1.0f64)).cos()
    };
    for (side, allowed) in [(3, 0.04), (5, 0.001)] {
        let cells = square(side, 1e-4, &Motion::new([0.9, 0.2, -0.3, 0.1], [3.0, -2.0, 1.0]));
        let bound = estimate(&cells, FitTo::Points).unwrap();
        let trials = 20_000;
        let mut exceeded = 0;
        for _ in 0..trials {
            let by: Vec<_> = cells.iter().map(|_| 1e-4 * gauss()).collect();
            let change = change(&cells, FitTo::Points, &bound.fit, &by).unwrap();
            exceeded += usize::from((0..3).any(|k| change[k].abs() > bound.uncertainty[k]));
        }
        let share = exceeded as f64 / f64::from(trials);
        println!(
            "{side} x {side} cells: any component exceeded in {:.3} % of {trials} trials",
            100.0 * share
        );
        assert!(share < allowed, "{share}");
    }
}
