//! Furnished rooms side by side and above each other.

use crate::build::Builder;
use crate::kind::SceneKind;
use crate::scene::Scene;
use crate::scenes::room::{HEIGHT, LENGTH, WIDTH, furnish};
use crate::vector::Vec3;
use std::num::NonZeroU16;

/// How many points fill a room of the building.
pub const POINTS_PER_ROOM: usize = 100_000;

/// From a room to the next along each axis: walls are 0.3 m thick, deeper than a door is recessed, and ceilings 0.4 m.
const PITCH: Vec3 = [LENGTH + 0.3, WIDTH + 0.3, HEIGHT + 0.4];

pub(crate) fn building(rooms: NonZeroU16) -> Scene {
    let mut b = Builder::new(SceneKind::Building);
    furnish(&mut b);
    b.finish_copied(places(rooms.get()))
}

/// The rooms that so many points fill.
pub(crate) fn rooms_for(points: usize) -> NonZeroU16 {
    let rooms = points.saturating_add(POINTS_PER_ROOM / 2) / POINTS_PER_ROOM;
    NonZeroU16::new(u16::try_from(rooms).unwrap_or(u16::MAX)).unwrap_or(NonZeroU16::MIN)
}

/// Where the rooms are, along x, then y, then z; the last storey may be unfinished.
fn places(rooms: u16) -> impl Iterator<Item = Vec3> {
    let [nx, ny, _] = counts(rooms);
    (0..u64::from(rooms)).map(move |room| {
        let place = [room % nx, room / nx % ny, room / nx / ny];
        [0, 1, 2].map(|axis| place[axis] as f64 * PITCH[axis])
    })
}

/// Rooms along each axis: one more where the building is shortest, until all have a place.
fn counts(rooms: u16) -> [u64; 3] {
    let mut counts = [1; 3];
    while counts.iter().product::<u64>() < u64::from(rooms) {
        let longer = [0, 1, 2].map(|axis| (counts[axis] + 1) as f64 * PITCH[axis]);
        let shortest = if longer[0] <= longer[1] && longer[0] <= longer[2] {
            0
        } else if longer[1] <= longer[2] {
            1
        } else {
            2
        };
        counts[shortest] += 1;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn buildings_are_near_to_cubes_and_no_two_rooms_share_a_place(rooms in 1..=u16::MAX) {
            let counts = counts(rooms);
            let sides = [0, 1, 2].map(|axis| counts[axis] as f64 * PITCH[axis]);
            // The longest side has grown last, when it was the shortest with one more.
            let (low, high) = sides.iter().fold((f64::MAX, 0.0_f64), |(a, b), x| (a.min(*x), b.max(*x)));
            prop_assert!(high - low <= PITCH[0] + 1e-9, "{sides:?}");
            let mut all: Vec<_> = places(rooms).map(|place| place.map(f64::to_bits)).collect();
            prop_assert_eq!(all.len(), usize::from(rooms));
            all.sort_unstable();
            all.dedup();
            prop_assert_eq!(all.len(), usize::from(rooms));
        }
    }

    #[test]
    fn the_number_of_rooms_is_that_of_the_points() {
        let of = |points| rooms_for(points).get();
        assert_eq!([0, 1, 149_999, 150_000, 10_000_000].map(of), [1, 1, 1, 2, 100]);
        assert_eq!([crate::MAX_POINTS, usize::MAX].map(of), [10_000, u16::MAX]);
    }
}
