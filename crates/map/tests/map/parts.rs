//! Maps taken apart, put together again, and merged.

use proptest::prelude::*;
use terrace::{
    Frame, GridError, Join, MapBuilder, MapCell, Mapper, MergeError, Moments, Params, PartsError, PlaneMap,
    PoseNoise, SampledPoint, Sighting, Sigma, StreamingError, View, Weighting,
};
use terrace_synth::Scene;

use crate::common::{bits, cloud, dot, scans, square, tenth, unknown};

type Scan = terrace::Scan;

fn streamed<'s>(params: Params, scans: impl IntoIterator<Item = &'s Scan>) -> Mapper {
    let mut mapper = Mapper::streaming(params).unwrap();
    for scan in scans {
        mapper.insert(scan).unwrap();
    }
    mapper
}

fn again(mapper: &Mapper) -> Result<Mapper, PartsError> {
    let parts = mapper.parts().unwrap();
    let views = mapper.views().to_vec();
    let mut builder = MapBuilder::new(*mapper.params(), mapper.chosen_cell_size(), views)?;
    parts.cells().try_for_each(|cell| builder.push(&cell))?;
    builder.finish()
}

/// Everything of a map, to the bit.
fn all(mapper: &Mapper) -> Vec<String> {
    let parts = mapper.parts().unwrap();
    let head = format!("{:?} {:?} {:?}", mapper.params(), mapper.chosen_cell_size(), mapper.views());
    std::iter::once(head).chain(parts.cells().map(|cell| format!("{cell:?}"))).collect()
}

fn room(points: usize) -> Vec<Scan> {
    scans(&Scene::room(), points, 5).into_iter().map(|scan| scan.scan).collect()
}

#[test]
fn a_map_is_put_together_from_its_parts() {
    let scans = room(60_000);
    for params in
        [Params::default(), Params::clusters(), Params { cell_size: Some(0.15), ..Params::default() }]
    {
        let mut first = streamed(params, &scans[..7]);
        let mut copy = again(&first).unwrap();
        assert_eq!(all(&copy), all(&first));
        assert_eq!(bits(&copy.extract().unwrap()), bits(&first.extract().unwrap()));
        // Both grow on alike.
        for mapper in [&mut first, &mut copy] {
            mapper.insert_more(&scans[7]).unwrap();
            mapper.insert_from(&scans[8], Some(PoseNoise::from_radians(0.01, 0.001).unwrap())).unwrap();
        }
        assert_eq!(all(&copy), all(&first));
        assert_eq!(bits(&copy.extract().unwrap()), bits(&first.extract().unwrap()));
    }
}

#[test]
fn a_map_that_keeps_its_points_has_the_parts_of_one_that_does_not() {
    let scans = room(30_000);
    for params in [Params::default(), Params::clusters()] {
        let mut kept = Mapper::new(params).unwrap();
        for scan in &scans {
            kept.insert(scan).unwrap();
        }
        assert_eq!(all(&kept), all(&streamed(params, &scans)));
        assert!(again(&kept).unwrap().is_streaming());
    }
}

#[test]
fn maps_without_points_have_parts_too() {
    for params in [Params::default(), tenth(Params::default), Params::clusters()] {
        let mapper = Mapper::streaming(params).unwrap();
        let copy = again(&mapper).unwrap();
        assert_eq!((all(&copy), copy.cells()), (all(&mapper), 0));
    }
    // One point, and points that are not in the map.
    let scan = unknown(&[[0.01, 0.02, 0.03], [f64::NAN; 3], [1e300, 0.0, 0.0]]);
    let mapper = streamed(tenth(Params::default), [&scan]);
    let view = mapper.views()[0];
    assert_eq!((view.points, view.absent, view.out_of_range), (3, 1, 1));
    assert_eq!(all(&again(&mapper).unwrap()), all(&mapper));
}

#[test]
fn maps_that_need_their_points_have_no_parts() {
    for params in [Params::paper(), Params { weighting: Weighting::Information, ..Params::default() }] {
        let mapper = Mapper::new(params).unwrap();
        assert_eq!(mapper.parts().err(), Some(StreamingError::NotByPlace));
        assert!(matches!(MapBuilder::new(params, None, Vec::new()), Err(PartsError::Params(_))));
        let by_place = Mapper::new(Params::default()).unwrap();
        let refused = by_place.clone().merge(&mapper).unwrap_err();
        assert_eq!(refused, MergeError::NotByPlace { ours: true, theirs: false });
    }
}

/// Whether a cell of one point at the origin is taken once it was changed.
fn changed(change: impl Fn(&mut MapCell, &mut View)) -> Result<Mapper, PartsError> {
    let mapper =
        streamed(tenth(Params::default), [&cloud(vec![[0.04, 0.02, 0.03]; 5], Sigma::Uniform(0.01))]);
    let parts = mapper.parts().unwrap();
    let (mut cell, mut view) = (parts.cells().next().unwrap(), mapper.views()[0]);
    change(&mut cell, &mut view);
    let mut builder = MapBuilder::new(*mapper.params(), None, vec![view])?;
    builder.push(&cell)?;
    builder.finish()
}

#[test]
fn parts_that_are_of_no_map_are_refused() {
    assert!(changed(|_, _| {}).is_ok());
    let sums = |cell: &MapCell, sum: [f64; 3]| {
        Moments::from_sums(cell.sums.count(), sum, cell.sums.second(), cell.sums.noise())
    };
    for wrong in [f64::NAN, f64::INFINITY, 1.0] {
        let refused = changed(|cell, _| cell.sums = sums(cell, [wrong, 0.0, 0.0]));
        assert!(matches!(refused, Err(PartsError::Sums { points: 5, .. })), "{wrong}");
    }
    assert!(matches!(changed(|cell, _| cell.sums = Moments::EMPTY), Err(PartsError::Sums { points: 0, .. })));
    let negative = terrace::SymmetricMatrix3::diagonal([-1e-9, 0.0, 0.0]);
    assert!(matches!(
        changed(|cell, _| cell.sums = cell.sums.with_noise(negative)),
        Err(PartsError::Sums { .. })
    ));
    assert!(matches!(
        changed(|cell, _| cell.key = [i32::MAX, 0, 0]),
        Err(PartsError::Grid(GridError::KeyOutOfRange { .. }))
    ));
    assert!(matches!(changed(|cell, _| cell.halvings = 99), Err(PartsError::Sample { .. })));
    let at = |x: f32| SampledPoint { place: [x; 3], endures: 31 };
    let with = |points: Vec<SampledPoint>| changed(|cell, _| cell.sample = points.clone().into());
    assert!(with(vec![at(0.0); 5]).is_ok());
    for strange in [vec![at(9.0)], vec![at(0.0); 6], vec![SampledPoint { endures: 32, ..at(0.0) }]] {
        assert!(matches!(with(strange), Err(PartsError::Sample { .. })));
    }
    for seen in [
        &[][..],
        &[Sighting { view: 0, points: 4 }],
        &[Sighting { view: 1, points: 5 }],
        &[Sighting { view: 0, points: 2 }, Sighting { view: 0, points: 3 }],
        &[Sighting { view: 0, points: 0 }],
    ] {
        assert!(matches!(changed(|cell, _| cell.seen = seen), Err(PartsError::Seen { points: 5, .. })));
    }
    assert_eq!(
        changed(|_, view| view.points = 7).unwrap_err(),
        PartsError::ViewPoints { view: 0, points: 7, found: 5 }
    );
    assert!(matches!(changed(|_, view| view.absent = 6), Err(PartsError::View { .. })));
    assert!(matches!(changed(|_, view| view.sensor = Some([f64::NAN; 3])), Err(PartsError::View { .. })));
    let pose = PoseNoise::from_radians(0.1, 0.0).ok();
    assert!(matches!(changed(|_, view| view.pose = pose), Err(PartsError::View { .. })));

    let view = View { points: usize::MAX, absent: usize::MAX, out_of_range: 0, sensor: None, pose: None };
    let head = |params, views| MapBuilder::new(params, None, views).map(|_| ());
    assert!(matches!(head(tenth(Params::default), vec![view, view]), Err(PartsError::View { view: 1, .. })));
    assert!(matches!(head(Params::default(), vec![view]), Err(PartsError::NoCellSize)));
    let mapper = streamed(tenth(Params::default), [&unknown(&[[0.04; 3]])]);
    let mut builder = MapBuilder::new(*mapper.params(), None, mapper.views().to_vec()).unwrap();
    let parts = mapper.parts().unwrap();
    let cell = parts.cells().next().unwrap();
    builder.push(&cell).unwrap();
    assert_eq!(builder.push(&cell), Err(PartsError::SameKey { key: [0, 0, 0] }));
}

#[test]
fn maps_that_do_not_fit_are_not_merged() {
    let floor = cloud(square(0.5), Sigma::Uniform(0.004));
    let ours = streamed(tenth(Params::default), [&floor]);
    let refused = |theirs: &Mapper| {
        let mut map = ours.clone();
        let refused = map.merge(theirs).unwrap_err();
        assert_eq!(all(&map), all(&ours));
        refused
    };
    let cells = streamed(Params { cell_size: Some(0.2), ..Params::default() }, [&floor]);
    assert_eq!(refused(&cells), MergeError::CellSizes { ours: 0.1, theirs: 0.2 });
    let clusters = streamed(tenth(Params::clusters), [&floor]);
    assert_eq!(refused(&clusters), MergeError::Kinds { ours: true, theirs: false });
    let unknown = streamed(tenth(Params::default), [&cloud(square(0.5), Sigma::Unknown)]);
    assert_eq!(refused(&unknown), MergeError::Errors { ours: true, theirs: false });
    let mut joins = Params::default();
    joins.regions.as_mut().unwrap().join = Join::Coplanar;
    let mut joins = streamed(Params { cell_size: Some(0.1), ..joins }, [&floor]);
    let error = refused(&joins);
    assert!(matches!(&error, MergeError::Settings { name: "regions.join", .. }));
    assert_eq!(
        error.to_string(),
        "the setting regions.join is Touching in one map and Coplanar in the other"
    );
    joins.set_params(Params { seed: 9, ..Params::default() }).unwrap();
    assert!(matches!(refused(&joins), MergeError::Settings { name: "seed", .. }));
    // What cells are made by stays.
    joins
        .set_params(Params { assignment: terrace::Assignment::ExpectedDistance, ..Params::clusters() })
        .unwrap();
    assert_eq!(joins.params(), ours.params());
    let mut map = ours.clone();
    map.merge(&joins).unwrap();
    assert_eq!(map.len(), 2 * ours.len());
}

#[test]
fn an_empty_map_changes_nothing() {
    let floor = cloud(square(0.5), Sigma::Uniform(0.004));
    for params in [Params::default(), tenth(Params::default), Params::clusters()] {
        let map = streamed(params, [&floor]);
        let empty = Mapper::streaming(params).unwrap();
        let (mut one, mut other) = (map.clone(), empty.clone());
        one.merge(&empty).unwrap();
        other.merge(&map).unwrap();
        assert_eq!((all(&one), all(&other)), (all(&map), all(&map)));
    }
}

#[test]
fn where_one_map_forgets_its_points_all_are_forgotten() {
    let scans = room(20_000);
    let params = tenth(Params::default);
    let kept = |scans: &[Scan]| {
        let mut mapper = Mapper::new(params).unwrap();
        for scan in scans {
            mapper.insert(scan).unwrap();
        }
        mapper
    };
    let whole = all(&streamed(params, &scans));
    let (mut both, mut one, mut other) =
        (kept(&scans[..6]), kept(&scans[..6]), streamed(params, &scans[..6]));
    both.merge(&kept(&scans[6..])).unwrap();
    one.merge(&streamed(params, &scans[6..])).unwrap();
    other.merge(&kept(&scans[6..])).unwrap();
    assert_eq!([both.is_streaming(), one.is_streaming(), other.is_streaming()], [false, true, true]);
    for merged in [&both, &one, &other] {
        assert_eq!(all(merged).len(), whole.len());
    }
    let labels = both.extract().unwrap().labels;
    assert_eq!(labels.len(), both.len());
    assert!(labels.iter().flatten().count() > both.len() / 2);
}

#[test]
fn planes_of_a_map_without_points_face_their_sensors() {
    let below =
        Scan::new(square(0.5), Sigma::Uniform(0.003), Frame::World { sensor: Some([1.0, 1.0, -2.0]) });
    for preset in [Params::default, Params::clusters] {
        let mapper = streamed(tenth(preset), [&below.clone().unwrap()]);
        let map = mapper.extract().unwrap();
        assert!(map.planes[0].plane.normal()[2] < -0.99);
        let kept = crate::common::map(tenth(preset), &[&below.clone().unwrap()]);
        assert!(dot(kept.planes[0].plane.normal(), map.planes[0].plane.normal()) > 0.99);
    }
}

/// The planes of one map are those of the other, up to rounding of sums.
fn assert_close(one: &PlaneMap, other: &PlaneMap) {
    assert_eq!(one.planes.len(), other.planes.len());
    for (a, b) in one.planes.iter().zip(&other.planes) {
        assert_eq!((a.points, a.cells), (b.points, b.cells));
        let (x, y) = (a.plane.coefficients(), b.plane.coefficients());
        assert!((0..4).all(|i| (x[i] - y[i]).abs() < 1e-9), "{x:?} {y:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn the_map_of_parts_is_that_of_the_whole(
        parts in prop::collection::vec(0..3_usize, 14),
        seed in 0..1000_u64,
        clusters in prop::bool::ANY,
    ) {
        let scans: Vec<Scan> =
            scans(&Scene::room(), 40_000, seed).into_iter().map(|scan| scan.scan).collect();
        let params = tenth(if clusters { Params::clusters } else { Params::default });
        // In the order in which they come to be when parts follow one another.
        let of_part = |part: usize| scans.iter().zip(&parts).filter(move |(_, of)| **of == part).map(|(scan, _)| scan);
        let whole = streamed(params, (0..3).flat_map(of_part));
        let maps = [0, 1, 2].map(|part| streamed(params, of_part(part)));
        let [mut merged, mut backwards] = [maps[0].clone(), maps[2].clone()];
        merged.merge(&maps[1]).unwrap();
        merged.merge(&maps[2]).unwrap();
        backwards.merge(&maps[1]).unwrap();
        backwards.merge(&maps[0]).unwrap();

        prop_assert_eq!(merged.views(), whole.views());
        for map in [&merged, &backwards] {
            prop_assert_eq!(map.cells(), whole.cells());
            let (parts, of_whole) = (map.parts().unwrap(), whole.parts().unwrap());
            let mut found: Vec<MapCell> = parts.cells().collect();
            let mut cells: Vec<MapCell> = of_whole.cells().collect();
            found.sort_by_key(|cell| cell.key);
            cells.sort_by_key(|cell| cell.key);
            for (found, cell) in found.iter().zip(&cells) {
                prop_assert_eq!((found.key, found.sums.count(), found.halvings), (cell.key, cell.sums.count(), cell.halvings));
                let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * cell.sums.count() as f64;
                prop_assert!((0..3).all(|i| near(found.sums.sum()[i], cell.sums.sum()[i])));
                prop_assert!((0..6).all(|i| near(found.sums.second().0[i], cell.sums.second().0[i])));
                prop_assert!((0..6).all(|i| near(found.sums.noise().0[i], cell.sums.noise().0[i])));
                let set = |sample: &[SampledPoint]| {
                    let bits = |point: &SampledPoint| (point.place.map(f32::to_bits), point.endures);
                    let mut points: Vec<_> = sample.iter().map(bits).collect();
                    points.sort_unstable();
                    points
                };
                prop_assert_eq!(set(&found.sample), set(&cell.sample));
                let mut seen = [found.seen, cell.seen].map(|seen| seen.iter().map(|s| s.points).collect::<Vec<_>>());
                for seen in &mut seen {
                    seen.sort_unstable();
                }
                prop_assert_eq!(&seen[0], &seen[1]);
            }
        }
        // The same order of cells, and all sums equal to rounding: the planes are the same.
        assert_close(&merged.extract().unwrap(), &whole.extract().unwrap());
    }
}
