//! 16-bit depth images as PNG.

use std::io::Cursor;

use png::{BitDepth, ColorType, Decoder, Limits};

use crate::Intrinsics;

/// Most pixels an image may have: forty times a one-megapixel depth camera keeps clear of it.
pub const MAX_PIXELS: u64 = 1 << 25;

/// Raw units per metre when nothing else is said: millimetres.
pub const DEFAULT_DEPTH_SCALE: f64 = 1000.0;

/// No byte of a DEFLATE stream unpacks to more than 1032; an image that claims more cannot be in its file.
const MAX_INFLATION: u64 = 1032;

/// What the decoder may hold besides the image: its rows and the small chunks.
const DECODER_BYTES: usize = 16 << 20;

/// A decoded depth image: one raw number a pixel, row by row.
///
/// ```
/// use terrace_io::{Intrinsics, depth::DepthImage};
///
/// let image = DepthImage { width: 2, height: 1, raw: vec![1500, 0] };
/// let camera = Intrinsics::new(500.0, 500.0, 0.0, 0.0)?;
/// let points = image.points(&camera, 1000.0)?;
/// assert_eq!(points[0], [0.0, 0.0, 1.5]);
/// assert!(points[1][2].is_nan()); // raw 0 is no measurement
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DepthImage {
    /// Number of columns.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
    /// Depth along the optical axis in raw units, row by row; 0 and 65535 are no measurement.
    pub raw: Vec<u16>,
}

/// Why a depth image was refused.
#[derive(Debug, thiserror::Error)]
pub enum DepthError {
    /// The PNG is damaged, cut short, or no PNG at all.
    #[error("damaged PNG: {message}")]
    Damaged {
        /// What the decoder says.
        message: String,
    },
    /// The PNG holds something else than depth, such as colours.
    #[error("the PNG is {bits}-bit {colour}; a depth image is 16-bit grey")]
    NotDepth {
        /// Bits per channel.
        bits: u8,
        /// Kind of pixel in words.
        colour: &'static str,
    },
    /// The header promises more pixels than [`MAX_PIXELS`] or than the file can hold.
    #[error(
        "the PNG claims {width} x {height} pixels, more than its {bytes} bytes can hold or {MAX_PIXELS} allow"
    )]
    TooLarge {
        /// Columns claimed.
        width: u32,
        /// Rows claimed.
        height: u32,
        /// Size of the file.
        bytes: usize,
    },
    /// The scale is not a positive, finite number of raw units per metre.
    #[error("the depth scale {scale} is not a positive number of raw units per metre")]
    Scale {
        /// The scale as given.
        scale: f64,
    },
}

impl DepthImage {
    /// Decodes a PNG of 16-bit grey pixels, plain or interlaced.
    ///
    /// Memory stays below 2 bytes a pixel and 16 MiB, and the number of pixels below [`MAX_PIXELS`] and below what
    /// the size of the file allows, whatever its header claims.
    ///
    /// # Errors
    /// [`DepthError`] when the PNG is damaged, is no depth image, or claims too many pixels.
    pub fn read(bytes: &[u8]) -> Result<Self, DepthError> {
        let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: DECODER_BYTES });
        decoder.set_ignore_text_chunk(true);
        decoder.set_ignore_iccp_chunk(true);
        let header = decoder.read_header_info().map_err(|e| damaged(&e))?;
        let (width, height) = (header.width, header.height);
        if (header.color_type, header.bit_depth) != (ColorType::Grayscale, BitDepth::Sixteen) {
            let colour = colour_name(header.color_type);
            return Err(DepthError::NotDepth { bits: header.bit_depth as u8, colour });
        }
        let pixels = u64::from(width) * u64::from(height);
        let too_large = DepthError::TooLarge { width, height, bytes: bytes.len() };
        if pixels > MAX_PIXELS || pixels * 2 > bytes.len() as u64 * MAX_INFLATION {
            return Err(too_large);
        }
        let Ok(size) = usize::try_from(pixels * 2) else { return Err(too_large) };

        let mut reader = decoder.read_info().map_err(|e| damaged(&e))?;
        let mut buffer = vec![0; size];
        let frame = reader.next_frame(&mut buffer).map_err(|e| damaged(&e))?;
        if (frame.width, frame.height) != (width, height) {
            return Err(DepthError::Damaged { message: "an animation frame smaller than the image".into() });
        }
        let raw = buffer.as_chunks::<2>().0.iter().map(|b| u16::from_be_bytes(*b)).collect();
        Ok(Self { width, height, raw })
    }

    /// Whether the first bytes of a file (26 are enough) are those of a 16-bit grey PNG.
    pub fn is_depth_png(head: &[u8]) -> bool {
        head.starts_with(b"\x89PNG\r\n\x1a\n")
            && head.get(12..16) == Some(b"IHDR")
            && head.get(24..26) == Some(&[16, 0])
    }

    /// The point behind each pixel in the camera's frame (x right, y down, z forward), row by row, in metres:
    /// `z = raw / scale`, then as [`Intrinsics::unproject`]. NaN where there is no measurement.
    ///
    /// # Errors
    /// [`DepthError::Scale`] when the scale (raw units per metre) is not positive and finite.
    pub fn points(&self, camera: &Intrinsics, scale: f64) -> Result<Vec<[f64; 3]>, DepthError> {
        check_scale(scale)?;
        let columns = self.width.max(1) as usize;
        let rows = self.raw.chunks(columns).enumerate();
        Ok(rows
            .flat_map(|(v, row)| {
                row.iter().enumerate().map(move |(u, raw)| {
                    if Self::is_measurement(*raw) {
                        camera.unproject([u as f64, v as f64], f64::from(*raw) / scale)
                    } else {
                        [f64::NAN; 3]
                    }
                })
            })
            .collect())
    }

    /// Whether a raw number stands for a depth: 0 and 65535 do not.
    pub fn is_measurement(raw: u16) -> bool {
        raw != 0 && raw != u16::MAX
    }
}

fn check_scale(scale: f64) -> Result<(), DepthError> {
    if scale.is_normal() && scale > 0.0 { Ok(()) } else { Err(DepthError::Scale { scale }) }
}

fn damaged(error: &png::DecodingError) -> DepthError {
    DepthError::Damaged { message: error.to_string() }
}

fn colour_name(colour: ColorType) -> &'static str {
    match colour {
        ColorType::Grayscale => "grey",
        ColorType::Rgb => "RGB",
        ColorType::Indexed => "palette",
        ColorType::GrayscaleAlpha => "grey with alpha",
        ColorType::Rgba => "RGB with alpha",
    }
}
