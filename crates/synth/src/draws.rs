//! Normal deviates for one purpose, from a seed and the number of a stream.

use crate::gauss::Gauss;
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;

/// What deviates are drawn for. Each purpose has random numbers of its own, so that the errors of points, the errors of
/// poses and the places of points never share one, whatever seeds and streams a caller takes for them.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Purpose {
    Points,
    Poses,
}

/// A sequence of standard normal deviates.
#[derive(Debug)]
pub(crate) struct Draws {
    rng: ChaCha8Rng,
    gauss: Gauss,
}

impl Draws {
    pub(crate) fn new(purpose: Purpose, seed: u64, stream: u64) -> Self {
        let tag = match purpose {
            Purpose::Points => *b"points  ",
            Purpose::Poses => *b"poses   ",
        };
        // The key of ChaCha is the seed, the purpose, and zeros.
        let mut key = [0; 32];
        for (byte, value) in key.iter_mut().zip(seed.to_le_bytes().into_iter().chain(tag)) {
            *byte = value;
        }
        let mut rng = ChaCha8Rng::from_seed(key);
        rng.set_stream(stream);
        Self { rng, gauss: Gauss::default() }
    }

    pub(crate) fn next<const N: usize>(&mut self) -> [f64; N] {
        [0; N].map(|_| self.gauss.sample(&mut self.rng))
    }
}
