//! How planes are found: options of `extract` and `merge`.

use std::num::NonZeroUsize;

use clap::{Args, ValueEnum};
use terrace::Join;

use crate::args::{Cost, SearchMethod};

/// How planes are found in the cells of a map.
#[derive(Debug, Args)]
pub struct MethodArgs {
    /// Points that make a cell dense [default: a tenth of the median, at least 4]
    #[arg(long, value_name = "N", help_heading = "Method")]
    pub tau: Option<u64>,
    /// Which planes are one: those that touch and go on without a step, or also those that are the same within their covariances,
    /// wherever they are [default: touching]
    #[arg(long, value_enum, value_name = "WHICH", help_heading = "Regions (--preset default)")]
    pub join: Option<JoinWhich>,
    /// Fewest points of a plane [default: four in a thousand of all points, from 20 to 250]
    #[arg(long, value_name = "N", help_heading = "Regions (--preset default)")]
    pub min_points: Option<u64>,
    /// Least area of a plane in m2 [default: 1/400 of the area of all planes, at most that of 50 cells, of 12 where errors are stated]
    #[arg(
        long,
        value_name = "M2",
        allow_negative_numbers = true,
        help_heading = "Regions (--preset default)"
    )]
    pub min_area: Option<f64>,
    /// Largest standard error of the orientation of a plane in radians [default: 0.01]
    #[arg(
        long,
        value_name = "RAD",
        allow_negative_numbers = true,
        help_heading = "Regions (--preset default)"
    )]
    pub max_tilt: Option<f64>,
    /// Largest distance of a point from its plane in standard errors [default: 3.1]
    #[arg(
        long,
        value_name = "X",
        allow_negative_numbers = true,
        help_heading = "Regions (--preset default)"
    )]
    pub reach: Option<f64>,
    /// Orientation threshold of the first clustering, 0 to 1 [default: by preset]
    #[arg(
        long,
        value_name = "X",
        allow_negative_numbers = true,
        help_heading = "Clusters (--preset clusters or paper)"
    )]
    pub phi: Option<f64>,
    /// Cells whose normal is less certain than this take no part [default: by preset]
    #[arg(
        long,
        value_name = "X",
        allow_negative_numbers = true,
        help_heading = "Clusters (--preset clusters or paper)"
    )]
    pub omega: Option<f64>,
    /// Depth of the neighbourhoods normals are fitted to [default: by preset]
    #[arg(long, value_name = "N", help_heading = "Clusters (--preset clusters or paper)")]
    pub depth: Option<u32>,
    /// Cost minimised for each uncertain cluster [default: by preset]
    #[arg(long, value_enum, value_name = "FORM", help_heading = "Clusters (--preset clusters or paper)")]
    pub cost: Option<Cost>,
    /// How phi is searched for each uncertain cluster [default: by preset]
    #[arg(long, value_enum, value_name = "METHOD", help_heading = "Clusters (--preset clusters or paper)")]
    pub search: Option<SearchMethod>,
    /// Most clusterings of the certified search per uncertain cluster, or 'all' for a proof [default: 2000]
    #[arg(long, value_name = "N", value_parser = Most::parse, conflicts_with_all = ["no_optimise"], help_heading = "Clusters (--preset clusters or paper)")]
    pub evaluations: Option<Most>,
    /// Leave clusters as first found
    #[arg(long, conflicts_with = "cost", help_heading = "Clusters (--preset clusters or paper)")]
    pub no_optimise: bool,
    /// Clusters of fewer cells are not planes [default: by preset]
    #[arg(long, value_name = "N", help_heading = "Clusters (--preset clusters or paper)")]
    pub min_cells: Option<usize>,
    /// Seed of everything random [default: 0]
    #[arg(long, value_name = "N", help_heading = "Method")]
    pub seed: Option<u64>,
    /// Standard error that does not average out over a plane: distortion of the sensor, surfaces that are not flat
    /// [default: 0]
    #[arg(
        long,
        value_name = "METRES",
        conflicts_with = "no_covariance",
        allow_negative_numbers = true,
        help_heading = "Uncertainty"
    )]
    pub floor: Option<f64>,
    /// Leave planes as fitted by least squares, without covariance
    #[arg(long, help_heading = "Uncertainty")]
    pub no_covariance: bool,
}

impl MethodArgs {
    /// The first option given that is about clusters.
    pub fn about_clusters(&self) -> Option<&'static str> {
        let given = [
            ("--phi", self.phi.is_some()),
            ("--omega", self.omega.is_some()),
            ("--depth", self.depth.is_some()),
            ("--cost", self.cost.is_some()),
            ("--search", self.search.is_some()),
            ("--evaluations", self.evaluations.is_some()),
            ("--no-optimise", self.no_optimise),
            ("--min-cells", self.min_cells.is_some()),
        ];
        given.into_iter().find_map(|(name, given)| given.then_some(name))
    }

    /// The first option given that is about regions.
    pub fn about_regions(&self) -> Option<&'static str> {
        let given = [
            ("--join", self.join.is_some()),
            ("--min-points", self.min_points.is_some()),
            ("--min-area", self.min_area.is_some()),
            ("--max-tilt", self.max_tilt.is_some()),
            ("--reach", self.reach.is_some()),
        ];
        given.into_iter().find_map(|(name, given)| given.then_some(name))
    }
}

/// Which planes are one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum JoinWhich {
    /// Those that touch and go on without a step
    Touching,
    /// Also those that are the same within their covariances, wherever they are
    Coplanar,
}

impl From<JoinWhich> for Join {
    fn from(which: JoinWhich) -> Self {
        match which {
            JoinWhich::Touching => Self::Touching,
            JoinWhich::Coplanar => Self::Coplanar,
        }
    }
}

/// At most a number, or no limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Most {
    /// At most this many.
    Number(NonZeroUsize),
    /// As many as it takes.
    All,
}

impl Most {
    fn parse(text: &str) -> Result<Self, String> {
        match text {
            "all" => Ok(Self::All),
            _ => {
                text.parse().map(Self::Number).map_err(|_| "not a whole number from 1, nor 'all'".to_owned())
            }
        }
    }
}

impl From<Most> for Option<usize> {
    fn from(most: Most) -> Self {
        match most {
            Most::Number(number) => Some(number.get()),
            Most::All => None,
        }
    }
}
