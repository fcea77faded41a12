//! The building.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::float_cmp, reason = "tests")]

use std::num::NonZeroU16;

use proptest::prelude::*;
use terrace_synth::{POINTS_PER_ROOM, Params, Scene, SceneKind};
use terrace_types::Frame;

/// From a room to the next along each axis.
const PITCH: [f64; 3] = [5.3, 4.3, 3.0];

fn building(rooms: u16) -> Scene {
    Scene::building(NonZeroU16::new(rooms).unwrap())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn every_room_is_the_room_moved(rooms in 1..40_u16, seed: u64) {
        let (building, room) = (building(rooms), Scene::room());
        let params = |points| Params { points: Some(points), sigma: None, seed };
        let made = building.generate(&params(280 * usize::from(rooms))).unwrap();
        let alone = room.generate(&params(280)).unwrap();
        // Views draw by their number: the first room is the room to the last bit.
        prop_assert_eq!(&made.scans[..14], &alone.scans[..]);
        for (views, planes) in made.scans.chunks(14).zip(building.planes().chunks(room.planes().len())) {
            let [at, first] = [&views[0], &alone.scans[0]].map(|scan| scan.scan.sensor_position().unwrap());
            let offset = [0, 1, 2].map(|i| at[i] - first[i]);
            for i in 0..3 {
                let rooms = offset[i] / PITCH[i];
                prop_assert!((rooms - rooms.round()).abs() < 1e-9 && rooms > -0.5);
            }
            for (view, same) in views.iter().zip(&alone.scans) {
                let (Frame::Sensor { pose }, Frame::Sensor { pose: of_room }) = (view.scan.frame(), same.scan.frame())
                else {
                    panic!("a sensor's frame")
                };
                prop_assert_eq!(pose.rotation(), of_room.rotation());
                let moved = [0, 1, 2].map(|i| of_room.translation()[i] + offset[i]);
                prop_assert!((0..3).all(|i| (moved[i] - pose.translation()[i]).abs() < 1e-9));
                // What is seen from a room is of that room.
                let of_this = planes[0].id..=planes[planes.len() - 1].id;
                prop_assert!(view.labels.iter().flatten().all(|id| of_this.contains(id)));
            }
            for (plane, same) in planes.iter().zip(room.planes()) {
                prop_assert_eq!((plane.name, plane.plane.normal()), (same.name, same.plane.normal()));
                let foot = same.plane.normal().map(|x| -same.plane.d() * x);
                let moved = [0, 1, 2].map(|i| foot[i] + offset[i]);
                prop_assert!(plane.plane.signed_distance(moved).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn points_stay_within_the_walls_of_their_room(rooms in 1..30_u16, seed: u64) {
        let params = Params { points: Some(1_400 * usize::from(rooms)), sigma: Some(0.0), seed };
        let made = building(rooms).generate(&params).unwrap();
        for views in made.scans.chunks(14) {
            let corner = views[0].scan.sensor_position().unwrap();
            // The first view is from (0.6, 0.6, 1.5), and the door is 6 cm deep.
            let low = [corner[0] - 0.6, corner[1] - 0.66, corner[2] - 1.5];
            let high = [low[0] + 5.0, low[1] + 4.06, low[2] + 2.6];
            for point in views.iter().flat_map(|view| view.scan.world_points().flatten()) {
                for i in 0..3 {
                    prop_assert!((low[i] - 1e-9..high[i] + 1e-9).contains(&point.position[i]));
                }
            }
        }
    }
}

#[test]
fn a_building_is_as_large_as_its_points_fill() {
    let of_room = Scene::room().planes().len();
    for (points, rooms) in [(1, 1), (POINTS_PER_ROOM, 1), (3 * POINTS_PER_ROOM, 3), (10_000_000, 100)] {
        assert_eq!(Scene::sized(SceneKind::Building, points).planes().len(), rooms * of_room);
    }
    assert_eq!(Scene::new(SceneKind::Building).planes().len(), 8 * of_room);
}
