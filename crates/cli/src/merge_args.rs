//! The command line of `merge`.

use std::path::PathBuf;

use clap::Args;

use crate::method_args::MethodArgs;

/// Arguments of `merge`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  terrace extract part1.ply --cell 0.1 --out part1 --save-map part1.parquet
  terrace extract part2.ply --cell 0.1 --out part2 --save-map part2.parquet
  terrace merge part1.parquet part2.parquet --out planes
      The planes of both parts, as one run over them finds them. The parts may come from different machines.
  terrace merge part1.parquet --out again --join coplanar
      The planes of one map again, with another setting.

Settings that are not given are those of the maps, which must then agree.

Written to DIR: planes.json (see docs/planes-json.md). Points are not in a map: there are no labels, and points of planes are
counted by samples.")]
pub struct MergeArgs {
    /// Maps that were saved by --save-map; the order is that of their views
    #[arg(required = true, value_name = "MAP")]
    pub maps: Vec<PathBuf>,
    /// Folder for the results; made when missing
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// How planes are found in the cells.
    #[command(flatten)]
    pub method: MethodArgs,
    /// Also write the merged map
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub save_map: Option<PathBuf>,
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Print nothing but errors
    #[arg(long, short)]
    pub quiet: bool,
}
