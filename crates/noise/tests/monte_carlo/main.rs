//! Simulated sensors and poses scatter as predicted.

// A test has no caller to report to.
#![allow(clippy::unwrap_used)]

mod pose;
mod sensors;

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace_noise::Covariance;

/// Enough for a standard deviation to 0.3 %.
const SAMPLES: usize = 60_000;

/// How far a standard deviation may be from the predicted one.
const TOLERANCE: f64 = 0.02;

fn rng(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// A draw from the standard normal distribution (Box and Muller).
fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let (u, v): (f64, f64) = (1.0 - rng.random::<f64>(), rng.random());
    (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn apply(rows: [[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    rows.map(|row| dot(row, v))
}

/// `v` turned about the direction of `omega` by its length (Rodrigues).
fn turned(omega: [f64; 3], v: [f64; 3]) -> [f64; 3] {
    let angle = dot(omega, omega).sqrt();
    if angle == 0.0 {
        return v;
    }
    let axis = omega.map(|x| x / angle);
    let (sine, cosine) = angle.sin_cos();
    let (side, along) = (cross(axis, v), dot(axis, v));
    std::array::from_fn(|i| cosine * v[i] + sine * side[i] + (1.0 - cosine) * along * axis[i])
}

/// The rows of the rotation by `omega`.
fn rotation(omega: [f64; 3]) -> [[f64; 3]; 3] {
    let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| turned(omega, axis));
    std::array::from_fn(|i| columns.map(|column| column[i]))
}

/// Directions along which scatter is compared: the axes, and many between them.
fn directions() -> Vec<[f64; 3]> {
    let mut rng = rng(99);
    let mut all = vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    all.extend((0..50).map(|_| {
        let v = [0; 3].map(|_| normal(&mut rng));
        let length = dot(v, v).sqrt();
        v.map(|x| x / length)
    }));
    all
}

/// Asserts that simulated points scatter as predicted, along each of many directions.
fn agrees(predicted: Covariance, tolerance: f64, mut simulate: impl FnMut() -> [f64; 3]) {
    let points: Vec<_> = (0..SAMPLES).map(|_| simulate()).collect();
    for along in directions() {
        let values = || points.iter().map(|p| dot(*p, along));
        let mean = values().sum::<f64>() / SAMPLES as f64;
        let variance = values().map(|x| (x - mean).powi(2)).sum::<f64>() / (SAMPLES - 1) as f64;
        let ratio = (variance / predicted.along(along).unwrap()).sqrt();
        assert!((ratio - 1.0).abs() < tolerance, "scatter along {along:?} is {ratio} of the predicted one");
    }
}
