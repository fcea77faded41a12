//! Polygons with holes.

use serde::Serialize;

/// A polygon with holes in the frame of its plane, coordinates in metres.
///
/// Rings are simple and not closed: the first point is not repeated. The outer ring runs counter-clockwise, holes run
/// clockwise and are within it; rings touch each other in single points at most.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Polygon {
    outer: Vec<[f64; 2]>,
    holes: Vec<Vec<[f64; 2]>>,
}

impl Polygon {
    pub(crate) fn new(outer: Vec<[f64; 2]>, holes: Vec<Vec<[f64; 2]>>) -> Self {
        Self { outer, holes }
    }

    /// The outer ring, counter-clockwise.
    pub fn outer(&self) -> &[[f64; 2]] {
        &self.outer
    }

    /// The holes, clockwise.
    pub fn holes(&self) -> &[Vec<[f64; 2]>] {
        &self.holes
    }

    /// The outer ring and then the holes.
    pub fn rings(&self) -> impl Iterator<Item = &[[f64; 2]]> {
        std::iter::once(self.outer.as_slice()).chain(self.holes.iter().map(Vec::as_slice))
    }

    /// Area in square metres, without the holes.
    pub fn area(&self) -> f64 {
        // Holes count negative: they run clockwise.
        self.rings().map(signed_area).sum()
    }

    /// Length of all borders, in metres.
    pub fn perimeter(&self) -> f64 {
        self.rings().flat_map(edges).map(|[a, b]| (b[0] - a[0]).hypot(b[1] - a[1])).sum()
    }

    /// Whether a point is inside, by the number of borders a ray from it crosses. On the border either may be said.
    pub fn contains(&self, point: [f64; 2]) -> bool {
        let crosses = |[a, b]: &[[f64; 2]; 2]| {
            (a[1] > point[1]) != (b[1] > point[1])
                && point[0] < a[0] + (b[0] - a[0]) * ((point[1] - a[1]) / (b[1] - a[1]))
        };
        self.rings().flat_map(edges).filter(crosses).count() % 2 == 1
    }
}

/// The edges of a ring, with that from the last point to the first.
pub(crate) fn edges(ring: &[[f64; 2]]) -> impl Iterator<Item = [[f64; 2]; 2]> {
    ring.iter().zip(ring.iter().cycle().skip(1)).map(|(a, b)| [*a, *b])
}

/// Area of a ring by the shoelace formula, positive when it runs counter-clockwise. Coordinates are taken from the first
/// point, so that the distance of the ring from the origin costs no digits.
pub(crate) fn signed_area(ring: &[[f64; 2]]) -> f64 {
    let Some(&[u, v]) = ring.first() else { return 0.0 };
    edges(ring).map(|[a, b]| (a[0] - u) * (b[1] - v) - (b[0] - u) * (a[1] - v)).sum::<f64>() / 2.0
}
