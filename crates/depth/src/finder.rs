//! From a depth image to planes.

use terrace_noise::{ScanNoise, SensorNoise};
use terrace_stats::Moments;
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
    sums: Vec<Moments>,
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
        let expected = self.camera.width * self.camera.height;
        if raw.len() != expected {
            return Err(DepthError::Length { found: raw.len(), expected });
        }
        let (errors, points) = self.take(raw);
        let noise = self.noise_of_image();
        let found = self.grown(noise);
        let looks: Vec<Looks> =
            found.iter().map(|region| Looks::of(region, self.image(), &self.camera, noise)).collect();
        let all: f64 = looks.iter().fold(0.0, |sum, looks| sum + looks.area);
        let fewest = (SHARE_OF_POINTS * points).clamp(FEWEST_POINTS, ENOUGH_POINTS);
        let fewest = self.settings.min_points.map_or(fewest, |fewest| fewest as f64);
        let least = self.settings.min_area.unwrap_or(SHARE_OF_AREA * all);

        let counts = self.label(raw, &errors, noise, &found, fewest);
        let (planes, numbers) = self.numbered(&found, &looks, &counts, noise, least);
        Ok(DepthPlanes {
            planes,
            labels: pulp::Arch::new().dispatch(Renumbered { labels: &self.labels, numbers }),
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of pixels")]
            points: points as usize,
            noise_scale: noise.scale,
            min_points: fewest,
            min_area: least,
        })
    }

    /// Sums up an image, with the errors of its points: what they are, and how many points there are.
    fn take(&mut self, raw: &[u16]) -> (Errors, f64) {
        let Self { camera, noise, sums, tiles, pyramid, .. } = self;
        tiles::sums(raw, camera, sums);
        let errors = match noise {
            Some(noise) => Errors::Stated(*noise),
            None => Errors::found(sums, camera),
        };
        let mut points = 0.0;
        for sum in sums.iter_mut() {
            let Some(mean) = sum.mean() else { continue };
            points += sum.weight();
            let noise = errors.at(mean.into()).map(|of_point| of_point * sum.weight());
            *sum = noise.map_or(Moments::EMPTY, |noise| sum.with_noise(noise));
        }
        tiles.clear();
        tiles.extend(sums.iter().map(Tile::of));
        pyramid.fill(sums, Tiling::of(camera));
        (errors, points)
    }

    fn image(&self) -> Image<'_> {
        Image { tiles: &self.tiles, sums: &self.sums, levels: &self.pyramid.levels }
    }

    fn noise_of_image(&self) -> Noise {
        let edge = 2.0 * TILE as f64 * self.camera.pixel();
        let scale = if self.noise.is_some() { scale_of(&self.sums) } else { 1.0 };
        Noise { scale, floor: FLOOR * edge }
    }

    /// The regions that are wide enough for a plane.
    fn grown(&self, noise: Noise) -> Vec<Region> {
        let mut regions = regions(self.image(), noise, self.noise.is_some(), self.settings.tilt);
        let pixel = self.camera.pixel();
        regions.retain(|region| {
            // A strip of the width w scatters by w² / 12.
            let [_, across, _] = region.fitted.fit.variances;
            (12.0 * across).sqrt() >= NARROWEST * pixel * region.fitted.plane.point.z
        });
        regions
    }

    /// Labels all pixels, by one more than the numbers of regions, and counts those of each; `None` for regions that leave theirs to
    /// others, because they explain their own tiles badly or are too little.
    fn label(
        &mut self,
        raw: &[u16],
        errors: &Errors,
        noise: Noise,
        regions: &[Region],
        fewest: f64,
    ) -> Vec<Option<Count>> {
        let Self { camera, settings, sums, tiles, owners, labels, .. } = self;
        owners.clear();
        owners.resize(sums.len(), 0);
        for (label, region) in (1..).zip(regions) {
            region.tiles.iter().for_each(|tile| owners[*tile as usize] = label);
        }
        labels.resize(raw.len(), 0);
        let tiling = Tiling::of(camera);
        let told = Labels { camera, tiling, tiles, errors, noise, owners, reach: settings.reach };
        let candidate = |region: &Region| Candidate {
            plane: region.fitted.plane,
            // A region that is smoother than errors say is not given less of them than are stated.
            grown: region.fitted.reduced_chi_squared().max(1.0 / noise.scale),
        };
        let mut candidates: Vec<Option<Candidate>> = regions.iter().map(|r| Some(candidate(r))).collect();
        let mut counts = told.all(raw, &candidates, labels);
        for ((candidate, region), count) in candidates.iter_mut().zip(regions).zip(&counts) {
            let keeps = count.points as f64 >= fewest && count.own as f64 >= OWN * region.fitted.points;
            *candidate = candidate.take().filter(|_| keeps);
        }
        if candidates.iter().any(Option::is_none) {
            counts = told.all(raw, &candidates, labels);
        }
        let enough = |count: &Count| count.points as f64 >= fewest;
        let count = |(candidate, count): (&Option<Candidate>, Count)| {
            candidate.as_ref().and(Some(count)).filter(enough)
        };
        candidates.iter().zip(counts).map(count).collect()
    }

    /// The planes, those with most pixels first, and the number of each label.
    fn numbered(
        &self,
        regions: &[Region],
        looks: &[Looks],
        counts: &[Option<Count>],
        noise: Noise,
        least: f64,
    ) -> (Vec<DepthPlane>, Vec<Option<PlaneId>>) {
        let is_plane = |looks: &Looks| {
            let curved =
                |bend: looks::Bend| bend.turn > self.settings.turn && bend.significance > SIGNIFICANT;
            looks.area >= least && !looks.bend.is_some_and(curved)
        };
        let mut of_planes: Vec<(u32, &Region, &Looks, &Count)> = (1..)
            .zip(regions.iter().zip(looks).zip(counts))
            .filter_map(|(label, ((region, looks), count))| Some((label, region, looks, count.as_ref()?)))
            .filter(|(_, _, looks, _)| is_plane(looks))
            .collect();
        of_planes.sort_by_key(|(.., count)| std::cmp::Reverse(count.points));
        let mut numbers: Vec<Option<PlaneId>> = vec![None; regions.len() + 1];
        let mut planes = Vec::with_capacity(of_planes.len());
        for (label, region, looks, count) in of_planes {
            let plane = DepthPlane::of((label, region), self.image(), &self.owners, looks, count, noise);
            // What turns out to be none has no number: labels tell of planes that are there.
            if let Some(plane) = plane {
                numbers[label as usize] = PlaneId::from_index(planes.len());
                planes.push(plane);
            }
        }
        (planes, numbers)
    }
}

/// The labels of pixels by the numbers of planes: a type, for a closure of this length would not become a part of what is dispatched to.
struct Renumbered<'a> {
    labels: &'a [u32],
    numbers: Vec<Option<PlaneId>>,
}

impl pulp::WithSimd for Renumbered<'_> {
    type Output = Vec<Option<PlaneId>>;

    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Self::Output {
        let mut numbers = self.numbers;
        // So that no place is beyond the last for sure, and several are looked up at once.
        numbers.resize(numbers.len().next_power_of_two(), None);
        let last = numbers.len() - 1;
        self.labels.iter().map(|label| numbers[*label as usize & last]).collect()
    }
}
