//! True labels of the points of exact scans.

use std::path::{Path, PathBuf};

use terrace_io::npy;
use terrace_types::PlaneId;

use crate::error::CliError;

/// The labels of each scan, from one file a scan or one file for all; `counts` are the points of the scans.
pub fn of_scans(files: &[PathBuf], counts: &[usize]) -> Result<Vec<Vec<Option<PlaneId>>>, CliError> {
    let refused = |path: &Path, reason: String| CliError::Labels { path: path.to_owned(), reason };
    let of_all: usize = counts.iter().sum();
    match files {
        [only] => {
            let mut rest = &read(only)?[..];
            if rest.len() != of_all {
                return Err(refused(
                    only,
                    format!("{} labels for {of_all} points of all inputs", rest.len()),
                ));
            }
            let mut split = Vec::with_capacity(counts.len());
            for count in counts {
                let (of_scan, others) = rest.split_at_checked(*count).unwrap_or((rest, &[]));
                split.push(of_scan.to_vec());
                rest = others;
            }
            Ok(split)
        }
        _ if files.len() == counts.len() => files
            .iter()
            .zip(counts)
            .map(|(path, count)| {
                let labels = read(path)?;
                if labels.len() == *count {
                    Ok(labels)
                } else {
                    Err(refused(path, format!("{} labels for {count} points", labels.len())))
                }
            })
            .collect(),
        _ => Err(CliError::Usage(format!(
            "--labels: {} files for {} inputs; one for each is needed, or one for all",
            files.len(),
            counts.len()
        ))),
    }
}

/// A label below 0, which is not known, is none: the planes through the points of labels are known without it.
fn read(path: &Path) -> Result<Vec<Option<PlaneId>>, CliError> {
    let refused = |reason: String| CliError::Labels { path: path.to_owned(), reason };
    let bytes = std::fs::read(path).map_err(|error| refused(error.to_string()))?;
    let numbers = npy::read_labels(&bytes).map_err(|error| refused(error.to_string()))?;
    Ok(numbers.into_iter().map(|n| u32::try_from(n).ok().and_then(PlaneId::new)).collect())
}
