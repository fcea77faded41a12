//! Boxes of a domain: their size, and how they are cut.

use crate::Axis;

type Interval = (f64, f64);

/// The share of the domain in a box.
pub(super) fn share(axes: &[Axis], piece: &[Interval]) -> f64 {
    axes.iter().zip(piece).map(|(axis, (lo, hi))| axis.share(*lo, *hi)).product()
}

/// The place in the middle.
pub(super) fn centre(axes: &[Axis], piece: &[Interval]) -> Vec<f64> {
    axes.iter().zip(piece).map(|(axis, (lo, hi))| axis.part(*lo, *hi, 0.5)).collect()
}

/// What is left of a piece without `covered`, as at most two boxes for each axis. Slabs are cut off the axis first where
/// most is left, which keeps the rest from becoming narrow.
pub(super) fn subtract(axes: &[Axis], piece: &[Interval], covered: &[Interval]) -> Vec<Vec<Interval>> {
    let left = |axis: usize| {
        let ((lo, hi), (from, to)) = (piece[axis], covered[axis]);
        axes[axis].share(lo, from).max(axes[axis].share(to, hi))
    };
    let mut order: Vec<(usize, f64)> = (0..axes.len()).map(|axis| (axis, left(axis))).collect();
    order.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut rest = piece.to_vec();
    let mut pieces = Vec::new();
    for (axis, _) in order {
        let ((lo, hi), (from, to)) = (rest[axis], covered[axis]);
        for (lo, hi) in [(lo, from.min(hi)), (to.max(lo), hi)] {
            if let Some(slab) = axes[axis].within(lo, hi) {
                let mut piece = rest.clone();
                piece[axis] = slab;
                pieces.push(piece);
            }
        }
        rest[axis] = (lo.max(from), hi.min(to));
    }
    pieces
}

/// A piece in two, at `x` along its longest side; none when it holds no place but `x`.
pub(super) fn halves(axes: &[Axis], piece: &[Interval], x: &[f64]) -> Vec<Vec<Interval>> {
    let mut longest: Option<(usize, f64, [Interval; 2])> = None;
    for (number, (axis, (lo, hi))) in axes.iter().zip(piece).enumerate() {
        // A counted axis is cut above `x`, which may be its lowest value.
        let cut = if axis.count().is_none() { x[number] } else { x[number].next_up() };
        let (Some(low), Some(high)) = (axis.within(*lo, cut), axis.within(cut, *hi)) else { continue };
        let side = axis.share(*lo, *hi);
        if longest.is_none_or(|(_, other, _)| side > other) {
            longest = Some((number, side, [low, high]));
        }
    }
    let Some((number, _, parts)) = longest else { return Vec::new() };
    let part = |side| {
        let mut part = piece.to_vec();
        part[number] = side;
        part
    };
    parts.map(part).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_and_what_is_covered_make_the_piece() {
        let axes = [Axis::Real { lo: 0.0, hi: 1.0 }, Axis::Integer { lo: 0, hi: 9 }];
        let piece = [(0.0, 1.0_f64.next_up()), (0.0, 9.0_f64.next_up())];
        let covered = [(0.25, 0.5), (f64::NEG_INFINITY, 4.0)];
        let rest = subtract(&axes, &piece, &covered);
        assert_eq!(rest.len(), 3);
        let total: f64 = rest.iter().map(|piece| share(&axes, piece)).sum();
        assert!((total - 0.9).abs() < 1e-15);
        assert!(subtract(&axes, &piece, &[(f64::NEG_INFINITY, f64::INFINITY); 2]).is_empty());
    }

    #[test]
    fn halves_are_cut_along_the_longest_side() {
        let axes = [Axis::Real { lo: 0.0, hi: 1.0 }, Axis::Integer { lo: 0, hi: 3 }];
        let piece = [(0.0, 0.25), (0.0, 1.0_f64.next_up())];
        let parts = halves(&axes, &piece, &centre(&axes, &piece));
        assert_eq!(
            parts,
            [vec![(0.0, 0.25), (0.0, 0.0_f64.next_up())], vec![(0.0, 0.25), (1.0, 1.0_f64.next_up())]]
        );
        let narrow = [(0.5, 0.5_f64.next_up()), (2.0, 2.0_f64.next_up())];
        assert!(halves(&axes, &narrow, &[0.5, 2.0]).is_empty());
    }
}
