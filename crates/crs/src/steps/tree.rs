//! A bounding-box tree over boxes that do not change.

use std::ops::Range;

use super::forest::{inside, overlap};

/// Boxes in a leaf.
const LEAF: usize = 8;

/// A binary tree, each node with the smallest box around its boxes; split at the median along the axis on which their
/// middles differ most. Depth log₂(*k* / 8); building is O(*d k* log *k*).
#[derive(Debug, Clone)]
pub(super) struct Tree {
    dimension: usize,
    nodes: Vec<Node>,
    /// The boxes around the nodes, one after another.
    hulls: Vec<(f64, f64)>,
    /// Numbers of boxes, those of a leaf side by side.
    items: Vec<usize>,
}

#[derive(Debug, Clone)]
enum Node {
    Leaf(Range<usize>),
    /// The first child is the next node, this is the second.
    Fork(usize),
}

impl Tree {
    /// The tree of the boxes `numbers`, whose intervals are in `axes`.
    pub(super) fn build(numbers: Range<usize>, dimension: usize, axes: &[(f64, f64)]) -> Self {
        let mut items: Vec<usize> = numbers.collect();
        let mut tree = Self { dimension, nodes: Vec::new(), hulls: Vec::new(), items: Vec::new() };
        tree.grow(&mut items, 0, axes);
        tree.items = items;
        tree
    }

    pub(super) fn len(&self) -> usize {
        self.items.len()
    }

    fn grow(&mut self, items: &mut [usize], first: usize, axes: &[(f64, f64)]) {
        let here = self.nodes.len();
        self.nodes.push(Node::Leaf(first..first + items.len()));
        let interval = |item: usize, axis: usize| axes[item * self.dimension + axis];
        let mut widest = (0, 0.0);
        for axis in 0..self.dimension {
            let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
            let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
            for &item in &*items {
                let (from, to) = interval(item, axis);
                (lo, hi) = (lo.min(from), hi.max(to));
                (least, most) = (least.min(middle(from, to)), most.max(middle(from, to)));
            }
            self.hulls.push((lo, hi));
            // Relative to the size of the boxes, for axes have different units.
            let spread = (most - least) / (hi.min(f64::MAX) / 2.0 - lo.max(f64::MIN) / 2.0);
            if spread > widest.1 {
                widest = (axis, spread);
            }
        }
        if items.len() <= LEAF {
            return;
        }
        let half = items.len() / 2;
        let by = |item: &usize| {
            let (lo, hi) = interval(*item, widest.0);
            middle(lo, hi)
        };
        // Equal middles are told apart by number: the same boxes give the same tree.
        items.select_nth_unstable_by(half, |a, b| by(a).total_cmp(&by(b)).then(a.cmp(b)));
        let (low, high) = items.split_at_mut(half);
        self.grow(low, first, axes);
        self.nodes[here] = Node::Fork(self.nodes.len());
        self.grow(high, first + half, axes);
    }

    pub(super) fn any_overlap(
        &self,
        with: &[(f64, f64)],
        axes: &[(f64, f64)],
        visit: &mut impl FnMut(usize) -> bool,
    ) -> bool {
        self.walk(0, axes, &|hull| overlap(hull, with), visit)
    }

    pub(super) fn around(&self, x: &[f64], axes: &[(f64, f64)], visit: &mut impl FnMut(usize)) {
        self.walk(0, axes, &|hull| inside(hull, x), &mut |item| {
            visit(item);
            false
        });
    }

    /// Visits the boxes under a node that `touches` says yes to, until `visit` returns true; whether it did.
    fn walk(
        &self,
        node: usize,
        axes: &[(f64, f64)],
        touches: &impl Fn(&[(f64, f64)]) -> bool,
        visit: &mut impl FnMut(usize) -> bool,
    ) -> bool {
        let of = |all: &[(f64, f64)], number: usize| {
            touches(&all[number * self.dimension..(number + 1) * self.dimension])
        };
        if !of(&self.hulls, node) {
            return false;
        }
        match &self.nodes[node] {
            Node::Fork(second) => {
                self.walk(node + 1, axes, touches, visit) || self.walk(*second, axes, touches, visit)
            }
            Node::Leaf(items) => self.items[items.clone()].iter().any(|item| of(axes, *item) && visit(*item)),
        }
    }
}

/// Halves first: the sum of two ends could overflow, and infinite ones have a middle nowhere.
fn middle(lo: f64, hi: f64) -> f64 {
    lo.max(f64::MIN) / 2.0 + hi.min(f64::MAX) / 2.0
}
