//! Sums of the pixels of each tile.

use terrace_stats::{Moments, SymmetricMatrix3};

use crate::camera::{Camera, is_measurement};

/// A tile has so many columns and rows of pixels.
pub(crate) const TILE: usize = 8;

/// How tiles lie in an image. Those at its right and lower edge may be cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Tiling {
    pub(crate) columns: usize,
    pub(crate) rows: usize,
}

impl Tiling {
    pub(crate) fn of(camera: &Camera) -> Self {
        Self { columns: camera.width.div_ceil(TILE), rows: camera.height.div_ceil(TILE) }
    }
}

/// Sums of the measured pixels of each tile, row by row of tiles, without errors.
///
/// A pixel (u, v) with the depth z is at ((u − cx)/fx · z, (v − cy)/fy · z, z), so that the sums of points follow from sums of z and z² with
/// powers of u and v, column by column of the tile, eight at a time. Depths are taken from one of the tile, so that single
/// precision is exact enough.
pub(crate) fn sums(raw: &[u16], camera: &Camera, to: &mut Vec<Moments>) {
    to.clear();
    pulp::Arch::new().dispatch(All { raw, camera, to });
}

/// A type, for a closure of this length would not become a part of what is dispatched to.
struct All<'a> {
    raw: &'a [u16],
    camera: &'a Camera,
    to: &'a mut Vec<Moments>,
}

impl pulp::WithSimd for All<'_> {
    type Output = ();

    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { raw, camera, to } = self;
        let width = camera.width;
        for (row, band) in raw.chunks(TILE * width).enumerate() {
            for column in (0..width).step_by(TILE) {
                let tile = pixels(band, width, column);
                let corner = camera.ray([column as f64, (row * TILE) as f64]);
                to.push(of_tile(&tile, corner, camera.focal.map(f64::recip), camera.unit));
            }
        }
    }
}

/// The raw depths of a tile, row by row; 0, which is no measurement, beyond the edge of the image.
pub(crate) type Pixels = [[u16; TILE]; TILE];

/// Those of the tile that begins at a column of a band of an image.
#[allow(clippy::inline_always)]
#[inline(always)]
pub(crate) fn pixels(band: &[u16], width: usize, column: usize) -> Pixels {
    let mut tile = [[0; TILE]; TILE];
    let rows = tile.iter_mut().zip(band.chunks_exact(width));
    // Apart, for a length that is known is a single load.
    if column + TILE <= width {
        for (of_tile, of_image) in rows {
            if let Some(pixels) = of_image[column..].first_chunk() {
                *of_tile = *pixels;
            }
        }
    } else {
        rows.for_each(|(of_tile, of_image)| {
            of_tile.iter_mut().zip(&of_image[column..]).for_each(|(to, raw)| *to = *raw);
        });
    }
    tile
}

/// Sums over pixels of m, m u, m v, m u², m u v, m v², for what m is summed.
type Powers = [f64; 6];

#[allow(clippy::inline_always)]
#[inline(always)]
fn of_tile(tile: &Pixels, [x, y]: [f64; 2], [dx, dy]: [f64; 2], unit: f64) -> Moments {
    let middle = tile[TILE / 2][TILE / 2];
    let reference = if is_measurement(middle) {
        middle
    } else {
        let Some(any) = tile.as_flattened().iter().copied().find(|raw| is_measurement(*raw)) else {
            return Moments::EMPTY;
        };
        any
    };
    // By column: sums over rows v of m, m v, m v².
    let mut ones = [[0.0_f32; TILE]; 3];
    let mut firsts = [[0.0_f32; TILE]; 3];
    let mut squares = [[0.0_f32; TILE]; 3];
    for (v, pixels) in tile.iter().enumerate() {
        let v = v as f32;
        for u in 0..TILE {
            let is_one = if is_measurement(pixels[u]) { 1.0_f32 } else { 0.0 };
            let off = is_one * (f32::from(pixels[u]) - f32::from(reference));
            for (sums, m) in [(&mut ones, is_one), (&mut firsts, off), (&mut squares, off * off)] {
                sums[0][u] += m;
                sums[1][u] += m * v;
                sums[2][u] += m * v * v;
            }
        }
    }
    let (ones, firsts, squares) = (powers(&ones), powers(&firsts), powers(&squares));
    let reference = f64::from(reference);
    // Of depths and their squares, in metres.
    let z: Powers = std::array::from_fn(|k| unit * (reference * ones[k] + firsts[k]));
    let zz: Powers = std::array::from_fn(|k| {
        unit * unit * (reference * reference * ones[k] + 2.0 * reference * firsts[k] + squares[k])
    });
    let [z1, zu, zv, ..] = z;
    let [s1, su, sv, suu, suv, svv] = zz;
    let sum = [x * z1 + dx * zu, y * z1 + dy * zv, z1];
    let second = [
        x * x * s1 + 2.0 * x * dx * su + dx * dx * suu,
        x * y * s1 + x * dy * sv + y * dx * su + dx * dy * suv,
        x * s1 + dx * su,
        y * y * s1 + 2.0 * y * dy * sv + dy * dy * svv,
        y * s1 + dy * sv,
        s1,
    ];
    // Pixels of a tile, counted one by one.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let points = ones[0] as u64;
    Moments::from_sums(points, sum, SymmetricMatrix3(second), SymmetricMatrix3::ZERO)
}

#[allow(clippy::inline_always)]
#[inline(always)]
fn powers([ones, v, vv]: &[[f32; TILE]; 3]) -> Powers {
    let mut sums = [0.0_f64; 6];
    for at in 0..TILE {
        let u = at as f64;
        let [m, mv, mvv] = [ones[at], v[at], vv[at]].map(f64::from);
        for (sum, term) in sums.iter_mut().zip([m, m * u, mv, m * u * u, mv * u, mvv]) {
            *sum += term;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn what_is_beyond_the_edge_is_no_measurement() {
        let (width, height) = (11, 3);
        let band: Vec<u16> = (1..=width * height).collect();
        let first = pixels(&band, width.into(), 0);
        assert_eq!(first[1], [12, 13, 14, 15, 16, 17, 18, 19]);
        let last = pixels(&band, width.into(), TILE);
        assert_eq!(
            last[..3],
            [[9, 10, 11, 0, 0, 0, 0, 0], [20, 21, 22, 0, 0, 0, 0, 0], [31, 32, 33, 0, 0, 0, 0, 0]]
        );
        assert!(first[3..].iter().chain(&last[3..]).all(|row| *row == [0; TILE]));
    }

    proptest! {
        #[test]
        fn sums_are_those_of_points_one_by_one(
            (width, height) in (1..40_usize, 1..40_usize),
            pixels in prop::collection::vec(prop_oneof![Just(0_u16), Just(u16::MAX), 900..1200_u16, any::<u16>()], 1600),
        ) {
            let raw = &pixels[..width * height];
            let camera = Camera::new([width, height], [500.0, -480.0], [19.5, 7.25], 1000.0).unwrap();
            let mut found = Vec::new();
            sums(raw, &camera, &mut found);
            let tiling = Tiling::of(&camera);
            let mut expected = vec![([0.0; 4], [0.0; 6]); tiling.columns * tiling.rows];
            for (at, raw) in raw.iter().enumerate().filter(|(_, raw)| is_measurement(**raw)) {
                let (u, v) = (at % width, at / width);
                let [x, y] = camera.ray([u as f64, v as f64]);
                let z = f64::from(*raw) / 1000.0;
                let (first, second) = &mut expected[v / TILE * tiling.columns + u / TILE];
                let p = [x * z, y * z, z];
                for (sum, term) in first.iter_mut().zip([1.0, p[0], p[1], p[2]]) {
                    *sum += term;
                }
                let products = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
                for (sum, (i, j)) in second.iter_mut().zip(products) {
                    *sum += p[i] * p[j];
                }
            }
            prop_assert_eq!(found.len(), expected.len());
            for (found, (first, second)) in found.iter().zip(expected) {
                let size = first[0].max(1.0) * 66.0 * 66.0;
                let all = |moments: &Moments| [&[moments.weight()], &moments.sum()[..], &moments.second().0].concat();
                let expected = [&first[..], &second].concat();
                let near = all(found).iter().zip(&expected).all(|(a, b)| (a - b).abs() <= 1e-6 * size);
                prop_assert!(near, "{:?} {:?}", found, expected);
            }
        }
    }

    #[test]
    fn a_plane_is_flat_to_a_part_of_a_raw_unit() {
        // Slanted, a few metres away, in tenths of a millimetre.
        let camera = Camera::new([64, 48], [500.0, 500.0], [31.5, 23.5], 10_000.0).unwrap();
        let depth = |u: usize, v: usize| 25_000.0 / (1.0 + 0.002 * u as f64 - 0.001 * v as f64);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let raw: Vec<u16> = (0..64 * 48).map(|at| depth(at % 64, at / 64).round() as u16).collect();
        let mut found = Vec::new();
        sums(&raw, &camera, &mut found);
        for sum in found {
            let fit = terrace_normals::fit_plane(&crate::flat::stats(&sum)).unwrap();
            // Rounding has a variance of a twelfth of a unit, of which the slant leaves less.
            let expected = (1e-8_f64 / 12.0).sqrt();
            assert!((0.5..1.3).contains(&(fit.rms() / expected)), "{} {expected}", fit.rms());
        }
    }
}
