//! Errors by direction, where it is not known from where points were seen.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use terrace_normals::symmetric_eigen;
use terrace_stats::SymmetricMatrix3;

/// Rounds in which places that scatter by more than this, in units of what the others tell, are left out; nothing changes in more.
const ROUNDS: usize = 8;
const OUTLYING: f64 = 3.0;
/// That errors are the same in all directions counts as much as so many places that scatter by the median: where all walls are parallel,
/// nothing is seen of the errors along them.
const SAME: f64 = 20.0;
/// A place weighs by what is told of it, but that is taken for no less than this share of the median.
const LEAST: f64 = 0.05;
/// So many places say enough: of more, some are looked at.
const ENOUGH: usize = 1 << 14;
/// Numbers in a symmetric matrix.
const NUMBERS: usize = 6;

/// What a flat place shows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    pub(crate) normal: [f64; 3],
    /// Of its points along the normal, in m², with the right median.
    pub(crate) variance: f64,
}

/// The covariance C that gives `nᵀ C n` at the places with the normals n, by least squares of relative errors; `None` when no place
/// scatters. Most sensors err along their rays, and rays of one view are nearly parallel.
pub(crate) fn by_direction(places: &[Place]) -> Option<SymmetricMatrix3> {
    // Points that do not scatter at all are on one step of a sensor that rounds, and tell nothing of its errors.
    let scatters = |place: &&Place| place.variance > 0.0;
    let stride = places.iter().filter(scatters).count().div_ceil(ENOUGH).max(1);
    let mut median = places.iter().filter(scatters).map(|place| place.variance).collect::<Vec<f64>>();
    let middle = median.len() / 2;
    if median.is_empty() {
        return None;
    }
    let median = *median.select_nth_unstable_by(middle, f64::total_cmp).1;
    // In units of the median.
    let seen: Vec<([f64; NUMBERS], f64)> = places
        .iter()
        .filter(scatters)
        .step_by(stride)
        .map(|place| (products(place.normal), place.variance / median))
        .collect();
    let mut found = SymmetricMatrix3::diagonal([1.0; 3]);
    for _ in 0..ROUNDS {
        found = fitted(&seen, &found)?;
    }
    Some(found * median)
}

/// What the numbers of a symmetric matrix are multiplied by for its value along a normal.
fn products([x, y, z]: [f64; 3]) -> [f64; NUMBERS] {
    [x * x, 2.0 * x * y, 2.0 * x * z, y * y, 2.0 * y * z, z * z]
}

/// One round: without the places that lie out by what was found before.
fn fitted(seen: &[([f64; NUMBERS], f64)], before: &SymmetricMatrix3) -> Option<SymmetricMatrix3> {
    let mut left = [[0.0; NUMBERS]; NUMBERS];
    let mut right = [0.0; NUMBERS];
    for (row, variance) in seen {
        let told: f64 = row.iter().zip(before.0).map(|(x, c)| x * c).sum::<f64>().max(LEAST);
        if *variance > OUTLYING * told {
            continue;
        }
        let weight = 1.0 / (told * told);
        for (i, of_row) in left.iter_mut().enumerate() {
            of_row[..=i].iter_mut().zip(row).for_each(|(sum, x)| *sum += weight * row[i] * x);
            right[i] += weight * row[i] * variance;
        }
    }
    // The sum of all squared entries of C − 1.
    for i in 0..NUMBERS {
        let is_diagonal = matches!(i, 0 | 3 | 5);
        left[i][i] += if is_diagonal { SAME } else { 2.0 * SAME };
        right[i] += if is_diagonal { SAME } else { 0.0 };
    }
    let left = Mat::from_fn(NUMBERS, NUMBERS, |i, j| left[i.max(j)][i.min(j)]);
    let right = Mat::from_fn(NUMBERS, 1, |i, _| right[i]);
    let solved = left.llt(Side::Lower).ok()?.solve(&right);
    let eigen = symmetric_eigen(&SymmetricMatrix3([0, 1, 2, 3, 4, 5].map(|i| solved[(i, 0)])));
    // A variance below zero means that there is none.
    let mut found = SymmetricMatrix3::ZERO;
    for (variance, axis) in eigen.values.into_iter().zip(eigen.vectors) {
        found += SymmetricMatrix3::outer(axis) * variance.max(0.0);
    }
    found.is_finite().then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// Places with normals all over, or along one, that scatter as the errors say, give or take.
    fn places(errors: &SymmetricMatrix3, normal: Option<[f64; 3]>) -> Vec<Place> {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let of_place = |_| {
            let drawn = [(); 3].map(|()| random.random_range(-1.0..1.0_f64));
            let length = drawn.iter().map(|x| x * x).sum::<f64>().sqrt();
            let normal = normal.unwrap_or(drawn.map(|x| x / length));
            let variance = errors.quadratic_form(normal) * random.random_range(0.5..1.5);
            Place { normal, variance }
        };
        (0..3000).map(of_place).collect()
    }

    fn along_a_ray() -> SymmetricMatrix3 {
        SymmetricMatrix3::diagonal([4e-6; 3]) + SymmetricMatrix3::outer([0.6, 0.0, 0.8]) * 9.6e-5
    }

    #[test]
    fn errors_along_a_ray_are_told_from_those_across() {
        let errors = along_a_ray();
        let is_found = |places: &[Place]| {
            let found = by_direction(places).unwrap();
            let off = found.0.iter().zip(errors.0).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            // What is far above the median is held back a little.
            assert!(off < 0.1 * 1e-4, "{found:?} {errors:?}");
        };
        let mut seen = places(&errors, None);
        is_found(&seen);
        // Edges and clutter scatter by more, and what is on one step of a sensor not at all.
        for (at, place) in seen.iter_mut().enumerate() {
            place.variance *= if at % 10 == 0 { 100.0 } else { 1.0 };
            place.variance *= if at % 10 == 5 { 0.0 } else { 1.0 };
        }
        is_found(&seen);
    }

    #[test]
    fn what_no_place_shows_is_as_in_other_directions() {
        let found = by_direction(&places(&along_a_ray(), Some([0.0, 0.0, 1.0]))).unwrap();
        let along = along_a_ray().quadratic_form([0.0, 0.0, 1.0]);
        for direction in [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
            assert!((found.quadratic_form(direction) / along - 1.0).abs() < 0.05, "{found:?}");
        }
    }

    #[test]
    fn places_that_do_not_scatter_tell_nothing() {
        assert_eq!(by_direction(&[]), None);
        assert_eq!(by_direction(&[Place { normal: [0.0, 0.0, 1.0], variance: 0.0 }; 9]), None);
    }
}
