//! The command line of `extract`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::builder::{PathBufValueParser, TypedValueParser};
use clap::{Args, ValueEnum};
use terrace::Join;
use terrace_noise::PoseSigma;

use crate::args::{Cost, Preset, ReadArgs, SearchMethod};
use crate::commands::extract::MeshFile;

/// Arguments of `extract`.
// Flags of a command line are independent of each other.
#[allow(clippy::struct_excessive_bools)]
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  terrace extract room.ply --out planes
      One cloud. Cell size and density threshold are chosen from the data and reported.
  terrace extract table.pcd --sensor kinect --out planes --picture
      Errors of a Kinect, along each ray and across it; and a picture of the planes from two sides.
  terrace extract kitchen/ --intrinsics 585,585,320,240 --sensor kinect --out planes
      A folder of NAME.depth.png with NAME.pose.txt beside them: a posed sequence.
  terrace extract scans/*.pcd --poses poses.tum --out planes
      Clouds in the sensor's frame and a trajectory (TUM, KITTI, 4x4, Open3D log).
  terrace extract scans/*.pcd --poses poses.tum --sensor lidar:range=0.02,angle=0.1deg --pose-sigma 0.02,0.1deg --out planes
      The same with the errors of a lidar, and poses that are sure to 2 cm and 0.1 degrees.
  terrace extract room.ply --out planes --extent --mesh room.glb --mesh room.obj
      How far each plane reaches: polygons with holes and areas, and the planes as meshes for viewers.

Written to DIR: planes.json (see docs/planes-json.md), labels.npy (one int32 per input point, all inputs in order, 0 is
no plane), points.ply (coloured by plane). With --extent also extents.json (see docs/planes-json.md).")]
pub struct ExtractArgs {
    /// Scans: files, folders or patterns. PLY, PCD, NPY, XYZ/CSV/TXT, 16-bit depth PNG
    #[arg(required = true, value_name = "INPUT")]
    pub inputs: Vec<String>,
    /// Folder for the results; made when missing
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Parameters to start from
    #[arg(long, value_enum, default_value = "default")]
    pub preset: Preset,
    /// Edge of a grid cell in metres [default: from spacing and noise of the first scan]
    #[arg(long, value_name = "METRES", allow_negative_numbers = true, help_heading = "Method")]
    pub cell: Option<f64>,
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
    /// Least area of a plane in m2 [default: 1/400 of the area of all planes, at most that of 50 cells]
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
    /// Seed of everything random
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = "Method")]
    pub seed: u64,
    /// How files are read.
    #[command(flatten)]
    pub read: ReadArgs,
    /// Poses of the scans, from sensor to world: TUM, KITTI, 4x4 matrices, Open3D log, or a folder of 4x4 files
    #[arg(long, value_name = "FILE", help_heading = "Input")]
    pub poses: Option<PathBuf>,
    /// How sure the poses are, the same for every scan: standard deviations of the translation in metres and of the
    /// rotation with its unit, as 0.02,0.3deg or 0.02,5mrad or 0.02,0.005rad
    #[arg(
        long,
        value_name = "T,R",
        conflicts_with = "pose_covariances",
        allow_hyphen_values = true,
        help_heading = "Uncertainty"
    )]
    pub pose_sigma: Option<PoseSigma>,
    /// How sure each pose is, a row of text for each: 36 numbers, the 6x6 covariance row by row, translation before
    /// rotation, along the axes of the world and about the sensor, in m and rad; or 2 numbers, standard deviations of
    /// the translation in m and of the rotation in rad
    #[arg(long, value_name = "FILE", help_heading = "Uncertainty")]
    pub pose_covariances: Option<PathBuf>,
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
    /// Also draw the planes from two sides into DIR/planes.png
    #[arg(long, help_heading = "Output")]
    pub picture: bool,
    /// Direction that is up in the picture, as x,y,z
    #[arg(
        long,
        value_name = "X,Y,Z",
        default_value = "0,0,1",
        value_parser = parse_vector,
        allow_hyphen_values = true,
        help_heading = "Output"
    )]
    pub up: Vector,
    /// Also write the boundary polygons of the planes, with holes, into DIR/extents.json, and areas into planes.json
    #[arg(long, help_heading = "Output")]
    pub extent: bool,
    /// Also write the planes as a mesh of triangles in the colours of points.ply, with areas into planes.json; the name
    /// ends in .ply, .obj or .glb. Can be given several times
    #[arg(
        long,
        value_name = "FILE",
        value_parser = PathBufValueParser::new().try_map(MeshFile::new),
        help_heading = "Output"
    )]
    pub mesh: Vec<MeshFile>,
    /// Do not write points.ply
    #[arg(long, help_heading = "Output")]
    pub no_points: bool,
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Print nothing but errors
    #[arg(long, short)]
    pub quiet: bool,
}

impl ExtractArgs {
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

/// Three numbers.
pub type Vector = [f64; 3];

fn parse_vector(text: &str) -> Result<Vector, String> {
    let numbers: Vec<f64> = text
        .split(',')
        .map(|part| part.trim().parse::<f64>().ok().filter(|x| x.is_finite()))
        .collect::<Option<_>>()
        .ok_or("three numbers with commas between are needed")?;
    let vector =
        <[f64; 3]>::try_from(numbers).map_err(|n| format!("three numbers are needed, not {}", n.len()))?;
    if vector.iter().all(|x| x.abs() <= 0.0) { Err("this is no direction".into()) } else { Ok(vector) }
}
