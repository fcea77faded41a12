//! Simulated surfaces, put into cells.

// Each test file uses the part it needs.
#![allow(dead_code, reason = "shared by tests of which none uses all")]
#![allow(clippy::unwrap_used, reason = "tests")]

use std::collections::HashMap;

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace_regions::{Cell, Points, Segmentation, Settings, segment};
use terrace_stats::{Stats, UncertainVector};

/// Points measured with the same error along every axis.
pub struct Scene {
    random: ChaCha8Rng,
    sigma: f64,
    pub points: Vec<[f64; 3]>,
    /// The surface that each point is of.
    pub truth: Vec<usize>,
}

impl Scene {
    pub fn new(seed: u64, sigma: f64) -> Self {
        let random = ChaCha8Rng::seed_from_u64(seed);
        Self { random, sigma, points: Vec::new(), truth: Vec::new() }
    }

    /// Measures so many places of a surface, which maps two numbers from 0 to 1.
    pub fn add(&mut self, surface: usize, points: usize, place: impl Fn(f64, f64) -> [f64; 3]) {
        for _ in 0..points {
            let [u, v] = [0; 2].map(|_| self.random.random::<f64>());
            let measured = place(u, v).map(|x| x + self.sigma * self.normal());
            self.points.push(measured);
            self.truth.push(surface);
        }
    }

    /// Of the standard normal distribution, by the method of Box and Muller.
    fn normal(&mut self) -> f64 {
        let [u, v] = [0; 2].map(|_| self.random.random::<f64>());
        (-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }

    /// The points in cells, with the error they have as the one that is stated.
    pub fn cells(&self, edge: f64) -> Sorted {
        Sorted::of(&self.points, edge, self.sigma)
    }
}

/// Points in cells.
#[derive(Debug, Clone)]
pub struct Sorted {
    pub edge: f64,
    pub cells: Vec<Cell>,
    pub cell_of: Vec<Option<u32>>,
    pub places: Vec<[f32; 3]>,
}

impl Sorted {
    /// Cells are in the order of their first points.
    pub fn of(points: &[[f64; 3]], edge: f64, sigma: f64) -> Self {
        Self::of_some_wide(points, edge, sigma, |_| false)
    }

    /// With a wide cell in the place of eight where `is_wide` says so of half of their keys.
    pub fn of_some_wide(
        points: &[[f64; 3]],
        edge: f64,
        sigma: f64,
        is_wide: impl Fn([i32; 3]) -> bool,
    ) -> Self {
        let mut sorted = Self { edge, cells: Vec::new(), cell_of: Vec::new(), places: Vec::new() };
        let mut known: HashMap<[i32; 3], u32> = HashMap::new();
        for point in points {
            #[allow(clippy::cast_possible_truncation, reason = "scenes are small")]
            let key = point.map(|x| (x / edge).floor() as i32);
            let is_wide = is_wide(key.map(|k| k >> 1));
            // Any of the eight keys will do.
            let key = if is_wide { key.map(|k| k | 1) } else { key };
            let anchor = key.map(|k| (f64::from(k) + if is_wide { 0.0 } else { 0.5 }) * edge);
            let number = *known.entry(key).or_insert_with(|| {
                sorted.cells.push(Cell { key, is_wide, stats: Stats::new(anchor) });
                u32::try_from(sorted.cells.len() - 1).unwrap()
            });
            sorted.cells[number as usize].stats.push(&UncertainVector::isotropic(*point, sigma));
            sorted.cell_of.push(Some(number));
            #[allow(clippy::cast_possible_truncation, reason = "single precision is what is asked for")]
            sorted.places.push([0, 1, 2].map(|i| (point[i] - anchor[i]) as f32));
        }
        sorted
    }

    pub fn points(&self) -> Points<'_> {
        Points { cells: &self.cell_of, places: &self.places }
    }

    pub fn segment(&self) -> Segmentation {
        segment(&self.cells, self.edge, self.points(), &Settings::default()).unwrap()
    }
}

/// A rectangle by a corner and two sides.
pub fn rectangle(corner: [f64; 3], u: [f64; 3], v: [f64; 3]) -> impl Fn(f64, f64) -> [f64; 3] {
    move |a, b| [0, 1, 2].map(|i| corner[i] + a * u[i] + b * v[i])
}

pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
