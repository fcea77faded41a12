//! Maps that forget points, beside those that keep them.

use terrace::{CellId, Mapper, Params, PlaneId, PlaneMap, Scan, StreamingError};
use terrace_synth::{Params as Synth, Scene};

use crate::common::check_sound;

fn room(points: usize) -> Vec<Scan> {
    let params = Synth { points: Some(points), ..Synth::default() };
    Scene::room().chunks(&params, usize::MAX).unwrap().map(|chunk| chunk.scan.scan).collect()
}

/// A scan in chunks of so many points.
fn chunks(scan: &Scan, size: usize) -> Vec<Scan> {
    let (points, sigma, frame) = scan.clone().into_parts();
    let part = |sigma: &terrace::Sigma, range: std::ops::Range<usize>| match sigma {
        terrace::Sigma::PerPoint(all) => terrace::Sigma::PerPoint(all[range].to_vec()),
        other => other.clone(),
    };
    (0..points.len())
        .step_by(size)
        .map(|first| {
            let range = first..(first + size).min(points.len());
            Scan::new(points[range.clone()].to_vec(), part(&sigma, range), frame).unwrap()
        })
        .collect()
}

fn streamed(params: Params, scans: &[Scan], size: usize) -> (PlaneMap, Vec<Option<PlaneId>>) {
    let mut mapper = Mapper::streaming(params).unwrap();
    for scan in scans {
        for (at, chunk) in chunks(scan, size).iter().enumerate() {
            if at == 0 { mapper.insert(chunk) } else { mapper.insert_more(chunk) }.unwrap();
        }
    }
    assert_eq!(mapper.cells_of_points().collect::<Vec<Option<CellId>>>(), []);
    let (mut map, mut labels) = mapper.extract_streamed(|_| {}).unwrap();
    let (mut all, mut some) = (Vec::new(), Vec::new());
    for (view, scan) in scans.iter().enumerate() {
        // Other chunks than before.
        for chunk in chunks(scan, size / 3 + 1) {
            labels.label(view, &chunk, &mut some);
            all.extend_from_slice(&some);
        }
    }
    labels.finish(&mut map);
    (map, all)
}

#[test]
fn planes_and_labels_are_those_of_a_map_that_keeps_points() {
    let scans = room(60_000);
    for params in [Params::default(), Params::clusters()] {
        let params = Params { cell_size: Some(0.12), ..params };
        let mut keeping = Mapper::new(params).unwrap();
        for scan in &scans {
            keeping.insert(scan).unwrap();
        }
        let kept = keeping.extract().unwrap();
        check_sound(&kept);
        for size in [1_000, 100_000] {
            for threads in [1, 3] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let (map, labels) = pool.install(|| streamed(params, &scans, size));
                // Numbers go by samples: planes are matched by their coefficients, which are the same bits.
                let same = |plane: &terrace::ExtractedPlane| {
                    kept.planes.iter().find(|other| other.plane == plane.plane).unwrap()
                };
                assert_eq!((map.planes.len(), map.points), (kept.planes.len(), kept.points));
                for plane in &map.planes {
                    let other = same(plane);
                    let found = (plane.points, plane.centroid, plane.rms, plane.estimate);
                    assert_eq!(found, (other.points, other.centroid, other.rms, other.estimate));
                }
                let numbered = |label: &Option<PlaneId>| label.map(|id| same(map.plane(id).unwrap()).id);
                assert_eq!(labels.iter().map(numbered).collect::<Vec<_>>(), kept.labels);
            }
        }
    }
}

#[test]
fn what_depends_on_the_order_of_points_is_refused() {
    assert!(matches!(Mapper::streaming(Params::paper()), Err(StreamingError::NotByPlace)));
}
