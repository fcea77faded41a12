//! Planes of sums, and how well they fit.

use glam::DVec3;
use terrace_normals::{PlaneFit, fit_plane, fit_planes};
use terrace_stats::{Moments, Stats, SymmetricMatrix3};

/// A neighbourhood with fewer points says too little.
const FEWEST: f64 = 8.0;
/// Planes that are fitted side by side.
const AT_ONCE: usize = 8;
/// Rounding of a bound, as a share of it.
pub(crate) const ROUNDING: f64 = 1e-9;

/// A plane by a point and its unit normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Flat {
    pub(crate) normal: DVec3,
    pub(crate) point: DVec3,
}

impl Flat {
    #[inline]
    pub(crate) fn distance(&self, place: DVec3) -> f64 {
        self.normal.dot(place - self.point)
    }
}

/// What the errors of points are taken to be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Noise {
    /// Times what is stated, in m²/m².
    pub(crate) scale: f64,
    /// And as a standard deviation at least this share of the depth.
    pub(crate) floor: f64,
}

impl Noise {
    /// Variance of the error of a point along a direction, in m², by the mean covariance of errors and the depth.
    #[inline]
    pub(crate) fn variance(&self, noise: &SymmetricMatrix3, depth: f64, direction: DVec3) -> f64 {
        (self.scale * noise.quadratic_form(direction.to_array())).max(self.least(depth))
    }

    /// The least that it is at a depth.
    #[inline]
    pub(crate) fn least(&self, depth: f64) -> f64 {
        (self.floor * depth).powi(2)
    }
}

/// The plane of least squares of some points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fitted {
    pub(crate) plane: Flat,
    pub(crate) fit: PlaneFit,
    pub(crate) points: f64,
    /// Mean variance of the error of a point along the normal, in m².
    pub(crate) variance: f64,
    /// Mean variance of the points along the normal, in m². Three of their freedoms went into the plane.
    pub(crate) thickness: f64,
    /// Standard error of the orientation where it is least sure, in radians.
    pub(crate) tilt: f64,
    /// The same of the error of a point across the longer direction in the plane.
    across: f64,
}

impl Fitted {
    /// `None` when the points are too few or determine no plane.
    pub(crate) fn of(sum: &Moments, noise: Noise) -> Option<Self> {
        let enough = sum.weight() >= FEWEST;
        let fit = fit_plane(&enough.then(|| stats(sum))?).ok()?;
        Self::by(sum, &fit, noise)
    }

    /// The same of many, several at a time, one after the other to `put`.
    pub(crate) fn of_all<'m>(
        sums: impl Iterator<Item = &'m Moments>,
        noise: Noise,
        mut put: impl FnMut(Option<Self>),
    ) {
        let mut sums = sums.fuse();
        loop {
            let taken: [Option<&Moments>; AT_ONCE] = std::array::from_fn(|_| sums.next());
            if taken[0].is_none() {
                return;
            }
            let fits = fit_planes(&taken.map(|sum| stats(sum.unwrap_or(&Moments::EMPTY))));
            for (sum, fit) in taken.iter().flatten().zip(&fits) {
                let fit = fit.as_ref().ok().filter(|_| sum.weight() >= FEWEST);
                put(fit.and_then(|fit| Self::by(sum, fit, noise)));
            }
        }
    }

    fn by(sum: &Moments, fit: &PlaneFit, noise: Noise) -> Option<Self> {
        let points = sum.weight();
        let plane = Flat { normal: fit.normal.into(), point: fit.centroid.into() };
        let (errors, depth) = (sum.mean_noise()?, plane.point.z);
        let variance = noise.variance(&errors, depth, plane.normal);
        let across = noise.variance(&errors, depth, fit.axes[1].into());
        let thickness = fit.variances[0] * points / (points - 3.0);
        let tilt = (thickness.max(variance) / (points * fit.variances[1])).sqrt();
        (variance > 0.0 && tilt.is_finite()).then_some(Self {
            plane,
            fit: *fit,
            points,
            variance,
            thickness,
            tilt,
            across,
        })
    }

    /// Mean squared distance of the points in units of the variance of their errors.
    pub(crate) fn reduced_chi_squared(&self) -> f64 {
        self.thickness / self.variance
    }

    /// Whether the points are a row: what they scatter across it is little more than their errors, so that the plane through them
    /// turns about the row as those fall.
    pub(crate) fn is_row(&self) -> bool {
        self.fit.variances[1] <= ROW * self.across
    }

    /// Whether the points lie as flat as their errors say, give or take what so few of them tell, and not along a line.
    pub(crate) fn is_flat(&self, chi_squared: f64, narrowest: f64) -> bool {
        let [_, across, along] = self.fit.variances;
        self.thickness <= allowed(chi_squared, self.points) * self.variance
            && across >= narrowest * along
            && !self.is_row()
    }
}

/// Points that scatter by less than this across their longer direction, in units of the variance of their errors, are a row.
const ROW: f64 = 2.0;

/// The mean square of so many points that passes for this reduced χ².
fn allowed(chi_squared: f64, points: f64) -> f64 {
    chi_squared * (1.0 + 3.0 * (2.0 / points).sqrt())
}

/// Sums about the camera itself: a scene is so small that squares lose nothing.
pub(crate) fn stats(sum: &Moments) -> Stats {
    Stats::from_moments([0.0; 3], *sum)
}

// What is known of points from their sums alone, without a plane fitted, and without roots: tiles are asked for it again and again.
//
// With eigenvalues λ₀ ≤ λ₁ ≤ λ₂ of the scatter C, trace t, determinant d and m = λ₀λ₁ + λ₀λ₂ + λ₁λ₂ the sum of the principal
// minors: λ₀ ≥ d/m, λ₁ ≤ t/2, and any unit vector n at the angle θ from the first eigenvector has nᵀCn ≥ λ₁ sin²θ.

/// A bound from below of the tilt of the plane through the points; `None` when it is not flat for sure, or they are too few.
pub(crate) fn least_tilt(sum: &Moments, noise: Noise, chi_squared: f64) -> Option<f64> {
    let points = sum.weight();
    if points < FEWEST {
        return None;
    }
    let [trace, minors, determinant] = sum.covariance()?.invariants();
    let thickness = (determinant / minors).max(0.0) * points / (points - 3.0);
    let [least, most] = sum.mean_noise()?.range();
    let [_, _, depth] = sum.mean()?;
    let floor = (noise.floor * depth).powi(2);
    let [least, most] = [least, most].map(|v| (noise.scale * v).max(floor));
    if thickness * (1.0 - ROUNDING) > allowed(chi_squared, points) * most {
        return None;
    }
    let tilt = (thickness.max(least) / (points * 0.5 * trace)).sqrt() * (1.0 - ROUNDING);
    // Not a number where all is zero, and then of no plane.
    (!tilt.is_nan()).then_some(tilt)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use terrace_stats::UncertainVector;

    proptest! {
        #[test]
        fn planes_of_many_are_those_one_by_one(
            all in prop::collection::vec(prop::collection::vec(prop::array::uniform3(0.5..2.0_f64), 0..20), 0..20),
        ) {
            let sums: Vec<Moments> = all
                .iter()
                .map(|points| {
                    let mut sum = Moments::EMPTY;
                    for point in points {
                        sum.push(&UncertainVector::isotropic(*point, 0.01));
                    }
                    sum
                })
                .collect();
            let noise = Noise { scale: 1.5, floor: 1e-3 };
            let mut found = Vec::new();
            Fitted::of_all(sums.iter(), noise, |fitted| found.push(format!("{fitted:?}")));
            let expected: Vec<String> = sums.iter().map(|sum| format!("{:?}", Fitted::of(sum, noise))).collect();
            prop_assert_eq!(found, expected);
        }
    }
}
