//! What was saved is what is read, to the bit.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod common;

use common::{all, file, map, room};
use proptest::prelude::*;
use terrace::{Frame, Join, Mapper, Params, Scan, Sigma};
use terrace_checkpoint::{SaveError, is_parquet, open_map, read_map, write_map};

/// A disk without room.
struct Full;

impl std::io::Write for Full {
    fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
        Err(std::io::Error::other("the disk is full"))
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

fn cloud(points: Vec<[f64; 3]>, sigma: Sigma) -> Scan {
    Scan::new(points, sigma, Frame::World { sensor: None }).unwrap()
}

#[test]
fn a_room_comes_back_with_its_planes() {
    let scans = room(60_000, 3);
    for params in
        [Params::default(), Params::clusters(), Params { cell_size: Some(0.2), ..Params::default() }]
    {
        let mapper = map(params, &scans);
        let bytes = file(&mapper);
        let mut again = read_map(bytes.clone()).unwrap();
        assert_eq!(all(&again), all(&mapper));
        assert_eq!(file(&again), bytes);
        let (found, expected) = (again.extract().unwrap(), mapper.extract().unwrap());
        assert!(found.planes.len() > 5);
        assert_eq!(format!("{found:?}"), format!("{expected:?}"));
        // Both grow on alike.
        let mut first = mapper.clone();
        for mapper in [&mut first, &mut again] {
            mapper.insert(&scans[0]).unwrap();
        }
        assert_eq!(all(&again), all(&first));
    }
}

#[test]
fn a_map_that_keeps_its_points_gives_the_same_file() {
    let scans = room(20_000, 4);
    let mut kept = Mapper::new(Params::default()).unwrap();
    let mut forgets = Mapper::streaming(Params::default()).unwrap();
    for scan in &scans {
        kept.insert(scan).unwrap();
        forgets.insert(scan).unwrap();
    }
    assert!(file(&kept) == file(&forgets));
}

#[test]
fn maps_of_no_point_and_of_one_come_back() {
    for params in
        [Params::default(), Params::clusters(), Params { cell_size: Some(0.1), ..Params::default() }]
    {
        let empty = Mapper::streaming(params).unwrap();
        let again = read_map(file(&empty)).unwrap();
        assert_eq!(all(&again), all(&empty));
        assert!(again.is_empty() && again.extract().is_err());
    }
    let points = vec![[1e6, -2e6, 0.25], [f64::NAN; 3], [1e300, 0.0, 0.0]];
    let mapper = map(Params { cell_size: Some(0.1), ..Params::default() }, &[cloud(points, Sigma::Unknown)]);
    let again = read_map(file(&mapper)).unwrap();
    assert_eq!(all(&again), all(&mapper));
    let view = again.views()[0];
    assert_eq!((again.cells(), view.points, view.absent, view.out_of_range), (1, 3, 1, 1));
}

#[test]
fn maps_that_cannot_be_saved_are_told() {
    let paper = Mapper::new(Params::paper()).unwrap();
    assert!(matches!(write_map(&paper, Vec::new()), Err(SaveError::Map(_))));
    let params = Params { cell_size: Some(0.1), ..Params::default() };
    let huge = map(params, &[cloud(vec![[0.04; 3]], Sigma::Uniform(1e200))]);
    assert!(matches!(write_map(&huge, Vec::new()), Err(SaveError::NotFinite { key: [0, 0, 0] })));
    let error = write_map(&map(params, &room(3000, 1)), Full).unwrap_err();
    assert!(error.to_string().contains("the disk is full"), "{error}");
}

#[test]
fn files_are_told_by_how_they_begin() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map");
    assert!(!is_parquet(&path) && open_map(&path).is_err());
    std::fs::write(&path, file(&Mapper::streaming(Params::default()).unwrap())).unwrap();
    assert!(is_parquet(&path) && open_map(&path).unwrap().is_empty());
    std::fs::write(&path, "PA").unwrap();
    assert!(!is_parquet(&path));
}

/// Points near each other, exact places and repeated ones included, at any distance from the origin.
fn points() -> impl Strategy<Value = Vec<[f64; 3]>> {
    let place = prop::array::uniform3(prop_oneof![Just(0.0), Just(-0.0), Just(0.1), -1.0..1.0]);
    (prop::collection::vec(place, 0..300), prop_oneof![Just(0.0), -1e7..1e7])
        .prop_map(|(points, far)| points.into_iter().map(|p| p.map(|x| x + far)).collect())
}

fn params() -> impl Strategy<Value = Params> {
    (prop::bool::ANY, 0.05..0.5, prop::option::of(1..9_u64), 0.0..1.0, prop::bool::ANY).prop_map(
        |(clusters, size, tau, phi, coplanar)| {
            let mut params = if clusters { Params::clusters() } else { Params::default() };
            (params.cell_size, params.tau, params.phi, params.omega) = (Some(size), tau, phi, 1.0 / phi);
            if let Some(regions) = &mut params.regions {
                regions.join = if coplanar { Join::Coplanar } else { Join::Touching };
                regions.min_area = tau.map(|tau| 1.0 / tau as f64);
            }
            params
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_map_comes_back(scans in prop::collection::vec((points(), 0.0..0.1), 0..4), params in params()) {
        let scans: Vec<Scan> = scans
            .into_iter()
            .map(|(points, sigma)| {
                let sensor = points.first().copied();
                Scan::new(points, Sigma::Uniform(sigma), Frame::World { sensor }).unwrap()
            })
            .collect();
        let mapper = map(params, &scans);
        let bytes = file(&mapper);
        let again = read_map(bytes.clone()).unwrap();
        prop_assert_eq!(all(&again), all(&mapper));
        prop_assert_eq!(file(&again), bytes);
    }
}
