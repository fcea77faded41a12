//! What the mapper refuses.

use terrace_cluster::ClusterError;
use terrace_crs::SearchError;
use terrace_grid::GridError;
use terrace_regions::RegionsError;

/// A parameter that cannot be used.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("the parameter {name} is {value}, it must be {expected}")]
pub struct ParamsError {
    /// The parameter, as it is called in [`Params`](crate::Params).
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// What is allowed.
    pub expected: &'static str,
}

impl ParamsError {
    pub(crate) fn new(name: &'static str, value: f64, expected: &'static str) -> Self {
        Self { name, value, expected }
    }
}

/// Why there is no map that forgets its points.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum StreamingError {
    /// A parameter cannot be used.
    #[error(transparent)]
    Params(#[from] ParamsError),
    /// Points that find their cell by expected distance, or weigh what they tell, are not told again by where they are.
    #[error("points can only be forgotten where their cell is told by their place and each counts the same")]
    NotByPlace,
    /// What views saw is only known where covariances need it.
    #[error("what views saw of the cells is not known everywhere: the map was made to spare that")]
    Spared,
}

/// Why a scan could not be inserted. The mapper is as it was.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum InsertError {
    /// No cell size was given, and this first scan does not show one: it has too few points, or they are all in one
    /// place. Give a cell size.
    #[error("no cell size can be chosen from {present} points; give one")]
    NoCellSize {
        /// Number of points that are not absent.
        present: usize,
    },
    /// Weighting by information needs a standard error for every point that is above zero along each axis, and neither
    /// so small nor so large that `1/σ²` is no positive, finite number.
    #[error("point {point} has no standard error with a weight 1/σ², which weighting by information needs")]
    NoWeight {
        /// Index of the point within the scan.
        point: usize,
    },
    /// The pose is said to be uncertain, and it is not known where the sensor stood.
    #[error("the error of a pose moves points about the sensor, and it is not known where that stood")]
    NoSensor,
    /// The cell size chosen is refused by the grid.
    #[error(transparent)]
    Grid(#[from] GridError),
}

/// Why no planes could be extracted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ExtractError {
    /// No scan with a usable point was inserted.
    #[error("no point was inserted")]
    Empty,
    /// A threshold or normal was refused by the clustering.
    #[error(transparent)]
    Cluster(#[from] ClusterError),
    /// The search for φ was refused: weights so large that β is not finite.
    #[error(transparent)]
    Search(#[from] SearchError),
    /// Cells or points were refused by the regions: more points than are numbered.
    #[error(transparent)]
    Regions(#[from] RegionsError),
}
