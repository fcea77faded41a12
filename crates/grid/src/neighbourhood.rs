//! Neighbourhoods along dense cells (Definition 2).

use crate::DenseCells;

/// Walks neighbourhoods, one after the other, on reused memory.
///
/// ```
/// use terrace_grid::{Assignment, Connectivity, VoxelGrid, Walk};
/// use terrace_stats::UncertainVector;
///
/// let mut grid = VoxelGrid::new(1.0, Assignment::Voxel)?;
/// for x in [0.5, 1.5, 2.5, 3.5] {
///     grid.insert(&UncertainVector::exact([x, 0.5, 0.5]))?;
/// }
/// let dense = grid.dense(1, Connectivity::Faces);
/// let mut walk = Walk::default();
/// assert_eq!(walk.neighbourhood(&dense, 0, 2), [0, 1, 2]);
/// assert_eq!(walk.neighbourhood(&dense, 2, 1), [2, 1, 3]);
/// # Ok::<(), terrace_grid::GridError>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Walk {
    /// The walk in which a node was last reached.
    reached: Vec<u32>,
    walks: u32,
    nodes: Vec<u32>,
}

impl Walk {
    /// `N_d(u)`: `node` itself, then the dense cells within `depth` direct connections along dense cells, nearest first.
    /// Empty for a node that does not exist.
    pub fn neighbourhood<'a>(&'a mut self, dense: &DenseCells, node: usize, depth: u32) -> &'a [u32] {
        self.nodes.clear();
        let Some(start) = u32::try_from(node).ok().filter(|_| node < dense.len()) else { return &self.nodes };
        self.nodes.push(start);
        if depth == 1 {
            self.nodes.extend_from_slice(dense.neighbours(node));
            return &self.nodes;
        }
        self.begin(dense.len());
        self.reached[node] = self.walks;
        let mut front = 0;
        for _ in 0..depth {
            let end = self.nodes.len();
            if front == end {
                break;
            }
            for at in front..end {
                for next in dense.neighbours(self.nodes[at] as usize) {
                    let reached = &mut self.reached[*next as usize];
                    if *reached != self.walks {
                        *reached = self.walks;
                        self.nodes.push(*next);
                    }
                }
            }
            front = end;
        }
        &self.nodes
    }

    /// Starts a new walk: marks of earlier ones no longer count.
    fn begin(&mut self, nodes: usize) {
        if self.walks == u32::MAX || self.reached.len() < nodes {
            self.reached.clear();
            self.reached.resize(nodes, 0);
            self.walks = 0;
        }
        self.walks += 1;
    }
}

#[cfg(test)]
mod tests {
    use terrace_stats::UncertainVector;

    use crate::{Assignment, Connectivity, VoxelGrid, Walk};

    #[test]
    fn marks_do_not_outlive_the_count_of_walks() {
        let mut grid = VoxelGrid::new(1.0, Assignment::Voxel).unwrap();
        for x in 0..5 {
            grid.insert(&UncertainVector::exact([f64::from(x), 0.0, 0.0])).unwrap();
        }
        let dense = grid.dense(1, Connectivity::Faces);
        // Marks of the first two walks, just before the count comes round to them again.
        let mut walk = Walk { reached: vec![1, 2, 1, 1, 2], walks: u32::MAX - 1, nodes: Vec::new() };
        assert_eq!(walk.neighbourhood(&dense, 0, 2), [0, 1, 2]);
        assert_eq!(walk.neighbourhood(&dense, 0, 9), [0, 1, 2, 3, 4]);
        assert_eq!(walk.neighbourhood(&dense, 4, 9), [4, 3, 2, 1, 0]);
    }
}
