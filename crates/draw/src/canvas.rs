//! What charts are drawn with, and on.

/// Where a text stands relative to its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// The text begins there.
    Start,
    /// The text is centred there.
    Middle,
    /// The text ends there.
    End,
}

/// A sheet on which lines, discs and text are drawn, in pixels from the upper left corner.
///
/// It has two back-ends, [`Svg`](crate::Svg) and [`Raster`](crate::Raster), so that whatever is drawn can be opened in a
/// browser and looked at as a PNG. Coordinates must be finite; a shape with others is left out.
pub trait Canvas {
    /// Width and height.
    fn size(&self) -> [f64; 2];

    /// A straight line with round ends.
    fn line(&mut self, from: [f64; 2], to: [f64; 2], width: f64, colour: [u8; 3]);

    /// A disc, filled.
    fn disc(&mut self, centre: [f64; 2], radius: f64, colour: [u8; 3]);

    /// An axis-parallel rectangle, filled, from its upper left to its lower right corner.
    fn rectangle(&mut self, from: [f64; 2], to: [f64; 2], colour: [u8; 3]);

    /// One line of text, centred vertically on its place; `size` is the height of capitals.
    fn text(&mut self, at: [f64; 2], text: &str, size: f64, anchor: Anchor, colour: [u8; 3]);

    /// How long a text of this size comes out, or about.
    fn text_width(&self, text: &str, size: f64) -> f64;
}

pub(crate) fn finite(values: &[f64]) -> bool {
    values.iter().all(|x| x.is_finite())
}
