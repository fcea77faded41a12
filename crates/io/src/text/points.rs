//! The points of a text file, taken piece by piece.

use terrace_types::Sigma;

use super::{Layout, TextError, first_line, names_in_comment, row, whole};
use crate::FieldChoice;
use crate::bytes::{Bytes, Failure, Outcome};
use crate::cloud::lines::Lines;

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// A place in a file, and the points that were read and not yet taken.
pub(crate) struct Points {
    lines: Lines,
    errors_from: FieldChoice,
    /// Number of points that the line of this number announces.
    announced: Option<(usize, u64)>,
    /// Lines of names in comments before the first point.
    comment_names: Vec<(usize, Vec<String>)>,
    layout: Option<Layout>,
    /// Number of points taken.
    taken: usize,
}

impl Points {
    /// Finds out how lines end.
    pub(crate) fn open<B: Bytes>(bytes: &mut B, errors_from: &FieldChoice) -> Outcome<Self, TextError, B> {
        let start = bytes.window(0, BYTE_ORDER_MARK.len()).map_err(Failure::Input)?;
        let start = if start == BYTE_ORDER_MARK { BYTE_ORDER_MARK.len() } else { 0 };
        Ok(Self {
            lines: Lines::of_text(bytes, start as u64).map_err(Failure::Input)?,
            errors_from: errors_from.clone(),
            announced: None,
            comment_names: Vec::new(),
            layout: None,
            taken: 0,
        })
    }

    /// The format for people.
    #[expect(clippy::unused_self, reason = "as for the other formats")]
    pub(crate) fn format(&self) -> &'static str {
        "text"
    }

    /// Adds the next points to the rows, until there are `most`.
    pub(crate) fn read<B: Bytes>(&mut self, bytes: &mut B, most: usize) -> Outcome<(), TextError, B> {
        while self.rows() < most {
            let Some((line, content)) = self.lines.next_filled(bytes).map_err(Failure::Input)? else {
                return Ok(self.check_end()?);
            };
            let content = content.trim_ascii();
            if let Some(comment) = content.strip_prefix(b"#").or_else(|| content.strip_prefix(b"//")) {
                if self.layout.is_none() {
                    self.comment_names.extend(names_in_comment(comment).map(|names| (line, names)));
                }
                continue;
            }
            if let Some(layout) = &mut self.layout {
                row(layout, line, content)?;
                continue;
            }
            if self.announced.is_none()
                && let Some(count) = whole(content, line)?
            {
                self.announced = Some((line, count));
                continue;
            }
            let (mut found, is_header) = first_line(line, content, &self.comment_names, &self.errors_from)?;
            if !is_header {
                row(&mut found, line, content)?;
            }
            self.layout = Some(found);
        }
        Ok(())
    }

    /// Takes the points and errors away.
    pub(crate) fn take(&mut self) -> (Vec<[f64; 3]>, Sigma) {
        self.taken += self.rows();
        self.layout.as_mut().map(|layout| layout.rows.take()).unwrap_or_default()
    }

    /// Takes over the memory of points and errors that are no longer needed.
    pub(crate) fn reuse(&mut self, points: Vec<[f64; 3]>, sigmas: Sigma) {
        if let Some(layout) = &mut self.layout {
            layout.rows.reuse(points, sigmas);
        }
    }

    fn rows(&self) -> usize {
        self.layout.as_ref().map_or(0, |layout| layout.rows.len())
    }

    /// Whether there are as many points as there should be, when there are no more lines.
    fn check_end(&self) -> Result<(), TextError> {
        let found = self.taken + self.rows();
        if let Some((line, announced)) = self.announced
            && usize::try_from(announced) != Ok(found)
        {
            return Err(TextError::Count { line, announced, found });
        }
        if found == 0 {
            return Err(TextError::NoPoints { lines: self.lines.read() });
        }
        Ok(())
    }
}
