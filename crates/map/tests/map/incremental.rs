//! Maps that grow.

use terrace::{Join, Mapper, Params, PoseNoise, Scan, Sigma, Stage, Weighting};
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

/// The planes of a map, which are the same when it is given away.
fn given_away(mapper: Mapper) {
    let mut told = Vec::new();
    let found = mapper.extract_observed(|stage| told.push(stage)).unwrap();
    assert!(!found.planes.is_empty());
    let mut again = Vec::new();
    let given = mapper.into_planes(|stage| again.push(stage)).unwrap();
    assert_eq!(bits(&given), bits(&found));
    assert_eq!(again, told);
}

#[test]
fn a_map_that_is_given_away_has_the_same_planes() {
    let scans = scans(&Scene::room(), 40_000, 6);
    let total: usize = scans.iter().map(|scan| scan.scan.len() + scans[0].scan.len()).sum();
    let joined = || {
        let mut params = Params::default();
        params.regions.as_mut().unwrap().join = Join::Coplanar;
        params
    };
    let weighted = || Params { weighting: Weighting::Information, ..Params::default() };
    for params in [Params::default(), Params::clusters(), joined(), weighted()] {
        // In one piece, in as many as scans, in two which a scan is in, and where there is no such room.
        for room in [total, 0, total - scans[13].scan.len() / 2, usize::MAX] {
            let mut mapper = Mapper::new(params).unwrap();
            mapper.reserve(room);
            for (number, scan) in scans.iter().enumerate() {
                let pose = (number % 2 == 1).then(|| PoseNoise::from_degrees(0.01, 0.5).unwrap());
                mapper.insert_from(&scan.scan, pose).unwrap();
                mapper.insert_more(&scans[0].scan).unwrap();
            }
            given_away(mapper.clone());
            let mut both = mapper.clone();
            if both.merge(&mapper).is_ok() {
                given_away(both);
            }
        }
        if params.by_place() {
            let mut mapper = Mapper::streaming(params).unwrap();
            for scan in &scans {
                mapper.insert(&scan.scan).unwrap();
            }
            given_away(mapper);
        }
    }
    // One scan, whose errors are not known.
    let points = scans[0].scan.points().to_vec();
    let mut mapper = Mapper::new(Params::default()).unwrap();
    mapper.insert(&Scan::new(points, Sigma::Unknown, scans[0].scan.frame()).unwrap()).unwrap();
    given_away(mapper);
}
