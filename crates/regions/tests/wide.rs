//! Cells of twice the edge beside others.

#![allow(clippy::unwrap_used, reason = "tests")]

mod scenes;

use scenes::{Scene, Sorted, dot, rectangle};
use terrace_regions::{Cell, Field, PartOf, RegionsError, Sample, Samples, Settings, find};

const SIGMA: f64 = 0.01;
const EDGE: f64 = 0.03;
/// What samples keep places in, in metres: 2⁻¹³.
const KEPT: f32 = 1.0 / 8192.0;

fn corner(seed: u64) -> Scene {
    let mut scene = Scene::new(seed, SIGMA);
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for side in 0..3 {
        scene.add(side, 6000, rectangle([0.013, 0.021, 0.017], axes[(side + 1) % 3], axes[(side + 2) % 3]));
    }
    scene
}

fn with(scene: &Scene, is_wide: impl Fn([i32; 3]) -> bool) -> Sorted {
    Sorted::of_some_wide(&scene.points, EDGE, SIGMA, is_wide)
}

#[test]
fn planes_go_on_from_cells_to_wide_ones() {
    for seed in 0..5 {
        let scene = corner(seed);
        let narrow = with(&scene, |_| false).segment();
        // Half of each face, in steps, a part that is chequered, and all.
        let ways: [fn([i32; 3]) -> bool; 3] =
            [|[x, y, z]| x + y + z < 16, |[x, y, z]| (x + y + z) % 2 == 0, |_| true];
        for is_wide in ways {
            let sorted = with(&scene, is_wide);
            assert!(sorted.cells.iter().any(|cell| cell.is_wide));
            let found = sorted.segment();
            assert_eq!(found.regions.len(), 3, "{found:?}");
            for region in &found.regions {
                let same = narrow.regions.iter().find(|r| dot(r.normal, region.normal).abs() > 0.99).unwrap();
                assert!((region.area / same.area - 1.0).abs() < 0.12, "{region:?} {same:?}");
                assert!(
                    (region.points as f64 / same.points as f64 - 1.0).abs() < 0.01,
                    "{region:?} {same:?}"
                );
            }
            let axis = |label: u32, found: &[terrace_regions::Region]| {
                let normal = found[label as usize].normal;
                (0..3).max_by(|a, b| normal[*a].abs().total_cmp(&normal[*b].abs())).unwrap()
            };
            let right = |found: &terrace_regions::Segmentation| {
                let labels = scene.truth.iter().zip(&found.labels);
                labels.filter(|(of, label)| label.is_some_and(|l| axis(l, &found.regions) == **of)).count()
            };
            assert!(right(&found) + 60 > right(&narrow), "{} {}", right(&found), right(&narrow));
        }
    }
}

#[test]
fn points_of_wide_cells_are_counted_by_all_samples_of_their_parts() {
    for (seed, are_rounded) in (0..5).flat_map(|seed| [(seed, true), (seed, false)]) {
        let scene = corner(seed);
        let (narrow, mut wide) = (with(&scene, |_| false), with(&scene, |_| true));
        if are_rounded {
            wide.places.iter_mut().flatten().for_each(|x| *x = (*x / KEPT).round() * KEPT);
        }
        // Where points are in their wide cell, sampled by narrow one.
        let mut samples = Samples::new(f64::from(KEPT) / 128.0);
        let mut parts: Vec<PartOf> = Vec::new();
        for ((part, whole), place) in narrow.cell_of.iter().zip(&wide.cell_of).zip(&wide.places) {
            let (part, whole) = (part.unwrap(), whole.unwrap());
            samples.push(part, *place);
            match parts.iter_mut().find(|known| known.part == part) {
                Some(known) => known.points += 1,
                None => parts.push(PartOf { whole, part, points: 1 }),
            }
        }
        let together = samples.together(parts);
        let mut alone = Samples::new(f64::from(KEPT) / 128.0);
        wide.cell_of.iter().zip(&wide.places).for_each(|(cell, place)| alone.push(cell.unwrap(), *place));
        // No part has more points than its sample beside another plane, though most cells have: then only those are counted wrong that
        // samples know to be on the other side.
        let by_parts = miscounted(&wide, |cell| together.sample(cell));
        let by_cells = miscounted(&wide, |cell| alone.sample(cell));
        assert!(by_parts <= if are_rounded { 0 } else { 6 } && by_cells > 9, "{by_parts} {by_cells}");
    }
}

/// By how many points the three planes of a corner are counted wrong.
fn miscounted<'s>(sorted: &Sorted, sample: impl Fn(u32) -> Sample<'s> + Sync) -> u64 {
    let field = Field::of(&sorted.cells, EDGE).unwrap();
    let of_cell = |cell: usize| sample(u32::try_from(cell).unwrap());
    let found = find(field, sorted.places.len() as u64, of_cell, &Settings::default()).unwrap();
    assert_eq!(found.regions.len(), 3);
    let points = sorted.cell_of.iter().zip(&sorted.places).map(|(cell, place)| (*cell, *place, ()));
    let measures = found.labeller.label_all(points, |(), _| ());
    found.regions.iter().zip(measures).map(|(region, measure)| region.points.abs_diff(measure.points)).sum()
}

#[test]
fn a_plane_is_three_of_its_cells_wide() {
    let mut scene = Scene::new(3, SIGMA);
    scene.add(0, 3000, rectangle([0.2, -0.3, 0.107], [1.6, 0.0, 0.0], [0.0, 0.13, 0.0]));
    assert_eq!(with(&scene, |_| false).segment().regions.len(), 1);
    assert_eq!(with(&scene, |_| true).segment().regions.len(), 0);
}

#[test]
fn a_wide_cell_is_alone_in_its_place() {
    let sorted = with(&corner(0), |_| false);
    let cells: Vec<Cell> =
        sorted.cells.iter().filter(|cell| cell.key.map(|k| k >> 1) == [0, 3, 4]).copied().collect();
    assert!(cells.len() > 1);
    for wide in 0..cells.len() {
        let mut cells = cells.clone();
        cells[wide].is_wide = true;
        let refused = Field::of(&cells, EDGE).unwrap_err();
        assert!(
            matches!(refused, RegionsError::SameKey { cells: all, .. } if all == cells.len()),
            "{refused}"
        );
        assert!(Field::of(&cells[wide..=wide], EDGE).is_ok());
    }
}
