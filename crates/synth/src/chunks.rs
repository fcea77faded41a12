//! Scans a scene piece by piece.

use crate::gauss::Gauss;
use crate::params::{Params, SynthError};
use crate::scene::{Hit, Scene};
use crate::sensor::View;
use crate::shape::{Ray, Rectangle, Shape};
use crate::synthetic::{LabelledScan, TruePlane, scan};
use crate::vector::{Vec3, add_scaled};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace_types::{Frame, PlaneId};

/// A piece of a scan.
#[derive(Debug, Clone, PartialEq)]
pub struct Chunk {
    /// The view it belongs to, from 0. The pieces of a view follow each other.
    pub view: usize,
    /// The points, with the frame of their view.
    pub scan: LabelledScan,
}

/// The pieces of a scan in order; made by [`Scene::chunks`].
///
/// ```
/// use terrace_synth::{Params, Scene};
///
/// let room = Scene::room();
/// let mut chunks = room.chunks(&Params { points: Some(100_000), ..Params::default() }, 4_096)?;
/// let total: usize = chunks.by_ref().map(|chunk| chunk.scan.labels.len()).sum();
/// assert_eq!(total, 100_000);
/// // What was seen of each plane on the way.
/// assert_eq!(chunks.planes()[0].name, "floor");
/// # Ok::<(), terrace_synth::SynthError>(())
/// ```
#[derive(Debug)]
pub struct Chunks<'a> {
    scene: &'a Scene,
    points: usize,
    sigma: Option<f64>,
    seed: u64,
    size: usize,
    view: usize,
    /// Points made of the current view.
    made: usize,
    rng: ChaCha8Rng,
    gauss: Gauss,
    /// For each plane the number of its points and the sum of their places in the building.
    seen: Vec<(usize, Vec3)>,
    /// For scenes without views: the rectangles with the area of all up to and including each.
    areas: Vec<(f64, &'a Rectangle, Option<PlaneId>)>,
}

/// One measurement, in the frame of its scan.
struct Measured {
    position: Vec3,
    sigma: f64,
    plane: Option<PlaneId>,
    /// Before noise, in the building.
    truth: Vec3,
}

impl<'a> Chunks<'a> {
    pub(crate) fn new(scene: &'a Scene, params: &Params, size: usize) -> Result<Self, SynthError> {
        Ok(Self {
            scene,
            points: params.checked_points(scene.kind.default_points())?,
            sigma: params.checked_sigma()?,
            seed: params.seed,
            size,
            view: 0,
            made: 0,
            rng: stream(params.seed, 0),
            gauss: Gauss::default(),
            seen: vec![(0, [0.0; 3]); scene.planes.len()],
            areas: summed_areas(scene),
        })
    }

    /// The planes of the scene, with what was seen of them in the pieces so far.
    pub fn planes(&self) -> Vec<TruePlane> {
        self.scene
            .planes
            .iter()
            .zip(&self.seen)
            .map(|(plane, (points, sum))| TruePlane {
                id: plane.id,
                name: plane.name,
                plane: plane.plane,
                centroid: (*points > 0).then(|| {
                    let mean = sum.map(|x| x / *points as f64);
                    self.scene.placement.transform(mean)
                }),
                points: *points,
            })
            .collect()
    }

    /// Points of a view: as equal a share as whole numbers allow.
    fn share(&self, view: usize) -> usize {
        let views = self.scene.views.len().max(1);
        self.points / views + usize::from(view < self.points % views)
    }

    /// Point `k` of the `n` that a sensor measures along its rays.
    fn along_a_ray(&mut self, view: &View, k: usize, n: usize) -> Measured {
        // The buildings are closed, so that a second ray is needed only when rounding opens a gap between two walls.
        loop {
            let direction = view.sensor.direction(k, n, &mut self.rng);
            let origin = view.in_room.translation();
            let ray = Ray { origin, direction: view.in_room.rotate(direction) };
            if let Some(Hit { distance, plane }) = self.scene.cast(&ray) {
                let sigma = self.sigma.unwrap_or_else(|| view.sensor.sigma(direction, distance));
                let range = distance + sigma * self.gauss.sample(&mut self.rng);
                return Measured {
                    position: direction.map(|x| x * range),
                    sigma,
                    plane: plane.and_then(|id| view.plane_in_building(id)),
                    truth: add_scaled(ray.at(distance), 1.0, view.room),
                };
            }
        }
    }

    /// A point spread evenly over the rectangles of the scene, with noise along every axis.
    fn on_the_area(&mut self) -> Measured {
        let total = self.areas.last().map_or(0.0, |(sum, ..)| *sum);
        loop {
            let at = total * self.rng.random::<f64>();
            let place = self.areas.partition_point(|(sum, ..)| *sum <= at);
            if let Some((_, part, plane)) = self.areas.get(place).copied() {
                let shares: [f64; 2] = [self.rng.random(), self.rng.random()];
                let truth = part.at(shares[0], shares[1]);
                let [start, end] = self.scene.white_noise;
                let sigma = self.sigma.unwrap_or(start + shares[0] * (end - start));
                let noise = [0; 3].map(|_| self.gauss.sample(&mut self.rng));
                let position = self.scene.placement.transform(add_scaled(truth, sigma, noise));
                return Measured { position, sigma, plane, truth };
            }
        }
    }
}

impl Iterator for Chunks<'_> {
    type Item = Chunk;

    fn next(&mut self) -> Option<Chunk> {
        let scene = self.scene;
        while self.made == self.share(self.view) {
            if self.view + 1 >= scene.views.len() {
                return None;
            }
            self.view += 1;
            self.made = 0;
            self.rng = stream(self.seed, self.view);
            self.gauss = Gauss::default();
        }
        let n = self.share(self.view);
        let end = n.min(self.made.saturating_add(self.size));
        let mut points = Vec::with_capacity(end - self.made);
        let mut sigmas = Vec::with_capacity(end - self.made);
        let mut labels = Vec::with_capacity(end - self.made);
        let view = scene.views.get(self.view);
        for k in self.made..end {
            let measured = match view {
                Some(view) => self.along_a_ray(view, k, n),
                None => self.on_the_area(),
            };
            points.push(measured.position);
            sigmas.push(measured.sigma);
            labels.push(measured.plane);
            if let Some((count, sum)) = measured.plane.and_then(|id| self.seen.get_mut(id.index())) {
                *count += 1;
                *sum = add_scaled(*sum, 1.0, measured.truth);
            }
        }
        self.made = end;
        let frame = view.map_or(Frame::World { sensor: None }, |view| Frame::Sensor { pose: view.in_world });
        Some(Chunk { view: self.view, scan: LabelledScan { scan: scan(points, sigmas, frame), labels } })
    }
}

/// Every view draws from a stream of its own, so that it does not depend on the views before it.
fn stream(seed: u64, view: usize) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(view as u64);
    rng
}

fn summed_areas(scene: &Scene) -> Vec<(f64, &Rectangle, Option<PlaneId>)> {
    let rectangles = scene.surfaces.iter().filter_map(|surface| match &surface.shape {
        Shape::Rectangle(part) => Some((part, surface.plane)),
        _ => None,
    });
    let mut sum = 0.0;
    rectangles
        .map(|(part, plane)| {
            sum += part.area();
            (sum, part, plane)
        })
        .collect()
}
