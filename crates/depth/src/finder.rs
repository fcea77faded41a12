//! From a depth image to planes.

use terrace_noise::{ScanNoise, SensorNoise};
use terrace_types::PlaneId;

use crate::camera::Camera;
use crate::errors::{Errors, scale_of};
use crate::flat::Noise;
use crate::grow::{Image, Region};
use crate::labels::{Candidate, Count, Labels};
use crate::looks::{self, Looks};
use crate::plane::DepthPlane;
use crate::pyramid::Pyramid;
use crate::regions::regions;
use crate::sum::Sum;
use crate::tile::Tile;
use crate::tiles::{self, TILE, Tiling};
use crate::{DepthError, Settings};

/// Points are taken to be known no better than to this share of the edge of two tiles: what is smaller is not looked at as a shape.
const FLOOR: f64 = 0.02;
/// A plane is as wide as so many pixels.
const NARROWEST: f64 = 1.5 * 2.0 * TILE as f64;
/// A region that keeps a smaller share of the points of its tiles is explained by others.
const OWN: f64 = 0.5;
/// Without a setting: the share of all points, their least number and that which is always enough, and the share of the area of all
/// planes.
const SHARE_OF_POINTS: f64 = 0.004;
const FEWEST_POINTS: f64 = 20.0;
const ENOUGH_POINTS: f64 = 250.0;
const SHARE_OF_AREA: f64 = 0.0025;
/// A bend is seen from so many standard errors on.
const SIGNIFICANT: f64 = 4.0;

/// Finds the planes of depth images of one camera, one after the other; keeps memory from one to the next. See the
/// [crate page](crate).
#[derive(Debug, Clone)]
pub struct PlaneFinder {
    camera: Camera,
    noise: Option<ScanNoise>,
    settings: Settings,
    sums: Vec<Sum>,
    tiles: Vec<Option<Tile>>,
    pyramid: Pyramid,
    owners: Vec<u32>,
    labels: Vec<u32>,
}

/// The planes of an image.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthPlanes {
    /// The planes, those with most pixels first.
    pub planes: Vec<DepthPlane>,
    /// The plane of each pixel, row by row.
    pub labels: Vec<Option<PlaneId>>,
    /// Pixels with a depth.
    pub points: usize,
    /// What the variances of errors were multiplied by, because planes scatter by more: 1 where stated errors are all there is.
    pub noise_scale: f64,
    /// The fewest pixels of a plane.
    pub min_points: f64,
    /// The least area of a plane, in m².
    pub min_area: f64,
}

impl DepthPlanes {
    /// Edge of a tile in pixels.
    pub const TILE: usize = TILE;
}

impl PlaneFinder {
    /// For images of this camera, whose errors are those of a model of the sensor, in its frame; without one they are found from each
    /// image.
    ///
    /// # Errors
    /// [`DepthError`] for settings out of their range.
    pub fn new(camera: Camera, noise: Option<SensorNoise>, settings: Settings) -> Result<Self, DepthError> {
        settings.validate()?;
        let in_camera = |noise| ScanNoise::new(noise, Some([0.0; 3]))?.with_axis([0.0, 0.0, 1.0]);
        Ok(Self {
            camera,
            noise: noise.map(in_camera).transpose()?,
            settings,
            sums: Vec::new(),
            tiles: Vec::new(),
            pyramid: Pyramid::default(),
            owners: Vec::new(),
            labels: Vec::new(),
        })
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Finds the planes of an image, given as raw depths row by row; 0 and 65535 are no measurement.
    ///
    /// # Errors
    /// [`DepthError::Length`] when there are not as many as pixels.
    pub fn find(&mut self, raw: &[u16]) -> Result<DepthPlanes, DepthError> {
        let Self { camera, noise, settings, sums, tiles, pyramid, owners, labels } = self;
        let expected = camera.width * camera.height;
        if raw.len() != expected {
            return Err(DepthError::Length { found: raw.len(), expected });
        }
        let tiling = Tiling::of(camera);
        tiles::sums(raw, camera, sums);
        let errors = match noise {
            Some(noise) => Errors::Stated(*noise),
            None => Errors::found(sums, camera),
        };
        let mut points = 0.0;
        for sum in sums.iter_mut().filter(|sum| sum.points() > 0.0) {
            points += sum.points();
            *sum = errors.at(sum.mean()).map_or(Sum::ZERO, |covariance| sum.with_noise(covariance));
        }
        tiles.clear();
        tiles.extend(sums.iter().map(Tile::of));
        pyramid.fill(sums, tiling);

        let edge = 2.0 * TILE as f64 * camera.pixel();
        let image = Image { tiles, sums, levels: &pyramid.levels };
        let are_stated = noise.is_some();
        let scale = if are_stated { scale_of(sums) } else { 1.0 };
        let noise = Noise { scale, floor: FLOOR * edge };
        let mut regions = regions(image, noise, are_stated, settings.tilt);
        let wide = |region: &Region| {
            // A strip of the width w scatters by w² / 12.
            let [_, across, _] = region.fitted.fit.variances;
            (12.0 * across).sqrt() >= NARROWEST * camera.pixel() * region.fitted.plane.point.z
        };
        regions.retain(wide);

        let fewest = (SHARE_OF_POINTS * points).clamp(FEWEST_POINTS, ENOUGH_POINTS);
        let fewest = settings.min_points.map_or(fewest, |fewest| fewest as f64);
        let looks: Vec<Looks> =
            regions.iter().map(|region| Looks::of(region, image, camera, noise)).collect();
        let all: f64 = looks.iter().fold(0.0, |sum, looks| sum + looks.area);
        let least = settings.min_area.unwrap_or(SHARE_OF_AREA * all);
        let is_plane = |looks: &Looks| {
            let curved = |bend: looks::Bend| bend.turn > settings.turn && bend.significance > SIGNIFICANT;
            looks.area >= least && !looks.bend.is_some_and(curved)
        };
        let candidate = |region: &Region| Candidate {
            plane: region.fitted.plane,
            // A region that is smoother than errors say is not given less of them than are stated.
            grown: region.fitted.reduced_chi_squared().max(1.0 / noise.scale),
        };
        let mut candidates: Vec<Option<Candidate>> = regions.iter().map(|r| Some(candidate(r))).collect();
        owners.clear();
        owners.resize(sums.len(), 0);
        for (label, region) in (1..).zip(&regions) {
            region.tiles.iter().for_each(|tile| owners[*tile as usize] = label);
        }
        labels.resize(raw.len(), 0);
        let of_image = |candidates: &[Option<Candidate>], labels: &mut [u32]| {
            let told =
                Labels { camera, tiling, tiles, errors: &errors, noise, owners, reach: settings.reach };
            told.all(raw, candidates, labels)
        };
        let mut counts = of_image(&candidates, labels);
        // What explains its own tiles badly, or is too little, leaves its pixels to others.
        let keeps = |count: &Count, region: &Region| {
            count.points as f64 >= fewest && count.own as f64 >= OWN * region.fitted.points
        };
        let mut dropped = false;
        for ((candidate, region), count) in candidates.iter_mut().zip(&regions).zip(&counts) {
            if !keeps(count, region) {
                *candidate = None;
                dropped = true;
            }
        }
        if dropped {
            counts = of_image(&candidates, labels);
        }
        let mut order: Vec<usize> = (0..regions.len())
            .filter(|at| {
                candidates[*at].is_some() && is_plane(&looks[*at]) && counts[*at].points as f64 >= fewest
            })
            .collect();
        order.sort_by_key(|at| std::cmp::Reverse(counts[*at].points));
        let mut numbers: Vec<Option<PlaneId>> = vec![None; regions.len() + 1];
        let mut planes = Vec::with_capacity(order.len());
        for at in order {
            let Ok(label) = u32::try_from(at + 1) else { continue };
            let plane = DepthPlane::of((label, &regions[at]), image, owners, &looks[at], &counts[at], noise);
            // What turns out to be none has no number: labels tell of planes that are there.
            if let Some(plane) = plane {
                numbers[at + 1] = PlaneId::from_index(planes.len());
                planes.push(plane);
            }
        }
        Ok(DepthPlanes {
            planes,
            labels: labels.iter().map(|label| numbers[*label as usize]).collect(),
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of pixels")]
            points: points as usize,
            noise_scale: noise.scale,
            min_points: fewest,
            min_area: least,
        })
    }
}
