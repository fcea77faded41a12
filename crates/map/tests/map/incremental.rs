//! Maps that grow.

use terrace::{Mapper, Params, Stage};
use terrace_synth::Scene;

use crate::common::{PRESETS, bits, check_sound, map_of, scans};

#[test]
fn asking_between_scans_changes_nothing() {
    let scans = scans(&Scene::room(), 40_000, 6);
    for preset in PRESETS {
        let mut mapper = Mapper::new(preset()).unwrap();
        let mut labels = 0;
        let mut last = None;
        for scan in &scans {
            assert_eq!(mapper.insert(&scan.scan).unwrap().points, scan.scan.len());
            labels += scan.scan.len();
            let found = mapper.extract().unwrap();
            check_sound(&found);
            assert_eq!((found.labels.len(), mapper.len()), (labels, labels));
            assert_eq!(bits(&found), bits(&mapper.extract().unwrap()));
            last = Some(found);
        }
        assert_eq!(bits(&last.unwrap()), bits(&map_of(preset(), &scans)));
    }
}

#[test]
fn the_cell_size_is_chosen_from_the_first_scan() {
    let scans = scans(&Scene::room(), 40_000, 6);
    let mut mapper = Mapper::new(Params::default()).unwrap();
    assert_eq!(mapper.chosen_cell_size(), None);
    mapper.insert(&scans[0].scan).unwrap();
    let chosen = mapper.chosen_cell_size().unwrap();
    assert_eq!(Some(chosen), terrace::choose_cell_size(&scans[0].scan));
    mapper.insert(&scans[1].scan).unwrap();
    let used = mapper.extract().unwrap().used;
    assert_eq!((used.chosen, used.cell_size), (Some(chosen), chosen.cell_size));
    assert_eq!(used.params, Params::default());
}

#[test]
fn stages_are_told_in_order_with_their_sizes() {
    let scans = scans(&Scene::room(), 40_000, 6);
    let told = |params| {
        let mapper = crate::common::mapper(params, &[&scans[0].scan, &scans[7].scan]);
        let mut told = Vec::new();
        let found = mapper.extract_observed(|stage| told.push(stage)).unwrap();
        (told, found)
    };
    let (stages, found) = told(Params { phi: 0.4, ..Params::clusters() });
    let counts = found.cell_counts;
    assert!(!found.optimised.is_empty());
    assert_eq!(
        stages,
        [
            Stage::Normals { cells: counts.occupied },
            Stage::Cluster { cells: counts.clustered },
            Stage::Optimise { clusters: found.optimised.len() },
            Stage::Label { points: found.labels.len() },
        ]
    );
    let (stages, found) = told(Params::default());
    let cells = found.cell_counts.occupied;
    let points = found.labels.len();
    assert_eq!(stages, [Stage::Normals { cells }, Stage::Grow { cells }, Stage::Label { points }]);
}
