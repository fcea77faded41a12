//! The settings of a map as JSON.

use serde::{Deserialize, Serialize};
use terrace::{
    Assignment, Connectivity, CostForm, Estimate, FitTo, Join, Optimise, Params, RegionStep, Regions, Search,
    Weighting,
};

use crate::MapFileError;

/// [`Params`], field by field, but for the cell size.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Settings {
    tau: Option<u64>,
    /// `null`: infinite.
    omega: Option<f64>,
    phi: f64,
    depth: u32,
    /// Number of neighbours.
    connectivity: u32,
    assignment: String,
    weighting: String,
    fit: String,
    random_seeds: bool,
    optimise: Option<OptimiseSettings>,
    estimate: Option<EstimateSettings>,
    regions: Option<RegionSettings>,
    min_cells: usize,
    seed: u64,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct OptimiseSettings {
    above: f64,
    form: String,
    weight_uncertainty: f64,
    weight_clusters: f64,
    search: SearchSettings,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
enum SearchSettings {
    Certified { evaluations: Option<usize> },
    ControlledRandom { population: usize, subset: usize, rounds: usize },
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct EstimateSettings {
    floor: f64,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RegionSettings {
    tilt: f64,
    reach: f64,
    turn: f64,
    min_points: Option<u64>,
    min_area: Option<f64>,
    join: String,
    errors_are_complete: bool,
    /// By its name in the library.
    leave_out: Option<String>,
}

/// The names of the choices of a setting.
type Names<T> = &'static [(&'static str, T)];

const ASSIGNMENTS: Names<Assignment> =
    &[("voxel", Assignment::Voxel), ("expected_distance", Assignment::ExpectedDistance)];
const WEIGHTINGS: Names<Weighting> =
    &[("uniform", Weighting::Uniform), ("information", Weighting::Information)];
const FITS: Names<FitTo> = &[("centres", FitTo::Centres), ("points", FitTo::Points)];
const FORMS: Names<CostForm> = &[("sum", CostForm::Sum), ("share", CostForm::Share)];
const JOINS: Names<Join> = &[("touching", Join::Touching), ("coplanar", Join::Coplanar)];

fn name<T: PartialEq>(names: Names<T>, value: &T) -> String {
    names.iter().find(|(_, of)| of == value).map_or("", |(name, _)| name).to_owned()
}

fn value<T: Copy>(setting: &'static str, names: Names<T>, name: &str) -> Result<T, MapFileError> {
    let found = names.iter().find(|(known, _)| *known == name).map(|(_, value)| *value);
    found.ok_or_else(|| unknown(setting, name))
}

fn unknown(name: &'static str, value: &str) -> MapFileError {
    MapFileError::Setting { name, value: value.chars().take(40).collect() }
}

impl From<&Params> for Settings {
    fn from(params: &Params) -> Self {
        let Params { cell_size: _, tau, omega, phi, depth, connectivity, assignment, weighting, .. } =
            *params;
        let Params { fit, random_seeds, optimise, estimate, regions, min_cells, seed, .. } = *params;
        Self {
            tau,
            omega: omega.is_finite().then_some(omega),
            phi,
            depth,
            connectivity: connectivity.neighbours(),
            assignment: name(ASSIGNMENTS, &assignment),
            weighting: name(WEIGHTINGS, &weighting),
            fit: name(FITS, &fit),
            random_seeds,
            optimise: optimise.map(OptimiseSettings::from),
            estimate: estimate.map(|Estimate { floor }| EstimateSettings { floor }),
            regions: regions.map(RegionSettings::from),
            min_cells,
            seed,
        }
    }
}

impl From<Optimise> for OptimiseSettings {
    fn from(optimise: Optimise) -> Self {
        let Optimise { above, form, weight_uncertainty, weight_clusters, search } = optimise;
        let search = match search {
            Search::Certified { evaluations } => SearchSettings::Certified { evaluations },
            Search::ControlledRandom { population, subset, rounds } => {
                SearchSettings::ControlledRandom { population, subset, rounds }
            }
        };
        Self { above, form: name(FORMS, &form), weight_uncertainty, weight_clusters, search }
    }
}

impl From<Regions> for RegionSettings {
    fn from(regions: Regions) -> Self {
        let Regions { tilt, reach, turn, min_points, min_area, join, errors_are_complete, leave_out } =
            regions;
        let (join, leave_out) = (name(JOINS, &join), leave_out.map(|step| format!("{step:?}")));
        Self { tilt, reach, turn, min_points, min_area, join, errors_are_complete, leave_out }
    }
}

impl Settings {
    /// The parameters, whose values may still be out of their range.
    pub(crate) fn params(self, cell_size: Option<f64>) -> Result<Params, MapFileError> {
        let Self { tau, omega, phi, depth, connectivity, assignment, weighting, .. } = self;
        let Self { fit, random_seeds, optimise, estimate, regions, min_cells, seed, .. } = self;
        let of_neighbours = Connectivity::from_neighbours(connectivity);
        Ok(Params {
            cell_size,
            tau,
            omega: omega.unwrap_or(f64::INFINITY),
            phi,
            depth,
            connectivity: of_neighbours.ok_or_else(|| unknown("connectivity", &connectivity.to_string()))?,
            assignment: value("assignment", ASSIGNMENTS, &assignment)?,
            weighting: value("weighting", WEIGHTINGS, &weighting)?,
            fit: value("fit", FITS, &fit)?,
            random_seeds,
            optimise: optimise.map(OptimiseSettings::optimise).transpose()?,
            estimate: estimate.map(|EstimateSettings { floor }| Estimate { floor }),
            regions: regions.map(RegionSettings::regions).transpose()?,
            min_cells,
            seed,
        })
    }
}

impl OptimiseSettings {
    fn optimise(self) -> Result<Optimise, MapFileError> {
        let Self { above, form, weight_uncertainty, weight_clusters, search } = self;
        let search = match search {
            SearchSettings::Certified { evaluations } => Search::Certified { evaluations },
            SearchSettings::ControlledRandom { population, subset, rounds } => {
                Search::ControlledRandom { population, subset, rounds }
            }
        };
        let form = value("optimise.form", FORMS, &form)?;
        Ok(Optimise { above, form, weight_uncertainty, weight_clusters, search })
    }
}

impl RegionSettings {
    fn regions(self) -> Result<Regions, MapFileError> {
        let Self { tilt, reach, turn, min_points, min_area, join, errors_are_complete, leave_out } = self;
        let step = |name: String| {
            let known = RegionStep::ALL.into_iter().find(|step| format!("{step:?}") == name);
            known.ok_or_else(|| unknown("regions.leave_out", &name))
        };
        let (join, leave_out) = (value("regions.join", JOINS, &join)?, leave_out.map(step).transpose()?);
        Ok(Regions { tilt, reach, turn, min_points, min_area, join, errors_are_complete, leave_out })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn again(params: &Params) -> Params {
        let text = serde_json::to_string(&Settings::from(params)).unwrap();
        serde_json::from_str::<Settings>(&text).unwrap().params(params.cell_size).unwrap()
    }

    #[test]
    fn all_settings_come_back() {
        let mut regions = Params { omega: f64::INFINITY, cell_size: Some(0.1 + 0.2), ..Params::default() };
        for step in RegionStep::ALL {
            let own = regions.regions.as_mut().unwrap();
            (own.leave_out, own.join, own.min_area) = (Some(step), Join::Coplanar, Some(1.0 / 3.0));
            assert_eq!(again(&regions), regions);
        }
        for params in [Params::default(), Params::clusters(), Params::paper()] {
            assert_eq!(again(&params), params);
            let bare = Params { optimise: None, estimate: None, tau: Some(u64::MAX), ..params };
            assert_eq!(again(&bare), bare);
        }
    }

    #[test]
    fn settings_that_are_not_known_are_told() {
        let text = serde_json::to_string(&Settings::from(&Params::default())).unwrap();
        let changed = |from: &str, to: &str| {
            assert!(text.contains(from), "{text}");
            let settings: Settings = serde_json::from_str(&text.replace(from, to)).unwrap();
            settings.params(None).unwrap_err().to_string()
        };
        assert_eq!(changed("\"voxel\"", "\"pixel\""), "the setting assignment is pixel, which is not known");
        assert!(changed("26", "27").contains("connectivity is 27"));
        assert!(changed("touching", "fuzzy").contains("regions.join is fuzzy"));
        assert!(serde_json::from_str::<Settings>(&text.replace("\"tau\"", "\"theta\"")).is_err());
    }
}
