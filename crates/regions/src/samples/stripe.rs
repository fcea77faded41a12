//! Samples of some of the cells, in memory.

use super::sample::Sample;
use super::spot::Spot;
use super::units::Unit;

/// So many points of a cell are kept at most.
pub(super) const MOST: usize = 16;
/// After so many halvings the threshold is at its least.
pub(super) const MOST_HALVINGS: u8 = 31;
/// So many are kept beside what is looked at for each point: all that many cells have.
pub(super) const FEW: usize = 6;
/// One more than are kept: a point is written first, and counted when it stays.
pub(super) const ROOM: usize = MOST + 1;
/// Cells, and further points of cells, that are in a row.
const PAGE: usize = 64;
/// A cell without further points.
const NONE: u32 = u32::MAX;
/// Its further points.
const NOTHING: &More = &[Spot::ZERO; ROOM - FEW];

/// Page by page, so that none is moved when more cells come. Aligned, for one of several is faster found so.
#[allow(clippy::vec_box, reason = "pages are not moved")]
#[derive(Debug, Clone, Default)]
#[repr(align(64))]
pub(super) struct Stripe {
    cells: Vec<Box<[Kept; PAGE]>>,
    /// Halvings of the threshold of each: apart, for they are looked at for points of which nothing else is.
    halvings: Vec<u8>,
    /// Further points of the cells that have more than a few, in the order in which they had.
    more: Vec<Box<[More; PAGE]>>,
    /// How many cells have.
    full: u32,
}

/// The sample of a cell, with its first points.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
struct Kept {
    /// Where further points are.
    more: u32,
    count: u16,
    few: [Spot; FEW],
}

pub(super) type More = [Spot; ROOM - FEW];

impl Stripe {
    /// Whether a point would be in the sample of a cell now; one that would not never will be.
    #[inline]
    pub(super) fn takes(&self, at: usize, spot: Spot) -> bool {
        spot.endures() >= self.halvings.get(at).copied().unwrap_or(0)
    }

    #[inline]
    pub(super) fn push(&mut self, at: usize, spot: Spot) {
        let cell = self.cells.get_mut(at / PAGE).map(|page| &mut page[at % PAGE]);
        let (Some(kept), Some(halvings)) = (cell, self.halvings.get_mut(at)) else {
            return self.push_anew(at, spot);
        };
        // Whether a point stays cannot be predicted while a cell fills: there is no branch.
        let stays = spot.endures() >= *halvings;
        let (before, after) = (kept.count(), kept.count + u16::from(stays));
        if let Some(free) = kept.few.get_mut(before) {
            *free = spot;
            kept.count = after;
            return;
        }
        let more = kept.more as usize;
        let Some(more) = self.more.get_mut(more / PAGE).map(|page| &mut page[more % PAGE]) else {
            if stays {
                self.push_anew(at, spot);
            }
            return;
        };
        if let Some(free) = more.get_mut(before - FEW) {
            *free = spot;
        }
        kept.count = after;
        if usize::from(after) > MOST {
            kept.make_room(halvings, more);
        }
    }

    /// As [`push`](Self::push), where there is no room yet.
    #[cold]
    #[inline(never)]
    fn push_anew(&mut self, at: usize, spot: Spot) {
        if self.get_or_new(at).count() >= FEW {
            self.more_of(at);
        }
        self.push(at, spot);
    }

    /// How often the sample of a cell was halved, if there ever was one.
    pub(super) fn halvings(&self, at: usize) -> Option<u8> {
        self.halvings.get(at).copied()
    }

    /// The sample of a cell.
    #[inline]
    pub(super) fn of(&self, at: usize, unit: Unit) -> Sample<'_> {
        let Some(kept) = self.get(at) else { return Sample::EMPTY };
        let more = kept.more as usize;
        let more = self.more.get(more / PAGE).map_or(NOTHING, |page| &page[more % PAGE]);
        Sample::of(&kept.few, more, kept.count, unit)
    }

    /// Puts these points, at most sixteen, in the place of the sample of a cell.
    pub(super) fn put(&mut self, at: usize, spots: &[Spot], halvings: u8) {
        let (few, others) = spots.split_at(spots.len().min(FEW));
        if !others.is_empty() {
            self.more_of(at)[..others.len()].copy_from_slice(others);
        }
        let kept = self.get_or_new(at);
        kept.few[..few.len()].copy_from_slice(few);
        // At most sixteen.
        #[allow(clippy::cast_possible_truncation)]
        let count = spots.len() as u16;
        kept.count = count;
        self.halvings[at] = halvings;
    }

    /// Halves the sample of a cell until it is halved so often.
    pub(super) fn halve(&mut self, at: usize, halvings: u8) {
        let more = self.get_or_new(at).more as usize;
        let (kept, done) = (&mut self.cells[at / PAGE][at % PAGE], &mut self.halvings[at]);
        let mut none = *NOTHING;
        let more = self.more.get_mut(more / PAGE).map_or(&mut none, |page| &mut page[more % PAGE]);
        while *done < halvings {
            kept.halve(done, more);
        }
    }

    fn get(&self, at: usize) -> Option<&Kept> {
        self.cells.get(at / PAGE).map(|page| &page[at % PAGE])
    }

    fn get_or_new(&mut self, at: usize) -> &mut Kept {
        if at / PAGE >= self.cells.len() {
            self.cells.resize_with(at / PAGE + 1, || Box::new([Kept::NONE; PAGE]));
            self.halvings.resize(self.cells.len() * PAGE, 0);
        }
        &mut self.cells[at / PAGE][at % PAGE]
    }

    /// Room for further points of a cell.
    fn more_of(&mut self, at: usize) -> &mut More {
        let next = self.full;
        let kept = self.get_or_new(at);
        if kept.more == NONE {
            kept.more = next;
            self.full += 1;
        }
        let more = self.get_or_new(at).more as usize;
        if more / PAGE >= self.more.len() {
            self.more.push(Box::new([*NOTHING; PAGE]));
        }
        &mut self.more[more / PAGE][more % PAGE]
    }
}

/// All points of a sample that there may be.
pub(super) fn all_of(few: &[Spot; FEW], more: &More) -> [Spot; ROOM] {
    let mut all = [Spot::ZERO; ROOM];
    let (first, others) = all.split_at_mut(FEW);
    first.copy_from_slice(few);
    others.copy_from_slice(more);
    all
}

impl Kept {
    const NONE: Self = Self { more: NONE, count: 0, few: [Spot::ZERO; FEW] };

    fn count(&self) -> usize {
        self.count.into()
    }

    /// Halves the threshold until there is room for what was just counted; one place again and again is not kept without end.
    #[inline(never)]
    fn make_room(&mut self, halvings: &mut u8, more: &mut More) {
        while usize::from(self.count) > MOST && *halvings < MOST_HALVINGS {
            self.halve(halvings, more);
        }
        if usize::from(self.count) > MOST {
            self.count -= 1;
        }
    }

    fn halve(&mut self, halvings: &mut u8, more: &mut More) {
        *halvings += 1;
        let all = all_of(&self.few, more);
        // Into other memory, and back at once: what was just written in pieces is waited for when it is read as a whole.
        let (mut kept, mut count) = ([Spot::ZERO; ROOM + 1], 0);
        for spot in all.iter().take(self.count()) {
            kept[count] = *spot;
            count += usize::from(spot.endures() >= *halvings);
        }
        self.few.copy_from_slice(&kept[..FEW]);
        more.copy_from_slice(&kept[FEW..ROOM]);
        // Not more than before.
        #[allow(clippy::cast_possible_truncation)]
        let count = count as u16;
        self.count = count;
    }
}
