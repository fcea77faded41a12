//! The command line of `extract`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PathBufValueParser, TypedValueParser};
use terrace_noise::PoseSigma;

use crate::args::{Preset, ReadArgs};
use crate::commands::extract::MeshFile;
use crate::method_args::MethodArgs;

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
  terrace extract part1.ply --cell 0.1 --out part1 --save-map part1.parquet
      A part of a map that 'terrace merge' puts together.

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
    /// How planes are found in the cells.
    #[command(flatten)]
    pub method: MethodArgs,
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
    /// Also write the map: its cells as Parquet (see docs/map-parquet.md), for 'terrace merge'. Not with --preset paper, whose cells
    /// do not add up
    #[cfg(feature = "parquet")]
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub save_map: Option<PathBuf>,
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
