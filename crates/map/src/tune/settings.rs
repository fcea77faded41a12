//! The five settings, as a place of a search, and where a result holds.

use std::fmt;

use terrace_crs::{Evaluation, Step};

use crate::{Interval, Params};

/// The settings that are tuned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Edge ξ of a cell in metres.
    pub cell_size: f64,
    /// Depth d of the neighbourhoods.
    pub depth: u32,
    /// Density threshold τ.
    pub tau: u64,
    /// Uncertainty threshold ω.
    pub omega: f64,
    /// Orientation threshold φ.
    pub phi: f64,
}

/// One of the settings, in the order of the coordinates of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TuneAxis {
    /// Edge ξ of a cell in metres.
    CellSize,
    /// Depth d of the neighbourhoods.
    Depth,
    /// Density threshold τ.
    Tau,
    /// Uncertainty threshold ω.
    Omega,
    /// Orientation threshold φ.
    Phi,
}

impl TuneAxis {
    /// All of them, in the order of the coordinates.
    pub const ALL: [Self; 5] = [Self::CellSize, Self::Depth, Self::Tau, Self::Omega, Self::Phi];

    /// The name it has in [`Params`].
    pub fn name(self) -> &'static str {
        match self {
            Self::CellSize => "cell_size",
            Self::Depth => "depth",
            Self::Tau => "tau",
            Self::Omega => "omega",
            Self::Phi => "phi",
        }
    }
}

impl fmt::Display for TuneAxis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Settings {
    /// The value of one of them.
    pub fn get(&self, axis: TuneAxis) -> f64 {
        match axis {
            TuneAxis::CellSize => self.cell_size,
            TuneAxis::Depth => self.depth.into(),
            TuneAxis::Tau => self.tau as f64,
            TuneAxis::Omega => self.omega,
            TuneAxis::Phi => self.phi,
        }
    }

    /// These settings with another value of one of them, which must be one that it can take.
    #[must_use]
    pub fn with(&self, axis: TuneAxis, value: f64) -> Self {
        let mut place = self.place();
        if let Some(x) = place.get_mut(axis as usize) {
            *x = value;
        }
        Self::at(&place).unwrap_or(*self)
    }

    /// The parameters with these settings, of clusters without a search for the φ of single ones.
    pub fn in_params(&self, params: &Params) -> Params {
        Params {
            cell_size: Some(self.cell_size),
            depth: self.depth,
            tau: Some(self.tau),
            omega: self.omega,
            phi: self.phi,
            optimise: None,
            regions: None,
            ..*params
        }
    }

    /// The place of a search.
    pub(crate) fn place(&self) -> Vec<f64> {
        TuneAxis::ALL.map(|axis| self.get(axis)).to_vec()
    }

    /// The settings at a place; `None` unless it has five coordinates. Depth and τ are whole numbers within an `f64` at
    /// every place of a [`TuneSpace`](crate::tune::TuneSpace).
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub(crate) fn at(place: &[f64]) -> Option<Self> {
        let [cell_size, depth, tau, omega, phi] = *place else { return None };
        Some(Self { cell_size, depth: depth as u32, tau: tau as u64, omega, phi })
    }
}

/// A value of the cost and the settings with the same result: any τ of `tau`, ω of `omega` and φ of `phi`, in any
/// combination, with the cell size and depth it was found at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TuneStep {
    /// The cost.
    pub value: f64,
    /// The smallest and the largest τ, both included, with the same dense cells; `None`: there is no largest.
    pub tau: (u64, Option<u64>),
    /// The ω, the first included and the second not, with the same cells certain enough. The second is infinite when all
    /// are.
    pub omega: (f64, f64),
    /// The φ with the same clusters.
    pub phi: Interval,
}

impl TuneStep {
    /// The answer of a cost at these settings.
    pub(crate) fn evaluation(&self, at: &Settings) -> Evaluation {
        let depth = f64::from(at.depth);
        let tau = (self.tau.0 as f64, self.tau.1.map_or(f64::INFINITY, |last| last as f64 + 1.0));
        let phi = (self.phi.lo, self.phi.hi.unwrap_or(f64::INFINITY));
        let cell = (at.cell_size, at.cell_size.next_up());
        let (lo, hi) = [cell, (depth, depth + 1.0), tau, self.omega, phi].into_iter().unzip();
        Evaluation { value: self.value, step: Step::Box { lo, hi } }
    }
}
