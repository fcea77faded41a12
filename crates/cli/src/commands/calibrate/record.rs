//! `calibrate.json`; its fields are in `docs/calibrate-json.md`.

use std::path::Path;

use serde::Serialize;
use serde_json::{Map, Value, json};
use terrace_calibration::{Calibration, Exceedance, LEVELS, Share};
use terrace_io::{WriteError, WriteErrorKind, write_atomically};
use terrace_trials::{PlaneAgreement, Ratio, Scatter};

use super::params;
use crate::calibrate_args::CalibrateArgs;

/// The version written.
const VERSION: u32 = 1;
/// The level of all bands and intervals.
const LEVEL: f64 = 0.95;

/// The file, to be filled in.
pub struct Record {
    kind: &'static str,
    parameters: Map<String, Value>,
    fields: Map<String, Value>,
}

impl Record {
    /// With the parameters that all kinds have.
    pub fn new(kind: &'static str, args: &CalibrateArgs) -> Self {
        let used = params(args, args.floor.unwrap_or(0.0));
        let mut record = Self { kind, parameters: Map::new(), fields: Map::new() };
        record.parameter("cell_size", used.cell_size);
        record.parameter("tau", used.tau);
        if args.clusters {
            record.parameter("omega", used.omega);
            record.parameter("phi", used.phi);
            record.parameter("depth", used.depth);
            record.parameter("min_cells", used.min_cells);
        }
        record.parameter("floor", args.floor.unwrap_or(0.0));
        record.parameter("seed", args.seed);
        let pose_sigma = args.pose_sigma;
        record.parameter(
            "pose_sigma",
            pose_sigma.map(|s| json!({ "translation": s.translation(), "rotation": s.rotation() })),
        );
        record.parameter("program_version", env!("CARGO_PKG_VERSION"));
        record
    }

    pub fn parameter(&mut self, name: &str, value: impl Serialize) {
        self.parameters.insert(name.to_owned(), json!(value));
    }

    pub fn set(&mut self, name: &str, value: impl Serialize) {
        self.fields.insert(name.to_owned(), json!(value));
    }

    pub fn write(self, path: &Path) -> Result<(), WriteError> {
        let mut value = json!({
            "format": "terrace-calibrate",
            "version": VERSION,
            "kind": self.kind,
            "parameters": self.parameters,
        });
        if let Value::Object(all) = &mut value {
            all.extend(self.fields);
        }
        write_atomically(path, |out| {
            serde_json::to_writer_pretty(&mut *out, &value)
                .map_err(|error| WriteErrorKind::Io(error.into()))?;
            Ok(out.write_all(b"\n")?)
        })
    }
}

pub fn of_calibration(calibration: &Calibration) -> Value {
    let ratio = Ratio::of(calibration);
    let test = calibration.kolmogorov_smirnov();
    let coverage: Vec<Value> = LEVELS
        .iter()
        .map(|level| json!({ "level": level, "share": calibration.coverage(*level).map(share) }))
        .collect();
    json!({
        "count": calibration.count(),
        "refused": calibration.refused(),
        "degrees_of_freedom": calibration.degrees_of_freedom(),
        "nees": calibration.nees(),
        "nees_band": calibration.nees_band(LEVEL),
        "nees_interval": calibration.nees_interval(LEVEL),
        "ratio": ratio.map(|ratio| ratio.rms),
        "ratio_median": ratio.map(|ratio| ratio.median),
        "coverage": coverage,
        "kolmogorov_smirnov": test.map(|t| json!({ "statistic": t.statistic, "p_value": t.p_value })),
    })
}

pub fn exceedance(bounds: &Exceedance) -> Option<Value> {
    bounds.share().map(share)
}

fn share(share: Share) -> Value {
    json!({
        "hits": share.hits(),
        "of": share.of(),
        "value": share.value(),
        "interval": share.interval(LEVEL),
    })
}

pub fn of_scatter(scatter: &Scatter) -> Value {
    json!({
        "squared": scatter.squared,
        "degrees": scatter.degrees,
        "reduced": scatter.reduced(),
        "band": scatter.band(LEVEL),
    })
}

pub fn of_plane(plane: &PlaneAgreement) -> Value {
    let residuals: Vec<Value> = plane
        .residuals
        .iter()
        .map(|r| {
            json!({
                "input": r.scan,
                "points": r.points,
                "columns": r.columns,
                "growth": r.growth,
                "reduced_chi_squared": r.reduced_chi_squared,
                "distance": r.distance,
                "difference": r.difference,
                "predicted": r.predicted,
                "squared": r.squared,
            })
        })
        .collect();
    let mut entry = of_calibration(&plane.calibration);
    entry["id"] = plane.id.get().into();
    entry["points"] = plane.points.into();
    entry["scatter"] = of_scatter(&plane.scatter);
    entry["residuals"] = residuals.into();
    entry
}
