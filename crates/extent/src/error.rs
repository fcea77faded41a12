//! What cannot be outlined.

use thiserror::Error;

/// Why a frame, a footprint, an outline or a mesh could not be made.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum ExtentError {
    /// A point is not finite, or so far away that its place in the plane is not.
    #[error("the point ({}, {}, {}) is not within a finite distance", point[0], point[1], point[2])]
    PointNotFinite {
        /// The point as given, in metres.
        point: [f64; 3],
    },
    /// The pixel size is no length.
    #[error("a resolution of {resolution} m is no pixel size: it must be positive and finite")]
    Resolution {
        /// The side of a pixel as given, in metres.
        resolution: f64,
    },
    /// The limit on pixels is too small to hold anything or too large for memory.
    #[error("a limit of {limit} pixels is not from {least} to {most}")]
    PixelLimit {
        /// The limit as given.
        limit: usize,
        /// The smallest limit that is taken.
        least: usize,
        /// The largest limit that is taken.
        most: usize,
    },
    /// A point is too many pixels away from the origin of the frame.
    #[error(
        "a point {distance} m from the origin of the frame is more than {most} pixels of {resolution} m away: \
         take larger pixels or an origin near the points"
    )]
    TooFar {
        /// Distance along the axis where it is larger, in metres.
        distance: f64,
        /// Side of a pixel in metres.
        resolution: f64,
        /// Largest distance in pixels.
        most: u32,
    },
    /// A length or an area of the options is negative or not finite.
    #[error("{name} is {value}, which is no size: it must be at least 0 and finite")]
    Size {
        /// Which option.
        name: &'static str,
        /// The value as given, in metres or square metres.
        value: f64,
    },
    /// Gaps this wide would take too long to close.
    #[error(
        "gaps of {gap} m are more than {most} pixels of {resolution} m wide: take larger pixels or close less"
    )]
    GapTooWide {
        /// The gap as given, in metres.
        gap: f64,
        /// Side of a pixel in metres.
        resolution: f64,
        /// Widest gap in pixels.
        most: u32,
    },
    /// A polygon could not be cut into triangles of the same area.
    #[error("a polygon of {polygon} m² was cut into triangles of {triangles} m²")]
    Triangulation {
        /// Area of the polygon in square metres.
        polygon: f64,
        /// Area of its triangles in square metres.
        triangles: f64,
    },
    /// More vertices than 32 bit indices can tell apart.
    #[error("{vertices} vertices are more than an index of 32 bits can tell apart")]
    TooManyVertices {
        /// Number of vertices.
        vertices: usize,
    },
}
