//! The numbers as JSON; the fields are in `docs/eval-json.md`.

use serde_json::{Map, Value, json};
use terrace_eval::{Evaluation, Measure};

use crate::commands::eval::Skipped;
use crate::commands::eval::compare::Compared;

/// The version written.
const VERSION: u32 = 1;

/// The whole file.
pub fn json(field: &str, compared: &[Compared], means: &[Measure], skipped: &[Skipped]) -> Value {
    let skipped: Vec<Value> = skipped
        .iter()
        .map(|s| json!({ "pred": s.pair.pred, "truth": s.pair.truth, "reason": s.reason }))
        .collect();
    json!({
        "format": "terrace-eval",
        "version": VERSION,
        "parameters": {
            "field": field,
            "match_above": [Evaluation::HALF, Evaluation::STRICT],
            "segcomp_share": Evaluation::SHARE,
            "pairs_skipped": skipped,
            "program_version": env!("CARGO_PKG_VERSION"),
        },
        "pairs": compared.iter().map(pair).collect::<Vec<_>>(),
        "mean": measures(means),
    })
}

fn pair(compared: &Compared) -> Value {
    let segcomp = &compared.evaluation.segcomp;
    json!({
        "pred": compared.pair.pred,
        "truth": compared.pair.truth,
        "pred_planes": compared.pred_planes,
        "truth_planes": compared.truth_planes,
        "points": compared.evaluation.points,
        "measures": measures(&compared.measures()),
        "over_found": segcomp.over_found,
        "under_true": segcomp.under_true,
        "planes": planes(compared),
    })
}

fn measures(measures: &[Measure]) -> Value {
    let entry = |measure: &Measure| {
        let value = match measure.value {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count from usize")]
            Some(count) if measure.count => json!(count as u64),
            value => json!(value),
        };
        (measure.name.to_owned(), value)
    };
    Value::Object(measures.iter().map(entry).collect::<Map<_, _>>())
}

fn planes(compared: &Compared) -> Vec<Value> {
    let plane = |plane: &terrace_eval::TruePlaneScore| {
        let deviation = compared.deviations.iter().find(|d| d.truth == plane.truth);
        let name = compared.true_planes.get(&plane.truth).and_then(|named| named.name.as_deref());
        json!({
            "id": plane.truth.get(),
            "name": name,
            "points": plane.points,
            "best_iou": plane.best_iou,
            "found": plane.found.map(terrace_types::PlaneId::get),
            "angle_degrees": deviation.map(|d| d.angle.to_degrees()),
            "offset": deviation.and_then(|d| d.offset),
        })
    };
    compared.evaluation.planes.iter().map(plane).collect()
}
