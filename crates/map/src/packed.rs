//! Places of points in six bytes each.

/// Places in metres: all points of a map are kept as the grid tells them, in whole units.
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
    use terrace_regions::Samples;

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
            let metres: Vec<[f32; 3]> = unpacked(&places, grid.place_unit()).collect();
            let mut again = Vec::new();
            Samples::new(grid.place_unit()).pack(&metres, &mut again);
            prop_assert_eq!(&again, &places);
            // And are those of the points.
            for ((point, place), cell) in points.iter().zip(&metres).zip(&cells) {
                let anchor = grid.get(cell.unwrap()).unwrap().anchor();
                for i in 0..3 {
                    let off = anchor[i] + f64::from(place[i]) - point[i];
                    prop_assert!(off.abs() <= 1.01 * grid.place_unit(), "{off}");
                }
            }
        }
    }
}
