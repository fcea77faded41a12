//! What surfaces of known shape come out as.

#![allow(clippy::unwrap_used, reason = "tests")]

mod scenes;

use std::f64::consts::TAU;

use scenes::{Scene, Sorted, dot, rectangle};
use terrace_regions::{Cell, Field, RegionsError, Sample, Segmentation, Settings, find, segment};
use terrace_stats::SymmetricMatrix3;

/// Standard error of a point, and an edge of half the cell that it suggests.
const SIGMA: f64 = 0.01;
const EDGE: f64 = 0.03;
const CORNER: [f64; 3] = [0.013, 0.021, 0.017];

/// Number of points of a surface by label.
fn count(scene: &Scene, found: &Segmentation, surface: usize, label: Option<u32>) -> usize {
    scene.truth.iter().zip(&found.labels).filter(|(of, found)| **of == surface && **found == label).count()
}

/// Number of points with the label of a region most of whose points are of another surface.
fn wrong(scene: &Scene, found: &Segmentation) -> usize {
    let regions = (0..).take(found.regions.len());
    let wrong = regions.map(|region| {
        let of: Vec<usize> = (0..4).map(|surface| count(scene, found, surface, Some(region))).collect();
        of.iter().sum::<usize>() - of.iter().max().unwrap()
    });
    wrong.sum()
}

fn box_corner(seed: u64, points: usize) -> Scene {
    let mut scene = Scene::new(seed, SIGMA);
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for side in 0..3 {
        scene.add(side, points, rectangle(CORNER, axes[(side + 1) % 3], axes[(side + 2) % 3]));
    }
    scene
}

#[test]
fn a_plane_is_as_sure_as_it_says() {
    let normal = [-0.3, 0.0, 1.6].map(|x: f64| x / 0.3_f64.hypot(1.6));
    for seed in 0..20 {
        let mut scene = Scene::new(seed, SIGMA);
        scene.add(0, 4000, rectangle([0.2, -0.3, 0.1], [1.6, 0.0, 0.3], [0.0, 1.5, 0.0]));
        let found = scene.cells(2.0 * EDGE).segment();
        let [plane] = found.regions[..] else { panic!("{found:?}") };
        let turned = dot(plane.normal, normal).abs().min(1.0).acos();
        assert!(turned < 4.0 * plane.tilt && plane.tilt < 0.001, "{turned} {plane:?}");
        assert!((0.9..1.1).contains(&plane.reduced_chi_squared), "{plane:?}");
        assert!((plane.rms / SIGMA - 1.0).abs() < 0.05 && found.noise_scale.to_bits() == 1.0_f64.to_bits());
        // Nothing but the tail is without a label.
        for (point, label) in scene.points.iter().zip(&found.labels) {
            let off = dot(plane.normal, [0, 1, 2].map(|i| point[i] - plane.point[i])).abs() / SIGMA;
            assert!(label.is_some() || off > Settings::default().reach - 0.05, "{off}");
        }
        assert!(count(&scene, &found, 0, None) < 20);
    }
}

/// Points at a corner are labelled better than by the nearest of the true planes: a plane that ends is not asked beyond its end.
#[test]
fn labels_at_a_corner_are_better_than_those_of_the_nearest_plane() {
    for (seed, points) in [(1, 1500), (2, 20_000), (3, 20_000), (4, 40_000)] {
        let scene = box_corner(seed, points);
        let off = |point: &[f64; 3], side: usize| (point[side] - CORNER[side]).abs();
        let is_wrong =
            |(point, side): &(&[f64; 3], &usize)| (0..3).any(|other| off(point, other) < off(point, **side));
        let nearest = scene.points.iter().zip(&scene.truth).filter(is_wrong).count();
        let found = scene.cells(EDGE).segment();
        assert_eq!(found.regions.len(), 3);
        let unlabelled = found.labels.iter().filter(|label| label.is_none()).count();
        let wrong = wrong(&scene, &found);
        assert!(wrong + unlabelled < nearest, "{seed}: {wrong} and {unlabelled}, not {nearest}");
    }
}

/// A wall of 3 × 2.4 m, whose door is set back.
fn door(depth: f64) -> Scene {
    let is_door = |x: f64, z: f64| (1.0..1.9).contains(&x) && z < 2.0;
    let mut scene = Scene::new(3, SIGMA);
    scene.add(0, 80_000, |u, v| {
        let (x, z) = (3.0 * u, 2.4 * v);
        [x + CORNER[0], CORNER[1] + if is_door(x, z) { depth } else { 0.0 }, z + CORNER[2]]
    });
    for (point, of) in scene.points.iter().zip(&mut scene.truth) {
        *of = usize::from(is_door(point[0] - CORNER[0], point[2] - CORNER[2]));
    }
    scene
}

#[test]
fn a_door_three_standard_errors_deep_is_not_its_wall() {
    let scene = door(3.0 * SIGMA);
    let found = scene.cells(EDGE).segment();
    let [wall, door] = found.regions[..] else { panic!("{found:?}") };
    assert_ne!(wall.surface, door.surface);
    assert!((door.point[1] - wall.point[1] - 3.0 * SIGMA).abs() < 0.2 * SIGMA);
    // By the nearest plane it would be every fifteenth point.
    assert!(wrong(&scene, &found) < 80_000 / 50);
}

#[test]
fn a_step_below_a_third_of_a_standard_error_is_not_seen() {
    let found = door(0.3 * SIGMA).cells(EDGE).segment();
    assert_eq!((found.regions.len(), found.noise_scale), (1, 1.0));
    // One of a standard error is not cut either, but shows as scatter beyond the errors.
    let found = door(SIGMA).cells(EDGE).segment();
    assert_eq!(found.regions.len(), 1);
    assert!((1.05..1.5).contains(&found.noise_scale), "{}", found.noise_scale);
}

#[test]
fn round_things_beside_a_floor_are_no_planes() {
    let mut scene = Scene::new(4, SIGMA);
    scene.add(0, 40_000, rectangle(CORNER, [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]));
    scene.add(1, 20_000, |u, v| [1.0 + 0.4 * (TAU * u).cos(), 1.0 + 0.4 * (TAU * u).sin(), 0.3 + v]);
    scene.add(2, 20_000, |u, v| {
        let (z, around) = (2.0 * v - 1.0, TAU * u);
        let r = 0.5 * (1.0 - z * z).sqrt();
        [3.0 + r * around.cos(), 1.0 + r * around.sin(), 0.9 + 0.5 * z]
    });
    let found = scene.cells(EDGE).segment();
    let [floor] = found.regions[..] else { panic!("{found:?}") };
    assert!(floor.normal[2].abs() > 0.9999);
    assert_eq!(count(&scene, &found, 1, None) + count(&scene, &found, 2, None), 40_000);
    assert!(count(&scene, &found, 0, None) < 100);
}

/// A floor, and two boards on a wall, in line, with a gap of three cells; the second with so many points for each of the first.
fn boards(share: f64) -> Scene {
    let mut scene = Scene::new(5, SIGMA);
    scene.add(0, 60_000, rectangle(CORNER, [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]));
    scene.add(1, 4000, rectangle([0.5, 1.512, 1.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.5]));
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of 4000")]
    let second = (4000.0 * share) as usize;
    scene.add(2, second, rectangle([1.1, 1.512, 1.0], [0.5 * share, 0.0, 0.0], [0.0, 0.0, 0.5]));
    scene
}

#[test]
fn boards_in_line_are_two_regions_of_one_surface() {
    let scene = boards(1.0);
    let found = scene.cells(EDGE).segment();
    let [floor, one, other] = found.regions[..] else { panic!("{found:?}") };
    assert_eq!(one.surface, other.surface);
    assert_ne!(one.surface, floor.surface);
    assert_eq!((one.normal, one.point), (other.normal, other.point));
    assert!((one.centroid[0] - other.centroid[0]).abs() > 0.55);
    assert_eq!(wrong(&scene, &found), 0);
    // What is much smaller than the rest belongs to it.
    let scene = boards(0.08);
    let found = scene.cells(EDGE).segment();
    assert_eq!(found.regions.len(), 2);
    assert!(count(&scene, &found, 2, Some(1)) > 300);
}

/// Half of all points are not in the largest part, at any resolution at which there are two.
#[test]
fn boards_without_a_floor_are_two_regions() {
    let mut scene = Scene::new(18, SIGMA);
    for (truth, x) in [(0, 0.5), (1, 1.0 + 6.0 * EDGE)] {
        scene.add(truth, 4000, rectangle([x, 1.512, 1.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.5]));
    }
    let found = scene.cells(EDGE).segment();
    let [one, other] = found.regions[..] else { panic!("{:?}", found.regions) };
    assert_eq!(one.surface, other.surface);
    assert_eq!(wrong(&scene, &found), 0);
}

/// A floor, and above it two faces in one plane with a groove between them, as wide as a cell: it may lie within one layer of cells, or in
/// two that hold points of the faces as well.
#[test]
fn faces_beside_a_groove_are_two_regions_wherever_cells_lie() {
    for step in 0..8 {
        let mut scene = Scene::new(17, 0.1 * SIGMA);
        let [x, y, z] = [0.7 + f64::from(step) * EDGE / 8.0, 0.017, 1.043];
        let (width, depth) = (EDGE, 0.5 * EDGE);
        scene.add(0, 60_000, rectangle(CORNER, [1.5, 0.0, 0.0], [0.0, 1.5, 0.0]));
        scene.add(1, 6000, rectangle([x - 0.5, y, z], [0.5, 0.0, 0.0], [0.0, 0.3, 0.0]));
        scene.add(2, 6000, rectangle([x + width, y, z], [0.5, 0.0, 0.0], [0.0, 0.3, 0.0]));
        scene.add(3, 360, |u, v| [x + width * u, y + 0.3 * v, z - depth]);
        let found = scene.cells(EDGE).segment();
        let [_, one, other] = found.regions[..] else { panic!("step {step}: {:?}", found.regions) };
        assert_eq!(one.surface, other.surface);
        assert!((one.centroid[0] - other.centroid[0]).abs() > 0.5);
    }
}

/// Rows with two empty cells between them, as the rings of a lidar are.
#[test]
fn rows_with_gaps_are_one_region() {
    let mut scene = Scene::new(6, SIGMA);
    scene.add(0, 2000, |u, v| [2.0 * u, 0.1 * (v * 10.0).floor() + 0.011, 0.017]);
    let found = scene.cells(EDGE).segment();
    assert_eq!(found.regions.len(), 1);
    assert!(count(&scene, &found, 0, None) < 10);
}

/// A lidar measures distances: on a wall that it faces, rows of points have errors across the wall alone. The plane through a row is
/// then any that holds it, and must not speak against the wall.
#[test]
fn dense_rows_with_errors_across_the_wall_are_one_region() {
    for (apart, in_row) in [(0.08, 400), (0.10, 200), (0.10, 800)] {
        let rows = (2.0_f64 / apart).floor();
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few thousand")]
        let points = rows as usize * in_row;
        let mut scene = Scene::new(16, 0.0);
        // What is left of the second number once it has named the row is an even error of the same variance.
        let off = |v: f64| SIGMA * 12.0_f64.sqrt() * ((v * rows).fract() - 0.5);
        scene.add(0, points, |u, v| [2.0 * u, apart * (v * rows).floor() + 0.011, 0.017 + off(v)]);
        let mut sorted = scene.cells(EDGE);
        for cell in &mut sorted.cells {
            let errors = SymmetricMatrix3::diagonal([0.0, 0.0, SIGMA * SIGMA]);
            cell.stats = cell.stats.with_noise(errors * cell.stats.count() as f64);
        }
        let found = sorted.segment();
        assert_eq!(found.regions.len(), 1, "rows of {in_row} points, {apart} m apart");
        assert!(count(&scene, &found, 0, None) < points / 100, "rows of {in_row} points, {apart} m apart");
    }
}

/// Errors are stated 40 % too small, and the table sags by two of them.
#[test]
fn a_bent_table_is_one_region() {
    let mut scene = Scene::new(7, SIGMA);
    let sag = |u: f64| 2.0 * SIGMA * (1.0 - (2.0 * u - 1.0).powi(2));
    scene.add(0, 20_000, |u, v| [2.0 * u + 0.013, v + 0.011, 0.317 - sag(u)]);
    let found = Sorted::of(&scene.points, EDGE, 0.6 * SIGMA).segment();
    let [table] = found.regions[..] else { panic!("{found:?}") };
    assert!(found.noise_scale > 1.5, "{}", found.noise_scale);
    assert!(count(&scene, &found, 0, None) < 50);
    // The bend is seen, and is far below that of a curved surface. The slope of a parabola is even from −4 h / w to 4 h / w.
    let bend = table.bend.unwrap();
    assert!(
        (bend.turn - 8.0 * SIGMA / 2.0 / 3_f64.sqrt()).abs() < 0.002 && bend.significance > 20.0,
        "{bend:?}"
    );
}

#[test]
fn errors_found_from_scatter_do_as_well_where_they_are_all_there_is() {
    let scene = box_corner(9, 20_000);
    let sorted = scene.cells(EDGE);
    let settings = Settings { errors_are_stated: false, ..Settings::default() };
    let found = segment(&sorted.cells, EDGE, sorted.points(), &settings).unwrap();
    assert_eq!(found.regions.len(), 3);
    assert!((1.0..1.05).contains(&found.noise_scale), "{}", found.noise_scale);
    assert!(wrong(&scene, &found) < 1000);
}

#[test]
fn sums_around_are_those_of_brute_force() {
    let cells = box_corner(8, 200).cells(4.0 * EDGE).cells;
    let sums = Field::of(&cells, 4.0 * EDGE).unwrap().sums_around(|place, sum| (place, *sum));
    for ((at, cell), (place, sum)) in cells.iter().enumerate().zip(sums) {
        assert_eq!(place, at);
        let touches = |key: &[i32; 3]| (0..3).all(|i| (key[i] - cell.key[i]).abs() <= 1);
        let near = cells.iter().filter(|other| touches(&other.key));
        assert_eq!(sum.count(), near.map(|other| other.stats.count()).sum::<u64>());
        assert_eq!(sum.anchor().map(f64::to_bits), cell.stats.anchor().map(f64::to_bits));
    }
}

#[test]
fn sums_around_several_are_those_around_each() {
    let cells = box_corner(8, 200).cells(4.0 * EDGE).cells;
    for count in [0, 1, 7, 8, 9, cells.len()] {
        let mut field = Field::of(&cells[..count], 4.0 * EDGE).unwrap();
        let each = field.sums_around(|place, sum| (place, *sum));
        let eights = field.sums_around_several(|places: [Option<usize>; 8], sums| {
            // What is of no cell is all behind the last.
            assert!(places.is_sorted_by_key(Option::is_none));
            std::array::from_fn(|at| places[at].map(|place| (place, sums[at])))
        });
        assert!(eights.eq(each.into_iter().map(Some)));
    }
}

#[test]
fn errors_that_are_told_later_are_those_of_the_cells() {
    let cells = box_corner(8, 200).cells(4.0 * EDGE).cells;
    let points = cells.iter().map(|cell| cell.stats.count()).sum();
    let bare: Vec<Cell> = cells
        .iter()
        .map(|cell| Cell { stats: cell.stats.with_noise(SymmetricMatrix3::ZERO), ..*cell })
        .collect();
    let mut known = Field::of(&cells, 4.0 * EDGE).unwrap();
    let mut told = Field::of(&bare, 4.0 * EDGE).unwrap();
    told.set_noise(|cell| cells[cell].stats.moments().noise()).unwrap();
    assert_eq!(told.sums_around(|_, sums| *sums), known.sums_around(|_, sums| *sums));
    let regions = |field| find(field, points, |_| Sample::EMPTY, &Settings::default()).unwrap().regions;
    let found = regions(told);
    assert_eq!(found.len(), 3);
    assert_eq!(found, regions(known));
    let mut strange = Field::of(&bare, 4.0 * EDGE).unwrap();
    let noise = |cell| SymmetricMatrix3::diagonal([if cell < 5 { 1e-4 } else { f64::NAN }; 3]);
    assert_eq!(strange.set_noise(noise), Err(RegionsError::Cell { cell: 5 }));
}
