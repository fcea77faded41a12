//! A plane of a depth image, and how sure it is.

use terrace_normals::CovariantPlane;
use terrace_stats::Stats;
use terrace_types::{Plane, Pose};

use crate::flat::{Flat, Noise, stats};
use crate::grow::{Image, Region};
use crate::labels::Count;
use crate::looks::Looks;
use crate::pyramid::{LEVELS, near};

/// Tiles at the edge of a region may hold something else: a plane rests on the others where they are at least so many, and at least
/// one in so many.
const FEWEST_INSIDE: usize = 12;
const SMALLEST_SHARE: usize = 5;
/// Neighbouring pixels share errors where groups of tiles scatter by so many of their standard errors more than they would otherwise, and
/// that is told by so many groups.
const SIGNIFICANT: f64 = 3.0;
const FEWEST_GROUPS: usize = 8;

/// A plane in the frame of the camera, unless [moved](Self::moved).
#[derive(Debug, Clone, PartialEq)]
pub struct DepthPlane {
    /// The plane of least variance; its normal points to the camera.
    pub plane: Plane,
    /// Mean of the points it rests on, in metres.
    pub centroid: [f64; 3],
    /// The same plane with the covariance of its tilt and offset, its normal either way. `None` where no error is known, or what
    /// it rests on lies exactly in a plane.
    pub covariant: Option<CovariantPlane>,
    /// What that covariance was multiplied by, because tiles, or groups of them, scatter about the plane by more than independent errors of
    /// pixels would make them: 1 where they do not.
    pub growth: f64,
    /// Number of pixels with its label.
    pub points: u64,
    /// Number of tiles it was grown over.
    pub tiles: usize,
    /// Root mean square distance of its pixels, in metres.
    pub rms: f64,
    /// The area of its tiles, in m².
    pub area: f64,
    /// Mean squared distance of the points it was grown over, in units of the variance of their errors.
    pub reduced_chi_squared: f64,
}

impl DepthPlane {
    /// `owners` tell by tile one more than the number of its region.
    pub(crate) fn of(
        (label, region): (u32, &Region),
        image: Image,
        owners: &[u32],
        looks: &Looks,
        count: &Count,
        noise: Noise,
    ) -> Option<Self> {
        let (columns, rows) = (image.levels[0].columns, image.levels[0].rows);
        let is_inside = |tile: &&u32| near(**tile as usize, columns, rows).all(|near| owners[near] == label);
        let inside: Vec<u32> = region.tiles.iter().filter(is_inside).copied().collect();
        let enough = inside.len() >= FEWEST_INSIDE && inside.len() * SMALLEST_SHARE >= region.tiles.len();
        let tiles = if enough { &inside } else { &region.tiles };
        let stats = |tile: &u32| {
            let stats = stats(&image.sums[*tile as usize]);
            stats.with_noise(stats.moments().noise() * noise.scale)
        };
        let stats: Vec<Stats> = tiles.iter().map(stats).collect();
        let mut covariant = CovariantPlane::of_cells(&stats).ok().flatten();
        let fit = covariant.map_or(region.fitted.fit, |covariant| covariant.fit);
        let flat = Flat { normal: fit.normal.into(), point: fit.centroid.into() };
        let growth = growth(tiles, image, &flat, noise);
        if let Some(covariant) = &mut covariant {
            covariant.tilt_offset = covariant.tilt_offset * growth;
        }
        let plane = Plane::through(fit.centroid, fit.normal).ok()?;
        Some(Self {
            // The camera is at the origin, on the side where d is positive.
            plane: if plane.d() < 0.0 { plane.flipped() } else { plane },
            centroid: fit.centroid,
            covariant,
            growth,
            points: count.points,
            tiles: region.tiles.len(),
            rms: (count.squares / count.points as f64).sqrt(),
            area: looks.area,
            reduced_chi_squared: region.fitted.reduced_chi_squared(),
        })
    }

    /// The same plane seen by a camera at this pose, in the world.
    #[must_use]
    pub fn moved(&self, pose: &Pose) -> Self {
        let turned = |v: [f64; 3]| {
            let rotation = pose.rotation();
            [0, 1, 2].map(|i| (0..3).map(|k| rotation[i][k] * v[k]).sum())
        };
        let centroid = pose.transform(self.centroid);
        let plane = Plane::through(centroid, turned(self.plane.normal())).unwrap_or(self.plane);
        let covariant = self.covariant.map(|mut covariant| {
            covariant.fit.centroid = pose.transform(covariant.fit.centroid);
            covariant.fit.normal = turned(covariant.fit.normal);
            covariant.fit.axes = covariant.fit.axes.map(turned);
            covariant
        });
        Self { plane, centroid, covariant, ..self.clone() }
    }
}

/// How much more the means of tiles, or of groups of them, scatter about a plane than independent errors of their points would have it, at the
/// size of group at which that is most.
fn growth(tiles: &[u32], image: Image, plane: &Flat, noise: Noise) -> f64 {
    let columns = image.levels[0].columns;
    let mut tiles = tiles.to_vec();
    tiles.sort_unstable();
    let mut growth = 1.0_f64;
    for level in 0..LEVELS {
        // By group, how far its points are off in all, and the variance of that.
        let mut by_group = vec![[0.0; 2]; image.levels[level].around.len()];
        for tile in tiles.iter().map(|tile| *tile as usize) {
            let Some(of_tile) = &image.tiles[tile] else { continue };
            let (column, row) = (tile % columns, tile / columns);
            let [off, variance] =
                &mut by_group[(row >> level) * image.levels[level].columns + (column >> level)];
            *off += of_tile.points * plane.distance(of_tile.mean);
            *variance += of_tile.points * of_tile.variance(noise, plane.normal);
        }
        let (mut sum, mut groups) = (0.0, 0);
        for [off, variance] in by_group.into_iter().filter(|[_, variance]| *variance > 0.0) {
            sum += off * off / variance;
            groups += 1;
        }
        if groups < FEWEST_GROUPS {
            break;
        }
        let freedom = groups as f64 - 3.0;
        let found = sum / freedom;
        if found > 1.0 + SIGNIFICANT * (2.0 / freedom).sqrt() {
            growth = growth.max(found);
        }
    }
    growth
}
