//! What touches the children of a group.

/// No group.
const NONE: u32 = u32::MAX;

/// The 26 neighbours of the place one step from the first along each axis, as bits by their numbers.
const AROUND: u64 = 0x777 << 32 | 0x757 << 16 | 0x777;
/// The number of that place.
const FIRST: u32 = 16 + 4 + 1;

/// The 4 × 4 × 4 places of the children of a group and of those around them, with what is there.
pub(crate) struct Places {
    /// The key of the first place: one before the children.
    from: [u32; 3],
    /// The last is for what is in none of them.
    children: [u32; 65],
    /// Which of them hold something, as bits.
    taken: u64,
    /// All that are in one of them, each once; where some may be wide.
    found: [u32; 65],
    count: usize,
    /// Whether one of them is in several.
    some_wide: bool,
}

impl Places {
    /// The places around the children of a group.
    pub(crate) fn around(parent: [u32; 3]) -> Self {
        let from = parent.map(|k| (k << 1).wrapping_sub(1));
        Self { from, children: [NONE; 65], taken: 0, found: [NONE; 65], count: 0, some_wide: false }
    }

    /// Puts a child of the group, or of one that it touches, where it is, if none of all is wide.
    #[inline]
    pub(crate) fn put(&mut self, child: u32, key: [u32; 3]) {
        self.set(self.place(key), child);
    }

    /// As [`put`](Self::put), where some may be wide: those are in all places of their parent's children.
    pub(crate) fn put_any(&mut self, child: u32, key: [u32; 3], is_wide: bool) {
        let [x, y, z] = self.place(key);
        let mut is_in = self.set([x, y, z], child);
        if is_wide {
            self.some_wide = true;
            for k in 1..8 {
                let beside = [x.wrapping_add(k >> 2), y.wrapping_add(k >> 1 & 1), z.wrapping_add(k & 1)];
                is_in |= self.set(beside, child);
            }
        }
        // At most as many as there are places.
        if let Some(free) = self.found.get_mut(self.count) {
            *free = child;
        }
        self.count += usize::from(is_in);
    }

    /// Appends what a child of the group touches.
    pub(crate) fn touching(
        &self,
        child: u32,
        key: [u32; 3],
        is_wide: impl Fn(u32) -> bool,
        to: &mut Vec<u32>,
    ) {
        if is_wide(child) {
            to.extend(self.found[..self.count].iter().filter(|other| **other != child));
            return;
        }
        let [x, y, z] = self.place(key);
        // Children are in the middle, so that all around is there.
        let mut around = self.taken & AROUND << (16 * x + 4 * y + z - FIRST);
        let (mut found, mut count) = ([NONE; 26], 0);
        while around != 0 {
            found[count] = self.children[around.trailing_zeros() as usize];
            count += 1;
            around &= around - 1;
        }
        if !self.some_wide {
            to.extend_from_slice(&found[..count]);
            return;
        }
        let first = to.len();
        for other in &found[..count] {
            if !is_wide(*other) || !to[first..].contains(other) {
                to.push(*other);
            }
        }
    }

    fn place(&self, key: [u32; 3]) -> [u32; 3] {
        [0, 1, 2].map(|i| key[i].wrapping_sub(self.from[i]))
    }

    /// Whether the place is one of them.
    fn set(&mut self, [x, y, z]: [u32; 3], child: u32) -> bool {
        let is_in = x | y | z < 4;
        let at = if is_in { 16 * x + 4 * y + z } else { 64 };
        self.children[at as usize] = child;
        self.taken |= u64::from(is_in) << (at % 64);
        is_in
    }
}
