//! Every setting of the method, with presets.

use terrace_cluster::SeedOrder;
use terrace_grid::{Assignment, Connectivity, validate_cell_size};
use terrace_normals::FitTo;
use terrace_regions::{RegionsError, Step};

use crate::{Beta, CostForm, ParamsError};

/// The largest population of the search for φ: one that still fits memory for every cluster at once.
const MAX_POPULATION: usize = 1_000_000;

/// How much each point counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Weighting {
    /// Every point the same (the paper).
    #[default]
    Uniform,
    /// By `1/σ²`, which gives the plane of least variance. Every point must then have a standard error above zero.
    Information,
}

/// Settings of the whole method. Start from a preset and change what you need to; `None` is chosen from the data, and
/// the value chosen is in the result ([`Used`](crate::Used)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Params {
    /// Edge ξ of a cell in metres. The paper wants it above the standard error of the points. `None`: from the spacing
    /// and noise of the first scan, see [`choose_cell_size`](crate::choose_cell_size).
    pub cell_size: Option<f64>,
    /// Density threshold τ: cells with at least this many points are dense. `None`: a tenth of the median density, and
    /// at least 4.
    pub tau: Option<u64>,
    /// Uncertainty threshold ω: cells whose normal has `s_x + s_y + s_z` of ω and more are left out.
    pub omega: f64,
    /// Orientation threshold φ of the first clustering, 0 to 1.
    pub phi: f64,
    /// Depth d of the neighbourhoods normals are fitted to (Definition 2), from 1.
    pub depth: u32,
    /// Which cells are directly connected.
    pub connectivity: Connectivity,
    /// How points find their cell.
    pub assignment: Assignment,
    /// How much each point counts.
    pub weighting: Weighting,
    /// What normals are fitted to.
    pub fit: FitTo,
    /// Where clusters begin. The seed of a random order is [`Params::seed`].
    pub random_seeds: bool,
    /// Search for a better φ for each uncertain cluster; `None` leaves clusters as first found.
    pub optimise: Option<Optimise>,
    /// Find for each plane the one of least variance, with its covariance
    /// ([`ExtractedPlane::estimate`](crate::ExtractedPlane::estimate)); `None` leaves planes as fitted by least squares.
    /// Not for the paper's way of finding cells, whose points are not those of a place, and not for weighted points.
    pub estimate: Option<Estimate>,
    /// Grow planes as regions, at several resolutions, with every threshold in standard errors, and label points one by one; `None` is
    /// the paper's way: clusters of cells with like normals, and points with the label of their cell. Of the settings above,
    /// regions use cell size, connectivity and depth (for the uncertainty of the normals of their cells), τ (for covariances) and
    /// `estimate`. Like covariances, not for the paper's way of finding cells, nor for weighted points: those are clustered.
    pub regions: Option<Regions>,
    /// Clusters of fewer cells are not reported as planes; their points have no label.
    pub min_cells: usize,
    /// Seed of everything random.
    pub seed: u64,
}

/// Settings of the search for φ (section V).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Optimise {
    /// Clusters whose largest of `s_x`, `s_y`, `s_z` is above this are uncertain.
    pub above: f64,
    /// How the clusters' uncertainties are summed up.
    pub form: CostForm,
    /// Weight w_nv of the uncertainties.
    pub weight_uncertainty: f64,
    /// Weight w_nc of the number of clusters.
    pub weight_clusters: f64,
    /// How the φ of least cost is searched.
    pub search: Search,
}

/// Settings of the covariance of planes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Estimate {
    /// Standard error, in metres, that does not average out over the points of a plane: of the sensor's distortion, its
    /// calibration, of surfaces that are not flat. It counts as that of one single point.
    pub floor: f64,
}

/// Settings of regions: what makes one a plane, and a point one of its points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Regions {
    /// The largest standard error of a plane's orientation, in radians: strips along edges, scraps, and patches of curved
    /// surfaces are less certain.
    pub tilt: f64,
    /// The largest distance of a point from its plane, in standard errors.
    pub reach: f64,
    /// A surface whose normal turns by this over it, rms, in radians, is no plane.
    pub turn: f64,
    /// The fewest points of a plane. `None`: four in a thousand of all points, at least 20, and 250 are always enough.
    pub min_points: Option<u64>,
    /// The least area of a plane, in m². `None`: a quarter of a per cent of the area of all planes, but no more than that of fifty
    /// cells, of twelve where errors are stated.
    pub min_area: Option<f64>,
    /// Which regions are one plane.
    pub join: Join,
    /// Whether stated errors are all that moves points while planes are as flat as they say. Models of sensors know nothing of
    /// distortion, which neighbouring points share: with them, say `false`, and surfaces may be bent by a few errors.
    pub errors_are_complete: bool,
    /// A step that is left out, to find what it is worth.
    pub leave_out: Option<Step>,
}

/// Which regions are one plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Join {
    /// Those that touch and go on without a step.
    #[default]
    Touching,
    /// Also those that are the same within their covariances, wherever they are. Planes are then those of least variance, whether or not
    /// covariances are to be told.
    Coplanar,
}

impl Regions {
    /// Without the join, which regions know nothing of.
    pub(crate) fn settings(&self, errors_are_stated: bool) -> terrace_regions::Settings {
        let Self { tilt, reach, turn, min_points, min_area, leave_out, .. } = *self;
        terrace_regions::Settings { tilt, reach, turn, errors_are_stated, min_points, min_area, leave_out }
    }
}

impl Default for Regions {
    fn default() -> Self {
        let terrace_regions::Settings { tilt, reach, turn, min_points, min_area, .. } =
            terrace_regions::Settings::default();
        Self {
            tilt,
            reach,
            turn,
            min_points,
            min_area,
            join: Join::default(),
            errors_are_complete: true,
            leave_out: None,
        }
    }
}

/// How the φ of least cost is searched. Both use that a clustering holds on a whole interval of φ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Search {
    /// Where a lower cost is likely first, then from end to end, until it is certain that there is none
    /// ([`CertifiedSearch`](terrace_crs::CertifiedSearch)).
    Certified {
        /// At most this many clusterings for each uncertain cluster; `None`: as many as it takes.
        evaluations: Option<usize>,
    },
    /// The controlled random search of Fig. 2
    /// ([`ControlledRandomSearch`](terrace_crs::ControlledRandomSearch)).
    ControlledRandom {
        /// Size n of the population, from 2 to a million.
        population: usize,
        /// Size m of the subset a trial is drawn from, from 2 to the population.
        subset: usize,
        /// Rounds ζ.
        rounds: usize,
    },
}

impl Search {
    /// The search of the paper: 20 samples, subsets of 2, 60 rounds.
    pub const PAPER: Self = Self::ControlledRandom { population: 20, subset: 2, rounds: 60 };
}

impl Default for Search {
    /// Certified, with at most 2000 clusterings.
    fn default() -> Self {
        Self::Certified { evaluations: Some(2000) }
    }
}

impl Default for Optimise {
    fn default() -> Self {
        Self {
            above: 0.15,
            form: CostForm::Share,
            weight_uncertainty: 1.0,
            weight_clusters: 0.01,
            search: Search::default(),
        }
    }
}

impl Default for Params {
    /// Regions over order-independent cells.
    fn default() -> Self {
        Self {
            cell_size: None,
            tau: None,
            omega: 0.4,
            phi: 0.1,
            depth: 1,
            connectivity: Connectivity::Corners,
            assignment: Assignment::Voxel,
            weighting: Weighting::Uniform,
            fit: FitTo::Points,
            random_seeds: false,
            optimise: Some(Optimise::default()),
            estimate: Some(Estimate::default()),
            regions: Some(Regions::default()),
            min_cells: 5,
            seed: 0,
        }
    }
}

impl Params {
    /// Clusters of cells with like normals, each uncertain one at the φ of least cost: the paper's idea on order-independent cells, with
    /// planes of all points, the most certain seeds first, and the certified search.
    pub fn clusters() -> Self {
        Self { regions: None, ..Self::default() }
    }

    /// The method as the paper describes it: cells by expected distance, planes of cell centres, random seeds.
    pub fn paper() -> Self {
        Self {
            assignment: Assignment::ExpectedDistance,
            fit: FitTo::Centres,
            random_seeds: true,
            estimate: None,
            regions: None,
            optimise: Some(Optimise { search: Search::PAPER, ..Optimise::default() }),
            ..Self::default()
        }
    }

    /// Whether points are those of the place of their cell, each with weight 1: what covariances, labels of points and
    /// [`Mapper::streaming`](crate::Mapper::streaming) need.
    pub fn by_place(&self) -> bool {
        self.assignment == Assignment::Voxel && self.weighting == Weighting::Uniform
    }

    /// The settings of regions, if planes are grown.
    pub(crate) fn grows(&self) -> Option<Regions> {
        self.regions.filter(|_| self.by_place())
    }

    /// The order in which cells found clusters.
    pub fn seed_order(&self) -> SeedOrder {
        if self.random_seeds { SeedOrder::Random { seed: self.seed } } else { SeedOrder::MostCertain }
    }

    /// Checks every value.
    ///
    /// # Errors
    /// [`ParamsError`] naming the first parameter that cannot be used, and its value.
    pub fn validate(&self) -> Result<(), ParamsError> {
        if let Some(size) = self.cell_size {
            validate_cell_size(size)
                .map_err(|_| ParamsError::new("cell_size", size, "a positive, finite length in metres"))?;
        }
        if self.tau == Some(0) {
            return Err(ParamsError::new("tau", 0.0, "at least 1"));
        }
        if self.omega.is_nan() || self.omega <= 0.0 {
            return Err(ParamsError::new("omega", self.omega, "above 0"));
        }
        if !(0.0..=1.0).contains(&self.phi) {
            return Err(ParamsError::new("phi", self.phi, "from 0 to 1"));
        }
        if self.depth == 0 {
            return Err(ParamsError::new("depth", 0.0, "at least 1"));
        }
        if let Some(Estimate { floor }) = self.estimate
            && !(floor.is_finite() && floor >= 0.0)
        {
            return Err(ParamsError::new("estimate.floor", floor, "a finite length in metres, from 0"));
        }
        if let Some(regions) = self.regions {
            regions.validate()?;
        }
        self.optimise.map_or(Ok(()), |optimise| optimise.validate())
    }
}

impl Regions {
    fn validate(&self) -> Result<(), ParamsError> {
        let of = |name| match name {
            "tilt" => "regions.tilt",
            "reach" => "regions.reach",
            "turn" => "regions.turn",
            _ => "regions.min_area",
        };
        self.settings(true).validate().map_err(|refusal| match refusal {
            RegionsError::Setting { name, value, expected } => ParamsError::new(of(name), value, expected),
            _ => ParamsError::new("regions", f64::NAN, "usable"),
        })
    }
}

impl Optimise {
    /// The cost that is minimised.
    pub fn beta(&self) -> Beta {
        let Self { form, weight_uncertainty, weight_clusters, .. } = *self;
        Beta { form, weight_uncertainty, weight_clusters }
    }

    fn validate(&self) -> Result<(), ParamsError> {
        let weights = [
            ("optimise.above", self.above),
            ("optimise.weight_uncertainty", self.weight_uncertainty),
            ("optimise.weight_clusters", self.weight_clusters),
        ];
        if let Some((name, value)) = weights.into_iter().find(|(_, v)| !(v.is_finite() && *v >= 0.0)) {
            return Err(ParamsError::new(name, value, "finite and at least 0"));
        }
        match self.search {
            Search::Certified { evaluations: Some(0) } => {
                Err(ParamsError::new("optimise.evaluations", 0.0, "at least 1"))
            }
            Search::ControlledRandom { population, .. } if !(2..=MAX_POPULATION).contains(&population) => {
                Err(ParamsError::new("optimise.population", population as f64, "from 2 to a million"))
            }
            Search::ControlledRandom { population, subset, .. } if !(2..=population).contains(&subset) => {
                Err(ParamsError::new("optimise.subset", subset as f64, "from 2 to the population"))
            }
            _ => Ok(()),
        }
    }
}
