//! What each step of the method is worth: the scores without it.

use terrace::{Params, RegionStep, Regions};

use crate::labelled::Labelled;
use crate::scenes::SceneError;
use crate::{Score, value};

/// F1 at 0.8 and weighted cover, as they are and without each step.
#[derive(Debug, Clone)]
pub struct Ablation {
    /// F1 and cover with all steps, then without each of [`RegionStep::ALL`].
    pub scores: Vec<[Option<f64>; 2]>,
}

impl Ablation {
    /// Extracts the planes once with all steps and once without each.
    ///
    /// # Errors
    /// When an extraction fails.
    pub fn of(scene: &Labelled) -> Result<Self, SceneError> {
        let without = std::iter::once(None).chain(RegionStep::ALL.map(Some));
        let score = |leave_out| {
            let regions = Some(Regions { leave_out, ..Regions::default() });
            let measures = Score::of(scene, Params { regions, ..Params::default() })?.measures;
            Ok(["f1_80", "weighted_cover"].map(|name| value(&measures, name)))
        };
        Ok(Self { scores: without.map(score).collect::<Result<_, SceneError>>()? })
    }

    /// The means over scenes of a group.
    pub fn mean(of: &[&Self]) -> Self {
        let runs = of.first().map_or(0, |first| first.scores.len());
        let mean = |run: usize, which: usize| {
            let values: Vec<f64> = of.iter().filter_map(|one| one.scores.get(run)?[which]).collect();
            (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
        };
        Self { scores: (0..runs).map(|run| [0, 1].map(|which| mean(run, which))).collect() }
    }

    /// The heading of the table.
    pub fn heading() -> String {
        let steps: Vec<String> =
            RegionStep::ALL.iter().map(|step| format!("no {step:?}").to_lowercase()).collect();
        format!(
            "| scene | all steps | {} |\n|---|---|{}",
            steps.join(" | "),
            "---|".repeat(RegionStep::ALL.len())
        )
    }

    /// A row: F1 and cover with all steps, then how far both fall without each; empty where neither changes by a thousandth.
    pub fn row(&self, name: &str) -> String {
        let Some(all) = self.scores.first() else { return String::new() };
        let shown = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |v| format!("{v:.3}"));
        let fall = |(with, without): (&Option<f64>, &Option<f64>)| Some(without.as_ref()? - with.as_ref()?);
        let cell = |without: &[Option<f64>; 2]| {
            let falls: Vec<f64> = all.iter().zip(without).filter_map(fall).collect();
            match falls[..] {
                [f1, cover] if f1.abs() >= 0.0005 || cover.abs() >= 0.0005 => {
                    format!("{f1:+.3} / {cover:+.3}")
                }
                _ => String::new(),
            }
        };
        let cells: Vec<String> = self.scores.iter().skip(1).map(cell).collect();
        format!("| {name} | {} / {} | {} |", shown(all[0]), shown(all[1]), cells.join(" | "))
    }
}
