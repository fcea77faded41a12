//! No cells, one point, points that determine no plane, and cells, points and settings that are not what they should be.

#![allow(clippy::unwrap_used, reason = "tests")]

mod scenes;

use scenes::{Scene, Sorted, rectangle};
use terrace_regions::{Cell, Field, Points, RegionsError, Segmentation, Settings, segment};
use terrace_stats::{Moments, Stats, SymmetricMatrix3, UncertainVector};

const NO_POINTS: Points<'static> = Points { cells: &[], places: &[] };

/// A square of 1 m without noise, points 2 cm apart, not along the cells.
fn flat(height: impl Fn(f64, f64) -> f64) -> Vec<[f64; 3]> {
    let place = |k: i32| [k % 50, k / 50].map(|i| 0.02 * f64::from(i) + 0.007);
    (0..2500).map(place).map(|[x, y]| [x, y, height(x, y)]).collect()
}

fn refused(cells: &[Cell], edge: f64, points: Points) -> RegionsError {
    segment(cells, edge, points, &Settings::default()).unwrap_err()
}

fn finds_nothing(points: &[[f64; 3]]) {
    for sigma in [0.0, 0.01] {
        let found = Sorted::of(points, 0.05, sigma).segment();
        assert_eq!((found.regions.len(), found.shares.len()), (0, 0), "{found:?}");
        assert_eq!(found.labels, vec![None; points.len()]);
    }
}

#[test]
fn no_cells_hold_no_planes() {
    let found = segment(&[], 0.1, NO_POINTS, &Settings::default()).unwrap();
    let nothing = Segmentation {
        regions: Vec::new(),
        labels: Vec::new(),
        shares: Vec::new(),
        noise_scale: 1.0,
        min_points: 20.0,
        min_area: 0.0,
    };
    assert_eq!(found, nothing);
    // Points of no cell get no label.
    let points = Points { cells: &[None; 3], places: &[[0.0; 3]; 3] };
    assert_eq!(segment(&[], 0.1, points, &Settings::default()).unwrap().labels, [None; 3]);
    assert_eq!(Field::of(&[], 0.1).unwrap().sums_around(|_, sums| sums.count()), []);
}

#[test]
fn one_place_and_one_line_are_no_planes() {
    finds_nothing(&[[0.3, 0.2, 0.1]]);
    finds_nothing(&[[0.3, 0.2, 0.1]; 500]);
    let along = |k: i32| [0.3, 0.2, 0.1].map(|x| x * f64::from(k) * 0.01);
    finds_nothing(&(0..500).map(along).collect::<Vec<_>>());
    finds_nothing(&(0..500).map(|k| [f64::from(k) * 0.01, 0.02, 0.03]).collect::<Vec<_>>());
}

#[test]
fn points_without_noise_and_without_errors_are_one_plane() {
    for sigma in [0.0, 0.01] {
        // Inside cells, on the face between two, and across them.
        for (height, slope) in [(0.512, 0.0), (0.5, 0.0), (0.5, 0.3)] {
            let points = flat(|x, _| height + slope * x);
            let found = Sorted::of(&points, 0.05, sigma).segment();
            assert_eq!(found.labels, vec![Some(0); 2500], "{sigma} {height} {slope}");
            let [plane] = found.regions[..] else { panic!("{found:?}") };
            let off = plane.normal[0] + slope * plane.normal[2];
            assert!(off.abs() < 1e-9 && plane.rms < 1e-9 && plane.reduced_chi_squared < 1e-9, "{plane:?}");
        }
    }
}

#[test]
fn edges_of_any_size_find_planes_or_nothing() {
    // One cell is too few for a region, whatever its edge is said to be.
    let whole = Sorted::of(&flat(|_, _| 0.512), 10.0, 0.01);
    let sorted = Sorted::of(&flat(|_, _| 0.512), 0.05, 0.01);
    for edge in [f64::MIN_POSITIVE, 1e-300, 1e-9, 1.0, 1e9, 1e300, f64::MAX] {
        let regions =
            |of: &Sorted| segment(&of.cells, edge, of.points(), &Settings::default()).unwrap().regions.len();
        assert_eq!(regions(&whole), 0);
        assert!(regions(&sorted) <= 1);
    }
    for edge in [0.0, -0.1, f64::INFINITY, f64::NEG_INFINITY, 1e-310] {
        assert_eq!(refused(&sorted.cells, edge, sorted.points()), RegionsError::Edge { edge });
    }
    assert!(matches!(refused(&[], f64::NAN, NO_POINTS), RegionsError::Edge { .. }));
}

#[test]
fn keys_at_the_ends_of_their_range_are_keys() {
    let mut sorted = Sorted::of(&flat(|_, _| 0.012), 0.05, 0.01);
    for cell in &mut sorted.cells {
        cell.key = [i32::MAX - cell.key[0], i32::MIN + cell.key[1], cell.key[2]];
    }
    assert_eq!(sorted.segment().labels, vec![Some(0); 2500]);
}

#[test]
fn cells_without_points_or_with_sums_that_are_not_finite_are_refused() {
    let sorted = Sorted::of(&flat(|_, _| 0.5), 0.05, 0.01);
    let with = |stats: Stats| {
        let mut cells = sorted.cells.clone();
        cells[7].stats = stats;
        refused(&cells, 0.05, sorted.points())
    };
    let good = sorted.cells[7].stats;
    assert_eq!(with(Stats::new([0.0; 3])), RegionsError::Cell { cell: 7 });
    assert_eq!(with(Stats::from_moments([0.0; 3], Moments::EMPTY)), RegionsError::Cell { cell: 7 });
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let far = Stats::from_moments([0.0, bad, 0.0], *good.moments());
        let vague = good.with_noise(SymmetricMatrix3::diagonal([0.0, 0.0, bad]));
        assert_eq!([with(far), with(vague)], [RegionsError::Cell { cell: 7 }; 2]);
    }
    // The square of the last is not finite.
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e200] {
        let mut stats = good;
        stats.push(&UncertainVector::exact([bad, 0.0, 0.0]));
        assert_eq!(with(stats), RegionsError::Cell { cell: 7 });
    }
}

#[test]
fn two_cells_at_one_place_are_refused() {
    let mut cells = Sorted::of(&flat(|_, _| 0.5), 0.05, 0.01).cells;
    let places = cells.len();
    cells.push(cells[5]);
    assert_eq!(refused(&cells, 0.05, NO_POINTS), RegionsError::SameKey { cells: places + 1, places });
}

#[test]
fn points_that_contradict_the_cells_are_refused() {
    let sorted = Sorted::of(&flat(|_, _| 0.5), 0.05, 0.01);
    let refused = |points: Points| refused(&sorted.cells, 0.05, points);
    let fewer = Points { cells: &sorted.cell_of, places: &sorted.places[1..] };
    assert_eq!(refused(fewer), RegionsError::Places { points: 2500, places: 2499 });
    let fewer = Points { cells: &[], places: &sorted.places };
    assert_eq!(refused(fewer), RegionsError::Places { points: 0, places: 2500 });
    let cells = u32::try_from(sorted.cells.len()).unwrap();
    for cell in [cells, u32::MAX] {
        let mut cell_of = sorted.cell_of.clone();
        cell_of[3] = Some(cell);
        let points = Points { cells: &cell_of, places: &sorted.places };
        assert_eq!(refused(points), RegionsError::NoCell { point: 3, cell });
    }
}

#[test]
fn points_of_no_cell_and_places_that_are_not_finite_get_no_label() {
    let mut sorted = Sorted::of(&flat(|_, _| 0.512), 0.05, 0.01);
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    for (point, bad) in bad.into_iter().enumerate() {
        for axis in 0..3 {
            sorted.places[100 * point + axis][axis] = bad;
        }
    }
    sorted.cell_of[1000] = None;
    let found = sorted.segment();
    for (point, label) in found.labels.iter().enumerate() {
        let known = point != 1000 && sorted.places[point].iter().all(|x| x.is_finite());
        assert_eq!(label.is_some(), known, "{point}");
    }
    let [plane] = found.regions[..] else { panic!("{found:?}") };
    assert_eq!(plane.points, 2490);
    assert!(plane.rms < 1e-6 && plane.centroid.iter().all(|x| x.is_finite()) && plane.bend.is_some());
}

#[test]
fn without_points_nothing_is_a_plane() {
    let sorted = Sorted::of(&flat(|_, _| 0.5), 0.05, 0.01);
    let found = segment(&sorted.cells, 0.05, NO_POINTS, &Settings::default()).unwrap();
    assert!(found.regions.is_empty() && found.labels.is_empty());
}

#[test]
fn settings_out_of_their_range_are_refused() {
    let bad = [0.0, -0.0, -1.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
    let default = Settings::default();
    assert_eq!(default.validate(), Ok(()));
    let name_of = |settings: &Settings| match segment(&[], 0.1, NO_POINTS, settings) {
        Err(RegionsError::Setting { name, .. }) => Some(name),
        _ => None,
    };
    for name in ["tilt", "reach", "turn"] {
        let with = |value: f64| {
            let mut settings = default;
            match name {
                "tilt" => settings.tilt = value,
                "reach" => settings.reach = value,
                _ => settings.turn = value,
            }
            settings
        };
        assert!(bad.iter().all(|value| name_of(&with(*value)) == Some(name)), "{name}");
        assert!([1e-300, 1e300].iter().all(|value| with(*value).validate().is_ok()), "{name}");
    }
    let area = |area| Settings { min_area: Some(area), ..default };
    assert!([-1e-9, f64::INFINITY, f64::NAN].iter().all(|bad| name_of(&area(*bad)) == Some("min_area")));
    assert_eq!(area(0.0).validate(), Ok(()));
}

#[test]
fn the_least_points_and_area_are_those_set() {
    let mut scene = Scene::new(1, 0.01);
    scene.add(0, 4000, rectangle([0.01, 0.02, 0.03], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]));
    scene.add(1, 2000, rectangle([0.01, 0.02, 1.03], [0.5, 0.0, 0.0], [0.0, 0.5, 0.0]));
    let sorted = scene.cells(0.05);
    let found = |min_points, min_area| {
        let settings = Settings { min_points, min_area, ..Settings::default() };
        segment(&sorted.cells, 0.05, sorted.points(), &settings).unwrap()
    };
    let regions = |min_points, min_area| found(min_points, min_area).regions.len();
    let set = found(Some(2500), Some(0.1));
    assert_eq!((set.regions.len(), set.min_points, set.min_area), (1, 2500.0, 0.1));
    assert_eq!((regions(Some(0), Some(0.0)), regions(None, None)), (2, 2));
    assert_eq!((regions(Some(5000), None), regions(None, Some(0.8)), regions(None, Some(2.0))), (0, 1, 0));
}
