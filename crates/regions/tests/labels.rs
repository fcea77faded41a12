//! What is told of labelled points, where cells hold far more of them than their samples.

#![allow(clippy::unwrap_used, reason = "tests")]

mod scenes;

use std::ops::Range;

use scenes::{Scene, Sorted, dot, rectangle};
use terrace_regions::{Field, Found, Measure, Samples, Settings, Tally, find};

const SIGMA: f64 = 0.01;
const EDGE: f64 = 0.06;

/// Three faces of a box, and some points around them.
fn corner(seed: u64) -> Scene {
    let mut scene = Scene::new(seed, SIGMA);
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for side in 0..3 {
        scene.add(side, 30_000, rectangle([0.013; 3], axes[(side + 1) % 3], axes[(side + 2) % 3]));
    }
    scene.add(3, 1000, |u, v| [u, v, (97.0 * (u + v)).fract()]);
    scene
}

fn found(sorted: &Sorted) -> Found {
    let mut samples = Samples::new(EDGE / f64::from(1 << 16));
    let mut packed = Vec::new();
    samples.pack(&sorted.places, &mut packed);
    samples.push_all(|point| sorted.cell_of[point], &packed);
    let field = Field::of(&sorted.cells, EDGE).unwrap();
    find(
        field,
        sorted.places.len() as u64,
        |cell| samples.sample(u32::try_from(cell).unwrap()),
        &Settings::default(),
    )
    .unwrap()
}

/// The labels of some points, in their order, and what they measure.
fn label(
    found: &Found,
    sorted: &Sorted,
    points: impl Iterator<Item = usize>,
) -> (Vec<Option<u32>>, Vec<Measure>) {
    let mut labels = Vec::new();
    let points = points.map(|at| (sorted.cell_of[at], sorted.places[at], ()));
    let measures = found.labeller.label_all(points, |(), label| labels.push(label));
    (labels, measures)
}

#[test]
fn points_measure_what_they_do_one_by_one() {
    for seed in 0..5 {
        let scene = corner(seed);
        let sorted = scene.cells(EDGE);
        let found = found(&sorted);
        let (labels, measures) = label(&found, &sorted, 0..sorted.places.len());
        let labelled = labels.iter().filter(|label| label.is_some()).count();
        assert!(found.regions.len() == 3 && labelled > 80_000, "{labelled}");
        for (number, (region, measure)) in found.regions.iter().zip(&measures).enumerate() {
            let own = scene
                .points
                .iter()
                .zip(&labels)
                .filter(|(_, label)| label.is_some_and(|label| label as usize == number));
            let own: Vec<[f64; 3]> = own.map(|(point, _)| *point).collect();
            let count = own.len() as f64;
            let off = |point: &[f64; 3]| dot(region.normal, [0, 1, 2].map(|i| point[i] - region.point[i]));
            let (mean, rms) = found.labeller.mean_and_rms(number, measure).unwrap();
            assert_eq!(measure.points, own.len() as u64);
            // Places are in single precision.
            assert!(
                (rms - (own.iter().map(|point| off(point).powi(2)).sum::<f64>() / count).sqrt()).abs() < 1e-7
            );
            for i in 0..3 {
                assert!((mean[i] - own.iter().map(|point| point[i]).sum::<f64>() / count).abs() < 1e-7);
            }
        }
        for (at, label) in labels.iter().enumerate() {
            let cell = sorted.cell_of[at].unwrap();
            assert_eq!(found.labeller.label(cell, sorted.places[at]), *label);
        }
    }
}

#[test]
fn neither_order_nor_parts_of_points_matter() {
    let sorted = corner(7).cells(EDGE);
    let found = found(&sorted);
    let all = sorted.places.len();
    let (labels, measures) = label(&found, &sorted, 0..all);
    let (mut backwards, of_last) = label(&found, &sorted, (all / 3..all).rev());
    let (first, mut sums) = label(&found, &sorted, (0..all / 3).rev());
    backwards.extend(first);
    backwards.reverse();
    sums.iter_mut().zip(&of_last).for_each(|(sum, more)| sum.add(more));
    assert_eq!((backwards, sums), (labels, measures));
}

#[test]
fn a_tally_that_was_taken_is_as_new() {
    let sorted = corner(9).cells(EDGE);
    let found = found(&sorted);
    let all = sorted.places.len();
    let mut tally = found.labeller.tally();
    let mut sums = vec![Measure::default(); found.regions.len()];
    let mut add = |tally: &mut Tally, range: Range<usize>| {
        let points = range.map(|at| (sorted.cell_of[at], sorted.places[at], ()));
        found.labeller.label_into(points, tally, |(), _| ());
        tally.take(|plane, measure| sums[plane as usize].add(&measure));
        tally.take(|plane, measure| panic!("{plane} {measure:?}"));
    };
    for range in [0..0, 0..all / 3, all / 3..all - 2000] {
        add(&mut tally, range);
    }
    // Of the last some take a point away from what their cell has of its plane, and are of none: each is all that there is to be taken.
    for at in all - 2000..all {
        add(&mut found.labeller.tally(), at..at + 1);
    }
    assert_eq!(sums, label(&found, &sorted, 0..all).1);
}

#[test]
fn points_are_told_by_parts_of_cells_as_by_cells() {
    let sorted = corner(10).cells(EDGE);
    let found = found(&sorted);
    // Two parts of each cell, the last cell first, and one part of none.
    let cells = u32::try_from(sorted.cells.len()).unwrap();
    let of = (0..2 * cells).map(|part| Some(cells - 1 - part / 2)).chain([None, Some(cells)]);
    let by_parts = found.labeller.clone().by_parts(of);
    for (at, (cell, place)) in sorted.cell_of.iter().zip(&sorted.places).enumerate() {
        let part = 2 * (cells - 1 - cell.unwrap()) + u32::from(at % 2 == 1);
        assert_eq!(by_parts.label(part, *place), found.labeller.label(cell.unwrap(), *place));
    }
    let points = || sorted.cell_of.iter().zip(&sorted.places);
    let parts = points().map(|(cell, place)| (Some(2 * (cells - 1 - cell.unwrap())), *place, ()));
    let whole = points().map(|(cell, place)| (*cell, *place, ()));
    let label = |(): (), _: Option<u32>| ();
    assert_eq!(by_parts.label_all(parts, label), found.labeller.label_all(whole, label));
    assert_eq!([2 * cells, 2 * cells + 1].map(|part| by_parts.label(part, [0.0; 3])), [None; 2]);
}

#[test]
fn points_of_no_cell_and_of_no_place_have_no_label() {
    let sorted = corner(8).cells(EDGE);
    let found = found(&sorted);
    let cell = sorted.cell_of[0];
    let strange = [
        (None, [0.0; 3], ()),
        (Some(u32::MAX), [0.0; 3], ()),
        (cell, [f32::NAN; 3], ()),
        (cell, [f32::INFINITY; 3], ()),
    ];
    let mut labels = Vec::new();
    let measures = found.labeller.label_all(strange.into_iter(), |(), label| labels.push(label));
    assert_eq!((labels, measures.iter().map(|of| of.points).sum::<u64>()), (vec![None; 4], 0));
}
