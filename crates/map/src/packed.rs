//! Places of points in six bytes each.

/// Added to a number of up to 22 bits it rounds it to an integer, which is in the lowest bits then.
const ROUNDING: f32 = 1.5 * (1_u32 << 23) as f32;

/// Places that are packed at once: they stay in the nearest cache.
const BATCH: usize = 256;

/// Places from the anchors of their cells, in units of the grid: all points of a map are kept so, and most of the memory that they need would
/// else be zeroes.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Packed(Vec<[i16; 3]>);

impl Packed {
    pub(crate) fn with_capacity(points: usize) -> Self {
        Self(Vec::with_capacity(points))
    }

    /// Appends places that are whole multiples of the unit.
    pub(crate) fn extend(&mut self, places: &[[f32; 3]], unit: f64) {
        let per_unit = single(1.0 / unit);
        let mut batch = [[0; 3]; BATCH];
        for places in places.chunks(BATCH) {
            // The same instructions, for more numbers at a time where the processor can.
            pulp::Arch::new().dispatch(|| {
                for (to, x) in batch.as_flattened_mut().iter_mut().zip(places.as_flattened()) {
                    // The lowest bits are the integer.
                    #[allow(clippy::cast_possible_truncation)]
                    let packed = (x * per_unit + ROUNDING).to_bits() as u16;
                    *to = packed.cast_signed();
                }
            });
            self.0.extend_from_slice(&batch[..places.len()]);
        }
    }

    pub(crate) fn of(&self) -> &[[i16; 3]] {
        &self.0
    }
}

/// The places as they were.
pub(crate) fn unpacked(packed: &[[i16; 3]], unit: f64) -> impl Iterator<Item = [f32; 3]> {
    let unit = single(unit);
    packed.iter().map(move |place| place.map(|x| f32::from(x) * unit))
}

/// Powers of two are the same in single precision, for cells of any size that is of use.
#[allow(clippy::cast_possible_truncation)]
fn single(unit: f64) -> f32 {
    unit as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use terrace_grid::{PointErrors, VoxelGrid};

    proptest! {
        #[test]
        fn places_come_back_to_the_bit(
            points in prop::collection::vec(prop::array::uniform3(-9.0..9.0_f64), 0..300),
            size in -12.0..9.0_f64,
            halves in any::<bool>(),
        ) {
            let size = size.exp2();
            let mut grid = if halves {
                VoxelGrid::of_halves(size)
            } else {
                VoxelGrid::new(size, terrace_grid::Assignment::Voxel)
            }.unwrap();
            let (mut cells, mut places) = (Vec::new(), Vec::new());
            grid.insert_all(&points, PointErrors::None, &mut cells, Some(&mut places)).unwrap();
            let mut packed = Packed::with_capacity(points.len());
            packed.extend(&places, grid.place_unit());
            let again: Vec<[f32; 3]> = unpacked(packed.of(), grid.place_unit()).collect();
            prop_assert_eq!(&again, &places);
            // And are those of the points.
            for ((point, place), cell) in points.iter().zip(&places).zip(&cells) {
                let anchor = grid.get(cell.unwrap()).unwrap().anchor();
                for i in 0..3 {
                    let off = anchor[i] + f64::from(place[i]) - point[i];
                    prop_assert!(off.abs() <= 1.01 * grid.place_unit(), "{off}");
                }
            }
        }
    }
}
