//! What errors carry over the faces between columns.

use glam::DVec3;
use terrace_normals::{CovariantPlane, PlaneFit};
use terrace_stats::SymmetricMatrix3;

use super::columns::{Column, Columns, Of, Sides};

/// Columns whose weights differ by less count alike.
const ALIKE: f64 = 1e-3;

/// A face between columns of which one counts more. A point that errors carry over it counts on the other side: on average,
/// points with an error to one side come in and those to the other go out, in proportion to the covariance of the errors along the
/// normal and across the face.
pub(crate) struct Face<'c> {
    /// The column that counts, or one of the two.
    pub(crate) inner: &'c Column,
    /// The axis across the face.
    pub(crate) across: usize,
    /// Points for each metre across the face, times ξ.
    points: f64,
    /// Their covariances, summed.
    noise: SymmetricMatrix3,
    /// The pull at (tilt, tilt, offset) of one such point, for a covariance of one.
    arm: DVec3,
}

impl Face<'_> {
    /// The expected pull of the errors.
    fn pull(&self, normal: DVec3) -> DVec3 {
        self.arm * DVec3::from(self.noise.rows()[self.across]).dot(normal)
    }

    /// The pull of as many points as a part of the column has, for a product of errors of one.
    pub(crate) fn pull_of(&self, part: f64) -> DVec3 {
        self.arm * self.points * part
    }
}

impl Columns {
    /// The faces at which the plane goes on and something is carried to where it counts differently.
    pub(crate) fn faces<'c>(
        &'c self,
        counts: &'c [bool],
        plane: &'c CovariantPlane,
        size: f64,
    ) -> impl Iterator<Item = Face<'c>> {
        let weight = |at: usize| if counts[at] { self.all[at].weight(plane) } else { 0.0 };
        let weights: Vec<f64> = (0..self.all.len()).map(weight).collect();
        // Each face once: that after a column, and that before it where the rim is, which knows no neighbours.
        let sides = |at: usize| {
            let Sides { after, before } = self.sides[at];
            let rim = |at: &u32| self.all[*at as usize].of == Of::Rim;
            [(1, after[0]), (2, after[1]), (1, before[0].filter(rim)), (2, before[1].filter(rim))]
                .into_iter()
                .zip([1.0, 1.0, -1.0, -1.0])
                .filter_map(|((side, beside), sign)| Some((side, beside? as usize, sign)))
        };
        let PlaneFit { centroid, normal, axes, .. } = plane.fit;
        let (normal, [e1, e2]) = (DVec3::from(normal), axes.map(DVec3::from));
        let centroid = DVec3::from(centroid) - DVec3::from(self.anchor);
        (0..self.all.len())
            .flat_map(move |at| sides(at).map(move |(side, beside, sign)| (at, side, beside, sign)))
            .filter_map(move |(at, side, beside, sign)| {
                let step = sign * (weights[at] - weights[beside]);
                if step.abs() <= ALIKE * weights[at].max(weights[beside]) {
                    return None;
                }
                // The one that counts, and the direction from it to the other.
                let (inner, outer, sign) = if counts[at] { (at, beside, sign) } else { (beside, at, -sign) };
                let (inner, outer) = (&self.all[inner], &self.all[outer]);
                let [own, others] = [inner, outer].map(|column| column.sum.count() as f64);
                let (points, noise) = if counts[at] && counts[beside] {
                    let both = inner.noise_of_points() * own + outer.noise_of_points() * others;
                    (0.5 * (own + others), both * 0.5)
                } else {
                    // Where it goes on with fewer points, they thin out towards the border.
                    let thinner = if outer.of == Of::Rim { 0.5 + 0.5 * (others / own).min(1.0) } else { 1.0 };
                    (own * thinner, inner.noise_of_points() * (own * thinner))
                };
                let across = (self.axis + side) % 3;
                // The middle of the face, on the plane.
                let mut middle = inner.mean() - centroid;
                let half = 0.5 * sign * size;
                middle[across] += half;
                middle[self.axis] -= half * normal[across] / normal[self.axis];
                let arm = DVec3::new(middle.dot(e1), middle.dot(e2), -1.0) * (-step / size);
                Some(Face { inner, across, points, noise, arm })
            })
    }

    /// Moves the plane back by what the errors carry over the faces.
    pub(crate) fn take_back_cuts(&self, counts: &[bool], plane: &mut CovariantPlane, size: f64) {
        let PlaneFit { centroid, normal, axes, .. } = plane.fit;
        let (centroid, normal, [e1, e2]) =
            (DVec3::from(centroid), DVec3::from(normal), axes.map(DVec3::from));
        let pull: DVec3 = self.faces(counts, plane, size).map(|face| face.pull(normal)).sum();
        let [tilt1, tilt2, offset] = (pull * DVec3::from(plane.gain)).to_array();
        let turned = (normal + tilt1 * e1 + tilt2 * e2).normalize();
        plane.fit.normal = turned.to_array();
        // In the plane again: the first less what stands on it, the second across both.
        let first = (e1 - e1.dot(turned) * turned).normalize();
        let second = turned.cross(first);
        let second = if second.dot(e2) < 0.0 { -second } else { second };
        plane.fit.axes = [first.to_array(), second.to_array()];
        plane.fit.centroid = (centroid + offset * normal).to_array();
    }
}
