//! The planes around groups of tiles, fitted when they are asked for.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;
use terrace_stats::Moments;

use crate::flat::{Fitted, Flat, Noise, least_tilt};
use crate::pyramid::{LEVELS, Level};

/// The surface at a tile may be turned against a plane by this, in radians, and by so many standard errors.
pub(crate) const TURNED: f64 = 0.3;
const TURNED_ERRORS: f64 = 3.0;
/// Squares of sines that are less apart are told apart by their angles.
const ROUNDING: f64 = 1e-9;

/// The planes around groups, each fitted once.
#[derive(Debug)]
pub(crate) struct Arounds<'t> {
    levels: &'t [Level; LEVELS],
    noise: Noise,
    /// By level and group: 0 while it is not known, else one more than the place of what was found.
    known: [Vec<u32>; LEVELS],
    found: Vec<Option<Fitted>>,
    /// By level and group, see [`least_tilt`].
    bounds: [Vec<Option<f64>>; LEVELS],
    /// By tile, once they are asked for.
    turns: Vec<Option<Turn>>,
}

/// Which planes a surface is along.
#[derive(Debug, Clone, Copy)]
enum Turn {
    Any,
    /// Those that it is turned against by no more than an angle up to a right one.
    Within {
        normal: DVec3,
        angle: f64,
        sine: f64,
        cosine: f64,
    },
}

impl Turn {
    /// Of a surface to which this plane was fitted, if any.
    fn of(fitted: Option<&Fitted>) -> Self {
        // The plane of a row turns about it as errors fall.
        let Some(fitted) = fitted.filter(|fitted| !fitted.is_row()) else { return Self::Any };
        let angle = TURNED + TURNED_ERRORS * fitted.tilt;
        if angle >= FRAC_PI_2 {
            return Self::Any;
        }
        let (sine, cosine) = angle.sin_cos();
        Self::Within { normal: fitted.plane.normal, angle, sine, cosine }
    }

    #[inline]
    fn holds(&self, plane: &Flat) -> bool {
        let Self::Within { normal, angle, sine, cosine } = *self else { return true };
        let across = normal.cross(plane.normal).length_squared();
        let along = normal.dot(plane.normal).abs();
        // The sine of what is left of the angle, times what is positive and below 2.
        let left = (sine * along).powi(2) - cosine * cosine * across;
        if left.abs() > ROUNDING { left > 0.0 } else { across.sqrt().atan2(along) <= angle }
    }
}

/// The place in a list that is so long, and one more.
fn place(len: usize) -> u32 {
    // Groups are fewer than pixels, and those than 32 bits can count.
    u32::try_from(len).unwrap_or(0)
}

impl<'t> Arounds<'t> {
    /// `chi_squared` is how points of planes may scatter, in units of the variance of their errors.
    pub(crate) fn of(levels: &'t [Level; LEVELS], noise: Noise, chi_squared: f64) -> Self {
        let known = levels.each_ref().map(|level| vec![0; level.around.len()]);
        let turns = vec![None; levels[0].around.len()];
        let bound = |around: &Moments| least_tilt(around, noise, chi_squared);
        let bounds = levels.each_ref().map(|level| level.around.iter().map(bound).collect());
        Self { levels, noise, known, found: Vec::new(), bounds, turns }
    }

    pub(crate) fn noise(&self) -> Noise {
        self.noise
    }

    /// A bound from below of the tilt of the plane of a group and of those it touches; `None` when it is not flat for sure.
    pub(crate) fn bound(&self, level: usize, group: usize) -> Option<f64> {
        self.bounds[level][group]
    }

    /// The plane of the points of a group and of those it touches; `None` when they determine none.
    pub(crate) fn get(&mut self, level: usize, group: usize) -> Option<&Fitted> {
        if self.known[level][group] == 0 {
            self.found.push(Fitted::of(&self.levels[level].around[group], self.noise));
            self.known[level][group] = place(self.found.len());
        }
        self.found.get((self.known[level][group] as usize).wrapping_sub(1))?.as_ref()
    }

    /// Fits the planes of groups, as far as they are not known, before they are asked for: several at a time.
    pub(crate) fn fit(&mut self, level: usize, groups: impl Iterator<Item = usize>) {
        let known = &mut self.known[level];
        let around = &self.levels[level].around;
        let unknown: Vec<usize> = groups.filter(|group| known[*group] == 0).collect();
        let mut groups = unknown.iter();
        Fitted::of_all(unknown.iter().map(|group| &around[*group]), self.noise, |fitted| {
            self.found.push(fitted);
            groups.by_ref().take(1).for_each(|group| known[*group] = place(self.found.len()));
        });
    }

    /// Whether the surface at a tile is along a plane, as far as it is known.
    #[inline]
    pub(crate) fn is_along(&mut self, tile: usize, plane: &Flat) -> bool {
        let turn = if let Some(turn) = self.turns[tile] {
            turn
        } else {
            let turn = Turn::of(self.get(0, tile));
            *self.turns[tile].insert(turn)
        };
        turn.holds(plane)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn planes_are_told_as_by_their_angle(
            normal in prop::array::uniform3(-1.0..1.0_f64),
            other in prop::array::uniform3(-1.0..1.0_f64),
            angle in 0.0..FRAC_PI_2,
            near in any::<bool>(),
        ) {
            let unit = |v: [f64; 3]| DVec3::from(v).try_normalize().unwrap_or(DVec3::Z);
            let (normal, other) = (unit(normal), Flat { normal: unit(other), point: DVec3::ZERO });
            let between = normal.cross(other.normal).length().atan2(normal.dot(other.normal).abs());
            // Also where both are apart by that angle itself.
            let angle = if near { between } else { angle };
            let (sine, cosine) = angle.sin_cos();
            let turn = Turn::Within { normal, angle, sine, cosine };
            prop_assert_eq!(turn.holds(&other), between <= angle);
            prop_assert!(Turn::Any.holds(&other));
        }
    }
}
