//! The planes around groups of tiles, fitted when they are asked for.

use crate::flat::{Fitted, Noise};
use crate::pyramid::{LEVELS, Level};

/// The planes around groups, each fitted once.
#[derive(Debug)]
pub(crate) struct Arounds<'t> {
    levels: &'t [Level; LEVELS],
    noise: Noise,
    /// By level and group: 0 while it is not known, else one more than the place of what was found.
    known: [Vec<u32>; LEVELS],
    found: Vec<Option<Fitted>>,
}

impl<'t> Arounds<'t> {
    pub(crate) fn of(levels: &'t [Level; LEVELS], noise: Noise) -> Self {
        let known = levels.each_ref().map(|level| vec![0; level.around.len()]);
        Self { levels, noise, known, found: Vec::new() }
    }

    pub(crate) fn noise(&self) -> Noise {
        self.noise
    }

    /// The plane of the points of a group and of those it touches; `None` when they determine none.
    pub(crate) fn get(&mut self, level: usize, group: usize) -> Option<&Fitted> {
        let known = &mut self.known[level][group];
        if *known == 0 {
            self.found.push(Fitted::of(&self.levels[level].around[group], self.noise));
            // Groups are fewer than pixels, and those than 32 bits can count.
            *known = u32::try_from(self.found.len()).unwrap_or(0);
        }
        self.found.get((*known as usize).wrapping_sub(1))?.as_ref()
    }
}
