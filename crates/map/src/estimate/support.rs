//! Which columns hold nothing but the plane, and how far they are from it.

use glam::DVec3;
use terrace_normals::CovariantPlane;

use super::columns::{Column, Columns, Near, Of, Sides, variance_along};

/// Cells further off than this many standard errors of their points are not of the plane.
const FAR: f64 = 4.0;
/// Columns whose mean or scatter is off by more of its standard errors hold something else.
pub(super) const DEVIATIONS: f64 = 4.0;
/// Where columns usually deviate by more than this, in units of their variance, a plane is looked for that fits most.
const ROUGH: f64 = 2.0;
/// Columns that deviate by no more of their usual deviation are most likely of it.
const CORE: f64 = 2.0;
/// The median of χ² of one degree of freedom.
const MEDIAN: f64 = 0.4549;

impl Columns {
    /// Which columns lie on the plane as far as their points can tell one by one, and have none beside them that does not.
    pub(crate) fn near(&self, near: &Near, floor: f64) -> Vec<bool> {
        let lies_on = |deviation: &Deviation| deviation.off <= FAR * FAR && deviation.scatter <= FAR * FAR;
        self.apart(self.deviations(near, floor).iter().map(|d| d.as_ref().is_some_and(lies_on)))
    }

    /// Which columns lie on the plane and have none beside them that does not: the mean by its own error, the scatter by that
    /// of a scatter.
    pub(crate) fn support(&self, near: &Near, floor: f64) -> Vec<bool> {
        let deviations = self.deviations(near, floor);
        let usual = Usual::of(&deviations);
        self.apart(self.all.iter().zip(&deviations).map(|(column, deviation)| {
            deviation.as_ref().is_some_and(|d| usual.holds(d, column.sum.count(), DEVIATIONS))
        }))
    }

    /// Which columns lie on the plane better than most do, where most do not lie as well as errors say: the plane may be off,
    /// because a part of its cells are those of something else. `None` where they do.
    pub(crate) fn core(&self, near: &Near, floor: f64) -> Option<Vec<bool>> {
        let deviations = self.deviations(near, floor);
        let usual = Usual::of(&deviations);
        (usual.mean > ROUGH).then(|| {
            let core = |(column, deviation): (&Column, &Option<Deviation>)| {
                deviation.as_ref().is_some_and(|d| usual.holds(d, column.sum.count(), CORE))
            };
            self.all.iter().zip(&deviations).map(core).collect()
        })
    }

    /// `None` for columns that are not of the plane alone.
    fn deviations(&self, near: &Near, floor: f64) -> Vec<Option<Deviation>> {
        let through = self.through(near);
        let of = |column: &Column| {
            if column.of == Of::Plane { column.deviation(through, near.normal, floor) } else { None }
        };
        self.all.iter().map(of).collect()
    }

    /// A place on a plane, from the anchor.
    fn through(&self, near: &Near) -> DVec3 {
        near.centroid - DVec3::from(self.anchor)
    }

    /// Those for which it holds, and for all beside them.
    fn apart(&self, holds: impl Iterator<Item = bool>) -> Vec<bool> {
        let mut counts = vec![true; self.all.len()];
        // From the few for which it does not: the others need no look around.
        for (at, _) in holds.enumerate().filter(|(_, holds)| !holds) {
            counts[at] = false;
            if self.all[at].of != Of::Rim {
                for near in self.around(at) {
                    counts[near] = false;
                }
            }
        }
        counts
    }

    /// Mean squared residuals in units of their variance, with their degrees of freedom: of points from the plane, and
    /// of the means of columns, which also tell of errors that neighbouring points share.
    pub(crate) fn chi_squared(&self, counts: &[bool], plane: &CovariantPlane, floor: f64) -> [(f64, f64); 2] {
        let near = Near::of(plane);
        let through = self.through(&near);
        let (mut of_points, mut of_means) = ((0.0, -3.0), (0.0, -3.0));
        for (at, column) in self.all.iter().enumerate().filter(|(at, _)| counts[*at]) {
            let Some(deviation) = column.deviation(through, near.normal, floor) else { continue };
            let count = column.sum.count() as f64;
            of_points = (of_points.0 + count * (deviation.scatter + deviation.off), of_points.1 + count);
            // Errors carry points from column to column and with them the mean, which is made up for by the columns on the
            // other side; not so at a border.
            let Sides { after, before } = self.sides[at];
            let within =
                after.into_iter().chain(before).all(|side| side.is_some_and(|side| counts[side as usize]));
            if within {
                of_means = (of_means.0 + deviation.mean, of_means.1 + 1.0);
            }
        }
        [of_points, of_means].map(|(sum, freedom): (f64, f64)| {
            // Three residuals tell nothing: a plane goes through three points.
            if freedom < 1.0 { (0.0, 1.0) } else { (sum / freedom, freedom) }
        })
    }
}

/// How far a column is from a plane, squared, in units of variances.
struct Deviation {
    /// Of its mean, in units of that of a point.
    off: f64,
    /// Of its mean, in units of that of the mean.
    mean: f64,
    /// Of its points from their mean.
    scatter: f64,
}

/// How far columns usually are from the plane, at least as far as their errors say: where surfaces are not as flat as that,
/// all deviate, and others stand out from them.
struct Usual {
    mean: f64,
    scatter: f64,
}

impl Usual {
    fn of(deviations: &[Option<Deviation>]) -> Self {
        let usual = |of: fn(&Deviation) -> f64| median(deviations.iter().flatten().map(of)).max(1.0);
        Self { mean: usual(|d| d.mean / MEDIAN), scatter: usual(|d| d.scatter) }
    }

    /// Whether a column of so many points is off by no more than so many standard errors.
    fn holds(&self, deviation: &Deviation, points: u64, errors: f64) -> bool {
        deviation.mean <= errors * errors * self.mean
            && self.scatters(deviation, points, errors.max(DEVIATIONS))
    }

    /// Whether the points scatter about their mean by no more than so many standard errors above what is usual.
    fn scatters(&self, deviation: &Deviation, points: u64, errors: f64) -> bool {
        deviation.scatter <= self.scatter * (1.0 + errors * (2.0 / points as f64).sqrt())
    }
}

impl Column {
    /// From a plane through a place, which is given from the anchor of the columns.
    fn deviation(&self, through: DVec3, normal: DVec3, floor: f64) -> Option<Deviation> {
        let [x, y, z] = normal.to_array();
        let weight = self.sum.weight();
        let along = DVec3::from(self.sum.sum()).dot(normal) / weight;
        let off = (along - through.dot(normal)).powi(2);
        let scatter = (self.sum.second().quadratic_form([x, y, z]) / weight - along * along).max(0.0);
        let own = variance_along(&self.sum, normal);
        let floor = floor * floor;
        let (mut of_point, mut of_mean) = (own + floor, own / self.sum.count() as f64 + floor);
        if let Some(seen) = &self.seen {
            of_point += seen.shared.of_points.quadratic_form([x, y, z]);
            of_mean += seen.shared.of_mean.quadratic_form([x, y, z]);
        }
        (of_mean > 0.0).then(|| Deviation {
            off: off / of_point,
            mean: off / of_mean,
            scatter: scatter / of_point,
        })
    }
}

/// 0 of nothing.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}
