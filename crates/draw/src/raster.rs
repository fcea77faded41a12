//! The canvas that colours pixels.

use crate::canvas::{Anchor, Canvas, finite};
use crate::error::DrawError;
use crate::font;
use crate::image::Image;

/// A canvas of pixels, with smooth edges.
///
/// ```
/// use terrace_draw::{Canvas, Raster};
///
/// let mut raster = Raster::new(20, 20)?;
/// raster.disc([10.0, 10.0], 5.0, [200, 0, 0]);
/// let image = raster.into_image();
/// assert_eq!([image.pixel(10, 10), image.pixel(1, 1)], [Some([200, 0, 0]), Some([255; 3])]);
/// # Ok::<(), terrace_draw::DrawError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Raster {
    image: Image,
}

impl Raster {
    /// A white canvas.
    ///
    /// # Errors
    /// [`DrawError::Size`] when a side is 0 or above [`MAX_SIDE`](crate::MAX_SIDE).
    pub fn new(width: usize, height: usize) -> Result<Self, DrawError> {
        Ok(Self::on(Image::new(width, height)?))
    }

    /// Draws on a picture.
    pub fn on(image: Image) -> Self {
        Self { image }
    }

    /// The picture drawn.
    pub fn into_image(self) -> Image {
        self.image
    }

    /// Colours all pixels between two corners by how far `inside` says their centres lie inside the shape, in pixels:
    /// its border crosses the pixels between −½ and ½.
    fn fill(&mut self, low: [f64; 2], high: [f64; 2], colour: [u8; 3], inside: impl Fn([f64; 2]) -> f64) {
        let [columns, rows] =
            [pixels(low[0], high[0], self.image.width()), pixels(low[1], high[1], self.image.height())];
        for y in rows {
            for x in columns.clone() {
                let share = (inside([x as f64 + 0.5, y as f64 + 0.5]) + 0.5).clamp(0.0, 1.0);
                if share > 0.0 {
                    self.image.blend(x, y, colour, share);
                }
            }
        }
    }
}

/// The pixels from `low` to `high` and one more on each side, within the picture.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to 0..=length")]
fn pixels(low: f64, high: f64, length: usize) -> std::ops::Range<usize> {
    let [start, end] = [low - 1.0, high + 2.0].map(|x| x.clamp(0.0, length as f64) as usize);
    start..end
}

impl Canvas for Raster {
    fn size(&self) -> [f64; 2] {
        [self.image.width() as f64, self.image.height() as f64]
    }

    fn line(&mut self, from: [f64; 2], to: [f64; 2], width: f64, colour: [u8; 3]) {
        if !finite(&[from[0], from[1], to[0], to[1], width]) {
            return;
        }
        let reach = width / 2.0;
        let low = [0, 1].map(|i| from[i].min(to[i]) - reach);
        let high = [0, 1].map(|i| from[i].max(to[i]) + reach);
        let along = [to[0] - from[0], to[1] - from[1]];
        let length2 = along[0] * along[0] + along[1] * along[1];
        self.fill(low, high, colour, |p| {
            let d = [p[0] - from[0], p[1] - from[1]];
            let share = if length2 > 0.0 {
                ((d[0] * along[0] + d[1] * along[1]) / length2).clamp(0.0, 1.0)
            } else {
                0.0
            };
            reach - (d[0] - share * along[0]).hypot(d[1] - share * along[1])
        });
    }

    fn disc(&mut self, centre: [f64; 2], radius: f64, colour: [u8; 3]) {
        if finite(&[centre[0], centre[1], radius]) {
            let (low, high) = (centre.map(|c| c - radius), centre.map(|c| c + radius));
            self.fill(low, high, colour, |p| radius - (p[0] - centre[0]).hypot(p[1] - centre[1]));
        }
    }

    fn rectangle(&mut self, from: [f64; 2], to: [f64; 2], colour: [u8; 3]) {
        if finite(&[from[0], from[1], to[0], to[1]]) {
            self.fill(from, to, colour, |p| {
                (p[0] - from[0]).min(to[0] - p[0]).min(p[1] - from[1]).min(to[1] - p[1])
            });
        }
    }

    fn text(&mut self, at: [f64; 2], text: &str, size: f64, anchor: Anchor, colour: [u8; 3]) {
        if !finite(&[at[0], at[1], size]) {
            return;
        }
        let (dot, width) = (dot(size), self.text_width(text, size));
        let left = match anchor {
            Anchor::Start => at[0],
            Anchor::Middle => at[0] - width / 2.0,
            Anchor::End => at[0] - width,
        };
        let (left, top) = (left.round(), (at[1] - font::HEIGHT as f64 * dot / 2.0).round());
        for (place, letter) in text.chars().enumerate() {
            for (column, dots) in font::glyph(letter).into_iter().enumerate() {
                for row in (0..8).filter(|row| (dots >> row) & 1 == 1) {
                    let x = left + (place * font::ADVANCE + column) as f64 * dot;
                    let y = top + f64::from(row) * dot;
                    self.rectangle([x, y], [x + dot, y + dot], colour);
                }
            }
        }
    }

    fn text_width(&self, text: &str, size: f64) -> f64 {
        (text.chars().count() * font::ADVANCE).saturating_sub(1) as f64 * dot(size)
    }
}

/// The side of a dot of the font: whole pixels, since anything else blurs so small a font.
fn dot(size: f64) -> f64 {
    (size / font::HEIGHT as f64).round().max(1.0)
}
