//! Points that are forgotten, and given again for their labels.

use terrace::{
    Assignment, Frame, Join, Mapper, Params, PlaneId, PlaneMap, PointLabels, PoseNoise, Scan, Sigma,
    StreamingError, Weighting,
};
use terrace_synth::Scene;

use crate::common::{bits, check_sound, scans};

/// Scans with the noise of the pose of each.
type Posed = Vec<(Scan, Option<PoseNoise>)>;

fn plain(scene: &Scene, points: usize, seed: u64) -> Posed {
    scans(scene, points, seed).into_iter().map(|scan| (scan.scan, None)).collect()
}

fn chunks(scan: &Scan, size: usize) -> Vec<Scan> {
    let chunk = |from: usize| {
        let range = from..(from + size).min(scan.len());
        let sigma = match scan.sigma() {
            Sigma::PerPoint(all) => Sigma::PerPoint(all[range.clone()].to_vec()),
            Sigma::PerAxis(all) => Sigma::PerAxis(all[range.clone()].to_vec()),
            Sigma::Covariance(all) => Sigma::Covariance(all[range.clone()].to_vec()),
            same => same.clone(),
        };
        Scan::new(scan.points()[range].to_vec(), sigma, scan.frame()).unwrap()
    };
    (0..scan.len()).step_by(size).map(chunk).collect()
}

/// The map of scans whose points go in chunk by chunk, twice.
fn streamed(params: Params, scans: &Posed, size: usize, again: usize) -> PlaneMap {
    let mut mapper = Mapper::streaming(params).unwrap();
    for (scan, pose) in scans {
        if mapper.wants_cell_size() {
            mapper.begin_with(terrace::choose_cell_size(scan).unwrap()).unwrap();
        }
        let all = chunks(scan, size);
        mapper.insert_from(&all[0], *pose).unwrap();
        for chunk in &all[1..] {
            mapper.insert_more(chunk).unwrap();
        }
    }
    let map = read_again(&mapper, scans, again);
    let (given, labels) = mapper.into_streamed(|_| {}).unwrap();
    let given = read_of(given, labels, scans, again);
    assert_eq!(bits(&given), bits(&map), "of a map that is given away");
    assert!(given.labels == map.labels);
    map
}

fn read_again(mapper: &Mapper, scans: &Posed, size: usize) -> PlaneMap {
    let (map, labels) = mapper.extract_streamed(|_| {}).unwrap();
    read_of(map, labels, scans, size)
}

fn read_of(mut map: PlaneMap, mut labels: PointLabels<'_>, scans: &Posed, size: usize) -> PlaneMap {
    assert!(map.labels.is_empty());
    let mut all = Vec::new();
    let mut of_chunk = vec![PlaneId::new(7); 3];
    for (view, (scan, _)) in scans.iter().enumerate() {
        for chunk in chunks(scan, size) {
            labels.label(view, &chunk, &mut of_chunk);
            assert_eq!(of_chunk.len(), chunk.len());
            all.extend_from_slice(&of_chunk);
        }
    }
    labels.finish(&mut map);
    // What is labelled after the end changes nothing, and is the same.
    let (first, _) = &scans[0];
    let before = bits(&map);
    labels.label(0, first, &mut of_chunk);
    assert!(of_chunk[..] == all[..first.len()]);
    labels.finish(&mut map);
    assert_eq!(bits(&map), before);
    map.labels = all;
    map
}

fn kept(params: Params, scans: &Posed) -> Mapper {
    let mut mapper = Mapper::new(params).unwrap();
    for (scan, pose) in scans {
        mapper.insert_from(scan, *pose).unwrap();
    }
    mapper
}

fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

/// Cells of which the fine ones hold no more points than their samples.
fn sparse(params: Params) -> Params {
    Params { cell_size: Some(0.12), ..params }
}

/// All the same: clusters to the bit; of regions the planes of least variance and the noise to rounding, for the search for them
/// begins at the mean of the points, which samples sum in another order.
fn assert_same(stream: &PlaneMap, found: &PlaneMap, name: &str) {
    if found.used.grown.is_none() {
        assert_eq!(bits(stream), bits(found), "{name}");
        return;
    }
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-9 * (1.0 + b.abs());
    let mut like_found = stream.clone();
    for (own, other) in like_found.planes.iter_mut().zip(&found.planes) {
        let (a, b) = (own.plane.coefficients(), other.plane.coefficients());
        assert!((0..4).all(|i| close(a[i], b[i])), "{name}: {a:?} instead of {b:?}");
        assert_eq!(own.estimate.is_some(), other.estimate.is_some(), "{name}");
        if let (Some(own), Some(other)) = (own.estimate, other.estimate) {
            assert!(close(own.largest_tilt(), other.largest_tilt()) && own.columns == other.columns);
        }
        (own.plane, own.estimate) = (other.plane, other.estimate);
    }
    let knots = |map: &PlaneMap| map.noise.clone().map(|noise| (noise.places, noise.knots));
    match (knots(&like_found), knots(found)) {
        (Some((places, own)), Some((of, other))) => {
            assert_eq!((places, own.len()), (of, other.len()), "{name}");
            assert!(own.iter().zip(&other).all(|(a, b)| close(a.along, b.along)), "{name}");
        }
        (own, other) => assert_eq!(own, other, "{name}"),
    }
    like_found.noise.clone_from(&found.noise);
    assert_eq!(bits(&like_found), bits(found), "{name}");
}

fn coplanar() -> Params {
    let mut params = Params::default();
    params.regions.as_mut().unwrap().join = Join::Coplanar;
    params
}

#[test]
fn where_samples_are_all_points_the_map_is_that_of_points_that_are_kept() {
    let room = plain(&Scene::room(), 40_000, 6);
    let unknown: Posed =
        room.iter().map(|(scan, _)| (scan.clone().with_sigma(Sigma::Unknown).unwrap(), None)).collect();
    let noise = PoseNoise::from_radians(0.01, 0.002).unwrap();
    let unsure: Posed = room.iter().map(|(scan, _)| (scan.clone(), Some(noise))).collect();
    for (name, scans) in [("room", room), ("unknown errors", unknown), ("unsure poses", unsure)] {
        for params in [Params::default(), coplanar(), Params::clusters()] {
            let params = sparse(params);
            let found = kept(params, &scans).extract().unwrap();
            assert!(found.planes.len() > 5, "{name}");
            for (size, again, threads) in [(700, 999, 1), (100_000, 100_000, 2), (4096, 1 << 15, 3)] {
                let stream = on_threads(threads, || streamed(params, &scans, size, again));
                check_sound(&stream);
                assert_same(&stream, &found, &format!("{name}, chunks of {size}"));
            }
        }
    }
}

#[test]
fn where_samples_are_a_part_chunks_and_threads_change_no_bit() {
    let scans = plain(&Scene::room(), 300_000, 2);
    for params in [Params::default(), coplanar(), Params::clusters()] {
        let params = Params { cell_size: Some(0.15), ..params };
        let found = kept(params, &scans).extract().unwrap();
        let stream = on_threads(1, || streamed(params, &scans, 10_000, 50_000));
        let planes = stream.planes.len();
        assert!(planes > 5 && planes == found.planes.len());
        for (size, again, threads) in [(300_000, 10_000, 2), (12_345, 7_777, 3)] {
            let other = on_threads(threads, || streamed(params, &scans, size, again));
            assert_eq!(bits(&other), bits(&stream));
        }
        // The same planes and labels, up to their numbers, which are by all points or by the samples, and to rounding: the search
        // for the best plane begins at the centroid.
        let of = |plane: &terrace::ExtractedPlane| {
            let same = |other: &&terrace::ExtractedPlane| {
                (other.points, other.cells) == (plane.points, plane.cells)
                    && (other.centroid, other.rms) == (plane.centroid, plane.rms)
            };
            stream.planes.iter().find(same).unwrap_or_else(|| panic!("{:?} is missing", plane.plane))
        };
        for plane in &found.planes {
            let (a, b) = (plane.plane.coefficients(), of(plane).plane.coefficients());
            assert!((0..4).all(|i| (a[i] - b[i]).abs() < 1e-6), "{a:?} {b:?}");
        }
        assert_eq!(found.labels.len(), stream.labels.len());
        for (kept, told) in found.labels.iter().zip(&stream.labels) {
            let renamed = kept.map(|id| of(&found.planes[id.index()]).id);
            assert_eq!(renamed, *told);
        }
    }
}

#[test]
fn a_map_that_keeps_its_points_is_asked_in_the_same_way() {
    let scans = plain(&Scene::room(), 30_000, 4);
    for params in [Params::default(), Params::clusters(), Params::paper()] {
        let mapper = kept(params, &scans);
        assert!(!mapper.is_streaming());
        assert_eq!(bits(&read_again(&mapper, &scans, 1000)), bits(&mapper.extract().unwrap()));
    }
}

#[test]
fn chunks_that_are_kept_are_one_scan() {
    let scans = plain(&Scene::table(), 30_000, 4);
    let (scan, _) = &scans[0];
    for params in [Params::default(), Params::clusters(), Params::paper()] {
        let mut mapper = Mapper::new(Params { cell_size: Some(0.1), ..params }).unwrap();
        for chunk in chunks(scan, 7001) {
            mapper.insert_more(&chunk).unwrap();
        }
        let whole = kept(*mapper.params(), &scans);
        assert_eq!(mapper.len(), scan.len());
        assert_eq!(bits(&mapper.extract().unwrap()), bits(&whole.extract().unwrap()));
    }
}

#[test]
fn points_count_though_they_are_forgotten() {
    let scans = plain(&Scene::table(), 20_000, 4);
    let mut mapper = Mapper::streaming(Params::default()).unwrap();
    assert!(mapper.is_empty() && mapper.is_streaming());
    for (scan, _) in &scans {
        assert_eq!(mapper.insert(scan).unwrap().points, scan.present());
    }
    assert_eq!(mapper.len(), scans.iter().map(|(scan, _)| scan.len()).sum::<usize>());
    assert_eq!(mapper.cells_of_points().count(), 0);
    let map = mapper.extract().unwrap();
    assert!(map.labels.is_empty() && !map.planes.is_empty());
    assert_eq!(map.points, mapper.len());
}

#[test]
fn absent_and_far_points_have_no_label() {
    let mut points: Vec<[f64; 3]> = crate::common::square(0.5);
    points.extend([[f64::NAN; 3], [1e300, 0.0, 0.0], [3.0, 3.0, 3.0]]);
    let scan = Scan::new(points, Sigma::Uniform(0.002), Frame::World { sensor: Some([1.0, 1.0, -2.0]) });
    let scans = vec![(scan.unwrap(), None)];
    for params in [Params::default(), Params::clusters()] {
        let map = streamed(Params { cell_size: Some(0.1), ..params }, &scans, 3000, 4000);
        assert_eq!(map.planes.len(), 1);
        assert!(map.planes[0].plane.normal()[2] < -0.99, "the sensor is below");
        assert_eq!(map.planes[0].points, 10_000);
        assert_eq!(map.labels[10_000..], [None; 3]);
    }
}

#[test]
fn points_that_are_not_told_by_their_place_are_not_forgotten() {
    for params in [
        Params::paper(),
        Params { assignment: Assignment::ExpectedDistance, ..Params::default() },
        Params { weighting: Weighting::Information, ..Params::clusters() },
    ] {
        assert_eq!(Mapper::streaming(params).unwrap_err(), StreamingError::NotByPlace);
    }
    let wrong = Params { phi: 2.0, ..Params::clusters() };
    assert!(matches!(Mapper::streaming(wrong), Err(StreamingError::Params(error)) if error.name == "phi"));
}
