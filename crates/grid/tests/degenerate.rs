//! Grids of little, of the same, of what is no number, and at the end of the range.

// Values are handed through unchanged, so they are compared exactly; a test has no caller to report to.
#![allow(clippy::float_cmp, clippy::unwrap_used)]

use terrace_grid::{
    Assignment, Connectivity, GridError, MAX_CELL_SIZE, MAX_INDEX, MIN_CELL_SIZE, VoxelGrid, VoxelKey, Walk,
    validate_cell_size,
};
use terrace_stats::{SymmetricMatrix3, UncertainVector};

const RULES: [Assignment; 2] = [Assignment::Voxel, Assignment::ExpectedDistance];
const CONNECTIVITIES: [Connectivity; 3] = [Connectivity::Faces, Connectivity::Edges, Connectivity::Corners];

fn grid_of(size: f64, assignment: Assignment, points: &[[f64; 3]]) -> VoxelGrid {
    let mut grid = VoxelGrid::new(size, assignment).unwrap();
    for p in points {
        grid.insert(&UncertainVector::isotropic(*p, 0.01)).unwrap();
    }
    grid
}

fn keys(grid: &VoxelGrid) -> Vec<VoxelKey> {
    grid.iter().map(|cell| cell.key()).collect()
}

#[test]
fn an_empty_grid() {
    for rule in RULES {
        let mut grid = VoxelGrid::new(0.1, rule).unwrap();
        assert!(grid.is_empty());
        assert_eq!([grid.len(), grid.iter().len()], [0, 0]);
        assert!(grid.find([0; 3]).is_none());
        for connectivity in CONNECTIVITIES {
            let dense = grid.dense(0, connectivity);
            assert!(dense.is_empty() && dense.cells().is_empty());
            assert_eq!(dense.neighbours(0), [0u32; 0]);
            assert_eq!(Walk::default().neighbourhood(&dense, 0, 3), [0u32; 0]);
        }
        grid.merge(&grid_of(0.1, rule, &[])).unwrap();
        assert!(grid.is_empty());
    }
}

#[test]
fn one_point() {
    for rule in RULES {
        let grid = grid_of(0.5, rule, &[[0.6, -0.1, 1.9]]);
        let cell = grid.find([1, -1, 3]).unwrap();
        assert_eq!((grid.len(), cell.density(), cell.id().index()), (1, 1, 0));
        assert_eq!((cell.centre(), cell.stats().anchor()), ([0.75, -0.25, 1.75], [0.75, -0.25, 1.75]));
        assert_eq!(cell.stats().mean(), Some([0.6, -0.1, 1.9]));
        let dense = grid.dense(1, Connectivity::Corners);
        assert_eq!((dense.len(), dense.neighbours(0).len()), (1, 0));
        assert_eq!(Walk::default().neighbourhood(&dense, 0, 5), [0]);
        assert!(grid.dense(2, Connectivity::Corners).is_empty());
    }
}

#[test]
fn duplicates_share_a_cell() {
    for rule in RULES {
        let grid = grid_of(0.1, rule, &[[0.03, 0.04, 0.05]; 100]);
        assert_eq!((grid.len(), grid.find([0; 3]).unwrap().density()), (1, 100));
        let scatter = grid.find([0; 3]).unwrap().stats().covariance().unwrap();
        assert!(scatter.0.iter().all(|c| c.abs() < 1e-16));
    }
}

#[test]
fn a_flat_layer_on_a_voxel_face_is_one_layer() {
    let points: Vec<_> = (0..100).map(|i| [f64::from(i % 10) / 8.0, f64::from(i / 10) / 8.0, 0.5]).collect();
    let grid = grid_of(0.25, Assignment::Voxel, &points);
    assert_eq!(grid.len(), 25);
    for cell in grid.iter() {
        assert_eq!(cell.key()[2], 2);
        assert_eq!(cell.stats().covariance().unwrap().get(2, 2), 0.0);
    }
}

#[test]
fn collinear_points_along_a_diagonal_touch_by_corners_alone() {
    let points: Vec<_> = (0..5).map(|i| [f64::from(i) + 0.5; 3]).collect();
    let grid = grid_of(1.0, Assignment::Voxel, &points);
    let reached = |c| Walk::default().neighbourhood(&grid.dense(1, c), 0, 9).len();
    assert_eq!(CONNECTIVITIES.map(reached), [1, 1, 5]);
}

#[test]
fn points_that_are_no_places_are_refused() {
    for rule in RULES {
        let mut grid = grid_of(0.1, rule, &[[0.0; 3]]);
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for axis in 0..3 {
                let mut p = [0.05; 3];
                p[axis] = bad;
                let refused = grid.insert(&UncertainVector::exact(p));
                assert!(matches!(refused, Err(GridError::PointNotFinite { .. })), "{p:?} gave {refused:?}");
            }
        }
        assert_eq!((grid.len(), grid.find([0; 3]).unwrap().density()), (1, 1));
    }
}

#[test]
fn points_out_of_range_are_refused() {
    for rule in RULES {
        let mut grid = VoxelGrid::new(0.01, rule).unwrap();
        for far in [1e300, -1e300, 1e12, -1e12, f64::MAX] {
            for axis in 0..3 {
                let mut p = [0.05; 3];
                p[axis] = far;
                let refused = grid.insert(&UncertainVector::exact(p));
                assert_eq!(refused, Err(GridError::OutOfRange { position: p, size: 0.01 }));
            }
        }
        assert!(grid.is_empty());
        // NaN beside a coordinate out of range: the NaN is told, for no unit cures it.
        let refused = grid.insert(&UncertainVector::exact([1e300, f64::NAN, 0.0]));
        assert!(matches!(refused, Err(GridError::PointNotFinite { .. })));
    }
}

#[test]
fn the_range_ends_at_max_index() {
    let end = f64::from(MAX_INDEX);
    for rule in RULES {
        let grid = grid_of(1.0, rule, &[[end, -end, end + 0.5]]);
        assert_eq!(keys(&grid), [[MAX_INDEX, -MAX_INDEX, MAX_INDEX]]);
        for beyond in [end + 1.0, -end - 0.25] {
            let mut grid = grid.clone();
            let refused = grid.insert(&UncertainVector::exact([0.0, 0.0, beyond]));
            assert!(matches!(refused, Err(GridError::OutOfRange { .. })));
        }
    }
}

#[test]
fn neighbours_at_the_end_of_the_range_do_not_overflow() {
    let end = f64::from(MAX_INDEX);
    let ends = [-end, 1.0 - end, end - 1.0, end];
    let end_of = |i: usize| ends[i % 4] + 0.5;
    let points: Vec<_> = (0..64).map(|i| [end_of(i / 16), end_of(i / 4), end_of(i)]).collect();
    for rule in RULES {
        let mut grid = grid_of(1.0, rule, &points);
        for p in &points {
            grid.insert(&UncertainVector::exact(*p)).unwrap();
        }
        assert_eq!(grid.len(), 64);
        // Eight cubes of 2×2×2 cells, one in each corner of the range.
        for (connectivity, neighbours) in CONNECTIVITIES.into_iter().zip([3, 6, 7]) {
            let dense = grid.dense(2, connectivity);
            assert_eq!(dense.len(), 64);
            assert!((0..64).all(|node| dense.neighbours(node).len() == neighbours));
            assert_eq!(Walk::default().neighbourhood(&dense, 0, u32::MAX).len(), 8);
        }
    }
}

#[test]
fn errors_of_points_that_are_no_errors_are_refused() {
    for rule in RULES {
        let mut grid = grid_of(0.1, rule, &[[0.0; 3]]);
        for bad in [-0.01, f64::NAN, f64::INFINITY] {
            for axis in 0..3 {
                let mut error = [0.01; 3];
                error[axis] = bad;
                // In a new voxel, which must not be founded.
                let refused = grid.insert(&UncertainVector { value: [0.5; 3], error });
                assert!(
                    matches!(refused, Err(GridError::StandardError { .. })),
                    "{error:?} gave {refused:?}"
                );
            }
        }
        assert_eq!(grid.len(), 1);
        assert!(grid.insert(&UncertainVector::isotropic([0.5; 3], 0.0)).is_ok());
        // A kilometre, and beyond what can be squared: of no use, but no harm to the place of points.
        for huge in [1e3, 1e200] {
            let id = grid.insert(&UncertainVector::isotropic([0.5; 3], huge)).unwrap();
            assert_eq!(grid.get(id).unwrap().stats().mean(), Some([0.5; 3]));
        }
    }
}

#[test]
fn weights_that_do_not_weigh_are_refused() {
    for rule in RULES {
        let mut grid = grid_of(0.1, rule, &[[0.0; 3]]);
        for bad in [0.0, -0.0, -1.0, f64::NAN, f64::INFINITY] {
            let refused = grid.insert_weighted(&UncertainVector::exact([0.5; 3]), bad);
            assert!(matches!(refused, Err(GridError::Weight { .. })), "{bad} gave {refused:?}");
        }
        assert_eq!(grid.len(), 1);
        // 1/σ² of a point known exactly: not a weight either.
        assert!(grid.insert_weighted(&UncertainVector::exact([0.5; 3]), 1.0 / 0f64.powi(2)).is_err());
        grid.insert_weighted(&UncertainVector::exact([0.05; 3]), 3.0).unwrap();
        let stats = grid.find([0; 3]).unwrap().stats();
        assert_eq!((stats.count(), stats.weight()), (2, 4.0));
        assert!((stats.mean().unwrap()[0] - 0.0375).abs() < 1e-15);
    }
}

#[test]
fn cell_sizes_that_are_no_lengths_are_refused() {
    let subnormal = f64::MIN_POSITIVE / 2.0;
    for bad in
        [0.0, -0.0, -0.1, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, subnormal, 1e-101, 1e101, f64::MAX]
    {
        for refused in
            [validate_cell_size(bad), VoxelGrid::new(bad, Assignment::Voxel).map(|g| g.cell_size())]
        {
            let Err(GridError::CellSize { size }) = refused else { panic!("{bad} gave {refused:?}") };
            assert_eq!(size.to_bits(), bad.to_bits());
        }
    }
    assert_eq!(
        validate_cell_size(-1.0).unwrap_err().to_string(),
        "the cell size -1 m is not a length from 1e-100 to 1e100 m"
    );
}

#[test]
fn cells_of_every_allowed_size_have_finite_statistics() {
    for size in [MIN_CELL_SIZE, 1e-9, 1.0, 1e9, MAX_CELL_SIZE] {
        for rule in RULES {
            let grid = grid_of(size, rule, &[[0.25 * size; 3], [0.75 * size; 3], [-1e9 * size; 3]]);
            assert_eq!(keys(&grid), [[-MAX_INDEX; 3], [0; 3]]);
            let covariance = grid.find([0; 3]).unwrap().stats().covariance().unwrap();
            assert!((covariance.get(0, 1) / size / size - 0.0625).abs() < 1e-15, "{size:e}: {covariance:?}");
        }
    }
}

#[test]
fn grids_of_other_cells_are_not_merged() {
    let mut grid = grid_of(0.1, Assignment::Voxel, &[[0.0; 3], [0.5; 3]]);
    let before: Vec<_> = grid.iter().map(|c| (c.key(), c.stats())).collect();
    for size in [0.2, 0.1 + 1e-16 * 2.0] {
        let other = grid_of(size, Assignment::Voxel, &[[7.0; 3]]);
        assert_eq!(grid.merge(&other), Err(GridError::SizesDiffer { ours: 0.1, theirs: size }));
        assert_eq!(grid.iter().map(|c| (c.key(), c.stats())).collect::<Vec<_>>(), before);
    }
}

#[test]
fn nodes_and_cells_that_do_not_exist() {
    let grid = grid_of(1.0, Assignment::Voxel, &[[0.5; 3], [1.5, 0.5, 0.5]]);
    let dense = grid.dense(1, Connectivity::Corners);
    let mut walk = Walk::default();
    for node in [2, 3, u32::MAX as usize, usize::MAX - 1, usize::MAX] {
        assert_eq!(dense.neighbours(node), [0u32; 0]);
        for depth in 0..3 {
            assert_eq!(walk.neighbourhood(&dense, node, depth), [0u32; 0]);
        }
    }
    let id = grid.find([1, 0, 0]).unwrap().id();
    assert!(grid_of(1.0, Assignment::Voxel, &[[0.5; 3]]).get(id).is_none());
}

#[test]
fn connectivities_by_number() {
    for c in CONNECTIVITIES {
        assert_eq!(Connectivity::from_neighbours(c.neighbours()), Some(c));
    }
    assert!([0, 4, 8, 27, u32::MAX].iter().all(|n| Connectivity::from_neighbours(*n).is_none()));
    assert_eq!(Connectivity::default().neighbours(), 26);
}

#[test]
fn two_walls_one_voxel_apart_stay_two() {
    // In layers 0 and 2 of cells of 10 cm, layer 1 between them empty.
    let wall = |x: f64| (0..400).map(move |i| [x, 0.05 * f64::from(i % 20), 0.05 * f64::from(i / 20)]);
    let points: Vec<_> = wall(0.05).chain(wall(0.25)).collect();
    for rule in RULES {
        let grid = grid_of(0.1, rule, &points);
        assert!(grid.iter().all(|cell| cell.key()[0] != 1));
        let dense = grid.dense(2, Connectivity::Corners);
        let reached = Walk::default().neighbourhood(&dense, 0, u32::MAX).to_vec();
        assert!(!reached.is_empty());
        for node in reached {
            let cell = grid.get(dense.cells()[node as usize]).unwrap();
            assert_eq!(cell.key()[0], 0);
        }
        // No cell mixes the two: each is flat to rounding.
        assert!(grid.iter().all(|cell| cell.stats().covariance().unwrap().get(0, 0) < 1e-15));
    }
}

#[test]
fn the_same_scan_twice_doubles_density_and_nothing_else() {
    let scan: Vec<_> =
        (0..500).map(|i| [0.37, 0.61, 0.89].map(|step: f64| 2.0 * (step * f64::from(i)).fract())).collect();
    let once = grid_of(0.25, Assignment::Voxel, &scan);
    let twice = grid_of(0.25, Assignment::Voxel, &[scan.clone(), scan].concat());
    assert_eq!(keys(&once), keys(&twice));
    for (a, b) in once.iter().zip(twice.iter()) {
        assert_eq!(2 * a.density(), b.density());
        let (a, b) = (a.stats(), b.stats());
        assert!((0..3).all(|i| (a.mean().unwrap()[i] - b.mean().unwrap()[i]).abs() < 1e-14));
        let (a, b) = (a.covariance().unwrap(), b.covariance().unwrap());
        assert!((0..6).all(|i| (a.0[i] - b.0[i]).abs() < 1e-15));
    }
}

#[test]
fn memory_is_taken_where_points_are() {
    for rule in RULES {
        let grid = grid_of(1.0, rule, &[[0.5; 3], [1e6 + 0.5, 0.5, 0.5]]);
        assert_eq!((grid.len(), grid.iter().len()), (2, 2));
        assert_eq!(keys(&grid), [[0, 0, 0], [1_000_000, 0, 0]]);
    }
}

#[test]
fn sizes_told_in_the_docs() {
    assert_eq!(size_of::<Option<terrace_grid::CellId>>(), 4);
}

#[test]
fn covariances_of_points_that_are_none_are_refused() {
    for rule in RULES {
        let mut grid = grid_of(0.1, rule, &[[0.0; 3]]);
        for (entry, bad) in [(0, -1e-9), (3, f64::NAN), (1, f64::INFINITY), (5, -1.0)] {
            let mut covariance = SymmetricMatrix3::diagonal([1e-4; 3]);
            covariance.0[entry] = bad;
            // In a new voxel, which must not be founded.
            let refused = grid.insert_covariant([0.5; 3], &covariance);
            assert!(matches!(refused, Err(GridError::Covariance { .. })), "{covariance:?} gave {refused:?}");
        }
        assert_eq!(grid.len(), 1);
    }
}

#[test]
fn errors_along_the_axes_are_a_diagonal_covariance() {
    let points = [[0.01, 0.02, 0.03], [0.07, 0.01, 0.05], [0.31, 0.02, 0.0]];
    for rule in RULES {
        let by_axis = grid_of(0.1, rule, &points);
        let mut by_matrix = VoxelGrid::new(0.1, rule).unwrap();
        for point in points {
            by_matrix.insert_covariant(point, &SymmetricMatrix3::diagonal([0.01 * 0.01; 3])).unwrap();
        }
        let stats = |grid: &VoxelGrid| grid.iter().map(|cell| cell.stats()).collect::<Vec<_>>();
        assert_eq!(stats(&by_axis), stats(&by_matrix));
    }
}
