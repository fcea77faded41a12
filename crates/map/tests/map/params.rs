//! Every parameter that cannot be used is refused by its name.

use terrace::{Mapper, Params, Search};

use crate::common::with_optimise;

const MAX_POPULATION: usize = 1_000_000;

fn refused(name: &str, value: f64, params: Params) {
    let error = params.validate().unwrap_err();
    assert_eq!(error.name, name);
    assert!(error.value.to_bits() == value.to_bits(), "{error}");
    assert!(error.to_string().contains(&format!("the parameter {name} is {value}")), "{error}");
    assert!(Mapper::new(params).is_err());
}

fn default() -> Params {
    Params::default()
}

#[test]
fn cell_sizes_that_are_no_lengths() {
    for size in [0.0, -0.0, -0.1, f64::NAN, f64::INFINITY, 1e-310, 1e-101, 1e101] {
        refused("cell_size", size, Params { cell_size: Some(size), ..default() });
    }
}

#[test]
fn a_density_threshold_of_zero() {
    refused("tau", 0.0, Params { tau: Some(0), ..default() });
}

#[test]
fn uncertainty_thresholds_that_leave_nothing() {
    for omega in [0.0, -1.0, f64::NAN] {
        refused("omega", omega, Params { omega, ..default() });
    }
}

#[test]
fn orientation_thresholds_outside_their_range() {
    for phi in [-1e-9, 1.000_001, f64::INFINITY, f64::NAN] {
        refused("phi", phi, Params { phi, ..default() });
    }
}

#[test]
fn a_depth_of_zero() {
    refused("depth", 0.0, Params { depth: 0, ..default() });
}

#[test]
fn weights_of_the_cost() {
    for bad in [-0.1, f64::NAN, f64::INFINITY] {
        refused("optimise.above", bad, with_optimise(default(), |o| o.above = bad));
        refused("optimise.weight_uncertainty", bad, with_optimise(default(), |o| o.weight_uncertainty = bad));
        refused("optimise.weight_clusters", bad, with_optimise(default(), |o| o.weight_clusters = bad));
    }
}

#[test]
fn populations_and_subsets_that_make_no_search() {
    for population in [0, 1, MAX_POPULATION + 1, usize::MAX] {
        refused("optimise.population", population as f64, random(population, 2, 60));
    }
    for subset in [0, 1, 21] {
        refused("optimise.subset", subset as f64, random(20, subset, 60));
    }
}

#[test]
fn a_search_without_a_clustering() {
    refused("optimise.evaluations", 0.0, with_search(Search::Certified { evaluations: Some(0) }));
}

fn random(population: usize, subset: usize, rounds: usize) -> Params {
    with_search(Search::ControlledRandom { population, subset, rounds })
}

fn with_search(search: Search) -> Params {
    with_optimise(default(), |o| o.search = search)
}

#[test]
fn the_ends_of_every_range_are_allowed() {
    let ends = [
        Params::paper(),
        Params { cell_size: Some(1e-100), tau: Some(1), omega: f64::INFINITY, phi: 0.0, ..default() },
        Params { cell_size: Some(1e100), tau: Some(u64::MAX), omega: 1e-300, phi: 1.0, ..default() },
        Params { depth: 1, min_cells: 0, ..default() },
        with_optimise(default(), |o| (o.above, o.weight_uncertainty, o.weight_clusters) = (0.0, 0.0, 0.0)),
        random(2, 2, 0),
        random(MAX_POPULATION, MAX_POPULATION, 60),
        with_search(Search::Certified { evaluations: Some(1) }),
        with_search(Search::Certified { evaluations: None }),
    ];
    for params in ends {
        assert_eq!(params.validate(), Ok(()));
    }
}
