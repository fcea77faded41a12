//! A plane through noisy points with the first-order covariance of its tilt and offset.

use terrace_stats::{Moments, Stats, SymmetricMatrix3};

use crate::fit::rounding;
use crate::{Degenerate, PlaneFit, symmetric_eigen};

/// A plane and how sure it is, from the known errors of its points.
///
/// First order: right while the errors are small against the extent of the patch, and the tilt that they cause against one
/// radian. Over 2000 random patches each, the squared error of tilt and offset in units of this covariance has the
/// mean 1 within its sampling error (`tests/covariant.rs`): for equal errors, errors from 1 to 12 mm in one patch, errors
/// along an oblique ray, a narrow patch, and ten million metres from the origin.
///
/// ```
/// use terrace_normals::CovariantPlane;
/// use terrace_stats::{Stats, UncertainVector};
///
/// // A table top of a square metre, measured at 121 places, each known to 1 cm.
/// let mut top = Stats::new([0.0, 0.0, 0.7]);
/// for i in 0..121_u8 {
///     let at = [0.1 * f64::from(i % 11) - 0.5, 0.1 * f64::from(i / 11) - 0.5, 0.7];
///     top.push(&UncertainVector::isotropic(at, 0.01));
/// }
/// let plane = CovariantPlane::of_cells(&[top])?.ok_or("no errors are known")?;
/// // Its height is known to 1 cm / √121, its tilt to some tenth of a degree.
/// assert!((plane.tilt_offset.get(2, 2).sqrt() - 0.01 / 11.0).abs() < 1e-9);
/// assert!((0.05..0.2).contains(&plane.tilt_offset.get(0, 0).sqrt().to_degrees()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CovariantPlane {
    /// The plane. Its variances are those of the points without their errors.
    pub fit: PlaneFit,
    /// Covariance of (tilt₁, tilt₂, offset): the true normal is `n + tilt₁ e₁ + tilt₂ e₂` to first order, with the axes
    /// e₁, e₂ of the fit, in radians, and the true plane is `offset` further along the normal at the centroid, in metres.
    pub tilt_offset: SymmetricMatrix3,
    /// Mean squared distance of the points from the plane in units of their errors, by the number of points less three: about 1
    /// where the errors are right and the surface is flat.
    pub reduced_chi_squared: f64,
    /// How far (tilt₁, tilt₂, offset) move for a pull of one, `A⁻¹`, which is diagonal along the axes of the fit: a point at
    /// (u, v) in the plane that is moved by ε along the normal pulls by `w ε (−u, −v, 1)`. For errors that points share.
    pub gain: [f64; 3],
    /// What a cell without errors among others with them is taken to have: the least variance of those, in m².
    least: f64,
}

impl CovariantPlane {
    /// Fits a plane to the points of all cells, each with the errors it knows of.
    ///
    /// # Algorithm
    /// 1. The scatter of the points is that of the surface plus the errors' covariance. What the errors add, Σ C, is
    ///    subtracted before the eigenvectors are taken: errors along an oblique ray would turn the plane otherwise.
    /// 2. Each cell weighs by the inverse of its errors' mean variance along the normal, `1 / nᵀ(Σ C / d) n`, which
    ///    gives the plane of least variance; the normal is that of the fit before.
    /// 3. A point at (u, v) in the plane, with the error ε along the normal and ε_u, ε_v along the axes, pulls at tilt
    ///    and offset by ε (−u, −v, 1) and, since its place in the plane is measured as well, by ε (−ε_u, −ε_v, 0). The variances
    ///    of these pulls add up to B, and `A = Σ w (u, v, 1)(u, v, 1)ᵀ`, so that the covariance is `A⁻¹ B A⁻¹`.
    ///
    /// Everything follows from the sums of the cells, each point with weight 1. `None` when no cell tells of an error: nothing is known then.
    ///
    /// # Errors
    /// [`Degenerate`] for fewer than four points, points that lie on a line once their errors are taken out, and sums that
    /// are not finite.
    pub fn of_cells<'s>(cells: impl IntoIterator<Item = &'s Stats>) -> Result<Option<Self>, Degenerate> {
        let mut cells = cells.into_iter().peekable();
        let Some(first) = cells.peek() else { return Err(Degenerate::TooFew { found: 0 }) };
        let anchor = first.mean().unwrap_or(first.anchor());
        // All relative to one anchor, once.
        let cells: Vec<Moments> = cells.map(|cell| *cell.with_anchor(anchor).moments()).collect();
        let found = Weighted::of(cells.iter().map(|cell| (cell, 1.0)));
        if found.count < 4 {
            return Err(Degenerate::TooFew { found: usize::try_from(found.count).unwrap_or(usize::MAX) });
        }
        let fit = found.fit(anchor)?;
        if !found.noise.is_finite() {
            return Err(Degenerate::NotFinite);
        }
        let first = Self::near(anchor, cells.iter(), fit.normal)?;
        // The weights follow from the plane, and the plane from the weights.
        first.map_or(Ok(None), |first| Self::near(anchor, cells.iter(), first.fit.normal))
    }

    /// As [`of_cells`](Self::of_cells), for sums that are all relative to one anchor and a plane that is known nearly already:
    /// weights are those of this normal. Allocates the weights alone.
    ///
    /// # Errors
    /// As [`of_cells`](Self::of_cells).
    pub fn near<'m>(
        anchor: [f64; 3],
        cells: impl Iterator<Item = &'m Moments> + Clone,
        normal: [f64; 3],
    ) -> Result<Option<Self>, Degenerate> {
        Self::near_with_shared(anchor, cells.map(|cell| (cell, SymmetricMatrix3::ZERO)), normal)
    }

    /// As [`near`](Self::near), for cells whose points also have errors in common, as those of a pose: each comes with the covariance that
    /// these give to a point. They do not average out, and are left out of [`tilt_offset`](Self::tilt_offset); but cells weigh as if
    /// they were errors of points, so that none has more weight than they allow. Without them, errors along a ray alone have points
    /// weigh without end once the plane is turned into their rays.
    ///
    /// # Errors
    /// As [`of_cells`](Self::of_cells).
    pub fn near_with_shared<'m>(
        anchor: [f64; 3],
        cells: impl Iterator<Item = (&'m Moments, SymmetricMatrix3)> + Clone,
        normal: [f64; 3],
    ) -> Result<Option<Self>, Degenerate> {
        if !cells.clone().any(|(cell, _)| variance_along(cell, normal) > 0.0) {
            return Ok(None);
        }
        let variances: Vec<f64> = cells
            .clone()
            .map(|(cell, shared)| variance_along(cell, normal) + shared.quadratic_form(normal))
            .collect();
        // A cell without errors among others with them would weigh without end: it counts as the least noisy of them.
        let least = variances.iter().copied().filter(|v| *v > 0.0).fold(f64::INFINITY, f64::min);
        let cells = cells.map(|(cell, _)| cell);
        let weighted = cells.zip(variances.iter().map(|variance| 1.0 / variance.max(least)));
        let sums = Weighted::of(weighted.clone());
        if sums.count < 4 {
            return Err(Degenerate::TooFew { found: usize::try_from(sums.count).unwrap_or(usize::MAX) });
        }
        let fit = sums.fit(anchor)?;
        let back = [0, 1, 2].map(|i| anchor[i] - fit.centroid[i]);
        let [_, across, along] = fit.variances;
        let gain = [1.0 / (sums.weight * along), 1.0 / (sums.weight * across), 1.0 / sums.weight];
        let tilt_offset = covariance(weighted, back, &fit, gain);
        let freedom = sums.count as f64 - 3.0;
        let reduced_chi_squared = sums.scatter().quadratic_form(fit.normal).max(0.0) * sums.weight / freedom;
        Ok(Some(Self { fit, tilt_offset, reduced_chi_squared, gain, least }))
    }

    /// What each point of a cell counts: the inverse of the mean variance of their errors along the normal, in 1/m².
    pub fn weight(&self, cell: &Moments) -> f64 {
        self.weight_with_shared(cell, &SymmetricMatrix3::ZERO)
    }

    /// The same where points have errors in common: see [`near_with_shared`](Self::near_with_shared).
    pub fn weight_with_shared(&self, cell: &Moments, shared: &SymmetricMatrix3) -> f64 {
        let normal = self.fit.normal;
        1.0 / (variance_along(cell, normal) + shared.quadratic_form(normal)).max(self.least)
    }

    /// The coefficients `(a, b, c, d)` of `a x + b y + c z + d = 0`, with the unit normal `(a, b, c)`.
    pub fn coefficients(&self) -> [f64; 4] {
        let [a, b, c] = self.fit.normal;
        [a, b, c, -dot(self.fit.normal, self.fit.centroid)]
    }

    /// Covariance of the coefficients: 4×4 of rank 3, for the normal keeps its length. Rows and columns as in
    /// [`coefficients`](Self::coefficients); the last one in metres.
    ///
    /// Far from the origin the variance of d is large and nearly all of it goes with the tilt: that is how it is at the
    /// origin. Use [`tilt_offset`](Self::tilt_offset) near the plane.
    pub fn covariance_of_coefficients(&self) -> [[f64; 4]; 4] {
        let PlaneFit { centroid, axes: [e1, e2], .. } = self.fit;
        // n' = n + t₁ e₁ + t₂ e₂ and d' = −n'·c − offset.
        let rows: [[f64; 3]; 4] = [0, 1, 2, 3].map(|i| match i {
            3 => [-dot(e1, centroid), -dot(e2, centroid), -1.0],
            i => [e1[i], e2[i], 0.0],
        });
        let inner = self.tilt_offset.rows();
        rows.map(|left| {
            let half = inner.map(|row| dot(row, left));
            rows.map(|right| dot(half, right))
        })
    }
}

/// Mean variance of the errors of a cell's points along a direction.
fn variance_along(cell: &Moments, direction: [f64; 3]) -> f64 {
    cell.noise().quadratic_form(direction) / cell.count().max(1) as f64
}

/// Sums over cells with a weight each, relative to their anchor.
struct Weighted {
    count: u64,
    weight: f64,
    sum: [f64; 3],
    second: SymmetricMatrix3,
    noise: SymmetricMatrix3,
}

impl Weighted {
    fn of<'m>(cells: impl Iterator<Item = (&'m Moments, f64)>) -> Self {
        let (second, noise) = (SymmetricMatrix3::ZERO, SymmetricMatrix3::ZERO);
        let mut sums = Self { count: 0, weight: 0.0, sum: [0.0; 3], second, noise };
        for (cell, w) in cells {
            sums.count = sums.count.saturating_add(cell.count());
            sums.weight += w * cell.weight();
            sums.sum = [0, 1, 2].map(|i| sums.sum[i] + w * cell.sum()[i]);
            sums.second += cell.second() * w;
            sums.noise += cell.noise() * w;
        }
        sums
    }

    fn mean(&self) -> [f64; 3] {
        self.sum.map(|s| s / self.weight)
    }

    /// The covariance of the points, errors included.
    fn scatter(&self) -> SymmetricMatrix3 {
        self.second * (1.0 / self.weight) + SymmetricMatrix3::outer(self.mean()) * -1.0
    }

    /// The plane through the points without what the errors add to their scatter.
    fn fit(&self, anchor: [f64; 3]) -> Result<PlaneFit, Degenerate> {
        let mean = self.mean();
        let centroid = [0, 1, 2].map(|i| anchor[i] + mean[i]);
        let eigen = symmetric_eigen(&(self.scatter() + self.noise * (-1.0 / self.weight)));
        PlaneFit::of(&eigen, centroid, rounding(centroid))
    }
}

/// `A⁻¹ B A⁻¹`. The cells are taken about the centroid of the fit, `back` from their anchor.
fn covariance<'m>(
    cells: impl Iterator<Item = (&'m Moments, f64)>,
    back: [f64; 3],
    fit: &PlaneFit,
    [a, b, c]: [f64; 3],
) -> SymmetricMatrix3 {
    let PlaneFit { normal, axes, .. } = *fit;
    let mut pulls = SymmetricMatrix3::ZERO;
    for (cell, weight) in cells {
        let moments = cell.translated(back);
        let points = moments.count().max(1) as f64;
        let noise = moments.noise() * (1.0 / points);
        let squared = weight * weight;
        let v = noise.quadratic_form(normal);
        let of_normal = noise.rows().map(|row| dot(row, normal));
        let [uu, uv, vv] = pairs(&moments.second(), axes);
        let [nuu, nuv, nvv] = pairs(&noise, axes);
        let [nu, nv] = axes.map(|axis| dot(axis, of_normal));
        let [u, w] = axes.map(|axis| dot(axis, moments.sum()));
        // The scatter of the surface itself, times v, and the products of errors; C_uv with both along the normal.
        let own = |of_pair: f64, noise_pair: f64, a: f64, b: f64| {
            v * (of_pair - points * noise_pair) + points * (v * noise_pair + a * b)
        };
        pulls += SymmetricMatrix3([
            own(uu, nuu, nu, nu),
            own(uv, nuv, nu, nv),
            -v * u,
            own(vv, nvv, nv, nv),
            -v * w,
            v * points,
        ]) * squared;
    }
    // A is diagonal: the axes are those of the weighted scatter, about the weighted mean.
    let [xx, xy, xz, yy, yz, zz] = pulls.0;
    SymmetricMatrix3([a * a * xx, a * b * xy, a * c * xz, b * b * yy, b * c * yz, c * c * zz])
}

/// `e₁ᵀ M e₁`, `e₁ᵀ M e₂`, `e₂ᵀ M e₂`.
fn pairs(matrix: &SymmetricMatrix3, [e1, e2]: [[f64; 3]; 2]) -> [f64; 3] {
    let of_e2 = matrix.rows().map(|row| dot(row, e2));
    [matrix.quadratic_form(e1), dot(e1, of_e2), matrix.quadratic_form(e2)]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
