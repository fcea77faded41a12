//! Any few points whatever: no panic, and a sound map.

use proptest::prelude::*;
use terrace::{Mapper, Params, Sigma};

use crate::common::{PRESETS, bits, check_sound, cloud};

/// Mostly places of a small grid, so that cells are dense and planes occur; and every kind of odd number.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        20 => (-4..4_i32).prop_map(|k| 0.05 * f64::from(k)),
        10 => -0.3..0.3_f64,
        1 => prop::sample::select(vec![f64::NAN, f64::INFINITY, -1e300, 1e-300, -0.0, 1e7, 1e9]),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_points_give_a_sound_map(
        points in prop::collection::vec(prop::array::uniform3(coordinate()), 0..400),
        sigma in prop::sample::select(vec![0.0, 1e-300, 0.01, 1e3, 1e200]),
        cell_size in prop::sample::select(vec![None, Some(0.05), Some(0.1), Some(1e3)]),
        phi in prop::sample::select(vec![0.0, 0.1, 1.0]),
        seed: u64,
    ) {
        for preset in PRESETS {
            let params = Params { cell_size, phi, seed, tau: Some(1), min_cells: 1, ..preset() };
            let mut mapper = Mapper::new(params).unwrap();
            let scan = cloud(points.clone(), Sigma::Uniform(sigma));
            let Ok(inserted) = mapper.insert(&scan) else {
                prop_assert!(cell_size.is_none() && mapper.is_empty());
                continue;
            };
            prop_assert_eq!(inserted.points + inserted.absent + inserted.out_of_range, points.len());
            if inserted.points > 0 {
                let found = mapper.extract().unwrap();
                check_sound(&found);
                prop_assert_eq!(bits(&found), bits(&mapper.extract().unwrap()));
            }
        }
    }
}
