//! Which points true and found planes share.

use std::collections::BTreeMap;

/// The points that each pair of a true and a found label shares, labels of no plane included; points that no count looks
/// at are left out.
#[derive(Debug, Clone, Default)]
pub struct Overlaps {
    shared: BTreeMap<(i32, i32), u64>,
    truth: BTreeMap<i32, u64>,
    found: BTreeMap<i32, u64>,
}

/// A label of the other side, and how much of it is shared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Part {
    /// The label, 0 for no plane.
    pub label: i32,
    /// Points of both.
    pub shared: u64,
    /// All its points.
    pub points: u64,
    /// Intersection over union.
    pub iou: f64,
}

impl Overlaps {
    /// Counts two labelings of the same points.
    pub fn of(truth: &[i32], found: &[i32]) -> Self {
        let mut all = Self::default();
        for (truth, found) in truth.iter().zip(found).filter(|(truth, _)| **truth >= 0) {
            *all.shared.entry((*truth, *found)).or_default() += 1;
            *all.truth.entry(*truth).or_default() += 1;
            *all.found.entry(*found).or_default() += 1;
        }
        all
    }

    /// The true labels with their points.
    pub fn truth(&self) -> impl Iterator<Item = (i32, u64)> {
        self.truth.iter().map(|(label, points)| (*label, *points))
    }

    /// The found labels with their points.
    pub fn found(&self) -> impl Iterator<Item = (i32, u64)> {
        self.found.iter().map(|(label, points)| (*label, *points))
    }

    /// The found labels in a true one, those with most shared points first.
    pub fn in_truth(&self, truth: i32) -> Vec<Part> {
        self.parts(|(t, _)| t == truth, |(_, f)| (f, self.found.get(&f)))
    }

    /// The true labels in a found one, those with most shared points first.
    pub fn in_found(&self, found: i32) -> Vec<Part> {
        self.parts(|(_, f)| f == found, |(t, _)| (t, self.truth.get(&t)))
    }

    fn parts<'a>(
        &'a self,
        meant: impl Fn((i32, i32)) -> bool,
        other: impl Fn((i32, i32)) -> (i32, Option<&'a u64>),
    ) -> Vec<Part> {
        let part = |(pair, shared): (&(i32, i32), &u64)| {
            let (label, points) = other(*pair);
            let of = |side: &BTreeMap<i32, u64>, label| side.get(&label).copied().unwrap_or(0);
            let union = of(&self.truth, pair.0) + of(&self.found, pair.1) - shared;
            let points = points.copied().unwrap_or(0);
            Part { label, shared: *shared, points, iou: *shared as f64 / union as f64 }
        };
        let mut parts: Vec<Part> = self.shared.iter().filter(|(pair, _)| meant(**pair)).map(part).collect();
        parts.sort_by_key(|part| std::cmp::Reverse(part.shared));
        parts
    }

    /// Found labels as if everything that lies in one true plane by this share of its points had been joined: what is
    /// then wrong is not wrong because planes were split.
    pub fn join(&self, found: &[i32], share: f64) -> Vec<i32> {
        let mut first: BTreeMap<i32, i32> = BTreeMap::new();
        let mut renamed: BTreeMap<i32, i32> = BTreeMap::new();
        for (label, points) in self.found().filter(|(label, _)| *label > 0) {
            let Some(most) = self.in_found(label).first().copied() else { continue };
            if most.label > 0 && most.shared as f64 >= share * points as f64 {
                renamed.insert(label, *first.entry(most.label).or_insert(label));
            }
        }
        found.iter().map(|label| renamed.get(label).copied().unwrap_or(*label)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_in_one_true_plane_is_joined() {
        let truth = [1, 1, 1, 1, 2, 2, 0, -1];
        let found = [5, 5, 6, 6, 6, 7, 8, 6];
        let all = Overlaps::of(&truth, &found);
        assert_eq!(all.join(&found, 0.6), [5, 5, 5, 5, 5, 7, 8, 5]);
        assert_eq!(all.join(&found, 0.8), found);
        let parts = all.in_truth(1);
        assert_eq!(parts[1], Part { label: 6, shared: 2, points: 3, iou: 0.4 });
        assert_eq!(all.in_found(8), [Part { label: 0, shared: 1, points: 1, iou: 1.0 }]);
    }
}
