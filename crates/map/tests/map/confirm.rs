//! Planes that are sure enough, layers, and points labelled one by one.

use terrace::{Confirm, Mapper, Params, PlaneMap, Sigma};
use terrace_synth::{LabelledScan, Scene};

use crate::common::{PRESETS, bits, cloud, map, map_of, rough, scans, square, tenth, unknown};

fn confirmed(params: Params) -> Params {
    Params { confirm: Some(Confirm::default()), ..params }
}

/// Shares of the points of each true plane that the plane found with most of them has, and of points of no plane that none
/// claims.
fn agreement(map: &PlaneMap, scans: &[LabelledScan], planes: usize) -> (Vec<f64>, f64) {
    let mut shared = vec![vec![0_u32; map.planes.len()]; planes];
    let mut of = vec![0_u32; planes];
    let (mut left, mut none) = (0_u32, 0_u32);
    let truth = scans.iter().flat_map(|s| &s.labels);
    for (found, truth) in map.labels.iter().zip(truth) {
        if let Some(truth) = truth {
            of[truth.index()] += 1;
            if let Some(found) = found {
                shared[truth.index()][found.index()] += 1;
            }
        } else {
            none += 1;
            left += u32::from(found.is_none());
        }
    }
    let most =
        |(shared, of): (&Vec<u32>, &u32)| f64::from(*shared.iter().max().unwrap_or(&0)) / f64::from(*of);
    (shared.iter().zip(&of).map(most).collect(), f64::from(left) / f64::from(none.max(1)))
}

fn check(map: &PlaneMap) {
    for (index, plane) in map.planes.iter().enumerate() {
        assert_eq!(plane.id.index(), index);
        let labelled = map.labels.iter().filter(|label| **label == Some(plane.id)).count();
        assert_eq!(labelled as u64, plane.points);
        assert!(plane.points > 0);
        assert!(plane.estimate.is_none_or(|estimate| estimate.largest_tilt() <= Confirm::default().tilt));
    }
    assert!(map.planes.is_sorted_by(|a, b| a.points >= b.points));
    assert!(map.labels.iter().flatten().all(|label| label.index() < map.planes.len()));
}

/// Nothing but the three planes of the table, and their points up to their edges.
#[test]
fn a_table_is_its_three_planes() {
    let scans = scans(&Scene::table(), 30_000, 3);
    let by_cells = map_of(Params::default(), &scans);
    let found = map_of(confirmed(Params::default()), &scans);
    check(&found);
    assert_eq!(found.planes.len(), 3);
    let (of_points, _) = agreement(&found, &scans, 3);
    let (of_cells, _) = agreement(&by_cells, &scans, 3);
    for (points, cells) in of_points.iter().zip(&of_cells) {
        assert!(*points > 0.96 && points > cells, "{points} of points, {cells} of cells");
    }
}

/// A door stands 6 cm behind its wall, nearer than a cell: it is a plane of its own, and of its points few are the wall's.
#[test]
fn a_door_is_not_its_wall() {
    let scene = Scene::room();
    let scans = scans(&scene, 300_000, 3);
    let planes = scene.planes().len();
    let door = scene.planes().iter().find(|plane| plane.name == "door").unwrap().id.index();
    let (by_cells, _) = agreement(&map_of(Params::default(), &scans), &scans, planes);
    let found = map_of(confirmed(Params::default()), &scans);
    check(&found);
    let (by_points, left) = agreement(&found, &scans, planes);
    let wall = found
        .planes
        .iter()
        .find(|p| (p.plane.normal()[1].abs() > 0.99) && p.centroid[1].abs() < 0.1)
        .unwrap();
    let on_wall = found
        .labels
        .iter()
        .zip(scans.iter().flat_map(|s| &s.labels))
        .filter(|(found, truth)| **found == Some(wall.id) && truth.is_some_and(|t| t.index() == door))
        .count();
    let of_door = scans.iter().flat_map(|s| &s.labels).flatten().filter(|t| t.index() == door).count();
    assert!(5 * on_wall < of_door, "{on_wall} of {of_door}");
    assert!(by_points[door] > 0.7, "{by_points:?} {by_cells:?}");
    assert!(left > 0.5, "of the points of no plane {left} are left alone");
}

/// Two points off a plane by more than their errors have no label, others in the same cell have.
#[test]
fn outliers_have_no_label() {
    let mut points = rough(0.75);
    let flat = points.len();
    points.extend([[1.003, 1.003, 0.79], [1.023, 1.003, 0.71]]);
    let scan = cloud(points, Sigma::Uniform(1e-3));
    let found = map(confirmed(tenth(Params::default)), &[&scan]);
    check(&found);
    assert_eq!(found.planes.len(), 1);
    assert!(found.labels[..flat].iter().filter(|label| label.is_some()).count() * 100 > flat * 99);
    assert!(found.labels[flat..].iter().all(Option::is_none));
    let by_cells = map(tenth(Params::default), &[&scan]);
    assert!(by_cells.labels[flat..].iter().any(Option::is_some));
}

#[test]
fn exact_points_have_a_plane() {
    let found = map(confirmed(tenth(Params::default)), &[&unknown(&square(0.75))]);
    assert_eq!(found.planes.len(), 1);
    assert!(found.labels.iter().all(Option::is_some));
}

/// In the paper's way of finding cells nothing is confirmed.
#[test]
fn the_papers_planes_stay() {
    let scan = unknown(&rough(0.7));
    assert_eq!(
        bits(&map(confirmed(tenth(Params::paper)), &[&scan]))
            .replace("confirm: Some(Confirm { tilt: 0.01, distance: 3.5, share: 0.5 })", "confirm: None"),
        bits(&map(tenth(Params::paper), &[&scan]))
    );
}

#[test]
fn settings_that_mean_nothing_are_refused() {
    for bad in [
        Confirm { tilt: 0.0, ..Confirm::default() },
        Confirm { tilt: f64::NAN, ..Confirm::default() },
        Confirm { distance: -1.0, ..Confirm::default() },
        Confirm { share: 1.5, ..Confirm::default() },
    ] {
        for preset in PRESETS {
            assert!(Mapper::new(Params { confirm: Some(bad), ..preset() }).is_err(), "{bad:?}");
        }
    }
}

#[test]
fn any_number_of_threads_labels_the_same_points() {
    let scans = scans(&Scene::room(), 60_000, 2);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        bits(&pool.install(|| map_of(confirmed(Params::default()), &scans)))
    };
    assert_eq!(on(1), on(3));
}
