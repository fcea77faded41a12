//! What charts share: colours, sizes, and a pen that knows the scale of the sheet.

use crate::canvas::{Anchor, Canvas};

pub(crate) const INK: [u8; 3] = [45, 45, 50];
pub(crate) const GRID: [u8; 3] = [228, 228, 232];
pub(crate) const WHITE: [u8; 3] = [255; 3];

/// Height of capitals: of the title and of all else.
pub(crate) const TITLE: f64 = 14.0;
pub(crate) const TEXT: f64 = 10.0;

/// Draws with widths and sizes in units of the sheet; places are those of the canvas.
pub(crate) struct Pen<'a, C> {
    pub(crate) canvas: &'a mut C,
    pub(crate) unit: f64,
}

impl<C: Canvas> Pen<'_, C> {
    pub(crate) fn line(&mut self, from: [f64; 2], to: [f64; 2], width: f64, colour: [u8; 3]) {
        self.canvas.line(from, to, width * self.unit, colour);
    }

    pub(crate) fn disc(&mut self, centre: [f64; 2], radius: f64, colour: [u8; 3]) {
        self.canvas.disc(centre, radius * self.unit, colour);
    }

    /// An open mark: a disc with a white one in it.
    pub(crate) fn ring(&mut self, centre: [f64; 2], radius: f64, stroke: f64, colour: [u8; 3]) {
        self.disc(centre, radius, colour);
        self.disc(centre, radius - stroke, WHITE);
    }

    pub(crate) fn text(&mut self, at: [f64; 2], text: &str, size: f64, anchor: Anchor) {
        self.canvas.text(at, text, size * self.unit, anchor, INK);
    }
}
