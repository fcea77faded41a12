//! Random draws from the 64-bit words of a generator, written out so that a seed keeps giving the same function.

use rand::Rng;

/// A multiple of 2⁻⁵³ in [0, 1).
pub(crate) fn unit(rng: &mut (impl Rng + ?Sized)) -> f64 {
    (rng.next_u64() >> 11) as f64 * (f64::EPSILON / 2.0)
}

/// A whole number in [1, most], by the high half of a product; 1 when `most` is zero.
pub(crate) fn whole(most: u32, rng: &mut (impl Rng + ?Sized)) -> u32 {
    let product = u128::from(rng.next_u64()) * u128::from(most);
    // The high half is below `most` and so fits.
    u32::try_from(product >> 64).unwrap_or(0) + 1
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand::rngs::ChaCha8Rng;

    use super::*;

    #[test]
    fn draws_fill_their_range() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let units: Vec<f64> = (0..1000).map(|_| unit(&mut rng)).collect();
        assert!(units.iter().all(|u| (0.0..1.0).contains(u)));
        assert!((units.iter().sum::<f64>() / 1000.0 - 0.5).abs() < 0.05);
        let mut seen = [0; 7];
        (0..1000).for_each(|_| seen[whole(6, &mut rng) as usize] += 1);
        assert!(seen[0] == 0 && seen[1..].iter().all(|&count| count > 100), "{seen:?}");
        assert_eq!(whole(0, &mut rng), 1);
    }
}
