//! The typical distance between neighbouring points.

/// Points whose nearest neighbour is sought.
const SAMPLE: usize = 2000;

/// Pairs looked at before the rest of the sample is let go: some tenths of a second.
const MOST_PAIRS: usize = 100_000_000;

/// The median distance from a point to its nearest neighbour, in metres, over at most 2000 points taken at equal steps.
/// `None` when there are no two points apart.
///
/// Points that are not finite do not count, and points at the very same place are no neighbours: a scan given twice has
/// the spacing of one.
///
/// *Algorithm*: points are sorted along the axis of largest extent; from each sampled point the search goes outward on
/// both sides until the distance along that axis alone is larger than the nearest found. The result is exact for each
/// sampled point, and the same on every run. When points crowd so that a hundred million pairs have been looked at, the
/// sample ends there.
pub(crate) fn spacing(points: &[[f64; 3]]) -> Option<f64> {
    let mut sorted: Vec<[f64; 3]> =
        points.iter().copied().filter(|p| p.iter().all(|x| x.is_finite())).collect();
    let axis = longest_axis(&sorted);
    sorted.sort_unstable_by(|a, b| a[axis].total_cmp(&b[axis]));
    let step = sorted.len().div_ceil(SAMPLE).max(1);
    // Spread over the whole cloud even when the budget ends early.
    let (even, odd): (Vec<_>, Vec<_>) =
        (0..sorted.len()).step_by(step).partition(|i| (i / step).is_multiple_of(2));
    let mut pairs = 0;
    let mut distances = Vec::new();
    for index in even.into_iter().chain(odd) {
        if pairs > MOST_PAIRS {
            break;
        }
        distances.extend(nearest(&sorted, index, axis, &mut pairs));
    }
    let middle = distances.len() / 2;
    (!distances.is_empty()).then(|| *distances.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Smallest and largest coordinate along each axis, over the points that are finite; `None` when there is none.
pub(crate) fn bounds(points: &[[f64; 3]]) -> Option<[[f64; 3]; 2]> {
    let present = points.iter().filter(|p| p.iter().all(|x| x.is_finite()));
    present.fold(None, |bounds, p| {
        let [low, high] = bounds.unwrap_or([*p, *p]);
        Some([[0, 1, 2].map(|i| p[i].min(low[i])), [0, 1, 2].map(|i| p[i].max(high[i]))])
    })
}

fn longest_axis(points: &[[f64; 3]]) -> usize {
    let [low, high] = bounds(points).unwrap_or_default();
    (0..3).max_by(|a, b| (high[*a] - low[*a]).total_cmp(&(high[*b] - low[*b]))).unwrap_or(0)
}

fn nearest(sorted: &[[f64; 3]], index: usize, axis: usize, pairs: &mut usize) -> Option<f64> {
    let (before, rest) = sorted.split_at_checked(index)?;
    let (point, after) = rest.split_first()?;
    let mut best = f64::INFINITY;
    let mut look = |other: &[f64; 3]| {
        *pairs += 1;
        let square: f64 = (0..3).map(|i| (point[i] - other[i]).powi(2)).sum();
        if square > 0.0 {
            best = best.min(square);
        }
        (point[axis] - other[axis]).powi(2) <= best
    };
    let _ = before.iter().rev().all(&mut look);
    let _ = after.iter().all(&mut look);
    best.is_finite().then(|| best.sqrt())
}
