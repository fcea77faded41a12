//! The paper's rule of assignment against a reference that keeps every point and looks at every cell.

// A test has no caller to report to; coordinates are small.
#![allow(clippy::unwrap_used, clippy::cast_possible_truncation)]

use proptest::prelude::*;
use terrace_grid::{Assignment, VoxelGrid, VoxelKey};
use terrace_stats::UncertainVector;

/// Cells with all their points.
#[derive(Default)]
struct Reference {
    cells: Vec<(VoxelKey, Vec<UncertainVector>)>,
}

fn squared(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum()
}

/// Eq. (2) with everything relative to the point, so that nothing cancels.
fn expected_squared_distance(p: &UncertainVector, cell: &[UncertainVector]) -> f64 {
    let n = cell.len() as f64;
    let to_mean = [0, 1, 2].map(|i| cell.iter().map(|q| q.value[i] - p.value[i]).sum::<f64>() / n);
    let errors: f64 = cell.iter().map(|q| squared(q.error)).sum();
    squared(to_mean) + squared(p.error) + errors / (n * n)
}

fn voxel(p: &UncertainVector, size: f64) -> VoxelKey {
    p.value.map(|x| (x / size).floor() as i32)
}

impl Reference {
    /// The cells `p` may join, with their distances: its own alone when that is new, else all around it.
    fn candidates(&self, p: &UncertainVector, own: VoxelKey) -> Vec<(f64, VoxelKey)> {
        if self.cells.iter().all(|(key, _)| *key != own) {
            return vec![(0.0, own)];
        }
        let around = |key: &VoxelKey| (0..3).all(|i| (key[i] - own[i]).abs() <= 1);
        let near = self.cells.iter().filter(|(key, _)| around(key));
        near.map(|(key, cell)| (expected_squared_distance(p, cell), *key)).collect()
    }

    fn add(&mut self, p: UncertainVector, to: VoxelKey) {
        match self.cells.iter_mut().find(|(key, _)| *key == to) {
            Some((_, cell)) => cell.push(p),
            None => self.cells.push((to, vec![p])),
        }
    }
}

fn point() -> impl Strategy<Value = UncertainVector> {
    (prop::array::uniform3(-1.0..1.0), prop::array::uniform3(0.0..0.4))
        .prop_map(|(value, error)| UncertainVector { value, error })
}

proptest! {
    #[test]
    fn each_point_joins_the_cell_that_brute_force_chooses(
        points in prop::collection::vec(point(), 1..120), size in 0.2..0.8,
    ) {
        let mut grid = VoxelGrid::new(size, Assignment::ExpectedDistance).unwrap();
        let mut reference = Reference::default();
        for p in points {
            let candidates = reference.candidates(&p, voxel(&p, size));
            let id = grid.insert(&p).unwrap();
            let chosen = grid.get(id).unwrap().key();
            let least = candidates.iter().map(|(d, _)| *d).fold(f64::INFINITY, f64::min);
            // Cells that differ by less than rounding are equally right.
            let right: Vec<_> = candidates.iter().filter(|(d, _)| *d <= least + 1e-13).map(|(_, key)| *key).collect();
            prop_assert!(right.contains(&chosen), "{chosen:?} instead of {right:?}");
            reference.add(p, chosen);
        }
        prop_assert_eq!(grid.len(), reference.cells.len());
        for (key, cell) in &reference.cells {
            let found = grid.find(*key).unwrap();
            prop_assert_eq!(found.density(), cell.len() as u64);
            let mean = found.stats().mean().unwrap();
            let expected = [0, 1, 2].map(|i| cell.iter().map(|p| p.value[i]).sum::<f64>() / cell.len() as f64);
            prop_assert!((0..3).all(|i| (mean[i] - expected[i]).abs() < 1e-13));
        }
    }
}

fn insert(grid: &mut VoxelGrid, p: [f64; 3], sigma: f64) -> VoxelKey {
    let id = grid.insert(&UncertainVector::isotropic(p, sigma)).unwrap();
    grid.get(id).unwrap().key()
}

fn paper() -> VoxelGrid {
    VoxelGrid::new(1.0, Assignment::ExpectedDistance).unwrap()
}

#[test]
fn a_point_in_an_empty_voxel_founds_a_cell_however_near_another_is() {
    let mut grid = paper();
    assert_eq!(insert(&mut grid, [0.99, 0.5, 0.5], 0.0), [0, 0, 0]);
    assert_eq!(insert(&mut grid, [1.01, 0.5, 0.5], 0.0), [1, 0, 0]);
}

#[test]
fn a_point_joins_the_nearer_centre_of_the_next_voxel() {
    let mut grid = paper();
    insert(&mut grid, [0.1, 0.5, 0.5], 0.0);
    insert(&mut grid, [1.1, 0.5, 0.5], 0.0);
    assert_eq!(insert(&mut grid, [0.9, 0.5, 0.5], 0.0), [1, 0, 0]);
    assert_eq!(grid.find([1, 0, 0]).unwrap().density(), 2);
    // By now the centre of the second cell is at 1.0.
    assert_eq!(insert(&mut grid, [0.5, 0.5, 0.5], 0.0), [0, 0, 0]);
}

#[test]
fn an_uncertain_centre_is_further_away() {
    let mut grid = paper();
    insert(&mut grid, [0.1, 0.5, 0.5], 0.0);
    insert(&mut grid, [1.1, 0.5, 0.5], 1.0);
    // 0.8² + 0 against 0.2² + 3·1².
    assert_eq!(insert(&mut grid, [0.9, 0.5, 0.5], 0.0), [0, 0, 0]);
}

#[test]
fn two_voxels_away_no_cell_is_looked_at() {
    for axis in 0..3 {
        for (near_the_face, beyond) in [(0.99, 2.0), (0.01, -1.01)] {
            let along = |x: f64| [0, 1, 2].map(|i| if i == axis { x } else { 0.5 });
            let mut grid = paper();
            insert(&mut grid, along(0.5), 10.0);
            insert(&mut grid, along(beyond), 0.0);
            assert_eq!(insert(&mut grid, along(near_the_face), 0.0), [0, 0, 0]);
        }
    }
}

#[test]
fn all_26_neighbours_are_looked_at() {
    for dx in -1..=1 {
        for dy in -1..=1 {
            for dz in -1..=1 {
                let mut grid = paper();
                let towards = |s: f64| [dx, dy, dz].map(|d| 0.5 + s * f64::from(d));
                // Its own centre is at the far end of the voxel, the neighbour's close beyond the face.
                insert(&mut grid, towards(-0.49), 0.0);
                insert(&mut grid, towards(0.51), 0.0);
                assert_eq!(insert(&mut grid, towards(0.4), 0.0), [dx, dy, dz]);
            }
        }
    }
}

#[test]
fn ties_go_to_the_own_voxel_then_to_the_smaller_key() {
    // Distances of 0.5 either way, written without rounding; the other key is larger, then smaller.
    for (own, other, between) in [(0.25, 1.25, 0.75), (0.75, -0.25, 0.25)] {
        let mut grid = paper();
        insert(&mut grid, [other, 0.5, 0.5], 0.0);
        insert(&mut grid, [own, 0.5, 0.5], 0.0);
        assert_eq!(insert(&mut grid, [between, 0.5, 0.5], 0.0), [0, 0, 0]);
    }
    // Its own centre is too uncertain: the neighbours below and above are equally near.
    let mut grid = paper();
    insert(&mut grid, [0.375, 0.75, 0.5], 9.0);
    insert(&mut grid, [1.0, 0.75, 0.5], 0.0);
    insert(&mut grid, [-0.25, 0.75, 0.5], 0.0);
    assert_eq!(insert(&mut grid, [0.375, 0.75, 0.5], 0.0), [-1, 0, 0]);
}

#[test]
fn the_order_of_points_matters() {
    let points = [[0.1, 0.5, 0.5], [0.9, 0.5, 0.5], [1.1, 0.5, 0.5]];
    let density = |order: [usize; 3]| {
        let mut grid = paper();
        for i in order {
            insert(&mut grid, points[i], 0.0);
        }
        grid.find([0; 3]).unwrap().density()
    };
    assert_eq!([density([0, 1, 2]), density([0, 2, 1])], [2, 1]);
}
