//! The scans, and what is to become small.

use terrace_types::Scan;

use crate::first::tenth_of_median_density;
use crate::tune::{Objective, Settings, TuneCost, TuneError, TuneSpace};
use crate::{ExtractError, InsertError, Mapper, Params, choose_cell_size};

/// Looks for better settings for scans, which it keeps: each cell size makes a grid of its own.
///
/// Memory: the scans, and, while a [`TuneCost`] lives, the grid of each cell size met with 4 bytes for each point, and the
/// normals of the last few choices of cell size, τ and depth.
///
/// ```
/// use terrace::tune::{Objective, TuneSearch, Tuner};
/// use terrace::{Frame, Mapper, Params, Scan, Sigma};
///
/// // A floor and a wall that meet, sampled every 4 cm.
/// let lattice = (0..2500).map(|k| [0.04 * f64::from(k % 50) + 0.003, 0.04 * f64::from(k / 50) + 0.003]);
/// let points = lattice.flat_map(|[u, v]| [[u, v, 0.0], [0.0, u, v]]).collect();
/// let scan = Scan::new(points, Sigma::Uniform(0.005), Frame::World { sensor: None })?;
///
/// let tuner = Tuner::new(Params::default(), vec![scan.clone()], Objective::default())?;
/// let mut cost = tuner.cost(&tuner.space())?;
/// let search = TuneSearch { evaluations: 20, ..TuneSearch::default() };
/// let tuned = cost.tune(&search, |progress| assert!(progress.evaluations <= 20))?;
/// assert!(tuned.step.value <= tuned.before.value);
///
/// // The parameters found are those of an extraction.
/// let mut mapper = Mapper::new(tuned.params)?;
/// mapper.insert(&scan)?;
/// assert!(mapper.extract()?.planes.len() >= 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Tuner {
    pub(crate) params: Params,
    pub(crate) scans: Vec<Scan>,
    pub(crate) objective: Objective,
    in_use: Settings,
}

impl Tuner {
    /// Settings for these scans, beginning with `params`; what is not given there is chosen from the data as an
    /// extraction would.
    ///
    /// # Errors
    /// [`TuneError`] when a parameter, weight or measure cannot be used, a scan cannot be inserted, or the labels do not
    /// fit the points.
    pub fn new(params: Params, scans: Vec<Scan>, objective: Objective) -> Result<Self, TuneError> {
        objective.check(scans.iter().map(Scan::len).sum())?;
        params.validate()?;
        let cell_size = match (params.cell_size, scans.first()) {
            (Some(size), _) => size,
            (None, Some(first)) => {
                let choice = choose_cell_size(first);
                choice.ok_or(InsertError::NoCellSize { present: first.present() })?.cell_size
            }
            (None, None) => return Err(ExtractError::Empty.into()),
        };
        let tau = if let Some(tau) = params.tau {
            tau
        } else {
            let mut mapper = Mapper::new(Params { cell_size: Some(cell_size), ..params })?;
            for scan in &scans {
                mapper.insert(scan)?;
            }
            let grid = mapper.grid().filter(|grid| !grid.is_empty());
            tenth_of_median_density(grid.ok_or(ExtractError::Empty)?)
        };
        let in_use = Settings { cell_size, depth: params.depth, tau, omega: params.omega, phi: params.phi };
        Ok(Self { params, scans, objective, in_use })
    }

    /// The settings of the parameters, with what was chosen from the data.
    pub fn in_use(&self) -> Settings {
        self.in_use
    }

    /// The space around the settings in use: [`TuneSpace::around`].
    pub fn space(&self) -> TuneSpace {
        TuneSpace::around(&self.in_use)
    }

    /// The cost of the settings of a space.
    ///
    /// # Errors
    /// [`TuneError`] for the first setting with no value, a value that it cannot take, or a reversed range.
    pub fn cost(&self, space: &TuneSpace) -> Result<TuneCost<'_>, TuneError> {
        Ok(TuneCost::new(self, space.bounds()?))
    }
}
