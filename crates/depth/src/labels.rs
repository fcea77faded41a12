//! Which plane each pixel is of.

use glam::DVec3;

use crate::camera::{Camera, is_measurement};
use crate::errors::Errors;
use crate::flat::{Flat, Noise};
use crate::pyramid::within;
use crate::tile::Tile;
use crate::tiles::{TILE, Tiling};

/// A region that pixels may be of.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Candidate {
    pub(crate) plane: Flat,
    /// What the variance of errors is multiplied by: how its own points scatter.
    pub(crate) grown: f64,
}

/// Pixels that are labelled as a region's.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Count {
    pub(crate) points: u64,
    /// Of these, in tiles of the region.
    pub(crate) own: u64,
    /// Sum of their squared distances from the plane, in m².
    pub(crate) squares: f64,
}

/// What labels are told by.
pub(crate) struct Labels<'a> {
    pub(crate) camera: &'a Camera,
    pub(crate) tiling: Tiling,
    pub(crate) tiles: &'a [Option<Tile>],
    pub(crate) errors: &'a Errors,
    pub(crate) noise: Noise,
    /// By tile, one more than the number of its region, 0 for none.
    pub(crate) owners: &'a [u32],
    /// The largest distance of a point from its plane, in standard errors.
    pub(crate) reach: f64,
}

/// A plane as the pixels of a tile see it: the distance of one in standard errors is `raw (c + a u + b v) + d`, u and v
/// counted from the corner of the tile.
#[derive(Debug, Clone, Copy)]
struct Near {
    /// One more than the number of its region.
    label: u32,
    a: f32,
    b: f32,
    c: f32,
    d: f32,
    /// −2 ln of its share of the points around.
    prior: f32,
    /// Variance of a point's error along the normal, in m².
    variance: f64,
}

type Row<T> = [T; TILE];

impl Labels<'_> {
    /// Labels all pixels, row by row: one more than the number of the region, 0 for none. Counts those of each region.
    pub(crate) fn all(
        &self,
        raw: &[u16],
        candidates: &[Option<Candidate>],
        labels: &mut [u32],
    ) -> Vec<Count> {
        let mut counts = vec![Count::default(); candidates.len()];
        pulp::Arch::new().dispatch(|| {
            let width = self.camera.width;
            let bands = raw.chunks(TILE * width).zip(labels.chunks_mut(TILE * width));
            let mut near = Vec::new();
            for (row, (raw, labels)) in bands.enumerate() {
                for column in 0..self.tiling.columns {
                    self.near([column, row], candidates, &mut near);
                    self.tile([column, row], &near, (raw, labels), &mut counts);
                }
            }
        });
        counts
    }

    /// The regions of a tile and of those around it.
    fn near(&self, [column, row]: [usize; 2], candidates: &[Option<Candidate>], found: &mut Vec<Near>) {
        found.clear();
        let at = row * self.tiling.columns + column;
        let Some(tile) = &self.tiles[at] else { return };
        // Regions and how many points they have around.
        let mut shares: Vec<(u32, f64)> = Vec::new();
        let mut all = 0.0;
        // A tile that is cut by the edge of a surface is of none, and so are those that it blurs.
        let steps = if self.owners[at] == 0 { 2 } else { 1 };
        for beside in within(steps, at, self.tiling.columns, self.tiling.rows) {
            let (owner, Some(tile)) = (self.owners[beside], &self.tiles[beside]) else { continue };
            if owner == 0 {
                continue;
            }
            all += tile.points;
            match shares.iter_mut().find(|(known, _)| *known == owner) {
                Some((_, sum)) => *sum += tile.points,
                None => shares.push((owner, tile.points)),
            }
        }
        for (label, points) in shares {
            let Some(candidate) = candidates.get(label as usize - 1).copied().flatten() else { continue };
            let owned = self.owners[at] == label;
            let seen = self.seen([column, row], tile, &candidate, owned);
            found.extend(seen.map(|near| Near { label, prior: single(-2.0 * (points / all).ln()), ..near }));
        }
        found.sort_unstable_by_key(|near| near.label);
    }

    fn seen(
        &self,
        [column, row]: [usize; 2],
        tile: &Tile,
        candidate: &Candidate,
        owned: bool,
    ) -> Option<Near> {
        let Flat { normal: n, point } = candidate.plane;
        let [width, height] = self.camera.focal;
        let [x, y] = self.camera.ray([(column * TILE) as f64, (row * TILE) as f64]);
        let offset = n.dot(point);
        let variance = if owned {
            tile.variance(self.noise, n)
        } else {
            // Errors where the plane is, not where the points of another surface are.
            let half = 0.5 * (TILE - 1) as f64;
            let ray = DVec3::new(x + half / width, y + half / height, 1.0);
            let depth = offset / n.dot(ray);
            let depth = if depth > 0.0 { depth } else { tile.mean.z };
            self.noise.variance(&self.errors.at(ray * depth)?, depth, n)
        };
        let variance = variance * candidate.grown;
        let per_error = 1.0 / variance.sqrt();
        let unit = per_error * self.camera.unit;
        per_error.is_finite().then(|| Near {
            label: 0,
            a: single(unit * n.x / width),
            b: single(unit * n.y / height),
            c: single(unit * (n.x * x + n.y * y + n.z)),
            d: single(-per_error * offset),
            prior: 0.0,
            variance,
        })
    }

    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn tile(
        &self,
        [column, row]: [usize; 2],
        near: &[Near],
        (raw, labels): (&[u16], &mut [u32]),
        counts: &mut [Count],
    ) {
        let (width, first) = (self.camera.width, column * TILE);
        let own = self.owners[row * self.tiling.columns + column];
        let reach = single(self.reach * self.reach);
        let mut points = [[0_u32; TILE]; 2];
        let mut squares = [0.0_f32; TILE];
        for (v, (raw, labels)) in raw.chunks_exact(width).zip(labels.chunks_exact_mut(width)).enumerate() {
            let (raw, labels) = (&raw[first..], &mut labels[first..]);
            let mut pixels = [0; TILE];
            let wide = raw.len().min(TILE);
            match raw.first_chunk::<TILE>() {
                Some(whole) => pixels = *whole,
                None => pixels[..wide].copy_from_slice(raw),
            }
            let found = best(&pixels, near, v as f32, reach);
            match labels.first_chunk_mut::<TILE>() {
                Some(whole) => *whole = found.labels,
                None => labels[..wide].copy_from_slice(&found.labels[..wide]),
            }
            if let [only] = near {
                for u in 0..TILE {
                    let is_one = found.labels[u] == only.label;
                    points[0][u] += u32::from(is_one);
                    squares[u] += if is_one { found.squares[u] } else { 0.0 };
                }
            } else {
                for of in near {
                    let count = &mut counts[of.label as usize - 1];
                    for u in 0..TILE {
                        if found.labels[u] == of.label {
                            count.points += 1;
                            count.own += u64::from(of.label == own);
                            count.squares += f64::from(found.squares[u]) * of.variance;
                        }
                    }
                }
            }
        }
        if let [only] = near {
            let count = &mut counts[only.label as usize - 1];
            let all = u64::from(points[0].iter().sum::<u32>());
            count.points += all;
            count.own += if only.label == own { all } else { 0 };
            count.squares += squares.iter().map(|s| f64::from(*s)).sum::<f64>() * only.variance;
        }
    }
}

struct Best {
    labels: Row<u32>,
    /// Squared distances from its plane, in units of the variance of errors.
    squares: Row<f32>,
}

/// For each pixel of a row the plane that it is most probably of.
#[allow(clippy::inline_always)]
#[inline(always)]
fn best(pixels: &Row<u16>, near: &[Near], v: f32, reach: f32) -> Best {
    let mut best = Best { labels: [0; TILE], squares: [0.0; TILE] };
    let mut least = [f32::INFINITY; TILE];
    for of in near {
        let c = of.c + of.b * v;
        for u in 0..TILE {
            let errors = f32::from(pixels[u]) * (c + of.a * u as f32) + of.d;
            let square = errors * errors;
            let score = square + of.prior;
            let better = square <= reach && score < least[u] && is_measurement(pixels[u]);
            least[u] = if better { score } else { least[u] };
            best.labels[u] = if better { of.label } else { best.labels[u] };
            best.squares[u] = if better { square } else { best.squares[u] };
        }
    }
    best
}

#[allow(clippy::cast_possible_truncation)]
fn single(x: f64) -> f32 {
    x as f32
}
