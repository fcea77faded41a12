//! The cells of a part, page by page.

use std::ops::{Index, IndexMut};

use crate::cell::Slot;

/// Slots of a page. What is not used of the last one is not touched either.
const PAGE: usize = 256;

/// What is kept of cells, by the number of their slot. None is moved when more come: a list that grows would be copied again and again,
/// into memory that is touched for the first time.
#[derive(Debug, Clone, Default)]
pub(crate) struct Slots {
    pages: Vec<Vec<Slot>>,
    len: usize,
}

impl Slots {
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    pub(crate) fn push(&mut self, slot: Slot) {
        if self.len.is_multiple_of(PAGE) {
            self.pages.push(Vec::with_capacity(PAGE));
        }
        if let Some(page) = self.pages.last_mut() {
            page.push(slot);
            self.len += 1;
        }
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &Slot> {
        self.pages.iter().flatten()
    }
}

impl Index<u32> for Slots {
    type Output = Slot;

    #[inline]
    fn index(&self, slot: u32) -> &Slot {
        &self.pages[slot as usize / PAGE][slot as usize % PAGE]
    }
}

impl IndexMut<u32> for Slots {
    #[inline]
    fn index_mut(&mut self, slot: u32) -> &mut Slot {
        &mut self.pages[slot as usize / PAGE][slot as usize % PAGE]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrace_stats::Moments;

    #[test]
    fn slots_are_where_they_were_put() {
        let mut slots = Slots::default();
        assert_eq!((slots.len(), slots.iter().count()), (0, 0));
        let slot = |x| Slot { key: [x, -x, 7], moments: Moments::EMPTY };
        for x in 0..100 {
            slots.push(slot(x));
            assert_eq!(slots.iter().count(), slots.len());
        }
        slots[33].key[2] = 8;
        for (at, found) in (0..100_u32).zip(slots.iter()) {
            let expected =
                Slot { key: [at.cast_signed(), -at.cast_signed(), if at == 33 { 8 } else { 7 }], ..slot(0) };
            assert_eq!((slots[at], *found), (expected, expected));
        }
        assert_eq!(slots.len(), 100);
    }
}
