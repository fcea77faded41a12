//! A picture of coloured pixels.

use crate::error::{DrawError, check_size};

/// The background of all pictures.
pub(crate) const WHITE: [u8; 3] = [255; 3];

/// A picture of coloured pixels, row by row from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    width: usize,
    height: usize,
    pixels: Vec<[u8; 3]>,
}

impl Image {
    /// A white picture.
    ///
    /// # Errors
    /// [`DrawError::Size`] when a side is 0 or above [`MAX_SIDE`](crate::MAX_SIDE).
    pub fn new(width: usize, height: usize) -> Result<Self, DrawError> {
        check_size(width, height)?;
        Ok(Self::white(width, height))
    }

    /// A white picture of any size.
    pub(crate) fn white(width: usize, height: usize) -> Self {
        Self { width, height, pixels: vec![WHITE; width * height] }
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The colour at column `x` and row `y`; `None` outside.
    pub fn pixel(&self, x: usize, y: usize) -> Option<[u8; 3]> {
        if x < self.width { self.pixels.get(y * self.width + x).copied() } else { None }
    }

    pub(crate) fn pixels_mut(&mut self) -> &mut [[u8; 3]] {
        &mut self.pixels
    }

    /// Mixes `colour` into a pixel; `share` 1 replaces it, 0 leaves it. Outside nothing happens.
    pub(crate) fn blend(&mut self, x: usize, y: usize, colour: [u8; 3], share: f64) {
        if x >= self.width {
            return;
        }
        if let Some(pixel) = self.pixels.get_mut(y * self.width + x) {
            for (old, new) in pixel.iter_mut().zip(colour) {
                let mixed = f64::from(*old) + share * (f64::from(new) - f64::from(*old));
                *old = crate::palette::to_byte(mixed / 255.0);
            }
        }
    }

    /// The picture with every square of `n` × `n` pixels averaged into one; what is left over is dropped.
    pub(crate) fn coarser(&self, n: usize) -> Self {
        let mut coarse = Self::white(self.width / n, self.height / n);
        let width = coarse.width;
        for (at, pixel) in coarse.pixels.iter_mut().enumerate() {
            let (left, top) = (at % width * n, at / width * n);
            let mut sum = [0.0; 3];
            for y in top..top + n {
                for colour in &self.pixels[y * self.width + left..][..n] {
                    sum = [0, 1, 2].map(|i| sum[i] + f64::from(colour[i]));
                }
            }
            *pixel = sum.map(|s| crate::palette::to_byte(s / (n * n * 255) as f64));
        }
        coarse
    }

    /// Two pictures side by side, aligned at the top, on white.
    ///
    /// # Errors
    /// [`DrawError::Size`] when both together are too wide.
    pub fn beside(left: &Self, right: &Self) -> Result<Self, DrawError> {
        let mut both = Self::new(left.width + right.width, left.height.max(right.height))?;
        both.paste(left, 0, 0);
        both.paste(right, left.width, 0);
        Ok(both)
    }

    /// Pictures in rows of `columns`, on white; a column is as wide as its widest picture, a row as high as its highest.
    /// The last row may be shorter.
    ///
    /// ```
    /// use terrace_draw::Image;
    ///
    /// let parts = [Image::new(30, 20)?, Image::new(40, 10)?, Image::new(5, 5)?];
    /// let sheet = Image::tiled(&parts, 2)?;
    /// assert_eq!((sheet.width(), sheet.height()), (30 + 40, 20 + 5));
    /// # Ok::<(), terrace_draw::DrawError>(())
    /// ```
    ///
    /// # Errors
    /// [`DrawError::Size`] when there is none, or all together are too wide or too high.
    pub fn tiled(parts: &[Self], columns: usize) -> Result<Self, DrawError> {
        let columns = columns.clamp(1, parts.len().max(1));
        let rows: Vec<&[Self]> = parts.chunks(columns).collect();
        let widths: Vec<usize> = (0..columns)
            .map(|column| rows.iter().filter_map(|row| row.get(column)).map(Self::width).max().unwrap_or(0))
            .collect();
        let heights: Vec<usize> =
            rows.iter().map(|row| row.iter().map(Self::height).max().unwrap_or(0)).collect();
        let mut sheet = Self::new(widths.iter().sum(), heights.iter().sum())?;
        let mut top = 0;
        for (row, height) in rows.iter().zip(heights) {
            let mut left = 0;
            for (part, width) in row.iter().zip(&widths) {
                sheet.paste(part, left, top);
                left += width;
            }
            top += height;
        }
        Ok(sheet)
    }

    /// Copies a picture that fits to this place.
    fn paste(&mut self, part: &Self, left: usize, top: usize) {
        let lines = self.pixels.chunks_exact_mut(self.width).skip(top);
        for (to, from) in lines.zip(part.pixels.chunks_exact(part.width)) {
            to[left..left + part.width].copy_from_slice(from);
        }
    }

    /// The picture as the bytes of a PNG file.
    ///
    /// # Errors
    /// [`DrawError::Png`] when the encoder fails.
    pub fn png(&self) -> Result<Vec<u8>, DrawError> {
        let mut bytes = Vec::new();
        // The sides are at most MAX_SIDE and so fit.
        let side = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        let mut encoder = png::Encoder::new(&mut bytes, side(self.width), side(self.height));
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(self.pixels.as_flattened())?;
        writer.finish()?;
        Ok(bytes)
    }
}
