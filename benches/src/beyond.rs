//! Where true labels end before the plane does.

use terrace_normals::fit_plane;
use terrace_stats::{Stats, UncertainVector};

/// Of larger planes what labels leave out is a small share.
const FEW: usize = 200;
/// Points are on a plane that are off by no more than so many times the root mean square of its own.
const OFF: f64 = 5.0;

/// How many points of no true plane (label 0) a small true plane goes on through: they lie on the plane of its points, and hang together
/// with it by steps no longer than those that its own points need. A plane that is found with all of them is right, and its IoU is no
/// more than its own share. `None` for a plane of many points, and where points determine none.
pub fn beyond(truth: &[i32], points: &[Option<[f64; 3]>], label: i32) -> Option<usize> {
    let of = |wanted: i32| {
        let labelled = truth.iter().zip(points).filter(move |(label, _)| **label == wanted);
        labelled.filter_map(|(_, point)| *point)
    };
    let mut reached: Vec<[f64; 3]> = of(label).take(FEW + 1).collect();
    let mut stats = Stats::new(*reached.first().filter(|_| reached.len() <= FEW)?);
    for point in &reached {
        stats.push(&UncertainVector { value: *point, error: [0.0; 3] });
    }
    let fit = fit_plane(&stats).ok()?;
    let is_on = |point: &[f64; 3]| {
        let off: f64 = (0..3).map(|i| fit.normal[i] * (point[i] - fit.centroid[i])).sum();
        off.abs() <= OFF * fit.rms()
    };
    let mut others: Vec<[f64; 3]> = of(0).filter(is_on).collect();
    let (step, before) = (longest_step(&reached)?, others.len());
    let mut next = 0;
    while let Some(from) = reached.get(next).copied() {
        next += 1;
        let (near, far): (Vec<_>, Vec<_>) = others.into_iter().partition(|other| apart(&from, other) <= step);
        reached.extend(near);
        others = far;
    }
    Some(before - others.len())
}

/// The longest step by which points hang together: the longest edge of their minimum spanning tree.
fn longest_step(points: &[[f64; 3]]) -> Option<f64> {
    let (first, rest) = points.split_first()?;
    let mut left: Vec<(f64, &[f64; 3])> = rest.iter().map(|point| (apart(first, point), point)).collect();
    let mut longest = 0.0_f64;
    while let Some(nearest) = (0..left.len()).min_by(|a, b| left[*a].0.total_cmp(&left[*b].0)) {
        let (step, from) = left.swap_remove(nearest);
        longest = longest.max(step);
        for (distance, point) in &mut left {
            *distance = distance.min(apart(from, point));
        }
    }
    Some(longest)
}

fn apart(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of 2 × `length` points with a step of 1, up and down by 1 mm.
    fn strip(length: u8) -> Vec<Option<[f64; 3]>> {
        let point =
            |k: u8| [f64::from(k / 2), f64::from(k % 2), if k.is_multiple_of(3) { 0.001 } else { -0.001 }];
        (0..2 * length).map(|k| Some(point(k))).collect()
    }

    #[test]
    fn a_plane_goes_on_through_what_hangs_together_with_it() {
        let mut points = strip(10);
        let mut truth = [vec![1; 12], vec![0; 8]].concat();
        assert_eq!(beyond(&truth, &points, 1), Some(8));
        // Off the plane, beyond a gap, of another plane, left out, or nowhere.
        let others = [(0, Some([6.0, 0.5, 0.1])), (0, Some([11.0, 0.0, 0.0])), (2, Some([7.0, 0.5, 0.0]))];
        for (label, point) in others.into_iter().chain([(-1, Some([7.5, 0.5, 0.0])), (0, None)]) {
            truth.push(label);
            points.push(point);
        }
        assert_eq!(beyond(&truth, &points, 1), Some(8));
        truth[12..14].fill(2);
        assert_eq!(beyond(&truth, &points, 1), Some(0), "a gap of two");
    }

    #[test]
    fn what_is_no_plane_or_a_large_one_goes_on_through_nothing_that_is_told() {
        let points = strip(110);
        assert_eq!(beyond(&[1; 220], &points, 1), None);
        assert_eq!(beyond(&[0; 220], &points, 1), None);
        let line: Vec<_> = (0..9).map(|k| Some([f64::from(k), 0.0, 0.0])).collect();
        assert_eq!(beyond(&[1; 9], &line, 1), None);
        assert_eq!(beyond(&[1], &[Some([0.0; 3])], 1), None);
    }
}
