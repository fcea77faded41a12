//! What a run of points adds to its cell, as a few numbers on end.

use std::ops::Range;

use terrace_stats::{Moments, Run as Sums};

use super::PointErrors;

/// Up to so many points are handed on as they are: they are fewer numbers than their sums.
const FEW: usize = 2;

/// How many numbers a run of so many points adds.
#[inline]
pub(super) fn len(points: usize, errors: &PointErrors<'_>) -> usize {
    (if points > FEW { Sums::LEN } else { 3 * points }) + errors.noise_len()
}

/// Writes what a run adds: its points from the centre of the voxel or their sums, then those of their errors. `range` are
/// its points among those of the errors.
#[inline]
pub(super) fn write(
    points: &[[f64; 3]],
    centre: [f64; 3],
    errors: &PointErrors<'_>,
    range: Range<usize>,
    to: &mut [f64],
) {
    let local = |point: &[f64; 3]| [0, 1, 2].map(|i| point[i] - centre[i]);
    let (values, noise) = to.split_at_mut(to.len() - errors.noise_len());
    if points.len() > FEW {
        let mut sums = Sums::EMPTY;
        for point in points {
            sums.push(local(point));
        }
        values.copy_from_slice(&sums.to_array());
    } else {
        for (value, point) in values.as_chunks_mut().0.iter_mut().zip(points) {
            *value = local(point);
        }
    }
    errors.write_noise(range, noise);
}

/// Adds what was written of a run of so many points, and returns what is left to read.
#[inline]
pub(super) fn add<'n>(
    moments: &mut Moments,
    points: usize,
    errors: &PointErrors<'_>,
    from: &'n [f64],
) -> &'n [f64] {
    let (written, rest) = from.split_at(len(points, errors));
    let (values, noise) = written.split_at(written.len() - errors.noise_len());
    let sums = if let Some(sums) = values.first_chunk() {
        Sums::from_array(points as u64, *sums)
    } else {
        let mut sums = Sums::EMPTY;
        for value in values.as_chunks().0 {
            sums.push(*value);
        }
        sums
    };
    moments.push_run(&sums, &errors.read_noise(points, noise));
    rest
}
