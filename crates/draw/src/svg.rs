//! The canvas that writes SVG.

use crate::canvas::{Anchor, Canvas, finite};
use crate::error::{DrawError, check_size};
use std::fmt::Write;

/// An SVG document in the making.
///
/// ```
/// use terrace_draw::{Anchor, Canvas, Svg};
///
/// let mut svg = Svg::new(100, 50)?;
/// svg.text([50.0, 25.0], "a < b", 12.0, Anchor::Middle, [0, 0, 0]);
/// assert!(svg.finish().contains("a &lt; b"));
/// # Ok::<(), terrace_draw::DrawError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Svg {
    width: usize,
    height: usize,
    body: String,
}

/// Capitals of common sans-serif fonts are about 0.72 of the font size high.
const CAPITAL: f64 = 0.72;

impl Svg {
    /// An empty document on white.
    ///
    /// # Errors
    /// [`DrawError::Size`] when a side is 0 or above [`MAX_SIDE`](crate::MAX_SIDE).
    pub fn new(width: usize, height: usize) -> Result<Self, DrawError> {
        check_size(width, height)?;
        Ok(Self { width, height, body: String::new() })
    }

    /// The text of the document.
    pub fn finish(&self) -> String {
        let Self { width, height, body } = self;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} \
             {height}\" font-family=\"Helvetica, Arial, sans-serif\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n{body}</svg>\n"
        )
    }

    /// Appends an element; writing to a string does not fail.
    fn push(&mut self, element: std::fmt::Arguments<'_>) {
        let written = self.body.write_fmt(element);
        debug_assert!(written.is_ok());
        self.body.push('\n');
    }
}

impl Canvas for Svg {
    fn size(&self) -> [f64; 2] {
        [self.width as f64, self.height as f64]
    }

    fn line(&mut self, from: [f64; 2], to: [f64; 2], width: f64, colour: [u8; 3]) {
        if finite(&[from[0], from[1], to[0], to[1], width]) {
            let ([x1, y1], [x2, y2], stroke) = (from, to, hex(colour));
            self.push(format_args!(
                "<line x1=\"{x1:.2}\" y1=\"{y1:.2}\" x2=\"{x2:.2}\" y2=\"{y2:.2}\" stroke=\"{stroke}\" \
                 stroke-width=\"{width:.2}\" stroke-linecap=\"round\"/>"
            ));
        }
    }

    fn disc(&mut self, centre: [f64; 2], radius: f64, colour: [u8; 3]) {
        if finite(&[centre[0], centre[1], radius]) {
            let ([x, y], fill) = (centre, hex(colour));
            self.push(format_args!(
                "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius:.2}\" fill=\"{fill}\"/>"
            ));
        }
    }

    fn rectangle(&mut self, from: [f64; 2], to: [f64; 2], colour: [u8; 3]) {
        if finite(&[from[0], from[1], to[0], to[1]]) {
            let ([x, y], fill) = (from, hex(colour));
            let [w, h] = [(to[0] - x).max(0.0), (to[1] - y).max(0.0)];
            self.push(format_args!(
                "<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{w:.2}\" height=\"{h:.2}\" fill=\"{fill}\"/>"
            ));
        }
    }

    fn text(&mut self, at: [f64; 2], text: &str, size: f64, anchor: Anchor, colour: [u8; 3]) {
        if finite(&[at[0], at[1], size]) {
            let (x, y) = (at[0], at[1] + size / 2.0);
            let (fill, em) = (hex(colour), size / CAPITAL);
            let anchor = match anchor {
                Anchor::Start => "start",
                Anchor::Middle => "middle",
                Anchor::End => "end",
            };
            let text = escaped(text);
            self.push(format_args!(
                "<text x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"{em:.2}\" text-anchor=\"{anchor}\" \
                 fill=\"{fill}\">{text}</text>"
            ));
        }
    }

    fn text_width(&self, text: &str, size: f64) -> f64 {
        // Letters of common sans-serif fonts are half an em wide on average; a little more keeps texts apart.
        text.chars().count() as f64 * 0.54 * size / CAPITAL
    }
}

fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Text as XML content: markup as entities; control characters, which XML forbids, as the replacement character.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' | '\r' | '\t' => out.push(' '),
            c if c.is_control() || matches!(c, '\u{FFFE}' | '\u{FFFF}') => out.push('\u{FFFD}'),
            c => out.push(c),
        }
    }
    out
}
