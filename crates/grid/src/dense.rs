//! The dense cells as a graph.

use crate::{CellId, VoxelKey};

/// Which cells are directly connected: those that share a face, an edge, or a corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Connectivity {
    /// 6 cells that share a face.
    Faces,
    /// 18 cells that share a face or an edge.
    Edges,
    /// 26 cells that share a face, an edge or a corner.
    #[default]
    Corners,
}

impl Connectivity {
    /// The connectivity with 6, 18 or 26 neighbours; `None` for any other number.
    pub fn from_neighbours(number: u32) -> Option<Self> {
        match number {
            6 => Some(Self::Faces),
            18 => Some(Self::Edges),
            26 => Some(Self::Corners),
            _ => None,
        }
    }

    /// How many cells a cell can be directly connected to.
    pub fn neighbours(self) -> u32 {
        match self {
            Self::Faces => 6,
            Self::Edges => 18,
            Self::Corners => 26,
        }
    }

    /// Largest Manhattan distance of the keys of connected cells.
    fn reach(self) -> i32 {
        match self {
            Self::Faces => 1,
            Self::Edges => 2,
            Self::Corners => 3,
        }
    }
}

/// The dense cells of a grid, in the order of their keys, and the graph of their direct connections.
///
/// A *node* is the place of a cell in that order, from 0.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DenseCells {
    cells: Vec<CellId>,
    keys: Vec<VoxelKey>,
    /// Node `i` is connected to `neighbours[starts[i]..starts[i + 1]]`.
    starts: Vec<usize>,
    neighbours: Vec<u32>,
}

impl DenseCells {
    /// Connects cells that are sorted by key.
    ///
    /// Nine cursors walk the sorted keys, one per column (dx, dy) around the cell at hand. Each only moves forward, and
    /// the up to three cells of its column lie side by side: so every cell is met a fixed number of times, without a
    /// look-up.
    pub(crate) fn connect(sorted: &[(VoxelKey, CellId)], connectivity: Connectivity) -> Self {
        let mut cursors = [0usize; 9];
        let mut starts = Vec::with_capacity(sorted.len() + 1);
        let mut neighbours = Vec::new();
        starts.push(0);
        for (key, _) in sorted {
            for (column, cursor) in (0i32..).zip(&mut cursors) {
                let (dx, dy) = (column / 3 - 1, column % 3 - 1);
                let first = [key[0] + dx, key[1] + dy, key[2] - 1];
                while sorted.get(*cursor).is_some_and(|(other, _)| *other < first) {
                    *cursor += 1;
                }
                for (node, (other, _)) in (*cursor..).zip(&sorted[*cursor..]).take(3) {
                    let dz = other[2] - key[2];
                    if other[0] != first[0] || other[1] != first[1] || dz > 1 {
                        break;
                    }
                    let steps = dx.abs() + dy.abs() + dz.abs();
                    if (1..=connectivity.reach()).contains(&steps) {
                        // A grid numbers its cells with 32 bits, so a place among them fits.
                        #[allow(clippy::cast_possible_truncation)]
                        neighbours.push(node as u32);
                    }
                }
            }
            starts.push(neighbours.len());
        }
        let (keys, cells) = sorted.iter().copied().unzip();
        Self { cells, keys, starts, neighbours }
    }

    /// Number of dense cells.
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// Whether no cell is dense.
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// The cells, by node.
    pub fn cells(&self) -> &[CellId] {
        &self.cells
    }

    /// The keys of the cells, by node: in rising order.
    pub fn keys(&self) -> &[VoxelKey] {
        &self.keys
    }

    /// The nodes directly connected to `node`, in rising order; none for a node that does not exist.
    #[inline]
    pub fn neighbours(&self, node: usize) -> &[u32] {
        match self.starts.get(node..) {
            Some([start, end, ..]) => &self.neighbours[*start..*end],
            _ => &[],
        }
    }
}
