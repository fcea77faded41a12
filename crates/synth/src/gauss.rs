//! Normal deviates.

use rand::{Rng, RngExt};

/// Normal deviates of mean 0 and variance 1 by Marsaglia's polar method.
///
/// *Based on* G. Marsaglia and T. A. Bray, "A convenient method for generating normal variables", SIAM Review 6
/// (1964). A point (x, y) is drawn in the square until it falls inside the unit circle; with q = x² + y²,
/// x √(−2 ln q / q) and y √(−2 ln q / q) are two independent deviates. The second one is kept for the next call.
#[derive(Debug, Clone, Default)]
pub(crate) struct Gauss {
    spare: Option<f64>,
}

impl Gauss {
    pub(crate) fn sample<R: Rng>(&mut self, rng: &mut R) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        loop {
            let x = 2.0 * rng.random::<f64>() - 1.0;
            let y = 2.0 * rng.random::<f64>() - 1.0;
            let q = x * x + y * y;
            if q > 0.0 && q < 1.0 {
                let scale = (-2.0 * q.ln() / q).sqrt();
                self.spare = Some(y * scale);
                return x * scale;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand::rngs::ChaCha8Rng;

    #[test]
    fn first_four_moments_are_those_of_the_normal_law() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut gauss = Gauss::default();
        let n = 400_000;
        let mut moments = [0.0; 4];
        for _ in 0..n {
            let x = gauss.sample(&mut rng);
            for (k, m) in moments.iter_mut().enumerate() {
                *m += x.powi(i32::try_from(k).unwrap() + 1) / f64::from(n);
            }
        }
        // Five standard errors of each moment: their variances are 1, 2, 15 and 96 over n.
        for ((m, expected), variance) in moments.iter().zip([0.0, 1.0, 0.0, 3.0]).zip([1.0, 2.0, 15.0, 96.0])
        {
            assert!((m - expected).abs() < 5.0 * (variance / f64::from(n)).sqrt(), "{moments:?}");
        }
    }
}
