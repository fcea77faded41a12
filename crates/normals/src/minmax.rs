//! The normal of a neighbourhood and its min-max uncertainty (Definition 3).

use glam::DVec3;
use terrace_stats::{SymmetricMatrix3, UncertainVector};

use crate::arrow::Arrows;
use crate::fit::{Spread, are_determined, determined, rounding};
use crate::{Degenerate, EigenvalueBounds, PlaneFit, Summarised, symmetric_eigen};

/// What the plane of a neighbourhood is fitted to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FitTo {
    /// The virtual centres of the cells, each with the same weight: the paper's fit.
    Centres,
    /// All points of the cells, through their summed statistics: uses the scatter within cells as well.
    #[default]
    Points,
}

/// A plane fitted to a neighbourhood, and how far its normal may be off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UncertainNormal {
    /// The plane.
    pub fit: PlaneFit,
    /// Largest change of each component of the unit normal under the min-max perturbations, without unit: the paper's
    /// (s_x, s_y, s_z) of a cell.
    pub uncertainty: [f64; 3],
}

impl UncertainNormal {
    /// The unit normal as an uncertain vector, with the min-max uncertainty as its standard error.
    pub fn as_vector(&self) -> UncertainVector {
        UncertainVector { value: self.fit.normal, error: self.uncertainty }
    }

    /// `s_x + s_y + s_z`, what the threshold ω is compared with.
    pub fn total(&self) -> f64 {
        self.uncertainty.iter().sum()
    }
}

/// A cell closer to the axis of a tilt than this share of the extent is on it: which side is rounding.
const ON_AXIS: f64 = 1e-9;

/// Components of a normal, and one more.
const LANES: usize = 4;

/// The normal of a neighbourhood of cells, with its min-max uncertainty. Allocates nothing; the cells are walked
/// through a few times.
///
/// # Algorithm
/// 1. Fit the plane: mean c, normal n, axes e₁, e₂ in the plane, variances λ₁ ≥ λ₂ ≥ λ₀ along e₁, e₂, n.
/// 2. The centre of cell i is uncertain by δᵢ along n: δᵢ² = nᵀ (scatter of its points / dᵢ + diag(E) / dᵢ²) n.
/// 3. For each component j of the normal and both signs, move every centre cᵢ by ±δᵢ sign((cᵢ − c)·gⱼ) along n, where
///    gⱼ = e₁ e₁ⱼ / (λ₁ − λ₀) + e₂ e₂ⱼ / (λ₂ − λ₀), and fit again. Moving a centre by t changes nⱼ by −wᵢ t (cᵢ − c)·gⱼ
///    to first order, wᵢ being its share of the weight, so that no errors up to these sizes change nⱼ by more.
/// 4. The uncertainty is the largest change of each component of the normal over the six fits.
///
/// The fits need no pass over the cells each: moving cells by tᵢ n changes the covariance by
/// `a nᵀ + n aᵀ + (Σ wᵢ tᵢ² − (Σ wᵢ tᵢ)²) n nᵀ` with `a = Σ wᵢ tᵢ (cᵢ − c)`.
///
/// # Parameters
/// * `cells`: the statistics of the cells of the neighbourhood, at least three with points, or [summaries](crate::Summary) of them.
/// * `to`: what is fitted, see [`FitTo`].
///
/// # Errors
/// [`Degenerate`] when the plane or the tilt is not determined. The *centres* must not be on a line, whatever is fitted:
/// the perturbations turn the plane at the centres, and would find centres in a row to be certain.
pub fn estimate<'c, C: Summarised + 'c>(
    cells: impl IntoIterator<Item = &'c C, IntoIter: Clone>,
    to: FitTo,
) -> Result<UncertainNormal, Degenerate> {
    let cells = cells.into_iter();
    let centres = Spread::of(cells.clone().filter_map(C::mean))?;
    let (fit, weight) = match to {
        FitTo::Centres => {
            let eigen = symmetric_eigen(&centres.covariance);
            (PlaneFit::of(&eigen, centres.centroid, rounding(centres.centroid))?, centres.count as f64)
        }
        FitTo::Points => fit_union(cells.clone(), &centres)?,
    };
    let tilted = pulp::Arch::new().dispatch(Tilted { cells, fit: &fit, weight, to, tilts: Tilts::of(&fit) });
    Ok(UncertainNormal { fit, uncertainty: tilted?.to_array() })
}

/// What the perturbations of the centres of cells do, several components of the normal at a time.
struct Tilted<'f, I> {
    cells: I,
    fit: &'f PlaneFit,
    weight: f64,
    to: FitTo,
    tilts: Tilts,
}

impl<'c, C: Summarised + 'c, I: Iterator<Item = &'c C>> pulp::WithSimd for Tilted<'_, I> {
    type Output = Result<DVec3, Degenerate>;

    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Self::Output {
        let Self { cells, fit, weight, to, mut tilts } = self;
        for cell in cells {
            if cell.weight().is_nan() {
                return Err(Degenerate::NotFinite);
            }
            let (Some(centre), Some(covariance)) = (cell.mean(), cell.covariance_of_mean()) else { continue };
            // Checked here because the larger of a NaN and 0 is 0: a cell without known error would count as certain.
            if !covariance.is_finite() {
                return Err(Degenerate::NotFinite);
            }
            let share = if to == FitTo::Centres { 1.0 } else { cell.weight() } / weight;
            let delta = covariance.quadratic_form(fit.normal).max(0.0).sqrt();
            tilts.add(DVec3::from_array(centre) - DVec3::from_array(fit.centroid), delta, share);
        }
        tilts.largest_change()
    }
}

/// The plane through all points of the cells, and their weight.
fn fit_union<'c, C: Summarised + 'c>(
    cells: impl Iterator<Item = &'c C>,
    centres: &Spread,
) -> Result<(PlaneFit, f64), Degenerate> {
    let origin = DVec3::from_array(centres.centroid);
    let (mut weight, mut sum, mut scatter) = (0.0, DVec3::ZERO, SymmetricMatrix3::ZERO);
    for cell in cells {
        let (Some(centre), Some(covariance)) = (cell.mean(), cell.covariance()) else { continue };
        let apart = DVec3::from_array(centre) - origin;
        weight += cell.weight();
        sum += apart * cell.weight();
        scatter += (covariance + SymmetricMatrix3::outer(apart.to_array())) * cell.weight();
    }
    let mean = sum / weight;
    let covariance = scatter * (1.0 / weight) + SymmetricMatrix3::outer(mean.to_array()) * -1.0;
    let bounds = EigenvalueBounds::of(&centres.covariance);
    let [across, trace] = [bounds.middle[0], centres.covariance.trace()];
    if !are_determined(across, trace - across, rounding(centres.centroid)) {
        determined(symmetric_eigen(&centres.covariance).values, rounding(centres.centroid))?;
    }
    let centroid = (origin + mean).to_array();
    Ok((PlaneFit::of(&symmetric_eigen(&covariance), centroid, rounding(centroid))?, weight))
}

/// What the perturbations do to the covariance, in the frame of the plane: e₁, e₂, n.
struct Tilts {
    axes: [DVec3; 3],
    variances: [f64; 3],
    rounding: f64,
    /// By component of the normal, and one that is nothing, so that they fill a vector: its direction gⱼ along e₁ and e₂, times
    /// (λ₁ − λ₀)(λ₂ − λ₀), which changes no sign and divides by nothing.
    directions: [[f64; LANES]; 2],
    /// Below this the product with a direction is rounding.
    on_axis: f64,
    /// `Σ w t (c − mean)` along each axis, `Σ w t` and `Σ w t²`, by component.
    pull: [[f64; LANES]; 3],
    mean: [f64; LANES],
    square: [f64; LANES],
}

impl Tilts {
    fn of(fit: &PlaneFit) -> Self {
        let [first, second] = fit.axes;
        let [thickness, along, across] = [fit.variances[0], fit.variances[2], fit.variances[1]];
        let (along_over, across_over) = (along - thickness, across - thickness);
        Self {
            axes: [first, second, fit.normal].map(DVec3::from_array),
            variances: [along, across, thickness],
            rounding: rounding(fit.centroid),
            directions: [first.map(|x| x * across_over), second.map(|x| x * along_over)]
                .map(|[x, y, z]| [x, y, z, 0.0]),
            on_axis: ON_AXIS * along_over * along.sqrt(),
            pull: [[0.0; LANES]; 3],
            mean: [0.0; LANES],
            square: [0.0; LANES],
        }
    }

    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn add(&mut self, from_centroid: DVec3, delta: f64, share: f64) {
        let place = self.axes.map(|axis| axis.dot(from_centroid));
        let ([first, second], step) = (self.directions, share * delta);
        let arms: [f64; LANES] = std::array::from_fn(|j| first[j] * place[0] + second[j] * place[1]);
        let steps = arms.map(|arm| if arm.abs() > self.on_axis { step } else { 0.0 });
        for j in 0..LANES {
            let moved = steps[j].copysign(arms[j]);
            for (pull, place) in self.pull.iter_mut().zip(place) {
                pull[j] += place * moved;
            }
            self.mean[j] += moved;
            self.square[j] += steps[j] * delta;
        }
    }

    /// The largest change of each component of the normal.
    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn largest_change(&self) -> Result<DVec3, Degenerate> {
        let [along, across, thickness] = self.variances;
        // To and fro; the last of each is not perturbed.
        let signed = |of: [f64; LANES], back: f64| -> [f64; 2 * LANES] {
            std::array::from_fn(|lane| if lane < LANES { of[lane] } else { back * of[lane - LANES] })
        };
        let [first, second, off] = self.pull.map(|pull| signed(pull, -1.0));
        let variance: [f64; LANES] = std::array::from_fn(|j| self.square[j] - self.mean[j] * self.mean[j]);
        let variance = signed(variance, 1.0);
        let tip = std::array::from_fn(|lane| thickness + 2.0 * off[lane] + variance[lane]);
        let arrows = Arrows { shaft: [along, across], barbs: [first, second], tip };
        let least = arrows.least();
        let mut largest = DVec3::ZERO;
        for lane in (0..2 * LANES).filter(|lane| lane % LANES < 3) {
            // The middle eigenvalue is no less than that of the plane itself, and all three have the sum of the diagonal.
            let most = along + tip[lane] - least.value[lane];
            let sure = least.is_found[lane] && are_determined(across, most, self.rounding);
            let [x, y, z] = if sure {
                least.vector.map(|x| x[lane])
            } else {
                solved(arrows.matrix(lane), self.rounding)?
            };
            // z − 1 without subtracting nearly equal numbers.
            let shrunk = -(x * x + y * y) / (1.0 + z);
            largest = largest.max((self.axes[0] * x + self.axes[1] * y + self.axes[2] * shrunk).abs());
        }
        Ok(largest)
    }
}

/// The least eigenvector where only the solver tells it; the last component is not negative.
#[cold]
fn solved(covariance: SymmetricMatrix3, rounding: f64) -> Result<[f64; 3], Degenerate> {
    let eigen = symmetric_eigen(&covariance);
    determined(eigen.values, rounding)?;
    let normal = eigen.vectors[0];
    Ok(if normal[2] < 0.0 { normal.map(|x| -x) } else { normal })
}
