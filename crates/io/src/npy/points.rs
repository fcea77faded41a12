//! The points of an NPY file, taken piece by piece.

use super::header::{self, Header};
use super::{Layout, NpyError, float, layout};
use crate::bytes::{Bytes, Failure, Outcome, PIECE};
use crate::cloud::fields::{Rows, SigmaFields, Wanted};
use crate::cloud::records::{ByteOrder, Column, Scalar, fill};

/// A place in a file, and the points that were read and not yet taken.
pub(crate) struct Points {
    /// Where the numbers start.
    body: u64,
    scalar: Scalar,
    order: ByteOrder,
    layout: Layout,
    /// Index of the point that comes next.
    next: usize,
    /// All points of an image in Fortran order, whose neighbours are far apart in the file.
    turned: Option<Vec<[f64; 3]>>,
    pub(crate) rows: Rows,
}

impl Points {
    /// Reads the header, and holds it against the bytes there are.
    pub(crate) fn open<B: Bytes>(bytes: &mut B) -> Outcome<Self, NpyError, B> {
        let header: Header = header::parse(bytes)?;
        let scalar = float(&header)?;
        let rows_and_columns = match header.shape[..] {
            [points, 3] => [points, 1],
            [height, width, 3] => [height, width],
            _ => {
                let expected = "(N, 3) or (H, W, 3)";
                return Err(NpyError::Shape { shape: header.shape, expected }.into());
            }
        };
        let layout = layout(bytes, &header, scalar, rows_and_columns, 3)?;
        let rows = Rows::new(Wanted { xyz: [0, 1, 2], sigma: SigmaFields::None });
        let (body, order) = (header.body, header.order);
        Ok(Self { body, scalar, order, layout, next: 0, turned: None, rows })
    }

    /// Number of points.
    pub(crate) fn promised(&self) -> u64 {
        self.layout.count() as u64
    }

    /// The format for people.
    #[expect(clippy::unused_self, reason = "as for the other formats")]
    pub(crate) fn format(&self) -> &'static str {
        "NPY"
    }

    /// Adds the next points to the rows, `most` at most.
    pub(crate) fn read<B: Bytes>(&mut self, bytes: &mut B, most: usize) -> Outcome<(), NpyError, B> {
        let count = most.min(self.layout.count() - self.next);
        let size = self.scalar.size();
        if !self.layout.fortran {
            let stride = 3 * size;
            let at = self.body + (self.next * stride) as u64;
            let field = |axis| (axis * size, self.scalar);
            self.rows.gather_records(bytes, at, stride, count, self.order, field).map_err(Failure::Input)?;
        } else if self.layout.columns == 1 {
            let (first, rows) = (self.next, self.rows.add_absent(count));
            read_columns(bytes, self.body, self.scalar, self.order, [first, self.layout.rows], rows)?;
        } else {
            if self.turned.is_none() {
                let mut all = vec![[f64::NAN; 3]; self.layout.count()];
                let places = [0, self.layout.count()];
                read_columns(bytes, self.body, self.scalar, self.order, places, &mut all)?;
                self.turned = Some(self.layout.in_rows(all));
            }
            let next = self.turned.as_ref().and_then(|all| all.get(self.next..)).unwrap_or_default();
            self.rows.add_absent(count).iter_mut().zip(next).for_each(|(row, point)| *row = *point);
        }
        self.next += count;
        Ok(())
    }
}

/// Sets rows from the point at `first` of `all` on, where all x are followed by all y and all z.
fn read_columns<B: Bytes>(
    bytes: &mut B,
    body: u64,
    scalar: Scalar,
    order: ByteOrder,
    [first, all]: [usize; 2],
    rows: &mut [[f64; 3]],
) -> Outcome<(), NpyError, B> {
    let size = scalar.size();
    for axis in 0..3 {
        let mut at = body + ((axis * all + first) * size) as u64;
        for piece in rows.chunks_mut(PIECE / size) {
            let length = piece.len() * size;
            let window = bytes.window(at, length).map_err(Failure::Input)?;
            fill(piece, axis, Column { bytes: window, stride: size, offset: 0, scalar }, order);
            at += length as u64;
        }
    }
    Ok(())
}
