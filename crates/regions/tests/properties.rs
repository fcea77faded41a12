//! What must hold for any rectangles.

#![allow(clippy::unwrap_used, reason = "tests")]

mod scenes;

use std::collections::BTreeMap;

use proptest::prelude::*;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use scenes::{Scene, Sorted, dot, rectangle};
use terrace_regions::{Segmentation, Settings};
use terrace_stats::Stats;

const SIGMA: f64 = 0.01;
/// A power of two, so that places of cells are exact.
const EDGE: f64 = 1.0 / 32.0;

/// A parallelogram by a corner and two sides, with so many points.
#[derive(Debug, Clone)]
struct Face {
    corner: [f64; 3],
    sides: [[f64; 3]; 2],
    points: usize,
}

/// Up to four of them, which may pass through each other, and points all over.
#[derive(Debug, Clone)]
struct Drawn {
    seed: u64,
    faces: Vec<Face>,
    anywhere: usize,
}

impl Drawn {
    fn scene(&self) -> Scene {
        let mut scene = Scene::new(self.seed, SIGMA);
        for (of, Face { corner, sides: [u, v], points }) in self.faces.iter().enumerate() {
            scene.add(of, *points, rectangle(*corner, *u, *v));
        }
        let height = |u: f64, v: f64| 3.0 * (97.0 * (u + v)).fract() - 1.5;
        scene.add(9, self.anywhere, |u, v| [4.0 * u - 2.0, 4.0 * v - 2.0, height(u, v)]);
        scene
    }
}

fn faces() -> impl Strategy<Value = Drawn> {
    let place = || prop::array::uniform3(-1.0..1.0_f64);
    let sides = [place(), place()].prop_filter("a surface", |[u, v]| {
        let (uu, uv, vv) = (dot(*u, *u), dot(*u, *v), dot(*v, *v));
        uu * vv - uv * uv > 0.2
    });
    let face =
        (place(), sides, 1500..5000_usize).prop_map(|(corner, sides, points)| Face { corner, sides, points });
    (any::<u64>(), prop::collection::vec(face, 1..5), 0..500_usize)
        .prop_map(|(seed, faces, anywhere)| Drawn { seed, faces, anywhere })
}

fn on_threads(threads: usize, sorted: &Sorted) -> Segmentation {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| sorted.segment())
}

/// Numbers from 0 in any order.
fn any_order(random: &mut ChaCha8Rng, length: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..length).collect();
    for last in (1..length).rev() {
        order.swap(last, random.random_range(0..=last));
    }
    order
}

/// The labels as sets of points.
fn partition(labels: &[Option<u32>]) -> Vec<Vec<usize>> {
    let mut sets: BTreeMap<Option<u32>, Vec<usize>> = BTreeMap::new();
    for (point, label) in labels.iter().enumerate() {
        sets.entry(*label).or_default().push(point);
    }
    let mut sets: Vec<Vec<usize>> = sets.into_values().collect();
    sets.sort_unstable();
    sets
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn regions_shares_and_labels_agree(faces in faces()) {
        let scene = faces.scene();
        let sorted = scene.cells(EDGE);
        let found = sorted.segment();
        prop_assert_eq!(found.labels.len(), scene.points.len());
        prop_assert!(found.regions.is_sorted_by(|a, b| a.points >= b.points));
        let mut shares: BTreeMap<(u32, u32), u32> = BTreeMap::new();
        for (cell, label) in sorted.cell_of.iter().zip(&found.labels) {
            if let (Some(cell), Some(label)) = (cell, label) {
                *shares.entry((*cell, *label)).or_default() += 1;
            }
        }
        let told: BTreeMap<(u32, u32), u32> =
            found.shares.iter().map(|share| ((share.cell, share.region), share.points)).collect();
        prop_assert!(found.shares.is_sorted_by_key(|share| share.cell) && told.len() == found.shares.len());
        prop_assert_eq!(told, shares);

        let reach = Settings::default().reach;
        // What a point is known to at least: a twentieth of two edges.
        let stated = (found.noise_scale * SIGMA * SIGMA).max((0.05 * 2.0 * EDGE).powi(2));
        for (number, region) in (0..).zip(&found.regions) {
            let own: Vec<[f64; 3]> = scene.points.iter().zip(&found.labels)
                .filter(|(_, label)| **label == Some(number)).map(|(point, _)| *point).collect();
            prop_assert_eq!(own.len() as u64, region.points);
            prop_assert!(region.points as f64 >= found.min_points && region.area >= found.min_area);
            prop_assert!(region.tilt <= Settings::default().tilt);
            prop_assert!((dot(region.normal, region.normal) - 1.0).abs() < 1e-12);
            let off = |point: &[f64; 3]| dot(region.normal, [0, 1, 2].map(|i| point[i] - region.point[i]));
            let errors = (stated * region.reduced_chi_squared.max(1.0 / found.noise_scale)).sqrt();
            let farthest = own.iter().map(|point| off(point).abs()).fold(0.0, f64::max);
            // Places are told in single precision.
            prop_assert!(farthest <= reach * errors + 1e-7, "{} {:?}", farthest / errors, region);
            let squares = own.iter().map(|point| off(point).powi(2)).sum::<f64>() / own.len() as f64;
            prop_assert!((region.rms - squares.sqrt()).abs() < 1e-7);
            for i in 0..3 {
                let mean = own.iter().map(|point| point[i]).sum::<f64>() / own.len() as f64;
                prop_assert!((region.centroid[i] - mean).abs() < 1e-7);
            }
        }
        for a in 0..found.regions.len() {
            for b in 0..a {
                let (a, b) = (&found.regions[a], &found.regions[b]);
                prop_assert!(a.surface != b.surface || (a.normal, a.point) == (b.normal, b.point));
            }
        }
    }

    #[test]
    fn threads_do_not_change_a_bit(faces in faces()) {
        let sorted = faces.scene().cells(EDGE);
        prop_assert_eq!(format!("{:?}", on_threads(1, &sorted)), format!("{:?}", on_threads(4, &sorted)));
    }

    /// But for the last bits, which a label near equal probabilities may turn on: none does here.
    #[test]
    fn the_order_of_cells_and_points_does_not_matter(faces in faces(), seed in any::<u64>()) {
        let sorted = faces.scene().cells(EDGE);
        let found = sorted.segment();
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let (cells, points) =
            (any_order(&mut random, sorted.cells.len()), any_order(&mut random, sorted.places.len()));
        let mut place_of = vec![0_u32; cells.len()];
        for (place, cell) in (0..).zip(&cells) {
            place_of[*cell] = place;
        }
        let other = Sorted {
            edge: EDGE,
            cells: cells.iter().map(|cell| sorted.cells[*cell]).collect(),
            cell_of: points.iter().map(|at| sorted.cell_of[*at].map(|cell| place_of[cell as usize])).collect(),
            places: points.iter().map(|point| sorted.places[*point]).collect(),
        };
        let mut labels = vec![None; points.len()];
        for (point, label) in points.iter().zip(other.segment().labels) {
            labels[*point] = label;
        }
        prop_assert_eq!(partition(&labels), partition(&found.labels));
    }

    /// By the largest groups of cells: those are where they were.
    #[test]
    fn blocks_of_eight_cells_are_the_same_anywhere(faces in faces(), by in prop::array::uniform3(-500..500_i32)) {
        let sorted = faces.scene().cells(EDGE);
        let found = sorted.segment();
        let mut moved = sorted.clone();
        for cell in &mut moved.cells {
            let anchor = [0, 1, 2].map(|i| cell.stats.anchor()[i] + 8.0 * EDGE * f64::from(by[i]));
            cell.stats = Stats::from_moments(anchor, *cell.stats.moments());
            cell.key = [0, 1, 2].map(|i| cell.key[i] + 8 * by[i]);
        }
        let moved = moved.segment();
        prop_assert_eq!(&moved.labels, &found.labels);
        prop_assert_eq!(&moved.shares, &found.shares);
        for (moved, found) in moved.regions.iter().zip(&found.regions) {
            prop_assert!((dot(moved.normal, found.normal).abs() - 1.0).abs() < 1e-12);
            prop_assert!((moved.rms - found.rms).abs() < 1e-9);
        }
    }
}
