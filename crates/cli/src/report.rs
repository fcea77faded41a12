//! A plane map as `planes.json`.

use serde_json::{Map, Value, json};
use terrace::{
    Assignment, CostForm, ExtractedPlane, FitTo, Grown, Join, NoiseKnot, NoiseLevel, PlaneEstimate, PlaneId,
    PlaneMap, Regions, Search, Weighting,
};
use terrace_io::planes_json::{
    OptimisedSummary, PhiInterval, PlaneRecord, PlanesFile, Summary, TiltOffset, Timings,
};

/// Everything `planes.json` holds. `extra` are parameters of the run that the map does not know, `area` is that of a plane in
/// square metres, where it is known.
pub fn planes_file(
    map: &PlaneMap,
    area: impl Fn(PlaneId) -> Option<f64>,
    extra: Map<String, Value>,
    timings: Timings,
) -> PlanesFile {
    let summary = map.summary();
    let mut parameters = parameters(map);
    parameters.extend(extra);
    PlanesFile {
        parameters,
        planes: map.planes.iter().map(|plane| record(plane, area(plane.id))).collect(),
        summary: Some(Summary {
            points: summary.points as u64,
            labelled: summary.labelled as u64,
            planes: summary.planes as u64,
            normal_uncertainty_mean: summary.normal_uncertainty_mean,
            optimised: map.used.params.optimise.filter(|_| map.used.grown.is_none()).map(|_| optimised(map)),
        }),
        timings_seconds: Some(timings),
    }
}

fn record(plane: &ExtractedPlane, area: Option<f64>) -> PlaneRecord {
    let mut record = PlaneRecord::new(plane.id, &plane.plane, plane.points);
    record.centroid = Some(plane.centroid);
    record.normal_uncertainty = plane.normal_uncertainty;
    if let Some(estimate) = &plane.estimate {
        record.covariance = Some(estimate.coefficients);
        record.tilt_offset_covariance = Some(tilt_offset(estimate));
        record.reduced_chi_squared = Some(estimate.reduced_chi_squared);
        record.growth = Some(estimate.growth);
        record.min_max = estimate.min_max;
    }
    record.cells = Some(plane.cells as u64);
    record.area = area;
    record.rms = Some(plane.rms);
    record.phi = plane.phi;
    record.phi_interval = plane.phi_interval.map(|interval| PhiInterval { lo: interval.lo, hi: interval.hi });
    record
}

/// The covariance of a plane, as it stands in `planes.json`.
pub fn tilt_offset(estimate: &PlaneEstimate) -> TiltOffset {
    TiltOffset { at: estimate.centroid, axes: estimate.axes, matrix: estimate.tilt_offset }
}

fn parameters(map: &PlaneMap) -> Map<String, Value> {
    let used = &map.used;
    let p = &used.params;
    // What clusters are made with means nothing where regions are grown.
    let clusters = used.grown.is_none();
    let optimise = p.optimise.filter(|_| clusters).map_or(Value::Null, |o| {
        json!({
            "above": o.above,
            "cost": match o.form { CostForm::Sum => "sum", CostForm::Share => "share" },
            "weight_uncertainty": o.weight_uncertainty,
            "weight_clusters": o.weight_clusters,
            "search": search(o.search),
        })
    });
    let chosen = used.chosen.map_or(Value::Null, |c| json!({ "spacing": c.spacing, "sigma": c.sigma }));
    let entries = [
        ("cell_size", json!(used.cell_size)),
        ("cell_size_from", chosen),
        ("tau", json!(used.tau)),
        // JSON has no infinity: an omega that excludes nothing is null.
        ("omega", json!((clusters && p.omega.is_finite()).then_some(p.omega))),
        ("phi", json!(clusters.then_some(p.phi))),
        ("depth", json!(p.depth)),
        ("connectivity", json!(p.connectivity.neighbours())),
        (
            "assignment",
            json!(match p.assignment {
                Assignment::Voxel => "voxel",
                Assignment::ExpectedDistance => "expected_distance",
            }),
        ),
        (
            "weighting",
            json!(match p.weighting {
                Weighting::Uniform => "uniform",
                Weighting::Information => "information",
            }),
        ),
        (
            "fit",
            json!(match p.fit {
                FitTo::Centres => "centres",
                FitTo::Points => "points",
            }),
        ),
        ("seeds", json!(clusters.then_some(if p.random_seeds { "random" } else { "most_certain" }))),
        ("optimise", optimise),
        ("regions", json!(p.regions.zip(used.grown).map(|(asked, used)| regions(&asked, &used)))),
        ("estimate", json!(p.estimate.map(|estimate| json!({ "floor": estimate.floor })))),
        ("noise_found", json!(map.noise.as_ref().map(noise))),
        ("min_cells", json!(clusters.then_some(p.min_cells))),
        ("seed", json!(p.seed)),
        ("cells_occupied", json!(map.cell_counts.occupied)),
        ("cells_dense", json!(map.cell_counts.dense)),
        ("cells_clustered", json!(clusters.then_some(map.cell_counts.clustered))),
    ];
    entries.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}

fn optimised(map: &PlaneMap) -> OptimisedSummary {
    let searches = || map.optimised.iter().map(|o| &o.minimum);
    let certified: f64 = searches().filter_map(|m| m.certified).sum();
    let clusters = searches().count();
    OptimisedSummary {
        clusters: clusters as u64,
        proven: searches().filter(|m| m.is_proven()).count() as u64,
        certified_mean: (clusters > 0).then(|| certified / clusters as f64),
        evaluations: searches().map(|m| m.evaluations as u64).sum(),
    }
}

fn regions(asked: &Regions, used: &Grown) -> Value {
    json!({
        "join": match asked.join { Join::Touching => "touching", Join::Coplanar => "coplanar" },
        "tilt": asked.tilt,
        "reach": asked.reach,
        "turn": asked.turn,
        "errors_are_complete": asked.errors_are_complete,
        "min_points": used.min_points,
        "min_area": used.min_area,
        "noise_scale": used.noise_scale,
    })
}

fn noise(found: &NoiseLevel) -> Value {
    let knot = |knot: &NoiseKnot| json!({ "range": knot.range, "along": knot.along, "across": knot.across });
    json!({ "places": found.places, "knots": found.knots.iter().map(knot).collect::<Vec<_>>() })
}

fn search(search: Search) -> Value {
    match search {
        Search::Certified { evaluations } => json!({ "method": "certified", "evaluations": evaluations }),
        Search::ControlledRandom { population, subset, rounds } => {
            json!({ "method": "controlled random", "population": population, "subset": subset, "rounds": rounds })
        }
    }
}
