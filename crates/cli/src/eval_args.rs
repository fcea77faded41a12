//! The command line of `eval`.

use std::path::PathBuf;

use clap::Args;

/// Arguments of `eval`.
#[derive(Debug, Args)]
#[command(
    override_usage = "terrace eval [OPTIONS] <PRED> <TRUTH> [<PRED> <TRUTH>]...",
    after_help = "\
PRED and TRUTH are labels of the same points in the same order. 0 is no plane, from 1 on the number
of a plane; a true label below 0 is not known, and the point is left out. Either may be
  an NPY array of whole numbers,
  a PLY or PCD file with the labels in a field, see --field,
  a folder with labels.npy, as 'extract' and 'synth' write them.

Examples:
  terrace eval planes truth/labels.npy
      The result of 'terrace extract --out planes' against true labels.
  terrace eval a a/truth.npy b b/truth.npy --json scores.json
      Two pairs, and the mean over them; also as JSON (see docs/eval-json.md).
  terrace eval found.pcd truth.pcd --field plane --per-plane
      Labels from the field 'plane' of two clouds; and each true plane by itself.

Columns of the tables:
  precision, recall, F1  of planes that match: with an intersection over union (IoU) above a value
  correct ... noise      planes found right, split, merged, missed and made up
  wcov, cov              best IoU of each true plane, weighted by its points, and not
  mean IoU, Dice         of the planes that match above 0.5
  all                    mean IoU over all true planes, 0 for those without match
  accuracy               share of the points of true planes that lie in the plane matching theirs
  claimed                share of the points of no true plane that were given to one
  angle, offset          of matched planes, the median; needs planes.json of both sides
  -                      there is nothing to take this of"
)]
pub struct EvalArgs {
    /// Found and true labels in turn: files or folders
    #[arg(required = true, num_args = 2.., value_names = ["PRED", "TRUTH"])]
    pub labels: Vec<PathBuf>,
    /// Field of PLY and PCD files that holds the labels
    #[arg(long, value_name = "NAME", default_value = "label")]
    pub field: String,
    /// Found planes, for angles; once for each pair [default: planes.json beside the labels, where it is there]
    #[arg(long, value_name = "FILE")]
    pub pred_planes: Vec<PathBuf>,
    /// True planes, likewise. Also read: a JSON object {"1": {"normal": [x, y, z], "offset": metres}}
    #[arg(long, value_name = "FILE")]
    pub truth_planes: Vec<PathBuf>,
    /// Also print each true plane
    #[arg(long)]
    pub per_plane: bool,
    /// Also write all numbers as JSON; with '-' to standard output in place of the tables
    #[arg(long, value_name = "FILE|-")]
    pub json: Option<PathBuf>,
    /// Print nothing but errors
    #[arg(long, short)]
    pub quiet: bool,
}
