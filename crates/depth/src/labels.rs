//! Which plane each pixel is of.

use glam::DVec3;

use crate::camera::{Camera, is_measurement};
use crate::errors::Errors;
use crate::flat::{Flat, Noise};
use crate::tile::Tile;
use crate::tiles::{Pixels, TILE, Tiling, pixels};

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
        pulp::Arch::new().dispatch(All { told: self, raw, candidates, labels })
    }

    /// The regions of a tile and of those around it; `shares` is room to count them in.
    fn near(
        &self,
        [column, row]: [usize; 2],
        candidates: &[Option<Candidate>],
        shares: &mut Vec<(u32, f64)>,
        found: &mut Vec<Near>,
    ) {
        found.clear();
        shares.clear();
        let Tiling { columns, rows } = self.tiling;
        let at = row * columns + column;
        let Some(tile) = &self.tiles[at] else { return };
        // A tile that is cut by the edge of a surface is of none, and so are those that it blurs.
        let owner = self.owners[at];
        let steps = if owner == 0 { 2 } else { 1 };
        let range = |at: usize, size: usize| at.saturating_sub(steps)..(at + steps + 1).min(size);
        let beside = range(column, columns);
        let in_row = |row: usize| row * columns + beside.start..row * columns + beside.end;
        if owner != 0 && range(row, rows).all(|row| self.owners[in_row(row)].iter().all(|o| *o == owner)) {
            // Most tiles are amid others of their region.
            let candidate = candidates.get(owner as usize - 1).and_then(Option::as_ref);
            let seen = candidate.and_then(|candidate| self.seen([column, row], tile, candidate, true));
            found.extend(seen.map(|near| Near { label: owner, ..near }));
            return;
        }
        // Regions and how many points they have around.
        let mut all = 0.0;
        for row in range(row, rows) {
            for (owner, tile) in self.owners[in_row(row)].iter().zip(&self.tiles[in_row(row)]) {
                let Some(tile) = tile.as_ref().filter(|_| *owner != 0) else { continue };
                all += tile.points;
                match shares.iter_mut().find(|(known, _)| known == owner) {
                    Some((_, sum)) => *sum += tile.points,
                    None => shares.push((*owner, tile.points)),
                }
            }
        }
        for (label, points) in &*shares {
            let Some(candidate) = candidates.get(*label as usize - 1).copied().flatten() else { continue };
            let owned = owner == *label;
            let seen = self.seen([column, row], tile, &candidate, owned);
            let prior = single(-2.0 * (points / all).ln());
            found.extend(seen.map(|near| Near { label: *label, prior, ..near }));
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
    fn tile(&self, own: u32, pixels: &Pixels, near: &[Near], counts: &mut [Count]) -> [Row<u32>; TILE] {
        let best = best(pixels, near, single(self.reach * self.reach));
        for of in near {
            let (mut ones, mut of_ones) = ([0; ALL], [0.0; ALL]);
            for at in 0..ALL {
                let is_one = best.labels[at] == of.label;
                ones[at] = u32::from(is_one);
                of_ones[at] = if is_one { best.squares[at] } else { 0.0 };
            }
            // By column.
            let mut points = [0_u32; TILE];
            let mut squares = [0.0_f32; TILE];
            for (ones, of_ones) in ones.as_chunks::<TILE>().0.iter().zip(of_ones.as_chunks::<TILE>().0) {
                for u in 0..TILE {
                    points[u] += ones[u];
                    squares[u] += of_ones[u];
                }
            }
            let count = &mut counts[of.label as usize - 1];
            let all = u64::from(points.iter().sum::<u32>());
            count.points += all;
            count.own += if of.label == own { all } else { 0 };
            count.squares += squares.iter().map(|s| f64::from(*s)).sum::<f64>() * of.variance;
        }
        let mut labels = [[0; TILE]; TILE];
        labels.as_flattened_mut().copy_from_slice(&best.labels);
        labels
    }
}

/// [`Labels::all`]: a type, for a closure of this length would not become a part of what is dispatched to.
struct All<'a, 'l> {
    told: &'a Labels<'l>,
    raw: &'a [u16],
    candidates: &'a [Option<Candidate>],
    labels: &'a mut [u32],
}

impl pulp::WithSimd for All<'_, '_> {
    type Output = Vec<Count>;

    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Vec<Count> {
        let Self { told, raw, candidates, labels } = self;
        let mut counts = vec![Count::default(); candidates.len()];
        let width = told.camera.width;
        let bands = raw.chunks(TILE * width).zip(labels.chunks_mut(TILE * width));
        let (mut shares, mut near) = (Vec::new(), Vec::new());
        for (row, (raw, labels)) in bands.enumerate() {
            for column in 0..told.tiling.columns {
                told.near([column, row], candidates, &mut shares, &mut near);
                let own = told.owners[row * told.tiling.columns + column];
                let pixels = pixels(raw, width, column * TILE);
                let found = told.tile(own, &pixels, &near, &mut counts);
                put(&found, labels, width, column * TILE);
            }
        }
        counts
    }
}

/// Puts the labels of a tile into a band of an image.
#[allow(clippy::inline_always)]
#[inline(always)]
fn put(tile: &[Row<u32>; TILE], band: &mut [u32], width: usize, column: usize) {
    let rows = tile.iter().zip(band.chunks_exact_mut(width));
    if column + TILE <= width {
        for (of_tile, of_image) in rows {
            if let Some(labels) = of_image[column..].first_chunk_mut() {
                *labels = *of_tile;
            }
        }
    } else {
        rows.for_each(|(of_tile, of_image)| {
            of_image[column..].iter_mut().zip(of_tile).for_each(|(to, label)| *to = *label);
        });
    }
}

/// Pixels of a tile, row by row.
const ALL: usize = TILE * TILE;

struct Best {
    labels: [u32; ALL],
    /// Squared distances from its plane, in units of the variance of errors.
    squares: [f32; ALL],
}

/// Where pixels are in their tile: u, then v.
const PLACES: [[f32; ALL]; 2] = {
    let mut places = [[0.0; ALL]; 2];
    let mut at = 0;
    while at < ALL {
        (places[0][at], places[1][at]) = ((at % TILE) as f32, (at / TILE) as f32);
        at += 1;
    }
    places
};

/// For each pixel the plane that it is most probably of.
#[allow(
    clippy::inline_always,
    clippy::needless_bitwise_bool,
    reason = "without a branch, in what is dispatched to"
)]
#[inline(always)]
fn best(pixels: &Pixels, near: &[Near], reach: f32) -> Best {
    let [us, vs] = &PLACES;
    let mut best = Best { labels: [0; ALL], squares: [0.0; ALL] };
    let (mut depths, mut reaches, mut least) = ([0.0; ALL], [0.0; ALL], [f32::INFINITY; ALL]);
    for ((depth, reaches), raw) in depths.iter_mut().zip(&mut reaches).zip(pixels.as_flattened()) {
        *depth = f32::from(*raw);
        // No square is below 0.
        *reaches = if is_measurement(*raw) { reach } else { -1.0 };
    }
    for of in near {
        // Over all pixels and without a branch, so that it is done for several at a time.
        for at in 0..ALL {
            let c = of.c + of.b * vs[at];
            let errors = depths[at] * (c + of.a * us[at]) + of.d;
            let square = errors * errors;
            let score = square + of.prior;
            let better = (square <= reaches[at]) & (score < least[at]);
            least[at] = if better { score } else { least[at] };
            best.labels[at] = if better { of.label } else { best.labels[at] };
            best.squares[at] = if better { square } else { best.squares[at] };
        }
    }
    best
}

#[allow(clippy::cast_possible_truncation)]
fn single(x: f64) -> f32 {
    x as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// As it is defined, for one pixel.
    fn best_of(raw: u16, [u, v]: [f32; 2], near: &[Near], reach: f32) -> (u32, f32) {
        let mut best = (0, 0.0);
        let mut least = f32::INFINITY;
        for of in near {
            let errors = f32::from(raw) * (of.c + of.b * v + of.a * u) + of.d;
            let score = errors * errors + of.prior;
            if is_measurement(raw) && errors * errors <= reach && score < least {
                (least, best) = (score, (of.label, errors * errors));
            }
        }
        best
    }

    fn near() -> impl Strategy<Value = Near> {
        // Coefficients so large that pixels are within and beyond the reach.
        (1..9_u32, prop::array::uniform4(-1.0..1.0_f32), 0.0..4.0_f32).prop_map(
            |(label, [a, b, c, d], prior)| Near {
                label,
                a: 1e-4 * a,
                b: 1e-4 * b,
                c: 1e-3 * c,
                d,
                prior,
                variance: 1e-4,
            },
        )
    }

    proptest! {
        #[test]
        fn pixels_of_a_tile_are_told_as_one_by_one(
            raw in prop::collection::vec(prop_oneof![4 => 1..4000_u16, 1 => Just(0), 1 => Just(u16::MAX)], ALL),
            near in prop::collection::vec(near(), 0..5),
            reach in 0.0..9.0_f32,
        ) {
            let mut pixels = [[0; TILE]; TILE];
            pixels.as_flattened_mut().copy_from_slice(&raw);
            let found = best(&pixels, &near, reach);
            for (at, raw) in raw.iter().enumerate() {
                let place = [(at % TILE) as f32, (at / TILE) as f32];
                prop_assert_eq!((found.labels[at], found.squares[at]), best_of(*raw, place, &near, reach));
            }
        }

        #[test]
        fn labels_are_put_where_the_tile_is(width in 1..30_usize, height in 1..=TILE, tile in 0..4_usize) {
            let column = (tile * TILE).min((width - 1) / TILE * TILE);
            let mut labels = [[0; TILE]; TILE];
            labels.as_flattened_mut().iter_mut().zip(1..).for_each(|(to, label)| *to = label);
            let mut band = vec![0; width * height];
            put(&labels, &mut band, width, column);
            for (at, label) in band.iter().enumerate() {
                let (u, v) = ((at % width).checked_sub(column), at / width);
                let expected = u.and_then(|u| labels[v].get(u)).copied().unwrap_or(0);
                prop_assert_eq!(*label, expected);
            }
        }
    }
}
