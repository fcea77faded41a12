//! The command line.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, Parser, Subcommand, ValueEnum};
use terrace::Params;
use terrace_noise::SensorNoise;
use terrace_synth::SceneKind;

use crate::calibrate_args::CalibrateArgs;
use crate::eval_args::EvalArgs;
use crate::extract_args::ExtractArgs;
#[cfg(feature = "parquet")]
use crate::merge_args::MergeArgs;

/// Finds the planes of 3D scans and says how sure it is of the orientation of each.
#[derive(Debug, Parser)]
#[command(
    name = "terrace",
    version,
    max_term_width = 100,
    after_help = "Exit codes: 0 done, 1 nothing usable in the inputs or no output written, 2 wrong arguments."
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Extract the planes of scans
    Extract(Box<ExtractArgs>),
    /// Put maps together that 'extract' saved, and extract their planes
    #[cfg(feature = "parquet")]
    Merge(Box<MergeArgs>),
    /// Search the settings that suit scans best: cell size, depth, tau, omega and phi at once
    Tune(Box<TuneArgs>),
    /// Compare found labels with true ones: precision, recall, overlap, planes split and merged, angles
    Eval(EvalArgs),
    /// Test whether the covariances of planes are right: on known planes, or scan against scan
    Calibrate(Box<CalibrateArgs>),
    /// Make a synthetic scan of a scene with known planes
    Synth(SynthArgs),
    /// Tell what files hold: format, points, bounds, spacing, absent points
    Info(InfoArgs),
    /// Make the experiments of the paper again: Tables I and II, Figures 1, 3 and 4
    Reproduce(ReproduceArgs),
}

/// How files are read.
#[derive(Debug, Args)]
pub struct ReadArgs {
    /// Standard error of every point in metres
    #[arg(
        long,
        value_name = "METRES",
        conflicts_with = "sensor",
        allow_negative_numbers = true,
        help_heading = "Input"
    )]
    pub sigma: Option<f64>,
    /// Errors of the points by a noise model: kinect | kinect:focal=525 | stereo:fb=80,disparity=0.2,focal=700 |
    /// lidar:range=0.02,angle=0.1deg | uniform:0.01 | axes:0.01,0.01,0.02. Lengths in metres, fb in px m, disparity and
    /// focal in px, angle in deg, mrad or rad
    #[arg(long, value_name = "SPEC", help_heading = "Input")]
    pub sensor: Option<SensorNoise>,
    /// Field of the files that holds the standard error [default: sigma, or sigma_x, sigma_y, sigma_z]
    #[arg(long, value_name = "NAME", conflicts_with_all = ["sigma", "sensor"], help_heading = "Input")]
    pub sigma_field: Option<String>,
    /// Camera of depth images: fx,fy,cx,cy in pixels, or a JSON or 3x3 text file
    #[arg(long, value_name = "FX,FY,CX,CY|FILE", help_heading = "Input")]
    pub intrinsics: Option<String>,
    /// Raw units of depth images per metre; raw 0 and 65535 are no measurement
    #[arg(
        long,
        value_name = "N",
        default_value_t = 1000.0,
        allow_negative_numbers = true,
        help_heading = "Input"
    )]
    pub depth_scale: f64,
}

/// Arguments of `tune`.
#[derive(Debug, Args)]
#[command(after_help = "\
Settings are given as lists a,b,c or as ranges lo..hi, ends included; a single value holds the setting fixed.

Examples:
  terrace tune room.ply --out tuned
      By the paper's cost: how uncertain the normals are, how many planes there are, how many points are left over.
  terrace tune room.ply --out tuned --labels truth.npy --cell 0.05,0.07,0.1 --depth 1 --phi 0.02..0.3
      By true labels, one int32 per point: 0 is no plane, below 0 is not known.

Written to DIR: tune.json (see docs/tune-json.md), landscape.png (the cost along each setting through the best).")]
pub struct TuneArgs {
    /// Scans: files, folders or patterns, as for 'extract'
    #[arg(required = true, value_name = "INPUT")]
    pub inputs: Vec<String>,
    /// Folder for the results; made when missing
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Parameters to start from: those of clusters, which are what is tuned
    #[arg(long, value_enum, default_value = "clusters")]
    pub preset: Preset,
    /// Edges of a grid cell in metres [default: half to twice the one chosen from the data]
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        allow_negative_numbers = true,
        help_heading = "Settings"
    )]
    pub cell: Option<Vec<f64>>,
    /// Depths of the neighbourhoods normals are fitted to [default: 1..2]
    #[arg(long, value_name = "RANGE", value_parser = parse_range::<u32>, help_heading = "Settings")]
    pub depth: Option<Range<u32>>,
    /// Points that make a cell dense [default: a quarter of to four times a tenth of the median, at least 4]
    #[arg(long, value_name = "LIST", value_delimiter = ',', help_heading = "Settings")]
    pub tau: Option<Vec<u64>>,
    /// Cells whose normal is less certain than this take no part [default: 0.05..1]
    #[arg(
        long,
        value_name = "RANGE",
        value_parser = parse_range::<f64>,
        allow_hyphen_values = true,
        help_heading = "Settings"
    )]
    pub omega: Option<Range<f64>>,
    /// Orientation thresholds [default: 0..1]
    #[arg(
        long,
        value_name = "RANGE",
        value_parser = parse_range::<f64>,
        allow_hyphen_values = true,
        help_heading = "Settings"
    )]
    pub phi: Option<Range<f64>>,
    /// Clusters of fewer cells are not planes [default: by preset]
    #[arg(long, value_name = "N", help_heading = "Settings")]
    pub min_cells: Option<usize>,
    /// True labels as NPY of whole numbers, one per point of all inputs in order
    #[arg(long, value_name = "FILE", help_heading = "Cost")]
    pub labels: Option<PathBuf>,
    /// How agreement with the labels is measured
    #[arg(long, value_enum, default_value = "cover", requires = "labels", help_heading = "Cost")]
    pub quality: QualityMeasure,
    /// Weight of the number of planes in the paper's cost
    #[arg(
        long,
        value_name = "W",
        default_value_t = 0.001,
        conflicts_with = "labels",
        allow_negative_numbers = true,
        help_heading = "Cost"
    )]
    pub weight_clusters: f64,
    /// Most evaluations of the search, at least 2
    #[arg(long, value_name = "N", default_value_t = 300, help_heading = "Search")]
    pub evaluations: usize,
    /// Seed of everything random
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = "Search")]
    pub seed: u64,
    /// How files are read.
    #[command(flatten)]
    pub read: ReadArgs,
    /// Poses of the scans, from sensor to world: TUM, KITTI, 4x4 matrices, Open3D log, or a folder of 4x4 files
    #[arg(long, value_name = "FILE", help_heading = "Input")]
    pub poses: Option<PathBuf>,
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Print nothing but errors
    #[arg(long, short)]
    pub quiet: bool,
}

/// Arguments of `synth`.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  terrace synth room --out room --points 100000
  terrace extract room/points.ply --out planes

Written to DIR: points.ply (with sigma and the true label), labels.npy and planes.json with the truth.")]
pub struct SynthArgs {
    /// The scene
    #[arg(value_enum)]
    pub scene: Scene,
    /// Folder for the results; made when missing
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Number of points [default: by scene]
    #[arg(long, value_name = "N")]
    pub points: Option<usize>,
    /// Standard error of the points in metres [default: the scene's own sensor]
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    pub sigma: Option<f64>,
    /// Seed of the noise
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Print nothing but errors
    #[arg(long, short)]
    pub quiet: bool,
}

/// Arguments of `info`.
#[derive(Debug, Args)]
pub struct InfoArgs {
    /// Files of points, or maps that were saved
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// How files are read.
    #[command(flatten)]
    pub read: ReadArgs,
}

/// Arguments of `reproduce`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  terrace reproduce --out paper
      Section VI-A: three planes in a table-like structure, clustered at phi = 0.97 and optimised.
  terrace reproduce --out paper --seeds 10
      The same for ten seeds.
  terrace reproduce --out paper --data kitchen/ --intrinsics 585,585,320,240
      Section VI-B as well, on a posed Kinect sequence.")]
pub struct ReproduceArgs {
    /// Folder for figures; made when missing
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// A folder of posed depth images for Table II, Figures 3 and 4
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// First seed
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Number of seeds of the synthetic experiment, one after the other
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    pub seeds: u64,
    /// Camera of the depth images of --data, fx,fy,cx,cy in pixels or a file
    #[arg(long, value_name = "FX,FY,CX,CY|FILE", default_value = "585,585,320,240")]
    pub intrinsics: String,
    /// Print nothing but errors and tables
    #[arg(long, short)]
    pub quiet: bool,
}

/// Parameters to start from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Preset {
    /// Regions grown at several resolutions, points labelled one by one
    Default,
    /// Clusters of cells with like normals, the uncertain ones split at a threshold of their own
    Clusters,
    /// Clusters as the paper describes them
    Paper,
}

impl Preset {
    /// As it is called on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Default => "default",
            Self::Clusters => "clusters",
            Self::Paper => "paper",
        }
    }

    /// The settings it stands for.
    pub fn params(self) -> Params {
        match self {
            Self::Default => Params::default(),
            Self::Clusters => Params::clusters(),
            Self::Paper => Params::paper(),
        }
    }
}

/// Cost of a threshold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Cost {
    /// Each cluster once: the formula as printed in the paper
    Sum,
    /// Each cluster by its share of the cells
    Share,
}

/// A search for the threshold of least cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SearchMethod {
    /// Until no lower cost is possible, or --evaluations are spent
    Certified,
    /// The controlled random search of the paper: 20 samples, 60 rounds
    Random,
}

/// How agreement with true labels is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum QualityMeasure {
    /// Best intersection over union of each true plane, weighted by its points
    Cover,
    /// F1 score of the planes that match above an intersection over union of 0.8
    F1,
}

/// Synthetic scenes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Scene {
    /// Three planes in a table-like structure, white noise
    Table,
    /// The paper's table-like structure: a board on two panels, along the axes, white noise
    Desk,
    /// One narrow plane of 0.9 x 0.3 m, white noise
    Strip,
    /// One plane of 0.6 x 0.6 m whose noise grows along a side from 1 to 12 mm
    Patch,
    /// A furnished room seen by a depth camera from fourteen places
    Room,
    /// Such rooms side by side and above each other, one for every 100 000 points
    Building,
    /// A corridor with a bend scanned by a lidar
    Corridor,
}

impl From<Scene> for SceneKind {
    fn from(scene: Scene) -> Self {
        match scene {
            Scene::Table => Self::Table,
            Scene::Desk => Self::Desk,
            Scene::Strip => Self::Strip,
            Scene::Patch => Self::Patch,
            Scene::Room => Self::Room,
            Scene::Building => Self::Building,
            Scene::Corridor => Self::Corridor,
        }
    }
}

/// The first and the last value, both included.
pub type Range<T> = (T, T);

fn parse_range<T: FromStr + Copy>(text: &str) -> Result<Range<T>, String> {
    let number =
        |part: &str| part.trim().parse::<T>().map_err(|_| format!("'{part}' is no number of a range lo..hi"));
    match text.split_once("..") {
        Some((lo, hi)) => Ok((number(lo)?, number(hi)?)),
        None => number(text).map(|only| (only, only)),
    }
}
