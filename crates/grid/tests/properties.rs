//! Cells, graphs and neighbourhoods against brute force.

// Keys and counts are exact; a test has no caller to report to.
#![allow(clippy::float_cmp, clippy::unwrap_used, clippy::cast_possible_truncation)]

use std::collections::{BTreeMap, BTreeSet};

use proptest::prelude::*;
use terrace_grid::{Assignment, Cell, Connectivity, DenseCells, VoxelGrid, VoxelKey, Walk};
use terrace_stats::{Stats, UncertainVector};

const CONNECTIVITIES: [(Connectivity, i32); 3] =
    [(Connectivity::Faces, 1), (Connectivity::Edges, 2), (Connectivity::Corners, 3)];

fn point() -> impl Strategy<Value = UncertainVector> {
    (prop::array::uniform3(-2.0..2.0), prop::array::uniform3(0.0..0.1))
        .prop_map(|(value, error)| UncertainVector { value, error })
}

fn points(most: usize) -> impl Strategy<Value = Vec<UncertainVector>> {
    prop::collection::vec(point(), 0..most)
}

/// How often each of some cells of a small box is hit.
fn hits() -> impl Strategy<Value = Vec<VoxelKey>> {
    prop::collection::vec([-3i32..4, -2i32..3, -3i32..3], 0..160)
}

fn grid_of(size: f64, points: &[UncertainVector]) -> VoxelGrid {
    let mut grid = VoxelGrid::new(size, Assignment::Voxel).unwrap();
    for p in points {
        grid.insert(p).unwrap();
    }
    grid
}

fn grid_with(keys: &[VoxelKey]) -> VoxelGrid {
    let centre = |key: &VoxelKey| UncertainVector::exact(key.map(|k| f64::from(k) + 0.5));
    grid_of(1.0, &keys.iter().map(centre).collect::<Vec<_>>())
}

fn keys(grid: &VoxelGrid) -> Vec<VoxelKey> {
    grid.iter().map(|cell| cell.key()).collect()
}

fn dense_keys(grid: &VoxelGrid, dense: &DenseCells) -> Vec<VoxelKey> {
    dense.cells().iter().map(|id| grid.get(*id).unwrap().key()).collect()
}

fn connected(a: VoxelKey, b: VoxelKey, reach: i32) -> bool {
    let steps = [0, 1, 2].map(|i| (a[i] - b[i]).abs());
    steps.iter().all(|s| *s <= 1) && (1..=reach).contains(&steps.iter().sum())
}

/// The same cells with the same counts, and sums to rounding. Points are within 4 m of the anchors.
fn alike(a: &VoxelGrid, b: &VoxelGrid) -> Result<(), TestCaseError> {
    let counts = |grid: &VoxelGrid| grid.iter().map(|c| (c.key(), c.density())).collect::<Vec<_>>();
    prop_assert_eq!(counts(a), counts(b));
    for (a, b) in a.iter().zip(b.iter()) {
        same_stats(&a.stats(), &b.stats())?;
    }
    Ok(())
}

fn same_stats(a: &Stats, b: &Stats) -> Result<(), TestCaseError> {
    prop_assert_eq!(a.anchor(), b.anchor());
    let (a, b) = (a.moments(), b.moments());
    prop_assert!((a.weight() - b.weight()).abs() < 1e-11);
    for i in 0..3 {
        prop_assert!((a.sum()[i] - b.sum()[i]).abs() < 1e-11);
        prop_assert!((a.error()[i] - b.error()[i]).abs() < 1e-11);
    }
    prop_assert!((0..6).all(|i| (a.second().0[i] - b.second().0[i]).abs() < 1e-11));
    Ok(())
}

proptest! {
    #[test]
    fn each_point_is_in_the_voxel_of_its_floor(points in points(100), size in 0.05..3.0) {
        let mut grid = VoxelGrid::new(size, Assignment::Voxel).unwrap();
        let mut expected: BTreeMap<VoxelKey, Stats> = BTreeMap::new();
        for p in &points {
            let key = p.value.map(|x| (x / size).floor() as i32);
            let id = grid.insert(p).unwrap();
            prop_assert_eq!(grid.get(id).unwrap().key(), key);
            let centre = key.map(|k| (f64::from(k) + 0.5) * size);
            prop_assert!((0..3).all(|i| (p.value[i] - centre[i]).abs() <= size * 0.500_001));
            expected.entry(key).or_insert(Stats::new(centre)).push(p);
        }
        prop_assert_eq!(grid.len(), expected.len());
        for (cell, (key, stats)) in grid.iter().zip(&expected) {
            prop_assert_eq!(cell.key(), *key);
            prop_assert_eq!(cell.density(), stats.count());
            same_stats(&cell.stats(), stats)?;
            prop_assert_eq!(grid.find(*key).map(|c| c.id()), Some(cell.id()));
        }
    }

    /// Faces at multiples of a power of two, where division is exact: they belong to the voxel above.
    #[test]
    fn a_point_on_a_face_is_in_the_voxel_above(
        key in prop::array::uniform3(-1000i32..1000), power in -8i32..9, below in prop::array::uniform3(any::<bool>()),
    ) {
        let size = 2f64.powi(power);
        let face = key.map(|k| f64::from(k) * size);
        let mut grid = VoxelGrid::new(size, Assignment::Voxel).unwrap();
        grid.insert(&UncertainVector::exact(face)).unwrap();
        prop_assert_eq!(keys(&grid), [key]);
        let just_below = |x: f64| if x == 0.0 { -f64::MIN_POSITIVE } else { x.next_down() };
        let p = [0, 1, 2].map(|i| if below[i] { just_below(face[i]) } else { face[i] });
        let id = grid.insert(&UncertainVector::exact(p)).unwrap();
        let expected = [0, 1, 2].map(|i| if below[i] { key[i] - 1 } else { key[i] });
        prop_assert_eq!(grid.get(id).unwrap().key(), expected);
    }

    #[test]
    fn the_order_of_points_does_not_matter(points in points(200).prop_shuffle(), size in 0.2..2.0) {
        let mut sorted = points.clone();
        sorted.sort_by(|a, b| a.value[2].total_cmp(&b.value[2]));
        let (a, b) = (grid_of(size, &points), grid_of(size, &sorted));
        alike(&a, &b)?;
        for tau in [0, 1, 3] {
            let (c, d) = (a.dense(tau, Connectivity::Corners), b.dense(tau, Connectivity::Corners));
            prop_assert_eq!(dense_keys(&a, &c), dense_keys(&b, &d));
            prop_assert!((0..c.len()).all(|node| c.neighbours(node) == d.neighbours(node)));
        }
    }

    #[test]
    fn the_same_order_gives_the_same_bits(points in points(100), size in 0.2..2.0) {
        let bits = |grid: &VoxelGrid| grid.iter().map(|c| (c.key(), *c.stats().moments())).collect::<Vec<_>>();
        prop_assert_eq!(bits(&grid_of(size, &points)), bits(&grid_of(size, &points)));
    }

    #[test]
    fn parts_merge_into_the_whole(
        points in points(200), parts in prop::collection::vec(0usize..3, 200), size in 0.2..2.0,
    ) {
        let part = |n: usize| -> Vec<_> {
            points.iter().zip(&parts).filter(|(_, part)| **part == n).map(|(p, _)| *p).collect()
        };
        let [a, b, c] = [0, 1, 2].map(|n| grid_of(size, &part(n)));
        let whole = grid_of(size, &points);
        let merged = |order: [&VoxelGrid; 3]| {
            let mut grid = order[0].clone();
            grid.merge(order[1]).unwrap();
            grid.merge(order[2]).unwrap();
            grid
        };
        alike(&merged([&a, &b, &c]), &whole)?;
        alike(&merged([&c, &a, &b]), &whole)?;
        // And a grid merged into goes on growing.
        let mut grown = merged([&a, &b, &c]);
        for p in &points {
            grown.insert(p).unwrap();
        }
        alike(&grown, &grid_of(size, &[points.clone(), points].concat()))?;
    }

    #[test]
    fn identities_stay_as_the_grid_grows(points in points(100)) {
        let mut grid = VoxelGrid::new(0.7, Assignment::Voxel).unwrap();
        let mut known: BTreeMap<VoxelKey, _> = BTreeMap::new();
        for p in &points {
            let founded = grid.len();
            let id = grid.insert(p).unwrap();
            let key = grid.get(id).unwrap().key();
            if grid.len() > founded {
                prop_assert_eq!(id.index(), founded);
            }
            prop_assert_eq!(*known.entry(key).or_insert(id), id);
        }
        grid.merge(&grid_of(0.7, &points.iter().map(UncertainVector::flipped).collect::<Vec<_>>())).unwrap();
        prop_assert!(known.iter().all(|(key, id)| grid.find(*key).unwrap().id() == *id));
    }

    #[test]
    fn cells_and_nodes_are_in_the_order_of_keys(hits in hits(), tau in 0u64..4) {
        let grid = grid_with(&hits);
        let distinct: BTreeSet<_> = hits.iter().copied().collect();
        prop_assert_eq!(keys(&grid), distinct.iter().copied().collect::<Vec<_>>());
        let count = |key: &VoxelKey| hits.iter().filter(|hit| *hit == key).count() as u64;
        let expected: Vec<_> = distinct.into_iter().filter(|key| count(key) >= tau).collect();
        prop_assert_eq!(dense_keys(&grid, &grid.dense(tau, Connectivity::Faces)), expected);
    }

    #[test]
    fn connections_are_those_of_brute_force(hits in hits(), tau in 1u64..3) {
        let grid = grid_with(&hits);
        for (connectivity, reach) in CONNECTIVITIES {
            let dense = grid.dense(tau, connectivity);
            let keys = dense_keys(&grid, &dense);
            for (node, key) in keys.iter().enumerate() {
                let expected: Vec<_> =
                    (0u32..).zip(&keys).filter(|(_, other)| connected(*key, **other, reach)).map(|(n, _)| n).collect();
                // Equal as lists, so neighbours are in rising order as well.
                prop_assert_eq!(dense.neighbours(node), expected);
                prop_assert!(dense.neighbours(node).len() <= connectivity.neighbours() as usize);
            }
        }
    }

    #[test]
    fn neighbourhoods_are_those_of_brute_force(hits in hits(), tau in 1u64..3) {
        let grid = grid_with(&hits);
        // One for all, of graphs that differ: nothing of an earlier walk may be left.
        let mut walk = Walk::default();
        for (connectivity, reach) in CONNECTIVITIES {
            let dense = grid.dense(tau, connectivity);
            let keys = dense_keys(&grid, &dense);
            for node in 0..keys.len() {
                let mut distance = BTreeMap::from([(node as u32, 0)]);
                for depth in 0..=4u32 {
                    let found = walk.neighbourhood(&dense, node, depth).to_vec();
                    let steps: Vec<u32> = found.iter().map(|n| distance.get(n).copied().unwrap_or(u32::MAX)).collect();
                    prop_assert_eq!(found[0], node as u32);
                    prop_assert!(steps.is_sorted(), "nearest first: {:?}", steps);
                    prop_assert_eq!(found.len(), distance.len());
                    prop_assert_eq!(found.into_iter().collect::<BTreeSet<_>>(), distance.keys().copied().collect());
                    // All that touch what was reached so far, by looking at every pair.
                    let next: Vec<_> = (0..keys.len() as u32)
                        .filter(|n| distance.keys().any(|m| connected(keys[*m as usize], keys[*n as usize], reach)))
                        .collect();
                    for n in next {
                        distance.entry(n).or_insert(depth + 1);
                    }
                }
            }
        }
    }

    #[test]
    fn a_grid_at_map_coordinates_is_as_good_as_one_at_the_origin(points in points(100)) {
        // A multiple of the cell, and of what both can write down: cells are the same, 10⁷ m away.
        let far = 1e7;
        let coarse = |x: f64| (x * 1_048_576.0).round() / 1_048_576.0;
        let near: Vec<_> = points.iter().map(|p| UncertainVector { value: p.value.map(coarse), ..*p }).collect();
        let moved: Vec<_> = near.iter().map(|p| UncertainVector { value: p.value.map(|x| x + far), ..*p }).collect();
        let (near, moved) = (grid_of(0.5, &near), grid_of(0.5, &moved));
        prop_assert_eq!(near.len(), moved.len());
        for (a, b) in near.iter().zip(moved.iter()) {
            prop_assert_eq!(a.key().map(|k| k + 20_000_000), b.key());
            prop_assert_eq!(*a.stats().moments(), *b.stats().moments());
        }
    }

    #[test]
    fn weights_reach_the_cells(points in points(60), weight in 0.5..100.0) {
        let mut grid = VoxelGrid::new(1.0, Assignment::Voxel).unwrap();
        let mut expected: BTreeMap<VoxelKey, Stats> = BTreeMap::new();
        for p in &points {
            let id = grid.insert_weighted(p, weight).unwrap();
            let cell: Cell = grid.get(id).unwrap();
            expected.entry(cell.key()).or_insert(Stats::new(cell.centre())).push_weighted(p, weight);
        }
        for (cell, stats) in grid.iter().zip(expected.values()) {
            prop_assert_eq!(&cell.stats(), stats);
        }
    }
}
