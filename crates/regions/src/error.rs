//! What can be wrong with cells and points.

/// Cells or points that no regions can be grown from.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum RegionsError {
    /// The edge of a cell is no length.
    #[error("cells have an edge of {edge} m: it must be above zero and finite")]
    Edge {
        /// As given, in metres.
        edge: f64,
    },
    /// A cell without points, or with sums that are not finite.
    #[error("cell {cell} has no points, or its sums are not finite")]
    Cell {
        /// Its place among the cells.
        cell: usize,
    },
    /// Two cells at one place of the lattice.
    #[error("of {cells} cells, only {places} are at different places of the lattice")]
    SameKey {
        /// Number of cells.
        cells: usize,
        /// Number of different keys.
        places: usize,
    },
    /// More cells than are numbered.
    #[error("{cells} cells are more than 2^32 − 1")]
    TooMany {
        /// Number of cells.
        cells: usize,
    },
    /// Not one place for each point.
    #[error("{points} points with {places} places")]
    Places {
        /// Number of points.
        points: usize,
        /// Number of places.
        places: usize,
    },
    /// A point of a cell that does not exist.
    #[error("point {point} is of cell {cell}, which does not exist")]
    NoCell {
        /// Its place among the points.
        point: usize,
        /// The cell.
        cell: u32,
    },
    /// More points than are numbered.
    #[error("{points} points are more than 2^32 − 1")]
    TooManyPoints {
        /// Number of points.
        points: usize,
    },
    /// A setting out of its range.
    #[error("{name} is {value}: it must be {expected}")]
    Setting {
        /// Which.
        name: &'static str,
        /// As given.
        value: f64,
        /// What is allowed.
        expected: &'static str,
    },
}

/// What cannot be the [sample](crate::Samples) of a cell.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SampleError {
    /// It is said to be halved more often than a sample is.
    #[error("a sample is halved 31 times at most, not {halvings}")]
    Halvings {
        /// As given.
        halvings: u8,
    },
    /// There are more places than a sample has.
    #[error("a sample has sixteen places at most, not {places}")]
    TooMany {
        /// As given.
        places: usize,
    },
    /// A place is not finite, or would have been left out.
    #[error(
        "the place {place:?}, which endures {endures} halvings, is not of a sample that was halved {halvings} times"
    )]
    Place {
        /// From the anchor of the cell, in metres.
        place: [f32; 3],
        /// As given.
        endures: u8,
        /// How often the sample was halved.
        halvings: u8,
    },
    /// A place is not a whole multiple of what places are kept in, or of too many of that.
    #[error("the place {place:?} is not in whole units of {unit} m, 2^8 of them at most")]
    Unit {
        /// From the anchor of the cell, in metres.
        place: [f32; 3],
        /// In metres.
        unit: f32,
    },
}
