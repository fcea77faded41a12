//! The noise that the columns of a plane show, where nobody stated any.

use super::columns::{Column, Columns, Near, Of, variance_along};
use super::level::scatter_along;
use super::support::DEVIATIONS;

/// The level of noise around a column is taken from so many columns at least.
const FEWEST_AROUND: usize = 4;
/// And is at most this, in units of the variance of the level of the map.
const MOST_NOISE: f64 = 4.0;

/// From which of the columns around it a column takes its noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Among {
    All,
    /// Those that scatter by no more than the level of the map explains, where there are any. The others are likely to hold something else
    /// beside the plane, which is found out by testing them: not against their own scatter.
    Explained,
}

/// What a column scatters along the normal.
#[derive(Debug, Clone, Copy)]
struct Shown {
    variance: f64,
    /// Whether the level of the map explains it.
    is_explained: bool,
}

impl Columns {
    /// Takes the level of noise from the columns around each, in their median, where the level of the whole map was taken: it
    /// knows how far a surface is, but not how it reflects or at what angle it was seen. What scatters far more than the level is no
    /// noise.
    pub(super) fn take_noise_from_around(&mut self, near: &Near, among: Among) {
        let normal = near.normal;
        let shown = |column: &Column| {
            let level = variance_along(&column.sum, normal);
            let variance =
                scatter_along(&column.sum, normal.to_array()).filter(|_| column.of == Of::Plane)?;
            let most = 1.0 + DEVIATIONS * (2.0 / column.sum.count() as f64).sqrt();
            Some(Shown { variance: variance.min(MOST_NOISE * level), is_explained: variance <= most * level })
        };
        let shown: Vec<Option<Shown>> = self.all.iter().map(shown).collect();
        for at in 0..self.all.len() {
            let around = || self.around(at).filter_map(|at| shown[at]);
            let chosen = among == Among::Explained && around().any(|shown| shown.is_explained);
            let mut near = [f64::INFINITY; 9];
            let mut count = 0;
            for (place, shown) in near.iter_mut().zip(around().filter(|shown| shown.is_explained || !chosen))
            {
                *place = shown.variance;
                count += 1;
            }
            if count < FEWEST_AROUND {
                continue;
            }
            near.sort_unstable_by(f64::total_cmp);
            let variance = near[count / 2];
            let column = &mut self.all[at];
            let level = variance_along(&column.sum, normal);
            if variance > 0.0 && level > 0.0 {
                column.sum = column.sum.with_noise(column.sum.noise() * (variance / level));
            }
        }
    }
}
