//! What the default settings find in a labelled scene, and how good that is.

use std::collections::BTreeMap;
use std::time::Instant;

use terrace::{ExtractedPlane, Mapper, Params, PlaneId};
use terrace_eval::{Contingency, Evaluation, Measure, PlaneAt, Spread};

use crate::Usage;
use crate::labelled::Labelled;
use crate::overlap::Overlaps;
use crate::scenes::SceneError;

/// A scene after extraction.
#[derive(Debug, Clone)]
pub struct Score {
    /// Everything measured, by name, always in the same order.
    pub measures: Vec<Measure>,
    /// The labels found.
    pub found: Vec<i32>,
    /// Which points true and found planes share.
    pub overlaps: Overlaps,
    /// The planes found.
    pub planes: Vec<ExtractedPlane>,
}

impl Score {
    /// Extracts the planes with these settings and compares them.
    ///
    /// # Errors
    /// When the extraction or the count of CPU time fails.
    pub fn of(scene: &Labelled, params: Params) -> Result<Self, SceneError> {
        // Where the peak cannot be forgotten, that of an earlier scene may be higher.
        let alone = Usage::forget_peak().is_ok();
        let (begin, clock) = (Usage::now()?, Instant::now());
        let mut mapper = Mapper::new(params)?;
        for scan in &scene.scans {
            mapper.insert(scan)?;
        }
        let map = mapper.extract()?;
        let (end, clock) = (Usage::now()?, clock.elapsed());

        let found: Vec<i32> = map.labels.iter().map(|id| PlaneId::label(*id)).collect();
        let evaluation = Evaluation::of(&Contingency::of_numbers(&scene.truth, &found)?);
        let overlaps = Overlaps::of(&scene.truth, &found);
        let joined = overlaps.join(&found, Evaluation::SHARE);
        let joined = Evaluation::of(&Contingency::of_numbers(&scene.truth, &joined)?);
        let truth = scene.planes.iter().map(|(id, known)| (*id, known.plane)).collect();
        let planes: BTreeMap<PlaneId, PlaneAt> =
            map.planes.iter().map(|p| (p.id, PlaneAt { plane: p.plane, centre: Some(p.centroid) })).collect();
        let deviations = evaluation.deviations(&truth, &planes);
        let angle = Spread::of(deviations.iter().map(|d| d.angle.to_degrees()));
        let offset = Spread::of(deviations.iter().filter_map(|d| d.offset));

        let mut measures = vec![Measure::count("points", mapper.len())];
        measures.extend(evaluation.measures());
        measures.extend([
            Measure::new("joined_f1_80", joined.strict.f1()),
            Measure::new("angle_degrees_median", angle.map(|s| s.median)),
            Measure::new("offset_millimetres_median", offset.map(|s| 1000.0 * s.median)),
            Measure::new("cell_size", Some(map.used.cell_size)),
            Measure::new("cpu_seconds", Some(end.cpu - begin.cpu)),
            Measure::new("clock_seconds", Some(clock.as_secs_f64())),
            Measure::new("peak_mib", alone.then_some(end.peak)),
        ]);
        Ok(Self { measures, found, overlaps, planes: map.planes })
    }
}

/// The value of the measure of this name.
pub fn value(measures: &[Measure], name: &str) -> Option<f64> {
    measures.iter().find(|m| m.name == name)?.value
}
