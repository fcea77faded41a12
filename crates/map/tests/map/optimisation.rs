//! The search for φ against the staircase it searches, and β against the formula.

use terrace::{
    Beta, BetaStep, CostForm, ExtractError, ExtractedPlane, Mapper, Optimised, Params, PlaneMap, Search,
    SeedOrder,
};
use terrace_cluster::{Grower, Staircase, segment};
use terrace_stats::UncertainVector;
use terrace_synth::Scene;

use crate::common::{CLUSTERED, mapper, scans, with_optimise};

const FORMS: [CostForm; 2] = [CostForm::Sum, CostForm::Share];

/// The paper's synthetic experiment: a table of three planes, merged by a threshold of 0.97.
fn table(preset: fn() -> Params, form: CostForm, seed: u64) -> (Mapper, PlaneMap) {
    let params = terrace_synth::Params { points: Some(30_000), sigma: Some(0.02), seed };
    let scans = Scene::table().generate(&params).unwrap().scans;
    let params = Params { cell_size: Some(0.07), omega: 0.4, phi: 0.97, min_cells: 1, seed, ..preset() };
    let params = with_optimise(params, |o| o.form = form);
    let mapper = mapper(params, &[&scans[0].scan]);
    let map = mapper.extract().unwrap();
    (mapper, map)
}

fn all_tables(check: impl Fn(&Mapper, &PlaneMap, usize, &Optimised)) {
    for preset in CLUSTERED {
        for form in FORMS {
            for seed in 0..3 {
                let (mapper, map) = table(preset, form, seed);
                assert!(!map.optimised.is_empty());
                for (number, record) in map.optimised.iter().enumerate() {
                    check(&mapper, &map, number, record);
                }
            }
        }
    }
}

fn staircase(mapper: &Mapper, number: usize) -> Vec<BetaStep> {
    mapper.uncertain_clusters().unwrap().get(number).unwrap().staircase(usize::MAX).unwrap()
}

fn step_of(steps: &[BetaStep], phi: f64) -> &BetaStep {
    let mut holding = steps.iter().filter(|s| s.interval.contains(phi));
    let step = holding.next().unwrap();
    assert!(holding.next().is_none(), "two steps hold {phi}");
    step
}

#[test]
fn steps_tile_the_interval_without_gap() {
    all_tables(|mapper, _, number, _| {
        let steps = staircase(mapper, number);
        assert!(steps.len() > 3);
        assert_eq!(steps[0].interval.lo, 0.0);
        for pair in steps.windows(2) {
            assert_eq!(pair[0].interval.hi, Some(pair[1].interval.lo));
            assert!(pair[0].interval.lo < pair[1].interval.lo);
        }
        assert!(steps.last().unwrap().interval.hi.is_none_or(|hi| hi > 1.0));
        assert!(steps.iter().all(|s| s.beta.is_finite() && s.beta > 0.0));
    });
}

#[test]
fn the_search_stands_on_the_staircase_and_not_above_its_start_nor_below_its_floor() {
    all_tables(|mapper, map, number, record| {
        let steps = staircase(mapper, number);
        let phi = record.minimum.x[0];
        assert_eq!(step_of(&steps, phi).beta, record.minimum.value);
        let start = step_of(&steps, map.used.params.phi).beta;
        assert!(record.minimum.value <= start, "{} from {start}", record.minimum.value);
        let lowest = steps.iter().map(|s| s.beta).fold(f64::INFINITY, f64::min);
        assert!(lowest <= record.minimum.value);
        // Complete, within its 2000 clusterings: the least there is.
        let certified = matches!(map.used.params.optimise.unwrap().search, Search::Certified { .. });
        assert_eq!(record.minimum.is_proven(), certified);
        assert!(!certified || lowest == record.minimum.value, "{lowest} {}", record.minimum.value);
        for trial in &record.minimum.trace {
            let beta = step_of(&steps, trial.x[0]).beta;
            if trial.source.is_bound() {
                assert!(trial.value <= beta, "{} above {beta}", trial.value);
            } else {
                assert_eq!(trial.value, beta);
            }
        }
    });
}

#[test]
fn beta_is_that_of_the_planes_that_were_made() {
    all_tables(|_, map, number, record| {
        if map.optimised.len() > 1 || number > 0 {
            return;
        }
        let made: Vec<&ExtractedPlane> =
            map.planes.iter().filter(|p| p.phi == Some(record.minimum.x[0])).collect();
        assert_eq!(made.len(), record.clusters);
        assert_eq!(made.iter().map(|p| p.cells).sum::<usize>(), record.cells);
        let optimise = map.used.params.optimise.unwrap();
        let uncertainty: f64 = made
            .iter()
            .map(|p| {
                let share = match optimise.form {
                    CostForm::Sum => 1.0,
                    CostForm::Share => p.cells as f64 / record.cells as f64,
                };
                share * p.normal_uncertainty.unwrap().iter().sum::<f64>()
            })
            .sum();
        let beta =
            optimise.weight_uncertainty * uncertainty + optimise.weight_clusters * record.clusters as f64;
        assert!((beta / record.minimum.value - 1.0).abs() < 1e-9);
    });
}

#[test]
fn beta_never_rises_above_that_of_the_cluster_as_found() {
    all_tables(|_, map, _, record| {
        let optimise = map.used.params.optimise.unwrap();
        let before = optimise.weight_uncertainty * record.uncertainty_before.iter().sum::<f64>()
            + optimise.weight_clusters;
        assert!(record.minimum.value <= before * (1.0 + 1e-9), "{} from {before}", record.minimum.value);
    });
}

#[test]
fn beta_never_rises_in_a_room_either() {
    for preset in CLUSTERED {
        for form in FORMS {
            for seed in 0..3 {
                let scans = scans(&Scene::room(), 40_000, seed);
                let params = with_optimise(Params { phi: 0.4, seed, ..preset() }, |o| o.form = form);
                let found = crate::common::map_of(params, &scans);
                assert!(!found.optimised.is_empty());
                for record in &found.optimised {
                    let before = record.uncertainty_before.iter().sum::<f64>() + 0.01;
                    assert!(
                        record.minimum.value <= before * (1.0 + 1e-9),
                        "{form:?} {seed} {} cells {before} {}",
                        record.cells,
                        record.minimum.value
                    );
                }
            }
        }
    }
}

#[test]
fn only_clusters_above_the_threshold_are_optimised() {
    let scans = scans(&Scene::room(), 40_000, 8);
    let scans: Vec<_> = scans.iter().map(|s| &s.scan).collect();
    let params = Params { phi: 0.3, ..Params::clusters() };
    for above in [0.0, 0.1, 0.2, 1.0] {
        let found = mapper(with_optimise(params, |o| o.above = above), &scans).extract().unwrap();
        for record in &found.optimised {
            assert!(record.cells > 1 && record.uncertainty_before.iter().any(|s| *s > above));
        }
        if above == 0.0 {
            assert!(found.optimised.len() > 10);
        }
        if above == 1.0 {
            assert!(found.optimised.is_empty() && found.planes.iter().all(|p| p.phi == Some(0.3)));
        }
        let kept = found.planes.iter().filter(|p| p.phi == Some(0.3));
        for plane in kept {
            let worst = plane.normal_uncertainty.unwrap().into_iter().fold(0.0, f64::max);
            let searched = found.optimised.iter().any(|o| o.minimum.x[0] == 0.3);
            assert!(worst <= above || searched, "{worst} was not searched");
        }
    }
}

#[test]
fn staircases_that_are_not_there_are_empty() {
    let (mapper, map) = table(Params::clusters, CostForm::Share, 0);
    let clusters = mapper.uncertain_clusters().unwrap();
    assert_eq!(clusters.len(), map.optimised.len());
    assert!(clusters.get(clusters.len()).is_none());
    let cluster = clusters.get(0).unwrap();
    assert_eq!(cluster.cells(), map.optimised[0].cells);
    assert!(cluster.staircase(0).unwrap().is_empty());
    assert_eq!(cluster.staircase(3).unwrap()[..], cluster.staircase(10).unwrap()[..3]);
    assert_eq!(cluster.search(Search::default()).unwrap(), map.optimised[0].minimum);
    let plain = Mapper::new(Params { optimise: None, ..*mapper.params() }).unwrap();
    assert_eq!(plain.uncertain_clusters().err(), Some(ExtractError::Empty));
}

/// Nodes 0, 1 and 2 look up, 3 looks sideways; all in a row.
#[test]
fn both_forms_of_beta_are_the_formula() {
    let normal = |value, error| Some(UncertainVector { value, error });
    let normals = [
        normal([0.0, 0.0, 1.0], [0.01, 0.02, 0.03]),
        normal([0.0, 0.6, 0.8], [0.02, 0.02, 0.02]),
        normal([0.0, 0.0, -1.0], [0.03, 0.02, 0.05]),
        normal([1.0, 0.0, 0.0], [0.1, 0.2, 0.3]),
        None,
    ];
    let edges: [&[u32]; 5] = [&[1], &[0, 2], &[1, 3], &[2, 4], &[3]];
    let params = terrace_cluster::Params { phi: 0.3, omega: 1.0, seeds: SeedOrder::MostCertain };
    let run = segment(&normals, |node| edges[node], &params).unwrap();
    assert_eq!(run.clusters().map(|c| c.nodes().len()).collect::<Vec<_>>(), [3, 1]);

    // s² = S/n − (L/n)² + E/n, node 2 having joined with its sign turned.
    let (l, s) = ([0.0, 0.6, 2.8], [0.0, 0.36, 1.0 + 0.64 + 1.0]);
    let e = [1e-4 + 4e-4 + 9e-4, 3.0 * 4e-4, 9e-4 + 4e-4 + 25e-4];
    let first: f64 = (0..3).map(|i| f64::sqrt(s[i] / 3.0 - f64::powi(l[i] / 3.0, 2) + e[i] / 3.0)).sum();
    let second = 0.6;
    let sum = 2.0 * (first + second) + 0.25 * 2.0;
    let share = 2.0 * (0.75 * first + 0.25 * second) + 0.25 * 2.0;
    let neighbours = |node: usize| edges[node];
    let stair = Staircase::new(&normals, neighbours, 1.0, SeedOrder::MostCertain).unwrap().at(0.3).unwrap();
    let beta =
        |form, weight_uncertainty| Beta { form, weight_uncertainty, weight_clusters: 0.25 }.of(&stair, 4);
    assert!((beta(CostForm::Sum, 2.0) - sum).abs() < 1e-8);
    assert!((beta(CostForm::Share, 2.0) - share).abs() < 1e-8);
    assert_eq!(beta(CostForm::Share, 0.0), 0.5);

    let none = [None, None];
    let nobody = Staircase::new(&none, |_| &[], 1.0, SeedOrder::MostCertain).unwrap().at(0.3).unwrap();
    for form in FORMS {
        assert_eq!(Beta { form, weight_uncertainty: 1.0, weight_clusters: 1.0 }.of(&nobody, 0), 0.0);
    }
}

/// The whole way from nothing: a clustering of its own for each φ, from end to end.
#[test]
fn the_repaired_staircase_is_that_of_clusterings_from_nothing() {
    let relative = |a: f64, b: f64| (a / b - 1.0).abs();
    for preset in CLUSTERED {
        let (mapper, _) = table(preset, CostForm::Share, 5);
        for cluster in mapper.uncertain_clusters().unwrap().iter() {
            let neighbours = |cell| cluster.neighbours(cell);
            let mut grower =
                Grower::new(cluster.normals(), neighbours, f64::INFINITY, cluster.seeds()).unwrap();
            let mut phi = Some(0.0);
            let steps = cluster.staircase(usize::MAX).unwrap();
            for step in &steps {
                let run = grower.grow(phi.unwrap()).unwrap();
                assert_eq!(step.interval, run.interval());
                assert!(relative(step.beta, cluster.beta().of(&run.stair(), cluster.cells())) < 2e-9);
                phi = step.interval.hi;
            }
            assert!(steps.len() > 100 && phi.is_none_or(|phi| phi > 1.0));
        }
    }
}
