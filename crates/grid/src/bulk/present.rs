//! The points of a batch that can be inserted, where some cannot: depth images lack some nearly everywhere.

use super::PointErrors;
use super::locate::{BATCH, Located, NOWHERE};
use crate::CellId;

/// Which points of a batch are left, with their errors. Memory is kept from one to the next.
#[derive(Debug)]
pub(super) struct Present {
    /// The place of each in the batch.
    at: [u8; BATCH],
    count: usize,
    /// What errors are made of, if each point has its own.
    errors: Vec<f64>,
}

const _: () = assert!(BATCH <= 256, "places are told in a byte");

impl Present {
    pub(super) fn new() -> Self {
        Self { at: [0; BATCH], count: 0, errors: Vec::new() }
    }

    /// Moves keys and places of those that are left to the front; tells how many are.
    pub(super) fn gather(&mut self, located: &mut Located, points: usize, errors: &PointErrors<'_>) -> usize {
        self.count = 0;
        self.errors.clear();
        for at in 0..points {
            if located.keys[at] != NOWHERE {
                located.keys[self.count] = located.keys[at];
                located.local[self.count] = located.local[at];
                // A place in a batch.
                #[allow(clippy::cast_possible_truncation)]
                let place = at as u8;
                self.at[self.count] = place;
                self.count += 1;
                errors.append(at, &mut self.errors);
            }
        }
        self.count
    }

    /// The errors of those that are left, of the same kind.
    pub(super) fn errors<'e>(&'e self, kind: &PointErrors<'_>) -> PointErrors<'e> {
        kind.of_numbers(&self.errors)
    }

    /// The cells of all points of the batch by those of the ones that are left.
    pub(super) fn spread(&self, found: &[Option<CellId>]) -> [Option<CellId>; BATCH] {
        let mut all = [None; BATCH];
        for (at, cell) in self.at[..self.count].iter().zip(found) {
            all[usize::from(*at)] = *cell;
        }
        all
    }
}
