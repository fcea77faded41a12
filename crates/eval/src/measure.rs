//! Measures by name, for tables and files.

use crate::evaluation::mean;
use crate::{Evaluation, Matches};

/// A measure by name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measure {
    /// Its name, in lower case with underscores.
    pub name: &'static str,
    /// Its value, if it has one.
    pub value: Option<f64>,
    /// Whether it is a number of planes; all others are shares from 0 to 1, unless the name says otherwise.
    pub count: bool,
}

impl Measure {
    /// A measure that is no count.
    pub fn new(name: &'static str, value: Option<f64>) -> Self {
        Self { name, value, count: false }
    }

    /// A number of planes.
    pub fn count(name: &'static str, count: usize) -> Self {
        Self { name, value: Some(count as f64), count: true }
    }

    /// The mean of each measure over rows that hold the same measures in the same order, of those rows in which it has a
    /// value. Empty without rows.
    pub fn means(rows: &[Vec<Self>]) -> Vec<Self> {
        let names = rows.first().map(Vec::as_slice).unwrap_or_default().iter().enumerate();
        names
            .map(|(at, measure)| {
                let values = rows.iter().filter_map(|row| row.get(at)?.value);
                Self::new(measure.name, mean(values))
            })
            .collect()
    }
}

impl Evaluation {
    /// All measures but those of single planes, always in the same order.
    pub fn measures(&self) -> Vec<Measure> {
        let at = |matches: &Matches, [matched, precision, recall, f1]: [&'static str; 4]| {
            [
                Measure::count(matched, matches.matched),
                Measure::new(precision, matches.precision()),
                Measure::new(recall, matches.recall()),
                Measure::new(f1, matches.f1()),
            ]
        };
        let segcomp = &self.segcomp;
        let mut all = vec![
            Measure::count("true_planes", self.half.true_planes),
            Measure::count("found_planes", self.half.found_planes),
        ];
        all.extend(at(&self.half, ["matched_50", "precision_50", "recall_50", "f1_50"]));
        all.extend(at(&self.strict, ["matched_80", "precision_80", "recall_80", "f1_80"]));
        all.extend([
            Measure::count("correct", segcomp.correct),
            Measure::count("over", segcomp.over),
            Measure::count("under", segcomp.under),
            Measure::count("missed", segcomp.missed),
            Measure::count("noise", segcomp.noise),
            Measure::new("weighted_cover", self.weighted_cover),
            Measure::new("cover", self.cover),
            Measure::new("mean_iou", self.mean_iou),
            Measure::new("mean_iou_all", self.mean_iou_all),
            Measure::new("mean_dice", self.mean_dice),
            Measure::new("point_accuracy", self.point_accuracy),
            Measure::new("non_planar_claimed", self.non_planar_claimed),
        ]);
        all
    }
}
