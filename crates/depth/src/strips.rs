//! Tiles eight in a row, which are asked at once whether they lie on a plane.

use terrace_stats::SymmetricMatrix3;

use crate::flat::{Flat, Noise, ROUNDING};
use crate::pyramid::{LEVELS, Level};
use crate::tile::Tile;

/// Tiles of a strip. Groups of tiles at any resolution are within one, row by row.
pub(crate) const STRIP: usize = 8;
const _: () = assert!(1 << (LEVELS - 1) <= STRIP);

/// The mean squared distance of a tile's points from the plane, in units of the variance of their errors, and what few
/// points tell, in standard errors of that.
const SLACK: f64 = 1.5;
const SIGNIFICANT: f64 = 3.0;

type Lanes = [f64; STRIP];

/// What is asked of tiles again and again, side by side.
#[derive(Debug, Clone, Copy, Default)]
struct Strip {
    mean: [Lanes; 3],
    /// Of the points of the tile, and below of their errors: xx, xy, xz, yy, yz, zz.
    scatter: [Lanes; 6],
    noise: [Lanes; 6],
    /// The least variance of errors.
    floor: Lanes,
    /// The most that points may scatter about the plane, in units of the variance of their errors.
    slack: Lanes,
    /// Of the points around.
    around: [Lanes; 6],
    trace: Lanes,
    minors: Lanes,
    /// The tiles that have points, bit by bit.
    tiles: u8,
}

/// What strips tell of a plane, bit by bit.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Told {
    /// The points of the tile are as near as their errors say.
    pub(crate) near: u8,
    /// The surface there is along the plane for sure.
    pub(crate) along: u8,
}

/// All tiles of an image.
#[derive(Debug)]
pub(crate) struct Strips {
    all: Vec<Strip>,
    /// In a row of tiles.
    columns: usize,
    /// What the variance of stated errors is multiplied by.
    scale: f64,
}

impl Strips {
    /// The tiles, and the sums around each.
    pub(crate) fn of(tiles: &[Option<Tile>], around: &Level, noise: Noise) -> Self {
        let columns = around.columns.div_ceil(STRIP);
        let mut all = Vec::with_capacity(columns * around.rows);
        let rows = tiles.chunks(around.columns).zip(around.around.chunks(around.columns));
        for (tiles, around) in rows {
            for (tiles, around) in tiles.chunks(STRIP).zip(around.chunks(STRIP)) {
                let mut strip = Strip::default();
                for (lane, (tile, around)) in tiles.iter().zip(around).enumerate() {
                    let Some((tile, around)) = tile.as_ref().zip(around.covariance()) else { continue };
                    strip.put(lane, tile, &around, noise);
                }
                all.push(strip);
            }
        }
        Self { all, columns, scale: noise.scale }
    }

    pub(crate) fn len(&self) -> usize {
        self.all.len()
    }

    /// Where the strip of a tile is, and the tile in it.
    #[inline]
    pub(crate) fn place(&self, column: usize, row: usize) -> (usize, usize) {
        (row * self.columns + column / STRIP, column % STRIP)
    }

    /// What a strip tells of a plane that tiles may lie off by some more than their errors, as a variance in units of those, and be turned
    /// against by an angle, given as its sine squared.
    pub(crate) fn told(&self, strip: usize, plane: &Flat, more: f64, sine_squared: f64) -> Told {
        let strip = &self.all[strip];
        let asked = Asked { strip, plane, scale: self.scale, more, sine_squared };
        pulp::Arch::new().dispatch(asked)
    }
}

impl Strip {
    fn put(&mut self, lane: usize, tile: &Tile, around: &SymmetricMatrix3, noise: Noise) {
        let lanes =
            |to: &mut [Lanes], from: &[f64]| to.iter_mut().zip(from).for_each(|(to, x)| to[lane] = *x);
        lanes(&mut self.mean, &tile.mean.to_array());
        lanes(&mut self.scatter, &tile.scatter.0);
        lanes(&mut self.noise, &tile.noise.0);
        lanes(&mut self.around, &around.0);
        let [trace, minors, _] = around.invariants();
        self.trace[lane] = trace;
        self.minors[lane] = minors;
        self.floor[lane] = noise.least(tile.mean.z);
        self.slack[lane] = SLACK * (1.0 + SIGNIFICANT * (2.0 / tile.points).sqrt());
        self.tiles |= 1 << lane;
    }
}

/// [`Strips::told`]: a type, for a closure of this length would not become a part of what is dispatched to.
struct Asked<'a> {
    strip: &'a Strip,
    plane: &'a Flat,
    scale: f64,
    more: f64,
    sine_squared: f64,
}

impl pulp::WithSimd for Asked<'_> {
    type Output = Told;

    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Told {
        let Self { strip, plane, scale, more, sine_squared } = self;
        let ([x, y, z], [px, py, pz]) = (plane.normal.to_array(), plane.point.to_array());
        // Of the normal, by which entries of a matrix are summed up along it.
        let products = [x * x, 2.0 * x * y, 2.0 * x * z, y * y, 2.0 * y * z, z * z];
        let (mut squares, mut limits, mut off, mut across) =
            ([0.0; STRIP], [0.0; STRIP], [0.0; STRIP], [0.0; STRIP]);
        for lane in 0..STRIP {
            let along = |matrix: &[Lanes; 6]| {
                let mut sum = matrix[0][lane] * products[0];
                for (entry, product) in matrix[1..].iter().zip(&products[1..]) {
                    sum += entry[lane] * product;
                }
                sum
            };
            let [mx, my, mz] = &strip.mean;
            let distance = x * (mx[lane] - px) + y * (my[lane] - py) + z * (mz[lane] - pz);
            let variance = (scale * along(&strip.noise)).max(strip.floor[lane]);
            squares[lane] = along(&strip.scatter).max(0.0) + distance * distance;
            limits[lane] = variance * (strip.slack[lane] + more);
            off[lane] = along(&strip.around);
            // λ₁ λ₂ = m − λ₀ (λ₁ + λ₂), λ₀ ≤ nᵀCn and λ₂ ≤ t.
            across[lane] =
                (strip.minors[lane] - off[lane] * strip.trace[lane]) * (sine_squared * (1.0 - ROUNDING));
            off[lane] *= strip.trace[lane];
        }
        let mut told = Told::default();
        for lane in 0..STRIP {
            told.near |= u8::from(squares[lane] <= limits[lane]) << lane;
            told.along |= u8::from(off[lane] <= across[lane]) << lane;
        }
        Told { near: told.near & strip.tiles, ..told }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flat::Fitted;
    use glam::DVec3;
    use proptest::prelude::*;
    use terrace_stats::{Moments, UncertainVector};

    const NOISE: Noise = Noise { scale: 1.2, floor: 1e-3 };
    const TURNED: f64 = 0.3;

    /// Points near a plane that is turned by some angle, seen from the origin; none in some tiles.
    fn tile() -> impl Strategy<Value = Moments> {
        let place = prop::array::uniform3(-1.0..1.0_f64);
        (prop::collection::vec(place, 0..20), -0.6..0.6_f64, prop_oneof![Just(0.0), 0.0..0.02_f64]).prop_map(
            |(places, turn, thick)| {
                let mut sum = Moments::EMPTY;
                for [u, v, w] in places {
                    let at = [0.1 * u, 0.1 * v, 1.0 + 0.1 * u * turn.tan() + thick * w];
                    sum.push(&UncertainVector::isotropic(at, 0.004));
                }
                sum
            },
        )
    }

    #[test]
    fn a_flat_surface_is_along_its_plane_without_a_fit() {
        let mut sum = Moments::EMPTY;
        for at in 0..64 {
            let [u, v] = [at % 8, at / 8].map(|k| 0.02 * f64::from(k));
            sum.push(&UncertainVector::isotropic([u, v, 1.0], 0.004));
        }
        let level = Level { columns: 9, rows: 1, around: vec![sum; 9] };
        let strips = Strips::of(&[Tile::of(&sum); 9], &level, NOISE);
        let told = |turn: f64| {
            let plane =
                Flat { normal: DVec3::new(turn.sin(), 0.0, turn.cos()), point: DVec3::new(0.07, 0.07, 1.0) };
            [0, 1].map(|strip| strips.told(strip, &plane, 0.0, TURNED.sin().powi(2)))
        };
        let [whole, cut] = told(0.0);
        assert_eq!([whole.near, whole.along, cut.near, cut.along & 1], [u8::MAX, u8::MAX, 1, 1]);
        assert_eq!(told(0.5).map(|told| (told.near, told.along & 1)), [(0, 0); 2]);
    }

    proptest! {
        #[test]
        fn strips_tell_what_tiles_tell_one_by_one(
            sums in prop::collection::vec(tile(), 1..40),
            columns in 1..20_usize,
            turn in -0.6..0.6_f64,
            more in 0.0..2.0_f64,
        ) {
            let rows = sums.len().div_ceil(columns);
            let mut sums = sums;
            sums.resize(columns * rows, Moments::EMPTY);
            // Here a tile stands for all around it.
            let level = Level { columns, rows, around: sums.clone() };
            let tiles: Vec<Option<Tile>> = sums.iter().map(Tile::of).collect();
            let strips = Strips::of(&tiles, &level, NOISE);
            prop_assert_eq!(strips.len(), columns.div_ceil(STRIP) * rows);
            let plane = Flat { normal: DVec3::new(-turn.sin(), 0.0, turn.cos()), point: DVec3::Z };
            for (at, tile) in tiles.iter().enumerate() {
                let (strip, lane) = strips.place(at % columns, at / columns);
                let Told { near, along } = strips.told(strip, &plane, more, TURNED.sin().powi(2));
                let [near, along] = [near, along].map(|bits| bits >> lane & 1 == 1);
                let Some(tile) = tile else {
                    prop_assert!(!near);
                    continue;
                };
                let off = plane.distance(tile.mean);
                let square = tile.scatter.quadratic_form(plane.normal.to_array()).max(0.0) + off * off;
                let errors = SLACK * (1.0 + SIGNIFICANT * (2.0 / tile.points).sqrt()) + more;
                let limit = tile.variance(NOISE, plane.normal) * errors;
                if (square - limit).abs() > 1e-9 * limit {
                    prop_assert_eq!(near, square < limit);
                }
                if let (true, Some(fitted)) = (along, Fitted::of(&sums[at], NOISE)) {
                    let normal = fitted.plane.normal;
                    let angle = normal.cross(plane.normal).length().atan2(normal.dot(plane.normal).abs());
                    prop_assert!(angle <= TURNED, "{angle}");
                }
            }
        }
    }
}
