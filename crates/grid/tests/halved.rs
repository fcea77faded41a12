//! Grids of half the resolution against grids of the points.

// A test has no caller to report to.
#![allow(clippy::unwrap_used)]

use proptest::prelude::*;
use terrace_grid::{Assignment, GridError, MAX_CELL_SIZE, MAX_INDEX, VoxelGrid};
use terrace_stats::{SymmetricMatrix3, UncertainVector};

fn grid_of(size: f64, points: &[UncertainVector]) -> VoxelGrid {
    let mut grid = VoxelGrid::new(size, Assignment::Voxel).unwrap();
    for p in points {
        grid.insert(p).unwrap();
    }
    grid
}

fn point() -> impl Strategy<Value = UncertainVector> {
    let coordinate = prop_oneof![-3.0..3.0, (-6i32..6).prop_map(|k| 0.5 * f64::from(k))];
    (prop::array::uniform3(coordinate), prop::array::uniform3(0.0..0.1))
        .prop_map(|(value, error)| UncertainVector { value, error })
}

fn close(a: SymmetricMatrix3, b: SymmetricMatrix3) -> bool {
    (0..6).all(|i| (a.0[i] - b.0[i]).abs() < 1e-11)
}

proptest! {
    #[test]
    fn the_cells_that_the_points_would_found(points in prop::collection::vec(point(), 0..150), power in -3i32..2) {
        // Halves of sizes that are written without rounding, so that faces stay faces.
        let size = 2f64.powi(power);
        let fine = grid_of(size, &points);
        let (coarse, of_cell) = fine.halved().unwrap();
        let expected = grid_of(2.0 * size, &points);
        prop_assert_eq!((coarse.len(), of_cell.len()), (expected.len(), fine.len()));
        for (a, b) in coarse.iter().zip(expected.iter()) {
            prop_assert_eq!((a.key(), a.id(), a.density()), (b.key(), b.id(), b.density()));
            let (a, b) = (a.stats(), b.stats());
            let (sums, others) = (a.moments().sum(), b.moments().sum());
            prop_assert!((0..3).all(|i| (sums[i] - others[i]).abs() < 1e-11));
            prop_assert!(close(a.moments().second(), b.moments().second()));
            prop_assert!(close(a.moments().noise(), b.moments().noise()));
        }
        for cell in fine.iter() {
            let whole = coarse.get(of_cell[cell.id().index()]).unwrap();
            prop_assert_eq!(whole.key(), cell.key().map(|k| k.div_euclid(2)));
        }
    }
}

#[test]
fn ends_of_the_range_and_of_sizes() {
    let end = f64::from(MAX_INDEX);
    let (coarse, _) = grid_of(1.0, &[UncertainVector::exact([end, -end, 0.0])]).halved().unwrap();
    assert_eq!(coarse.iter().next().unwrap().key(), [MAX_INDEX / 2, -MAX_INDEX / 2, 0]);
    let largest = grid_of(MAX_CELL_SIZE, &[]).halved().map(|(grid, _)| grid.len());
    assert_eq!(largest, Err(GridError::CellSize { size: 2.0 * MAX_CELL_SIZE }));
    assert!(grid_of(1.0, &[]).halved().unwrap().0.is_empty());
}
