//! The scans of a map.

use terrace_noise::PoseNoise;

/// A scan of a map: where it was seen from, and what became of its points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Number of points, absent ones included.
    pub points: usize,
    /// How many of them are absent: not finite.
    pub absent: usize,
    /// How many were left out: too many cells away from the origin, or beyond the number of cells a grid holds.
    pub out_of_range: usize,
    /// Where the sensor stood, in metres; `None` when it is not known.
    pub sensor: Option<[f64; 3]>,
    /// How sure its pose is; `None` is a pose without error.
    pub pose: Option<PoseNoise>,
}

impl View {
    /// How many of its points are in the map; `None` when more are missing than there are.
    pub(crate) fn present(&self) -> Option<usize> {
        self.points.checked_sub(self.absent)?.checked_sub(self.out_of_range)
    }
}
