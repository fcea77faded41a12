//! One pair: its files, and what is made of them.

use std::path::{Path, PathBuf};

use terrace_eval::{Contingency, Evaluation, Measure, PlaneDeviation, Spread};

use crate::commands::eval::error::PairError;
use crate::commands::eval::inputs::{self, Planes};
use crate::error::CliError;
use crate::eval_args::EvalArgs;

/// Found and true labels, and the planes given for them.
#[derive(Debug)]
pub struct Pair<'a> {
    pub pred: &'a Path,
    pub truth: &'a Path,
    pred_planes: Option<&'a Path>,
    truth_planes: Option<&'a Path>,
}

/// A pair that was compared.
#[derive(Debug)]
pub struct Compared<'a> {
    pub pair: &'a Pair<'a>,
    /// The files the planes are from.
    pub pred_planes: Option<PathBuf>,
    pub truth_planes: Option<PathBuf>,
    pub evaluation: Evaluation,
    pub true_planes: Planes,
    pub deviations: Vec<PlaneDeviation>,
}

/// The pairs that the arguments name.
pub fn pairs(args: &EvalArgs) -> Result<Vec<Pair<'_>>, CliError> {
    let (labels, rest) = args.labels.as_chunks::<2>();
    if let [last] = rest {
        return Err(CliError::Usage(format!("{}: found labels without true ones", last.display())));
    }
    for (option, files) in [("--pred-planes", &args.pred_planes), ("--truth-planes", &args.truth_planes)] {
        if !files.is_empty() && files.len() != labels.len() {
            let (files, pairs) = (files.len(), labels.len());
            let message =
                format!("{option} was given {files} times for {pairs} pairs; it is needed for each");
            return Err(CliError::Usage(message));
        }
    }
    Ok(labels
        .iter()
        .enumerate()
        .map(|(at, [pred, truth])| Pair {
            pred,
            truth,
            pred_planes: args.pred_planes.get(at).map(PathBuf::as_path),
            truth_planes: args.truth_planes.get(at).map(PathBuf::as_path),
        })
        .collect())
}

/// Reads and compares a pair.
pub fn compare<'a>(pair: &'a Pair<'a>, field: &str) -> Result<Compared<'a>, PairError> {
    let (pred_path, truth_path) = (labels_file(pair.pred), labels_file(pair.truth));
    let read = |path: &Path| {
        inputs::labels(path, field).map_err(|kind| PairError::File { path: path.to_owned(), kind })
    };
    let (pred, truth) = (read(&pred_path)?, read(&truth_path)?);
    let both = Contingency::of_numbers(&truth, &pred).map_err(|error| PairError::Labels {
        pred: pred_path.clone(),
        truth: truth_path.clone(),
        error,
    })?;
    let evaluation = Evaluation::of(&both);
    let (pred_planes, found_planes) = planes(pair.pred_planes, &pred_path)?.unzip();
    let (truth_planes, true_planes) = planes(pair.truth_planes, &truth_path)?.unzip();
    let (found_planes, true_planes) = (found_planes.unwrap_or_default(), true_planes.unwrap_or_default());
    let deviations = evaluation.deviations(
        &true_planes.iter().map(|(id, named)| (*id, named.at.plane)).collect(),
        &found_planes.iter().map(|(id, named)| (*id, named.at)).collect(),
    );
    Ok(Compared { pair, pred_planes, truth_planes, evaluation, true_planes, deviations })
}

/// The labels in a folder, or the file itself.
fn labels_file(path: &Path) -> PathBuf {
    if path.is_dir() { path.join("labels.npy") } else { path.to_owned() }
}

/// The planes that were given, or those beside the labels. Only given ones must be readable: what is beside may be of
/// something else.
fn planes(given: Option<&Path>, labels: &Path) -> Result<Option<(PathBuf, Planes)>, PairError> {
    if let Some(path) = given {
        let planes = inputs::planes(path).map_err(|kind| PairError::File { path: path.to_owned(), kind })?;
        return Ok(Some((path.to_owned(), planes)));
    }
    let beside = labels.with_file_name("planes.json");
    if !beside.is_file() {
        return Ok(None);
    }
    match inputs::planes(&beside) {
        Ok(planes) => Ok(Some((beside, planes))),
        Err(kind) => {
            eprintln!("terrace: no angles: {}: {kind}", beside.display());
            Ok(None)
        }
    }
}

impl Compared<'_> {
    /// All measures, those of angles (degrees) and offsets (metres) at the end.
    pub fn measures(&self) -> Vec<Measure> {
        let angle = Spread::of(self.deviations.iter().map(|d| d.angle.to_degrees()));
        let offset = Spread::of(self.deviations.iter().filter_map(|d| d.offset));
        let mut all = self.evaluation.measures();
        all.extend([
            Measure::new("angle_degrees_median", angle.map(|a| a.median)),
            Measure::new("angle_degrees_mean", angle.map(|a| a.mean)),
            Measure::new("angle_degrees_max", angle.map(|a| a.max)),
            Measure::new("offset_median", offset.map(|o| o.median)),
            Measure::new("offset_mean", offset.map(|o| o.mean)),
            Measure::new("offset_max", offset.map(|o| o.max)),
        ]);
        all
    }
}
