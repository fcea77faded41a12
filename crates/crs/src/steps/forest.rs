//! Boxes in several axes, looked up by a place or by a box.

use super::tree::Tree;

/// Boxes not yet in a tree are scanned; a new tree is built when they are this many.
const TAIL: usize = 32;

/// Of trees that differ less than by this factor one is made.
const GROWTH: usize = 4;

/// Half-open boxes in the order of insertion, found by bounding-box trees.
///
/// The logarithmic method (J. L. Bentley, J. B. Saxe, *Decomposable searching problems I: static-to-dynamic
/// transformation*, Journal of Algorithms 1 (4), 301-358, 1980): trees that are never changed; a new one takes in those
/// before it that are at most [`GROWTH`] times as large. So there are at most log₅(*k* / 32) trees to be visited by a
/// question, and each box is built into a few times that many, whatever the order of insertion.
#[derive(Debug, Clone)]
pub(super) struct Forest {
    dimension: usize,
    /// The intervals `[lo, hi)` of all boxes, one after another.
    axes: Vec<(f64, f64)>,
    /// From large to small, each more than [`GROWTH`] times as large as all that follow; together all boxes but the tail.
    trees: Vec<Tree>,
    len: usize,
    treed: usize,
}

impl Forest {
    pub(super) fn new(dimension: usize) -> Self {
        Self { dimension, axes: Vec::new(), trees: Vec::new(), len: 0, treed: 0 }
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// The box inserted as number `index`.
    pub(super) fn get(&self, index: usize) -> &[(f64, f64)] {
        &self.axes[index * self.dimension..(index + 1) * self.dimension]
    }

    pub(super) fn insert(&mut self, axes: &[(f64, f64)]) {
        self.axes.extend_from_slice(axes);
        self.len += 1;
        if self.len - self.treed < TAIL {
            return;
        }
        let mut from = self.treed;
        while let Some(last) = self.trees.pop_if(|tree| tree.len() <= GROWTH * (self.len - from)) {
            from -= last.len();
        }
        self.trees.push(Tree::build(from..self.len, self.dimension, &self.axes));
        self.treed = self.len;
    }

    /// Calls `visit` with the number of each box that overlaps `[lo, hi)` on all axes, in no particular but a fixed
    /// order, until it returns true; whether it did.
    pub(super) fn any_overlap(&self, axes: &[(f64, f64)], mut visit: impl FnMut(usize) -> bool) -> bool {
        self.trees.iter().any(|tree| tree.any_overlap(axes, &self.axes, &mut visit))
            || (self.treed..self.len).any(|index| overlap(self.get(index), axes) && visit(index))
    }

    /// Calls `visit` with the number of each box around `x`, in no particular but a fixed order.
    pub(super) fn around(&self, x: &[f64], mut visit: impl FnMut(usize)) {
        for tree in &self.trees {
            tree.around(x, &self.axes, &mut visit);
        }
        for index in (self.treed..self.len).filter(|index| inside(self.get(*index), x)) {
            visit(index);
        }
    }
}

pub(super) fn overlap(a: &[(f64, f64)], b: &[(f64, f64)]) -> bool {
    a.iter().zip(b).all(|((a_lo, a_hi), (b_lo, b_hi))| a_lo < b_hi && b_lo < a_hi)
}

pub(super) fn inside(axes: &[(f64, f64)], x: &[f64]) -> bool {
    axes.iter().zip(x).all(|((lo, hi), x)| lo <= x && x < hi)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trees_shrink_fast() {
        let mut forest = Forest::new(2);
        for i in 0..1000_u32 {
            let lo = f64::from(i);
            forest.insert(&[(lo, lo + 1.0), (f64::NEG_INFINITY, f64::INFINITY)]);
            let sizes: Vec<usize> = forest.trees.iter().map(Tree::len).collect();
            assert!(sizes.windows(2).all(|pair| GROWTH * pair[1] < pair[0]), "{sizes:?}");
            assert!(forest.len - forest.treed < TAIL);
        }
        for i in 0..1000 {
            let mut seen = Vec::new();
            forest.around(&[i as f64 + 0.5, 0.0], |index| seen.push(index));
            assert_eq!(seen, [i]);
        }
    }
}
