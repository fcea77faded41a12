//! `tune.json`; its fields are in `docs/tune-json.md`.

use std::path::Path;

use serde_json::{Value, json};
use terrace::StopReason;
use terrace::tune::{Settings, SliceStep, TuneAxis, TuneSpace, TuneStep, Tuned};
use terrace_io::{Source, WriteError, WriteErrorKind, write_atomically};

use crate::args::{QualityMeasure, TuneArgs};
use crate::commands::tune::MATCH_ABOVE;

/// The version written.
const VERSION: u32 = 1;

/// What the file tells.
pub struct Record<'a> {
    pub args: &'a TuneArgs,
    pub space: &'a TuneSpace,
    pub tuned: &'a Tuned,
    pub slices: &'a [(TuneAxis, Vec<SliceStep>)],
    pub skipped: &'a [(Source, String)],
}

impl Record<'_> {
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        write_atomically(path, |out| {
            serde_json::to_writer_pretty(&mut *out, &self.json())
                .map_err(|error| WriteErrorKind::Io(error.into()))?;
            Ok(out.write_all(b"\n")?)
        })
    }

    fn json(&self) -> Value {
        let Self { args, space, tuned, slices, skipped } = self;
        let skipped: Vec<Value> =
            skipped.iter().map(|(s, why)| json!({ "input": s.path, "reason": why })).collect();
        let slices: serde_json::Map<String, Value> = slices
            .iter()
            .map(|(axis, steps)| {
                let steps = steps.iter().map(|s| json!([s.lo, s.hi, s.value])).collect();
                (axis.name().to_owned(), Value::Array(steps))
            })
            .collect();
        let trials: Vec<Value> = tuned
            .trials
            .iter()
            .map(|trial| {
                let mut entry = settings(&trial.settings, trial.value);
                entry["evaluated"] = json!(trial.evaluated);
                entry
            })
            .collect();
        let mut best = settings(&tuned.best, tuned.step.value);
        best["same_result"] = same_result(&tuned.step);
        json!({
            "format": "terrace-tune",
            "version": VERSION,
            "parameters": {
                "preset": args.preset.name(),
                "seed": args.seed,
                "min_cells": tuned.params.min_cells,
                "evaluations": args.evaluations,
                "inputs_skipped": skipped,
                "program_version": env!("CARGO_PKG_VERSION"),
            },
            "cost": self.cost(),
            "space": {
                "cell_size": space.cell_size,
                "depth": space.depth,
                "tau": space.tau,
                "omega": space.omega,
                "phi": space.phi,
            },
            "before": settings(&tuned.before_settings, tuned.before.value),
            "best": best,
            "evaluations": tuned.evaluations,
            "certified": tuned.certified,
            "stop": match tuned.stop {
                StopReason::Certified => "certified",
                StopReason::Cancelled => "cancelled",
                _ => "evaluations",
            },
            "trials": trials,
            "slices": slices,
        })
    }

    fn cost(&self) -> Value {
        match (&self.args.labels, self.args.quality) {
            (None, _) => json!({
                "of": "uncertainty",
                "weight_uncertainty": 1.0,
                "weight_clusters": self.args.weight_clusters,
            }),
            (Some(_), QualityMeasure::Cover) => json!({ "of": "labels", "quality": "cover" }),
            (Some(_), QualityMeasure::F1) => {
                json!({ "of": "labels", "quality": "f1", "match_above": MATCH_ABOVE })
            }
        }
    }
}

fn settings(of: &Settings, cost: f64) -> Value {
    json!({
        "cell_size": of.cell_size,
        "depth": of.depth,
        "tau": of.tau,
        "omega": of.omega,
        "phi": of.phi,
        "cost": cost,
    })
}

/// JSON has no infinity: no upper end is null.
fn same_result(step: &TuneStep) -> Value {
    let (omega, end) = step.omega;
    json!({
        "tau": [step.tau.0, step.tau.1],
        "omega": [omega, end.is_finite().then_some(end)],
        "phi": [step.phi.lo, step.phi.hi],
    })
}
