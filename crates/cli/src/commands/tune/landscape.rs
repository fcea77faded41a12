//! The cost along each setting through the best, and everything that was tried.

use terrace::tune::{SliceStep, TuneAxis, Tuned};
use terrace_draw::{DrawError, Image, Sample, Staircase, Step};

/// Edges of a chart, in pixels.
const SIZE: (usize, usize) = (800, 480);

const COLUMNS: usize = 2;

/// One chart for each setting that was searched; `None` when all were fixed.
pub fn draw(tuned: &Tuned, slices: &[(TuneAxis, Vec<SliceStep>)]) -> Result<Option<Image>, DrawError> {
    let charts: Vec<Image> = slices
        .iter()
        .filter_map(|(axis, slice)| chart(tuned, *axis, slice))
        .map(|chart| chart.image(SIZE.0, SIZE.1))
        .collect::<Result<_, _>>()?;
    if charts.is_empty() { Ok(None) } else { Image::tiled(&charts, COLUMNS).map(Some) }
}

fn chart(tuned: &Tuned, axis: TuneAxis, slice: &[SliceStep]) -> Option<Staircase> {
    let steps = steps(slice);
    let range = [steps.first()?.low, steps.last()?.high];
    let samples = tuned.trials.iter().map(|trial| Sample {
        x: trial.settings.get(axis),
        value: trial.value,
        evaluated: trial.evaluated,
    });
    let (name, label) = match axis {
        TuneAxis::CellSize => ("cell size", "cell size, m"),
        TuneAxis::Depth => ("depth", "depth of neighbourhoods, cells"),
        TuneAxis::Tau => ("tau", "tau, points"),
        TuneAxis::Omega => ("omega", "omega"),
        TuneAxis::Phi => ("phi", "phi"),
    };
    Some(Staircase {
        title: format!("cost along {name} through the best"),
        ticks: if single(slice) { slice.iter().map(|step| step.lo).collect() } else { Vec::new() },
        steps,
        samples: samples.collect(),
        best: Some([tuned.best.get(axis), tuned.step.value]),
        ..Staircase::new(label, "cost", range)
    })
}

/// Whether a setting has single values.
fn single(slice: &[SliceStep]) -> bool {
    slice.iter().all(|step| step.lo.to_bits() == step.hi.to_bits())
}

/// Single values as steps that reach half way to their neighbours.
fn steps(slice: &[SliceStep]) -> Vec<Step> {
    if !single(slice) {
        return slice.iter().map(|s| Step { low: s.lo, high: s.hi, value: s.value }).collect();
    }
    let half = |at: usize| match (slice.get(at), slice.get(at + 1)) {
        (Some(here), Some(next)) => (next.lo - here.lo) / 2.0,
        _ => 0.0,
    };
    let last = slice.len().saturating_sub(1);
    (0..slice.len())
        .map(|at| {
            let SliceStep { lo, value, .. } = slice[at];
            // At the ends as far out as in.
            let down = if at == 0 { half(0) } else { half(at - 1) };
            let up = if at == last { down } else { half(at) };
            Step { low: lo - down, high: lo + up, value }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_values_become_steps_without_gaps() {
        let slice = [1.0, 2.0, 4.0].map(|x| SliceStep { lo: x, hi: x, value: x });
        let ends: Vec<[f64; 2]> = steps(&slice).iter().map(|s| [s.low, s.high]).collect();
        assert_eq!(ends, [[0.5, 1.5], [1.5, 3.0], [3.0, 5.0]]);
        let stairs = [SliceStep { lo: 0.0, hi: 0.5, value: 1.0 }, SliceStep { lo: 0.5, hi: 0.5, value: 2.0 }];
        assert_eq!(steps(&stairs)[1], Step { low: 0.5, high: 0.5, value: 2.0 });
    }
}
