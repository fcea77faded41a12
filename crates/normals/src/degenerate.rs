//! Why a neighbourhood has no normal.

/// Why points or centres determine no plane.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Degenerate {
    /// Fewer than three: any number of planes passes through them. A larger depth or cell may help.
    #[error("{found} points or cells determine no plane, three are needed")]
    TooFew {
        /// How many there are.
        found: usize,
    },
    /// All in one place, to within rounding.
    #[error("all points are in one place: their largest variance is {variance:.1e} m²")]
    Coincident {
        /// Largest variance along any direction, in m².
        variance: f64,
    },
    /// All on one line, to within rounding or a ten-thousandth of their extent.
    #[error(
        "all points are on one line: they vary by {across:.1e} m² across it and by {along:.1e} m² along it"
    )]
    Collinear {
        /// Largest variance across the line, in m².
        across: f64,
        /// Variance along the line, in m².
        along: f64,
    },
    /// A statistic is NaN or infinite.
    #[error("the statistics of the points are not finite")]
    NotFinite,
}
