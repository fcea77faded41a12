//! Cells along a space-filling curve.

/// The bits of a key that fit into a code three times, and those of a cube of the coarsest level.
const BITS: u32 = 21;
const CUBE: u32 = 3;

/// In which order [`Field::of_ordered`](crate::Field::of_ordered) takes cells, where it is found before their sums are told: on another thread,
/// say.
#[derive(Debug)]
pub struct Order(pub(crate) Curve);

impl Order {
    /// Of so many cells, none of them wide, by their keys.
    pub fn of(cells: usize, key: impl Fn(usize) -> [i32; 3]) -> Self {
        Self(Curve::of(cells, key))
    }
}

/// Cells along a space-filling curve.
#[derive(Debug)]
pub(crate) struct Curve {
    /// Their keys in that order, from a corner of the largest cube.
    pub(crate) along: Vec<[u32; 3]>,
    /// The place of each among the given ones.
    pub(crate) order: Vec<u32>,
    /// That corner.
    pub(crate) corner: [i32; 3],
}

impl Curve {
    /// Keys by the bits of all three in turn: the order of the curve that fills cubes of 2ˡ × 2ˡ × 2ˡ one after the other.
    pub(crate) fn of(cells: usize, key: impl Fn(usize) -> [i32; 3]) -> Self {
        let keys: Vec<[i32; 3]> = (0..cells).map(key).collect();
        let least = |axis: usize| keys.iter().map(|key| key[axis]).min().unwrap_or(0);
        // Cubes are those of the lattice, wherever the cells are.
        let corner = [0, 1, 2].map(|axis| least(axis) & !((1 << CUBE) - 1));
        // A list that is made of another, number by number, stays where that is: here, and where keys are told again.
        let keys: Vec<[u32; 3]> = keys.into_iter().map(|key| along_curve(key, corner)).collect();
        let order = in_order(&keys);
        Self { along: order.iter().map(|at| keys[*at as usize]).collect(), order, corner }
    }

    /// The key of the cell of a rank, as it was given.
    pub(crate) fn key(&self, rank: usize) -> [i32; 3] {
        as_given(self.along[rank], self.corner)
    }

    /// The place of each cell among the given ones, and the keys as they were given.
    pub(crate) fn into_order_and_keys(self) -> (Vec<u32>, Vec<[i32; 3]>) {
        (self.order, self.along.into_iter().map(|key| as_given(key, self.corner)).collect())
    }
}

/// What is a key from the corner of a curve.
fn as_given(along: [u32; 3], corner: [i32; 3]) -> [i32; 3] {
    [0, 1, 2].map(|i| along[i].cast_signed().wrapping_add(corner[i]))
}

/// A key from the corner of a curve.
pub(crate) fn along_curve(key: [i32; 3], corner: [i32; 3]) -> [u32; 3] {
    [0, 1, 2].map(|i| key[i].wrapping_sub(corner[i]).cast_unsigned())
}

/// Places of keys, in the order of the curve.
fn in_order(keys: &[[u32; 3]]) -> Vec<u32> {
    let bits = u32::BITS - keys.iter().flatten().fold(0, |all, k| all | k).leading_zeros();
    let places = usize::BITS - keys.len().leading_zeros();
    if 3 * bits + places > u64::BITS {
        let code = |key: [u32; 3]| (interleaved(key.map(|k| k >> BITS)), interleaved(key));
        let mut order: Vec<((u64, u64), u32)> = keys.iter().map(|key| code(*key)).zip(0..).collect();
        radsort::sort_by_key(&mut order, |(code, _)| *code);
        return order.into_iter().map(|(_, at)| at).collect();
    }
    // Code and place in one number: half the memory of the two.
    let mut order: Vec<u64> =
        keys.iter().zip(0..).map(|(key, at)| interleaved(*key) << places | at).collect();
    if !order.is_sorted() {
        radsort::sort_by_key(&mut order, |number| number >> places);
    }
    // A place is below the number of cells, which is one of 32 bits.
    #[allow(clippy::cast_possible_truncation)]
    let place = |number: u64| (number & ((1 << places) - 1)) as u32;
    order.into_iter().map(place).collect()
}

/// The lower bits of three numbers in turn.
fn interleaved([x, y, z]: [u32; 3]) -> u64 {
    let spread = |k: u32| {
        let mut x = u64::from(k) & ((1 << BITS) - 1);
        x = (x | x << 32) & 0x001f_0000_0000_ffff;
        x = (x | x << 16) & 0x001f_0000_ff00_00ff;
        x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
        x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
        (x | x << 2) & 0x1249_2492_4924_9249
    };
    spread(x) << 2 | spread(y) << 1 | spread(z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn bits_are_taken_in_turn() {
        assert_eq!(interleaved([1, 0, 0]), 4);
        assert_eq!(interleaved([0, 3, 0]), 0b01_0010);
        assert_eq!(interleaved([(1 << 21) - 1; 3]), (1 << 63) - 1);
    }

    proptest! {
        /// Near each other code and place fit into one number, and far from each other not.
        #[test]
        fn keys_are_sorted_by_their_bits_and_told_again(
            keys in prop::collection::vec(prop::array::uniform3(-9..9_i32), 0..40),
            far in prop::option::of(prop::array::uniform3(any::<i32>())),
        ) {
            let keys = [keys, far.into_iter().collect()].concat();
            let curve = Curve::of(keys.len(), |at| keys[at]);
            let bits = |key: [u32; 3]| (0..96).rev().map(move |bit| key[2 - bit % 3] >> (bit / 3) & 1);
            prop_assert!(curve.along.is_sorted_by(|a, b| bits(*a).le(bits(*b))));
            let (order, again) = curve.into_order_and_keys();
            prop_assert_eq!(&again, &order.iter().map(|at| keys[*at as usize]).collect::<Vec<_>>());
            // Of the same keys the first is first.
            prop_assert!((1..keys.len()).all(|at| again[at] != again[at - 1] || order[at] > order[at - 1]));
        }
    }
}
