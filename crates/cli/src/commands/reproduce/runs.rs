//! The same map clustered without optimisation and with either form of the cost.

use terrace::{CostForm, Mapper, Optimise, Params, PlaneMap, Scan};

use crate::error::CliError;

/// The three results that a table compares.
pub struct Runs {
    /// Clusters at the initial φ.
    pub without: PlaneMap,
    /// After optimisation with the share of each cluster.
    pub share: PlaneMap,
    /// After optimisation with the formula as printed.
    pub sum: PlaneMap,
    /// The map of `share`, to walk its staircases.
    pub mapper: Mapper,
}

/// Inserts the scans once and extracts three times.
pub fn run<E>(params: Params, insert: impl FnOnce(&mut Mapper) -> Result<(), E>) -> Result<Runs, CliError>
where
    CliError: From<E>,
{
    let optimise = |form| Some(Optimise { form, ..params.optimise.unwrap_or_default() });
    let mut mapper = Mapper::new(params)?;
    insert(&mut mapper)?;
    let mut extract = |optimise| {
        mapper.set_optimise(optimise)?;
        Ok::<_, CliError>(mapper.extract()?)
    };
    let without = extract(None)?;
    let sum = extract(optimise(CostForm::Sum))?;
    let share = extract(optimise(CostForm::Share))?;
    Ok(Runs { without, share, sum, mapper })
}

/// Inserts one scan.
pub fn insert(mapper: &mut Mapper, scan: &Scan) -> Result<(), CliError> {
    let inserted =
        mapper.insert(scan).map_err(|e| CliError::NothingUsable { inputs: 1, last: e.to_string() });
    inserted.map(|_| ())
}

/// A row of a table: mean of (s_x, s_y, s_z) over the clusters, dashes where there is none, and their number.
pub fn row(name: &str, map: &PlaneMap) -> String {
    let summary = map.summary();
    let mean = summary
        .normal_uncertainty_mean
        .map_or("    -      -      -  ".to_owned(), |[x, y, z]| format!("{x:6.3} {y:6.3} {z:6.3}"));
    format!("  {name:<34} {mean} {:>9}\n", summary.planes)
}
