//! The command line of `calibrate`.

use std::num::{NonZeroU32, NonZeroUsize};
use std::path::PathBuf;

use clap::Args;
use terrace_noise::PoseSigma;

use crate::args::{ReadArgs, Scene};

/// Arguments of `calibrate`.
// Flags of a command line are independent of each other.
#[allow(clippy::struct_excessive_bools)]
#[derive(Debug, Args)]
#[command(
    override_usage = "terrace calibrate [OPTIONS] --out <DIR> --scene <SCENE>\n       \
                      terrace calibrate [OPTIONS] --out <DIR> --labels <FILE>... <INPUT>...\n       \
                      terrace calibrate [OPTIONS] --out <DIR> <INPUT>...",
    after_help = "\
Three ways:
  --scene           noisy copies of a built scene, against its planes
  INPUT --labels    noisy copies of exact scans, against the planes through the points of each label
  INPUT             posed scans without truth: each scan's planes against those of all others

Examples:
  terrace calibrate --scene room --copies 200 --out room
      A furnished room, seen by a Kinect.
  terrace calibrate --scene corridor --pose-sigma 0.02,0.1deg --pose-unstated --out corridor
      What becomes of covariances when poses are wrong and nobody says so.
  terrace calibrate --scene table --offset 1e7,1e7,0 --out far
      The same scene in national coordinates.
  terrace calibrate hall/*.ply --poses hall/poses.txt --labels hall/*.labels.npy --sensor lidar:range=0.02,angle=0rad --out hall
      Simulated scans without noise, with 2 cm of it along each ray.
  terrace calibrate kitchen/ --intrinsics 585,585,320,240 --sensor kinect --floor 0.01 --out kitchen
      A real sequence, without and with a floor of 1 cm.

Columns of the tables:
  n            errors that were counted
  NEES/D       mean squared error in units of the covariance, per degree of freedom: 1 is right, 4 is
               standard deviations too small by a factor of 2; low, high: where 95 % of right ones fall
  50 % ...     share of the errors within the ellipsoid that is to hold this share
  refused      covariances without an inverse
  ratio        observed over predicted standard deviation, by the root mean square and by the median

Written to DIR: calibrate.json (see docs/calibrate-json.md), qq.png and qq.svg: distances against expected ones."
)]
pub struct CalibrateArgs {
    /// Scans: files, folders or patterns, as for 'extract'
    #[arg(required_unless_present = "scene", conflicts_with = "scene", value_name = "INPUT")]
    pub inputs: Vec<String>,
    /// Folder for the results; made when missing
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// A built scene with known planes. Without --sensor or --sigma: kinect for rooms,
    /// lidar:range=0.02,angle=0.05deg for the corridor, white noise for the others
    #[arg(long, value_enum, value_name = "SCENE")]
    pub scene: Option<Scene>,
    /// Points of each copy [default: by scene]
    #[arg(long, value_name = "N", help_heading = "Scene")]
    pub points: Option<usize>,
    /// Moves the scene, in metres
    #[arg(
        long,
        value_name = "X,Y,Z",
        value_parser = parse_offset,
        allow_hyphen_values = true,
        help_heading = "Scene"
    )]
    pub offset: Option<[f64; 3]>,
    /// True labels as NPY of whole numbers: one file for each input, or one for the points of all inputs in order. 0 is
    /// no plane, from 1 on the number of a plane. The points must be exact: --sensor or --sigma tells the noise of copies
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with = "scene", help_heading = "Known planes")]
    pub labels: Vec<PathBuf>,
    /// Number of noisy copies [default: 100]
    #[arg(long, value_name = "N", help_heading = "Known planes")]
    pub copies: Option<NonZeroU32>,
    /// Do not look at single cells, which takes about as long again
    #[arg(long, help_heading = "Known planes")]
    pub no_cells: bool,
    /// Do not tell the errors of points when planes are extracted: they have to be found from the scatter
    #[arg(long, help_heading = "Known planes")]
    pub unstated: bool,
    /// Do not tell that poses are wrong, by --pose-sigma
    #[arg(long, requires = "pose_sigma", help_heading = "Known planes")]
    pub pose_unstated: bool,
    /// Planes seen by fewer scans are left out [default: 5]
    #[arg(long, value_name = "N", help_heading = "Scan against scan")]
    pub views: Option<NonZeroUsize>,
    /// Poses of the scans, as for 'extract'
    #[arg(long, value_name = "FILE", conflicts_with = "scene", help_heading = "Input")]
    pub poses: Option<PathBuf>,
    /// How sure the poses are: standard deviations of the translation in metres and of the rotation with its unit, as
    /// 0.02,0.3deg. With known planes, poses of the copies are made wrong by as much
    #[arg(long, value_name = "T,R", allow_hyphen_values = true, help_heading = "Input")]
    pub pose_sigma: Option<PoseSigma>,
    /// How sure each pose is, as for 'extract'
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with_all = ["scene", "labels", "pose_sigma"],
        help_heading = "Input"
    )]
    pub pose_covariances: Option<PathBuf>,
    /// How files are read.
    #[command(flatten)]
    pub read: ReadArgs,
    /// Edge of a grid cell in metres [default: from spacing and noise of the first scan]
    #[arg(long, value_name = "METRES", allow_negative_numbers = true, help_heading = "Method")]
    pub cell: Option<f64>,
    /// Judge the planes of clusters of cells (extract --preset clusters), not those of regions
    #[arg(long, help_heading = "Method")]
    pub clusters: bool,
    /// Orientation threshold of the first clustering, 0 to 1 [default: 0.1]
    #[arg(
        long,
        value_name = "X",
        allow_negative_numbers = true,
        requires = "clusters",
        help_heading = "Method"
    )]
    pub phi: Option<f64>,
    /// Points that make a cell dense [default: a tenth of the median, at least 4]
    #[arg(long, value_name = "N", help_heading = "Method")]
    pub tau: Option<u64>,
    /// Depth of the neighbourhoods normals are fitted to [default: 1]
    #[arg(long, value_name = "N", requires = "clusters", help_heading = "Method")]
    pub depth: Option<u32>,
    /// Clusters of fewer cells are not planes [default: 5]
    #[arg(long, value_name = "N", requires = "clusters", help_heading = "Method")]
    pub min_cells: Option<usize>,
    /// Standard error in metres that does not average out over the points of a plane. Scans against each other are looked
    /// at without and with it
    #[arg(long, value_name = "METRES", allow_negative_numbers = true, help_heading = "Method")]
    pub floor: Option<f64>,
    /// Seed of everything random
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = "Method")]
    pub seed: u64,
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Print nothing but errors
    #[arg(long, short)]
    pub quiet: bool,
}

fn parse_offset(text: &str) -> Result<[f64; 3], String> {
    let numbers: Option<Vec<f64>> =
        text.split(',').map(|part| part.trim().parse::<f64>().ok().filter(|x| x.is_finite())).collect();
    numbers
        .and_then(|numbers| numbers.try_into().ok())
        .ok_or_else(|| "three numbers of metres with commas between are needed".to_owned())
}
