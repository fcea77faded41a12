//! Sums of many vectors before they reach their set.

/// Sums over vectors with weight 1, without their errors: what [`Moments::push_run`](crate::Moments::push_run) adds at
/// once. Small enough to stay in registers while vectors are added.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Run {
    pub(crate) count: u64,
    pub(crate) sum: [f64; 3],
    pub(crate) second: [f64; 6],
}

impl Run {
    /// No vector yet.
    pub const EMPTY: Self = Self { count: 0, sum: [0.0; 3], second: [0.0; 6] };

    /// Numbers of [`to_array`](Self::to_array).
    pub const LEN: usize = 9;

    /// The sums alone, to be written down beside the count.
    #[inline]
    pub fn to_array(&self) -> [f64; Self::LEN] {
        let ([x, y, z], [xx, xy, xz, yy, yz, zz]) = (self.sum, self.second);
        [x, y, z, xx, xy, xz, yy, yz, zz]
    }

    /// The sums of so many vectors, as written down.
    #[inline]
    pub fn from_array(count: u64, [x, y, z, xx, xy, xz, yy, yz, zz]: [f64; Self::LEN]) -> Self {
        Self { count, sum: [x, y, z], second: [xx, xy, xz, yy, yz, zz] }
    }

    /// Adds a vector.
    #[inline]
    pub fn push(&mut self, [x, y, z]: [f64; 3]) {
        self.count += 1;
        for (sum, value) in self.sum.iter_mut().zip([x, y, z]) {
            *sum += value;
        }
        for (sum, product) in self.second.iter_mut().zip([x * x, x * y, x * z, y * y, y * z, z * z]) {
            *sum += product;
        }
    }
}
