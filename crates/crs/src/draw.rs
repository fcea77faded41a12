//! Random draws from the 64-bit words of a generator.
//!
//! Written out, since the sampling routines of `rand` may change their results between releases and a seed should
//! give the same trace for as long as its generator gives the same words.

use rand::Rng;

use crate::{Axis, Bounds};

/// A place uniformly in the bounds: by width on real axes, all values alike on the others. One word for each axis.
pub(crate) fn place(bounds: &Bounds, rng: &mut (impl Rng + ?Sized)) -> Vec<f64> {
    let value = |axis: &Axis| match axis {
        // The product can round up past `hi` on the last bit.
        Axis::Real { lo, hi } => (lo + (hi - lo) * unit(rng)).min(*hi),
        other => other.nth(below(other.count().unwrap_or(1), rng)),
    };
    bounds.axes().iter().map(value).collect()
}

/// `count` different entries, uniformly drawn; all of them if there are no more. Leaves `order` permuted: the first
/// steps of a Fisher-Yates shuffle, which may start from any order.
pub(crate) fn subset<'o>(order: &'o mut [usize], count: usize, rng: &mut (impl Rng + ?Sized)) -> &'o [usize] {
    let count = count.min(order.len());
    for front in 0..count {
        let step = below((order.len() - front) as u64, rng);
        // Below the length, which is a usize.
        order.swap(front, front + usize::try_from(step).unwrap_or(0));
    }
    &order[..count]
}

/// As [`subset`], from all entries but the number `without`.
pub(crate) fn others<'o>(
    order: &'o mut [usize],
    without: usize,
    count: usize,
    rng: &mut (impl Rng + ?Sized),
) -> &'o [usize] {
    let last = order.len().saturating_sub(1);
    if let Some(at) = order.iter().position(|entry| *entry == without) {
        order.swap(at, last);
    }
    subset(&mut order[..last], count, rng)
}

/// A multiple of 2⁻⁵³ in [0, 1).
pub(crate) fn unit(rng: &mut (impl Rng + ?Sized)) -> f64 {
    (rng.next_u64() >> 11) as f64 * (f64::EPSILON / 2.0)
}

/// A whole number in [0, n), n > 0, by the high half of a product. Its bias, at most n / 2⁶⁴, is far below what any run can see.
fn below(n: u64, rng: &mut (impl Rng + ?Sized)) -> u64 {
    let product = u128::from(rng.next_u64()) * u128::from(n);
    // The high half is below n and so fits.
    u64::try_from(product >> 64).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand::rngs::ChaCha8Rng;

    use super::*;

    #[test]
    fn places_fill_the_bounds_and_stay_inside() {
        let bounds = Bounds::new([(-1.0, 3.0), (0.1, 0.1), (0.0, f64::MAX)]).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(0);
        let (mut lowest, mut highest) = (f64::MAX, f64::MIN);
        for _ in 0..10_000 {
            let x = place(&bounds, &mut rng);
            assert!(bounds.contains(&x), "{x:?}");
            lowest = lowest.min(x[0]);
            highest = highest.max(x[0]);
        }
        assert!(lowest < -0.99 && highest > 2.99);
    }

    #[test]
    fn values_that_can_be_counted_are_drawn_alike() {
        let bounds = Bounds::of([Axis::Integer { lo: -1, hi: 1 }, Axis::List(vec![0.5, 7.0])]).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut seen = std::collections::BTreeMap::new();
        for _ in 0..6000 {
            let x = place(&bounds, &mut rng);
            assert!(bounds.contains(&x), "{x:?}");
            *seen.entry(format!("{x:?}")).or_insert(0_u32) += 1;
        }
        // Six places of expectation 1000, five standard deviations either way.
        assert_eq!(seen.len(), 6);
        assert!(seen.values().all(|count| count.abs_diff(1000) < 145), "{seen:?}");
    }

    #[test]
    fn each_pair_of_four_is_drawn_equally_often() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut order = [0, 1, 2, 3];
        let mut seen = [[0_u32; 4]; 4];
        for _ in 0..12_000 {
            let drawn = subset(&mut order, 2, &mut rng);
            seen[drawn[0]][drawn[1]] += 1;
        }
        for (i, row) in seen.iter().enumerate() {
            for (j, &count) in row.iter().enumerate() {
                // Twelve ordered pairs of expectation 1000, five standard deviations either way.
                assert!(if i == j { count == 0 } else { count.abs_diff(1000) < 155 }, "{seen:?}");
            }
        }
    }

    #[test]
    fn others_are_never_the_one_left_out() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let mut order = [0, 1, 2, 3];
        let mut seen = [0_u32; 4];
        for _ in 0..6000 {
            for i in others(&mut order, 2, 2, &mut rng) {
                seen[*i] += 1;
            }
        }
        // Two of three: expectation 4000, five standard deviations either way.
        assert_eq!(seen[2], 0);
        assert!([0, 1, 3].iter().all(|i| seen[*i].abs_diff(4000) < 185), "{seen:?}");
        assert!(others(&mut [0], 0, 3, &mut rng).is_empty());
    }

    #[test]
    fn a_subset_of_everything_or_more_is_a_permutation() {
        let mut order = [0, 1, 2];
        assert_eq!(subset(&mut order, 9, &mut ChaCha8Rng::seed_from_u64(2)).len(), 3);
        order.sort_unstable();
        assert_eq!(order, [0, 1, 2]);
    }
}
