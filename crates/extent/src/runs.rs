//! Sets of pixels as runs along rows.

use std::collections::{BTreeMap, VecDeque};

/// Pixels of a row from the first column to before the second.
pub(crate) type Run = (i32, i32);

/// Runs of each row that has any, sorted, apart from each other.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Runs(BTreeMap<i32, Vec<Run>>);

impl Runs {
    pub(crate) fn of(pixels: impl Iterator<Item = [i32; 2]>) -> Self {
        let mut rows: BTreeMap<i32, Vec<Run>> = BTreeMap::new();
        for [column, row] in pixels {
            rows.entry(row).or_default().push((column, column + 1));
        }
        rows.values_mut().for_each(merge);
        Self(rows)
    }

    pub(crate) fn rows(&self) -> impl Iterator<Item = (i32, &[Run])> {
        self.0.iter().map(|(row, runs)| (*row, runs.as_slice()))
    }

    fn row(&self, row: i32) -> &[Run] {
        self.0.get(&row).map_or(&[], Vec::as_slice)
    }

    /// The columns of a row that are in the set, of those from the first to before the last.
    pub(crate) fn columns(&self, row: i32, first: i32, last: i32) -> impl Iterator<Item = i32> {
        let runs = self.row(row);
        let next = runs.partition_point(|run| run.1 <= first);
        runs.iter()
            .skip(next)
            .take_while(move |run| run.0 < last)
            .flat_map(move |run| run.0.max(first)..run.1.min(last))
    }

    /// Pixels one of whose four neighbours is not in the set, by row and column.
    pub(crate) fn border(&self) -> Vec<[i32; 2]> {
        let mut border = Vec::new();
        for (row, runs) in self.rows() {
            let within = shrunk(runs, 1);
            let inside = intersection(&within, &intersection(self.row(row - 1), self.row(row + 1)));
            for (start, end) in difference(runs, &inside) {
                border.extend((start..end).map(|column| [column, row]));
            }
        }
        border
    }

    /// Without these pixels.
    pub(crate) fn without(mut self, pixels: &[[i32; 2]]) -> Self {
        let mut gone: BTreeMap<i32, Vec<Run>> = BTreeMap::new();
        for &[column, row] in pixels {
            gone.entry(row).or_default().push((column, column + 1));
        }
        for (row, mut gone) in gone {
            merge(&mut gone);
            if let Some(runs) = self.0.get_mut(&row) {
                *runs = difference(runs, &gone);
            }
        }
        self.0.retain(|_, runs| !runs.is_empty());
        self
    }

    /// Morphological closing with a disc of this radius in pixels: all that no disc in the complement reaches.
    pub(crate) fn closed(&self, radius: f64) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "radii are bounded by the caller")]
        let half_widths: Vec<i32> =
            (0..=radius as i32).map(|dy| (radius * radius - f64::from(dy * dy)).sqrt() as i32).collect();
        let reach = half_widths.len().saturating_sub(1);
        if reach == 0 {
            return self.clone();
        }
        let reach = i32::try_from(reach).unwrap_or(i32::MAX);
        let mut closed = BTreeMap::new();
        // Dilated rows from `row - reach` to `row + reach`.
        let mut window: VecDeque<(i32, Vec<Run>)> = VecDeque::new();
        for row in self.rows_within(reach) {
            window.retain(|(at, _)| *at >= row - reach);
            let next = window.back().map_or(row - reach, |(at, _)| at + 1);
            window.extend((next..=row + reach).map(|at| (at, self.dilated(at, &half_widths))));
            let runs = eroded(&window, row, &half_widths);
            if !runs.is_empty() {
                closed.insert(row, runs);
            }
        }
        Self(closed)
    }

    /// Every row with pixels in it or within reach both above and below, in order: no other can hold any once closed.
    fn rows_within(&self, reach: i32) -> Vec<i32> {
        let mut rows: Vec<i32> = Vec::new();
        for &row in self.0.keys() {
            match rows.last() {
                Some(&last) if row - last <= 2 * reach + 1 => rows.extend(last + 1..=row),
                _ => rows.push(row),
            }
        }
        rows
    }

    fn dilated(&self, row: i32, half_widths: &[i32]) -> Vec<Run> {
        let mut dilated = Vec::new();
        let reach = i32::try_from(half_widths.len()).unwrap_or(i32::MAX) - 1;
        for (at, runs) in self.0.range(row - reach..=row + reach) {
            if let Some(half) = half_width(half_widths, at - row) {
                dilated.extend(runs.iter().map(|(start, end)| (start - half, end + half)));
            }
        }
        merge(&mut dilated);
        dilated
    }
}

/// How far a disc reaches to either side, so many rows from its middle.
fn half_width(half_widths: &[i32], dy: i32) -> Option<i32> {
    half_widths.get(usize::try_from(dy.abs()).ok()?).copied()
}

fn eroded(window: &VecDeque<(i32, Vec<Run>)>, row: i32, half_widths: &[i32]) -> Vec<Run> {
    let mut left: Option<Vec<Run>> = None;
    for (at, runs) in window {
        let Some(half) = half_width(half_widths, at - row) else { continue };
        let runs = shrunk(runs, half);
        left = Some(match left {
            Some(left) => intersection(&left, &runs),
            None => runs,
        });
    }
    left.unwrap_or_default()
}

/// Runs without so many pixels at each end.
fn shrunk(runs: &[Run], by: i32) -> Vec<Run> {
    runs.iter().map(|(start, end)| (start + by, end - by)).filter(|(start, end)| start < end).collect()
}

/// Sorts runs and joins those that overlap or touch.
fn merge(runs: &mut Vec<Run>) {
    runs.sort_unstable();
    runs.dedup_by(|next, run| {
        let joined = next.0 <= run.1;
        if joined {
            run.1 = run.1.max(next.1);
        }
        joined
    });
}

fn intersection(a: &[Run], b: &[Run]) -> Vec<Run> {
    let mut both = Vec::new();
    let (mut a, mut b) = (a.iter().peekable(), b.iter().peekable());
    while let (Some(x), Some(y)) = (a.peek(), b.peek()) {
        let (start, end) = (x.0.max(y.0), x.1.min(y.1));
        if start < end {
            both.push((start, end));
        }
        if x.1 < y.1 {
            a.next()
        } else {
            b.next()
        };
    }
    both
}

fn difference(runs: &[Run], gone: &[Run]) -> Vec<Run> {
    let mut left = Vec::new();
    let mut gone = gone.iter().peekable();
    for &(mut start, end) in runs {
        while let Some(&&(from, to)) = gone.peek() {
            if from >= end {
                break;
            }
            if start < from {
                left.push((start, from));
            }
            start = start.max(to);
            if to > end {
                break;
            }
            gone.next();
        }
        if start < end {
            left.push((start, end));
        }
    }
    left
}

#[cfg(test)]
#[path = "runs_tests.rs"]
mod tests;
