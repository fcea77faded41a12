//! Staircases recorded elsewhere, from JSON files.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use terrace_staircases::Staircase;

use crate::problem::Problem;

/// One file: `values[i]` holds on `[borders[i], borders[i + 1])`; the search is within `[lo, hi]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Recorded {
    name: String,
    lo: f64,
    hi: f64,
    borders: Vec<f64>,
    values: Vec<f64>,
}

impl Recorded {
    /// The part within `[lo, hi]`.
    fn staircase(&self) -> Result<Staircase, Box<dyn Error>> {
        // Checks the lists before they are cut.
        Staircase::new(self.borders.clone(), self.values.clone())?;
        let (first, last) = (self.borders[0], self.borders[self.values.len()]);
        if !(first <= self.lo && self.lo < self.hi && self.hi <= last) {
            return Err(
                format!("[{}, {}] is not within the borders' [{first}, {last}]", self.lo, self.hi).into()
            );
        }
        let (mut borders, mut values) = (vec![self.lo], Vec::new());
        for (ends, &value) in self.borders.windows(2).zip(&self.values) {
            if self.lo < ends[1] && ends[0] < self.hi {
                borders.push(ends[1].min(self.hi));
                values.push(value);
            }
        }
        Ok(Staircase::new(borders, values)?)
    }
}

/// A problem for each `.json` file in `folder`, in the order of the file names.
///
/// # Errors
///
/// No such file, or one that cannot be read or is no staircase; names the file.
pub fn staircases(folder: &Path) -> Result<Vec<Problem>, Box<dyn Error>> {
    let entries = fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut files =
        entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<PathBuf>, std::io::Error>>()?;
    files.retain(|file| file.extension().is_some_and(|extension| extension == "json"));
    files.sort();
    if files.is_empty() {
        return Err(format!("{}: no .json files", folder.display()).into());
    }
    files
        .iter()
        .map(|file| read(file).map_err(|error| format!("{}: {error}", file.display()).into()))
        .collect()
}

fn read(file: &Path) -> Result<Problem, Box<dyn Error>> {
    let recorded: Recorded = serde_json::from_str(&fs::read_to_string(file)?)?;
    let staircase = recorded.staircase()?;
    let mut problem = Problem::new(move |_| Ok(staircase.clone()))?;
    problem.name = recorded.name;
    Ok(problem)
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrace_crs::Cost;
    use terrace_staircases::TestCost;

    fn recorded(lo: f64, hi: f64) -> Result<Staircase, Box<dyn Error>> {
        let (borders, values) = (vec![0.0, 1.0, 2.0, 3.0], vec![7.0, 8.0, 9.0]);
        Recorded { name: "r".into(), lo, hi, borders, values }.staircase()
    }

    #[test]
    fn the_lists_are_cut_to_the_bounds() {
        let whole = recorded(0.0, 3.0).unwrap();
        assert_eq!((whole.borders().len(), whole.values().len()), (4, 3));
        let mut part = recorded(1.0, 2.5).unwrap();
        assert_eq!((part.borders(), part.values()), (&[1.0, 2.0, 2.5][..], &[8.0, 9.0][..]));
        assert_eq!((part.minimum(), part.evaluate(&[2.2]).value), (8.0, 9.0));
        for (lo, hi) in [(-1.0, 3.0), (0.0, 4.0), (2.0, 2.0), (f64::NAN, 3.0)] {
            assert!(recorded(lo, hi).is_err(), "{lo} {hi}");
        }
    }

    #[test]
    fn files_are_read_in_order_and_bad_ones_are_named() {
        let folder = tempfile::tempdir().unwrap();
        assert!(staircases(folder.path()).err().unwrap().to_string().contains("no .json files"));
        for name in ["b", "a"] {
            let text =
                format!(r#"{{"name":"{name}","lo":0.0,"hi":1.0,"borders":[0.0,0.5,1.0],"values":[2,1]}}"#);
            fs::write(folder.path().join(format!("{name}.json")), text).unwrap();
        }
        let problems = staircases(folder.path()).unwrap();
        let names: Vec<&str> = problems.iter().map(|problem| &*problem.name).collect();
        assert_eq!((names, problems[0].steps), (vec!["a", "b"], 2));
        fs::write(folder.path().join("c.json"), "{}").unwrap();
        assert!(staircases(folder.path()).err().unwrap().to_string().contains("c.json"));
    }
}
