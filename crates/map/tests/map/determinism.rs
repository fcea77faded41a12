//! The same scans, parameters and seed give the same bits; another seed changes only what is random.

use terrace::{Params, PlaneMap, Search};
use terrace_synth::Scene;

use crate::common::{PRESETS, bits, check_sound, map_of, scans, unoptimised, with_optimise};

fn on_threads(threads: usize, work: impl FnOnce() -> PlaneMap + Send) -> PlaneMap {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

/// Thresholds at which the room has clusters to optimise.
fn merging(preset: fn() -> Params) -> Params {
    Params { phi: 0.4, ..preset() }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let scans = scans(&Scene::room(), 60_000, 3);
    for preset in PRESETS {
        let one = on_threads(1, || map_of(merging(preset), &scans));
        check_sound(&one);
        assert!(one.planes.len() > 5 && one.optimised.is_empty() == one.used.grown.is_some());
        for threads in [2, 3] {
            let more = on_threads(threads, || map_of(merging(preset), &scans));
            assert!(one == more && bits(&one) == bits(&more), "{threads} threads");
        }
    }
}

#[test]
fn steps_side_by_side_give_the_same_bits() {
    // Scans of more points than go through a step together.
    let scans = scans(&Scene::room(), 400_000, 3);
    let one = on_threads(1, || map_of(Params::default(), &scans));
    let two = on_threads(2, || map_of(Params::default(), &scans));
    assert!(one == two && bits(&one) == bits(&two));
}

/// The same map with the seed left out of the record of parameters.
fn seedless(mut map: PlaneMap) -> String {
    map.used.params.seed = 0;
    bits(&map)
}

#[test]
fn without_anything_random_the_seed_changes_nothing() {
    let scans = scans(&Scene::room(), 30_000, 3);
    for params in [Params::default(), unoptimised(Params::clusters())] {
        let seeded = |seed| map_of(Params { seed, ..params }, &scans);
        assert_eq!(seeded(9).used.params.seed, 9);
        assert_eq!(seedless(seeded(0)), seedless(seeded(9)));
    }
}

#[test]
fn with_certain_founders_the_seed_changes_the_random_search_alone() {
    let scans = scans(&Scene::room(), 60_000, 3);
    let params = with_optimise(merging(Params::clusters), |o| o.search = Search::PAPER);
    let seeded = |seed| map_of(Params { seed, ..params }, &scans);
    let (a, b) = (seeded(0), seeded(1));
    assert_eq!(a.cell_counts, b.cell_counts);
    assert_eq!(a.optimised.len(), b.optimised.len());
    let mut traces_differ = false;
    for (x, y) in a.optimised.iter().zip(&b.optimised) {
        assert_eq!((x.cells, x.uncertainty_before), (y.cells, y.uncertainty_before));
        assert_eq!(x.minimum.trace[0], y.minimum.trace[0], "the search begins at the φ in use");
        traces_differ |= x.minimum.trace != y.minimum.trace;
    }
    assert!(traces_differ);
    let certain = |map: &PlaneMap| {
        let kept: Vec<_> =
            map.planes.iter().filter(|p| p.phi == Some(0.4)).map(|p| p.plane.coefficients()).collect();
        kept
    };
    assert_eq!(certain(&a), certain(&b));
    assert!(!certain(&a).is_empty());
}

#[test]
fn in_the_paper_preset_the_seed_changes_clusters_but_not_cells() {
    let scans = scans(&Scene::room(), 30_000, 3);
    let seeded = |seed| map_of(Params { seed, ..Params::paper() }, &scans);
    let (a, b) = (seeded(0), seeded(1));
    assert_eq!(a.cell_counts, b.cell_counts);
    let cells = |map: &PlaneMap| map.cells.iter().map(|c| (c.centroid, c.points)).collect::<Vec<_>>();
    assert_eq!(cells(&a), cells(&b));
    assert_ne!(a.planes, b.planes);
}

#[test]
fn the_number_of_samples_is_the_number_asked_for_at_most() {
    let scans = scans(&Scene::room(), 30_000, 3);
    let search = Search::ControlledRandom { population: 7, subset: 3, rounds: 11 };
    let params = with_optimise(merging(Params::clusters), |o| o.search = search);
    let found = map_of(params, &scans);
    assert!(!found.optimised.is_empty());
    for record in &found.optimised {
        assert!((7..=18).contains(&record.minimum.calls), "{}", record.minimum.calls);
    }
}
