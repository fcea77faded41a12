//! Clouds and short cuts.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace::{
    Assignment, ExtractedPlane, Frame, Grown, Inserted, LabelledCell, Mapper, Optimise, Params, PlaneMap,
    Scan, Sigma, Weighting,
};
use terrace_synth::{LabelledScan, Scene};

pub const PRESETS: [fn() -> Params; 3] = [Params::default, Params::clusters, Params::paper];

/// Those whose planes are clusters of cells.
pub const CLUSTERED: [fn() -> Params; 2] = [Params::clusters, Params::paper];

/// Cells of a tenth of a metre.
pub fn tenth(preset: fn() -> Params) -> Params {
    Params { cell_size: Some(0.1), ..preset() }
}

pub fn unoptimised(params: Params) -> Params {
    Params { optimise: None, ..params }
}

pub fn with_optimise(params: Params, change: impl Fn(&mut Optimise)) -> Params {
    let mut optimise = params.optimise.unwrap();
    change(&mut optimise);
    Params { optimise: Some(optimise), ..params }
}

pub fn cloud(points: Vec<[f64; 3]>, sigma: Sigma) -> Scan {
    Scan::new(points, sigma, Frame::World { sensor: None }).unwrap()
}

pub fn unknown(points: &[[f64; 3]]) -> Scan {
    cloud(points.to_vec(), Sigma::Unknown)
}

pub fn mapper(params: Params, scans: &[&Scan]) -> Mapper {
    let mut mapper = Mapper::new(params).unwrap();
    for scan in scans {
        mapper.insert(scan).unwrap();
    }
    mapper
}

pub fn map(params: Params, scans: &[&Scan]) -> PlaneMap {
    mapper(params, scans).extract().unwrap()
}

/// The map of one cloud of unknown errors, in cells of a tenth of a metre, and what became of its points.
pub fn tenth_map(preset: fn() -> Params, points: &[[f64; 3]]) -> (Inserted, PlaneMap) {
    let mut mapper = Mapper::new(tenth(preset)).unwrap();
    let inserted = mapper.insert(&unknown(points)).unwrap();
    (inserted, mapper.extract().unwrap())
}

/// A square of 2 m at this height, a point every 2 cm, none on the faces of cells of a tenth of a metre.
pub fn square(height: f64) -> Vec<[f64; 3]> {
    lattice(100, 0.02).into_iter().map(|[x, y]| [x + 0.003, y + 0.003, height]).collect()
}

pub fn lattice(side: u32, spacing: f64) -> Vec<[f64; 2]> {
    (0..side * side).map(|k| [spacing * f64::from(k / side), spacing * f64::from(k % side)]).collect()
}

/// As [`square`], every point moved up or down by up to a millimetre.
pub fn rough(height: f64) -> Vec<[f64; 3]> {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    square(height).into_iter().map(|[x, y, z]| [x, y, z + rng.random_range(-1e-3..1e-3)]).collect()
}

/// Three numbers of the normal law with variance 1, each as the sum of twelve uniform ones.
pub fn gauss(rng: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0
}

/// A rotation about no axis in particular.
pub fn turned(p: [f64; 3]) -> [f64; 3] {
    let pose = terrace::Pose::from_quaternion([0.3, -0.2, 0.7], [0.3, -0.5, 0.2, 0.7]).unwrap();
    pose.transform(p)
}

pub fn scans(scene: &Scene, points: usize, seed: u64) -> Vec<LabelledScan> {
    let params = terrace_synth::Params { points: Some(points), sigma: None, seed };
    scene.generate(&params).unwrap().scans
}

pub fn map_of(params: Params, scans: &[LabelledScan]) -> PlaneMap {
    map(params, &scans.iter().map(|s| &s.scan).collect::<Vec<_>>())
}

pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

/// Between two directions, the sign left aside, in radians. Exact for small angles, unlike the arc cosine.
pub fn angle(a: [f64; 3], b: [f64; 3]) -> f64 {
    let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    dot(cross, cross).sqrt().atan2(dot(a, b).abs())
}

/// Every bit of a map: `Debug` prints the shortest decimals that are no other number, and tells 0 from −0.
pub fn bits(map: &PlaneMap) -> String {
    format!("{map:?}")
}

/// What must hold for any input.
pub fn check_sound(map: &PlaneMap) {
    for (index, plane) in map.planes.iter().enumerate() {
        assert_eq!(plane.id.index(), index);
        assert!((dot(plane.plane.normal(), plane.plane.normal()) - 1.0).abs() < 1e-12);
        let rounding = 1e-9 * (1.0 + plane.plane.d().abs());
        match (plane.estimate, map.used.grown) {
            (Some(estimate), _) => {
                assert!(plane.plane.signed_distance(estimate.centroid).abs() < rounding);
            }
            (None, None) => assert!(plane.plane.signed_distance(plane.centroid).abs() < rounding),
            // A region is fitted to its cells before its points are labelled: they need not have the plane in their middle.
            (None, Some(_)) => {
                assert!(plane.plane.signed_distance(plane.centroid).abs() <= plane.rms + 10.0 * rounding);
            }
        }
        if let Some(estimate) = plane.estimate {
            assert_eq!(estimate.plane, plane.plane);
            let [e1, e2] = estimate.axes;
            let normal = plane.plane.normal();
            for (a, b, expected) in
                [(e1, e1, 1.0), (e2, e2, 1.0), (e1, e2, 0.0), (e1, normal, 0.0), (e2, normal, 0.0)]
            {
                assert!((dot(a, b) - expected).abs() < 1e-9);
            }
            let c = estimate.tilt_offset;
            let entries = [c[0][0], c[0][1], c[0][2], c[1][1], c[1][2], c[2][2]];
            assert!(
                Sigma::is_valid_covariance(entries) && c[0][0] > 0.0 && c[1][1] > 0.0 && c[2][2] > 0.0,
                "{c:?}"
            );
            assert!(estimate.growth >= 1.0 && estimate.reduced_chi_squared >= 0.0);
        }
        assert!(plane.normal_uncertainty.iter().flatten().all(|s| s.is_finite() && *s >= 0.0));
        assert!(plane.rms.is_finite() && plane.rms >= 0.0);
        let labelled = map.labels.iter().filter(|l| **l == Some(plane.id)).count();
        assert_eq!(labelled as u64, plane.points);
        let cells: Vec<_> = map.cells.iter().filter(|c| c.plane == Some(plane.id)).collect();
        assert_eq!(cells.len(), plane.cells);
        match map.used.grown {
            Some(grown) => check_grown(plane, &grown),
            None => check_clustered(plane, &cells),
        }
    }
    let labelled = map.labels.iter().flatten().map(|id| id.index());
    assert!(labelled.max().is_none_or(|most| most < map.planes.len()), "a label of no plane");
    assert!(map.planes.is_sorted_by(|a, b| a.points >= b.points));
    let counts = map.cell_counts;
    assert!(counts.clustered <= counts.dense && counts.dense <= counts.occupied);
    assert_eq!(counts.dense, map.cells.len());
    assert_eq!(map.used.grown.is_some(), map.used.params.regions.is_some() && by_place(&map.used.params));
    if let Some(grown) = map.used.grown {
        assert!(map.optimised.is_empty() && counts.clustered == 0);
        assert!(grown.noise_scale >= 1.0 && grown.min_area.is_finite() && grown.min_area.is_sign_positive());
    }
}

/// Regions need points of the place of their cell, each with weight 1.
fn by_place(params: &Params) -> bool {
    params.assignment == Assignment::Voxel && params.weighting == Weighting::Uniform
}

fn check_grown(plane: &ExtractedPlane, grown: &Grown) {
    assert_eq!((plane.phi, plane.phi_interval), (None, None));
    assert!(plane.points as f64 >= grown.min_points);
    assert!(plane.cells > 0 || plane.normal_uncertainty.is_none());
}

fn check_clustered(plane: &ExtractedPlane, cells: &[&LabelledCell]) {
    assert!(plane.normal_uncertainty.is_some());
    let (phi, interval) = (plane.phi.unwrap(), plane.phi_interval.unwrap());
    assert!(interval.contains(phi), "{phi} in {interval:?}");
    assert_eq!(cells.iter().map(|c| c.points).sum::<u64>(), plane.points);
}
