//! The plan of a room with a pillar, drawn from the dense cells of a grid of two scans.

use terrace_grid::{Assignment, Connectivity, GridError, VoxelGrid, Walk};
use terrace_stats::UncertainVector;

const CELL: f64 = 0.25;

/// Points on a wall from `from` to `to`, a hand's breadth apart, 1 m to 2 m above the floor.
fn wall(from: [f64; 2], to: [f64; 2]) -> impl Iterator<Item = UncertainVector> {
    let steps = 80;
    (0..steps * 10).map(move |i| {
        let (along, up) = (f64::from(i % steps) / f64::from(steps), f64::from(i / steps) / 10.0);
        let at = |k: usize| from[k] + along * (to[k] - from[k]);
        UncertainVector::isotropic([at(0), at(1), 1.0 + up], 0.01)
    })
}

fn main() -> Result<(), GridError> {
    let (left, right, back, front) = (0.1, 5.1, 0.1, 3.1);
    let mut first = VoxelGrid::new(CELL, Assignment::Voxel)?;
    let mut second = first.clone();
    // The first scan sees two walls, the second another, a pillar, and one stray point outside.
    for point in wall([left, back], [right, back]).chain(wall([left, back], [left, front])) {
        first.insert(&point)?;
    }
    for point in wall([left, front], [right, front]).chain(wall([3.1, 1.6], [3.6, 1.6])) {
        second.insert(&point)?;
    }
    second.insert(&UncertainVector::isotropic([5.6, 1.6, 1.1], 0.01))?;

    let [a, b] = [first.len(), second.len()];
    first.merge(&second)?;
    let grid = first;
    println!("{a} cells and {b} cells merge into {} cells of {CELL} m", grid.len());

    let dense = grid.dense(5, Connectivity::Corners);
    println!("{} of them hold at least 5 points\n", dense.len());

    // A '#' where any cell of the column is dense, a '.' where points are too few.
    for y in (0..13).rev() {
        let column = |x: i32| {
            let density = (4..8).filter_map(|z| grid.find([x, y, z])).map(|cell| cell.density()).max();
            density.map_or(' ', |points| if points >= 5 { '#' } else { '.' })
        };
        println!("  {}", (0..24).map(column).collect::<String>().trim_end());
    }

    // What hangs together along dense cells: the walls, and the pillar apart from them.
    let mut walk = Walk::default();
    let mut seen = vec![false; dense.len()];
    println!();
    for node in 0..dense.len() {
        if seen[node] {
            continue;
        }
        let part = walk.neighbourhood(&dense, node, u32::MAX);
        for n in part {
            seen[*n as usize] = true;
        }
        if let Some(cell) = grid.get(dense.cells()[node]) {
            let [x, y, z] = cell.centre();
            println!("connected: {} cells, the first of them at ({x}, {y}, {z})", part.len());
        }
    }
    Ok(())
}
