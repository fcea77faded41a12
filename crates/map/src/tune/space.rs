//! The settings among which the best are looked for.

use terrace_crs::{Axis, Bounds};
use terrace_grid::validate_cell_size;

use crate::ParamsError;
use crate::tune::{Settings, TuneAxis, TuneError};

/// The largest τ: up to here every whole number is an `f64`.
const MOST_TAU: u64 = 1 << 53;

/// The settings among which the best are looked for. A single value, or a range with equal ends, holds a setting fixed.
///
/// One made from the data is [`Tuner::space`](crate::tune::Tuner::space).
#[derive(Debug, Clone, PartialEq)]
pub struct TuneSpace {
    /// Edges ξ of a cell in metres, in any order.
    pub cell_size: Vec<f64>,
    /// The least and the largest depth d, both included.
    pub depth: (u32, u32),
    /// Density thresholds τ, in any order.
    pub tau: Vec<u64>,
    /// The least and the largest uncertainty threshold ω, both included.
    pub omega: (f64, f64),
    /// The least and the largest orientation threshold φ, both included.
    pub phi: (f64, f64),
}

impl TuneSpace {
    /// Around settings in use: cells from half to twice the size, depth 1 and 2, τ from a quarter to four times and at
    /// least 4, ω from 0.05 to 1, every φ.
    pub fn around(at: &Settings) -> Self {
        let near = |factor: f64| significant(factor * at.cell_size);
        let root = std::f64::consts::SQRT_2;
        Self {
            cell_size: vec![near(0.5), near(1.0 / root), at.cell_size, near(root), near(2.0)],
            depth: (1, 2),
            tau: [at.tau / 4, at.tau / 2, at.tau, at.tau.saturating_mul(2), at.tau.saturating_mul(4)]
                .map(|tau| tau.clamp(at.tau.min(4), MOST_TAU))
                .to_vec(),
            omega: (0.05, 1.0),
            phi: (0.0, 1.0),
        }
    }

    /// Whether a setting can take more than one value.
    pub fn varies(&self, axis: TuneAxis) -> bool {
        match axis {
            TuneAxis::CellSize => self.cell_size.iter().any(|size| Some(size) != self.cell_size.first()),
            TuneAxis::Depth => self.depth.0 < self.depth.1,
            TuneAxis::Tau => self.tau.iter().any(|tau| Some(tau) != self.tau.first()),
            TuneAxis::Omega => self.omega.0 < self.omega.1,
            TuneAxis::Phi => self.phi.0 < self.phi.1,
        }
    }

    /// The domain of a search, in the order of [`TuneAxis::ALL`].
    ///
    /// # Errors
    /// [`TuneError`] for the first setting with no value, a value that it cannot take, or a reversed range.
    pub(crate) fn bounds(&self) -> Result<Bounds, TuneError> {
        let mut sizes = self.cell_size.clone();
        if let Some(wrong) = sizes.iter().copied().find(|size| validate_cell_size(*size).is_err()) {
            return Err(ParamsError::new("cell_size", wrong, "a positive, finite length in metres").into());
        }
        sizes.sort_by(f64::total_cmp);
        sizes.dedup();
        let mut taus = self.tau.clone();
        taus.sort_unstable();
        taus.dedup();
        if let Some(wrong) = taus.iter().find(|tau| !(1..=MOST_TAU).contains(*tau)) {
            return Err(ParamsError::new("tau", *wrong as f64, "from 1 to 2^53").into());
        }
        for (axis, count) in [(TuneAxis::CellSize, sizes.len()), (TuneAxis::Tau, taus.len())] {
            if count == 0 {
                return Err(TuneError::NoValue { axis });
            }
        }
        if self.depth.0 == 0 {
            return Err(ParamsError::new("depth", 0.0, "at least 1").into());
        }
        let depth = (f64::from(self.depth.0), f64::from(self.depth.1));
        let within =
            |(lo, hi): (f64, f64), axis: TuneAxis, expected, fits: &dyn Fn(f64) -> bool| match [lo, hi]
                .into_iter()
                .find(|value| !fits(*value))
            {
                Some(wrong) => Err(TuneError::from(ParamsError::new(axis.name(), wrong, expected))),
                None if lo > hi => Err(TuneError::Reversed { axis, lo, hi }),
                None => Ok(()),
            };
        within(depth, TuneAxis::Depth, "at least 1", &|_| true)?;
        within(self.omega, TuneAxis::Omega, "above 0 and finite", &|x| x > 0.0 && x.is_finite())?;
        within(self.phi, TuneAxis::Phi, "from 0 to 1", &|x| (0.0..=1.0).contains(&x))?;
        let real = |(lo, hi)| Axis::Real { lo, hi };
        Ok(Bounds::of([
            Axis::List(sizes),
            Axis::Integer { lo: self.depth.0.into(), hi: self.depth.1.into() },
            Axis::List(taus.into_iter().map(|tau| tau as f64).collect()),
            real(self.omega),
            real(self.phi),
        ])?)
    }
}

/// To three significant digits, for a size that is one of many and that people read.
fn significant(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn in_use() -> Settings {
        Settings { cell_size: 0.123_456, depth: 1, tau: 6, omega: 0.4, phi: 0.1 }
    }

    #[test]
    fn around_holds_the_settings_in_use() {
        let space = TuneSpace::around(&in_use());
        assert_eq!(space.cell_size, [0.0617, 0.0873, 0.123_456, 0.175, 0.247]);
        assert_eq!(space.tau, [4, 4, 6, 12, 24]);
        let bounds = space.bounds().unwrap();
        assert!(bounds.contains(&in_use().place()));
        assert_eq!(bounds.axes()[2], Axis::List(vec![4.0, 6.0, 12.0, 24.0]));
        assert!(TuneAxis::ALL.into_iter().all(|axis| space.varies(axis)));
        let few = TuneSpace::around(&Settings { tau: 2, ..in_use() });
        assert!(few.tau.contains(&2) && few.bounds().is_ok());
    }

    #[test]
    fn single_values_are_fixed() {
        let space = TuneSpace {
            cell_size: vec![0.1, 0.1],
            depth: (2, 2),
            tau: vec![5],
            omega: (0.4, 0.4),
            phi: (0.1, 0.1),
        };
        assert!(space.bounds().unwrap().contains(&[0.1, 2.0, 5.0, 0.4, 0.1]));
        assert!(!TuneAxis::ALL.into_iter().any(|axis| space.varies(axis)));
    }

    #[test]
    fn what_is_no_space_is_an_error_with_its_values() {
        let space = TuneSpace::around(&in_use());
        let message = |space: TuneSpace| space.bounds().unwrap_err().to_string();
        let wrong = [
            (TuneSpace { cell_size: vec![0.1, -1.0], ..space.clone() }, "the parameter cell_size is -1"),
            (TuneSpace { cell_size: vec![], ..space.clone() }, "no value of cell_size"),
            (TuneSpace { tau: vec![], ..space.clone() }, "no value of tau"),
            (TuneSpace { tau: vec![4, 0], ..space.clone() }, "the parameter tau is 0"),
            (TuneSpace { depth: (0, 2), ..space.clone() }, "the parameter depth is 0"),
            (
                TuneSpace { depth: (3, 2), ..space.clone() },
                "the range of depth ends at 2, below its beginning, 3",
            ),
            (TuneSpace { omega: (0.0, 1.0), ..space.clone() }, "the parameter omega is 0"),
            (TuneSpace { omega: (0.1, f64::INFINITY), ..space.clone() }, "the parameter omega is inf"),
            (TuneSpace { phi: (0.5, f64::NAN), ..space.clone() }, "the parameter phi is NaN"),
            (
                TuneSpace { phi: (0.5, 0.25), ..space },
                "the range of phi ends at 0.25, below its beginning, 0.5",
            ),
        ];
        for (space, begins) in wrong {
            let message = message(space);
            assert!(message.contains(begins), "{message}");
        }
    }
}
