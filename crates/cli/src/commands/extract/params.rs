//! The parameters of the method, from the arguments.

use terrace::{CostForm, Optimise, Params, Search};

use crate::args::{Cost, SearchMethod};
use crate::error::CliError;
use crate::extract_args::ExtractArgs;
use crate::method_args::MethodArgs;

/// Those of the preset, with what the arguments change.
///
/// # Errors
/// [`CliError::Usage`] for an option that the preset has no use for.
pub fn params(args: &ExtractArgs) -> Result<Params, CliError> {
    let mut params = args.preset.params();
    if let Some(regions) = &mut params.regions {
        // The model of a sensor leaves out its distortion.
        regions.errors_are_complete = args.read.sensor.is_none();
    }
    params.cell_size = args.cell.or(params.cell_size);
    let preset = format!("--preset {}", args.preset.name());
    change(&mut params, &args.method, "add --preset clusters", &preset)?;
    Ok(params)
}

/// Changes parameters as the arguments say. `for_clusters` tells people what to do with an option about clusters, `which` what it is
/// that grows no regions.
///
/// # Errors
/// [`CliError::Usage`] for an option that these parameters have no use for.
pub fn change(
    params: &mut Params,
    args: &MethodArgs,
    for_clusters: &str,
    which: &str,
) -> Result<(), CliError> {
    match (&mut params.regions, args.about_regions(), args.about_clusters()) {
        (Some(_), _, Some(option)) => {
            return Err(CliError::Usage(format!("{option} is about clusters: {for_clusters}")));
        }
        (None, Some(option), _) => {
            return Err(CliError::Usage(format!("{option} is about regions, which {which} does not grow")));
        }
        (Some(regions), ..) => {
            regions.join = args.join.map_or(regions.join, Into::into);
            regions.min_points = args.min_points.or(regions.min_points);
            regions.min_area = args.min_area.or(regions.min_area);
            regions.tilt = args.max_tilt.unwrap_or(regions.tilt);
            regions.reach = args.reach.unwrap_or(regions.reach);
        }
        (None, None, _) => {}
    }
    params.tau = args.tau.or(params.tau);
    params.phi = args.phi.unwrap_or(params.phi);
    params.omega = args.omega.unwrap_or(params.omega);
    params.depth = args.depth.unwrap_or(params.depth);
    params.min_cells = args.min_cells.unwrap_or(params.min_cells);
    params.seed = args.seed.unwrap_or(params.seed);
    if args.no_covariance {
        params.estimate = None;
    }
    if let Some(floor) = args.floor {
        let Some(estimate) = &mut params.estimate else {
            return Err(CliError::Usage(format!(
                "--floor is part of the covariance of planes, which {which} does not make"
            )));
        };
        estimate.floor = floor;
    }
    if args.no_optimise {
        params.optimise = None;
    }
    if let Some(cost) = args.cost {
        let form = match cost {
            Cost::Sum => CostForm::Sum,
            Cost::Share => CostForm::Share,
        };
        params.optimise = Some(Optimise { form, ..params.optimise.unwrap_or_default() });
    }
    if let Some(optimise) = &mut params.optimise {
        match args.search {
            Some(SearchMethod::Certified) => optimise.search = Search::default(),
            Some(SearchMethod::Random) => optimise.search = Search::PAPER,
            None => {}
        }
        if let (Search::Certified { evaluations }, Some(most)) = (&mut optimise.search, args.evaluations) {
            *evaluations = most.into();
        }
    }
    Ok(())
}
