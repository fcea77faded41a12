//! The rules by which points are added.

/// Which cell a point is added to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Assignment {
    /// The cell of the voxel the point lies in. Independent of the order of points.
    #[default]
    Voxel,
    /// The paper's rule (section III-A, Eq. 3): a point in an empty voxel founds a cell there; otherwise it joins, of
    /// its own voxel and the occupied ones among the 26 around it, the cell with the smallest expected squared
    /// distance to its virtual centre. Ties go to the point's own voxel, then to the smaller key. Depends on the order
    /// of points.
    ExpectedDistance,
}
