//! NPY, the arrays of `NumPy`: points, labels and standard errors.
//!
//! Versions 1 to 3 of the format, both byte orders, C and Fortran order. An organised cloud, `H × W × 3`, becomes its
//! points row by row; so do labels and errors of `H × W`. Structured arrays and Python objects are refused. Bytes after
//! the array are ignored.
//!
//! **Limits.** At most 16 bytes are asked for per byte of the file, whatever its header says.
//!
//! ```
//! use terrace_io::npy;
//!
//! let mut file = b"\x93NUMPY\x01\x00\x38\x00{'descr': '<f4', 'fortran_order': False, 'shape': (1,3)}".to_vec();
//! file.extend([1.0_f32, 2.0, 3.5].map(f32::to_le_bytes).as_flattened());
//! assert_eq!(npy::read(&file)?.points, [[1.0, 2.0, 3.5]]);
//! # Ok::<(), npy::NpyError>(())
//! ```

mod header;
mod points;

use crate::Cloud;
use crate::bytes::{Bytes, Failure, place};
use crate::cloud::records::{ByteOrder, Column, Scalar, fill};
use header::Header;
pub(crate) use points::Points;

/// Why an NPY file was refused. Offsets are in bytes from the start of the file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NpyError {
    /// The file does not start with the mark of the format.
    #[error("an NPY file starts with `\\x93NUMPY`, this one with `{found}`")]
    NotNpy {
        /// The start of the file.
        found: String,
    },
    /// The version of the format is not known.
    #[error("version {major}.{minor} of the NPY format is not known")]
    Version {
        /// The first number of the version.
        major: u8,
        /// The second number of the version.
        minor: u8,
    },
    /// The file ends within the header.
    #[error("the header needs {needed} bytes, the file has {present}")]
    TruncatedHeader {
        /// Bytes up to the end of the header.
        needed: usize,
        /// Bytes of the file.
        present: usize,
    },
    /// The header is not the dictionary it should be.
    #[error("byte {offset}: expected {expected}, found `{found}`")]
    Header {
        /// Where it differs.
        offset: usize,
        /// What would have been right.
        expected: &'static str,
        /// What is there.
        found: String,
    },
    /// The numbers are of a type that is not read here.
    #[error("the type of the array is `{descr}` instead of {expected}")]
    Type {
        /// The type, as NumPy writes it.
        descr: String,
        /// What is read.
        expected: &'static str,
    },
    /// The array has another shape than is read here.
    #[error("the shape of the array is {shape:?} instead of {expected}")]
    Shape {
        /// The shape.
        shape: Vec<u64>,
        /// What is read.
        expected: &'static str,
    },
    /// The header promises more than the file has. It was cut, or the shape is wrong.
    #[error(
        "an array of shape {shape:?} with {size} bytes a number does not fit the {present} bytes from byte {offset} on"
    )]
    Truncated {
        /// The shape.
        shape: Vec<u64>,
        /// Bytes of a number.
        size: usize,
        /// Where the numbers start.
        offset: usize,
        /// Bytes from there to the end of the file.
        present: usize,
    },
    /// A label does not fit 32 bits.
    #[error("the label {value} of point {point} does not fit 32 bits")]
    Label {
        /// Index of the point.
        point: usize,
        /// The label.
        value: i128,
    },
}

/// The numbers of an array whose shape and size were checked.
struct Array<'a> {
    bytes: &'a [u8],
    order: ByteOrder,
    layout: Layout,
}

/// The points of an array, row by row.
#[derive(Debug, Clone, Copy)]
struct Layout {
    rows: usize,
    columns: usize,
    fortran: bool,
}

/// Reads points from an array of `N × 3` or `H × W × 3` numbers in single or double precision.
///
/// # Errors
/// [`NpyError`] when the file is no whole NPY file or its array is not of points.
pub fn read(mut bytes: &[u8]) -> Result<Cloud, NpyError> {
    let mut points = Points::open(&mut bytes).map_err(Failure::content)?;
    points.read(&mut bytes, usize::MAX).map_err(Failure::content)?;
    let format = points.format();
    let (points, sigma) = points.rows.take();
    Ok(Cloud { points, sigma, viewpoint: None, format })
}

/// Reads labels from an array of `N` or `H × W` whole numbers of any width that fit 32 bits.
///
/// # Errors
/// [`NpyError`] when the file is no whole NPY file, its array is not of labels, or a label does not fit.
pub fn read_labels(mut bytes: &[u8]) -> Result<Vec<i32>, NpyError> {
    let header = header::parse(&mut bytes).map_err(Failure::content)?;
    let integer = header.scalar.filter(|scalar| scalar.is_integer());
    let scalar = integer.ok_or_else(|| wrong_type(&header, "whole numbers (i1 to i8, u1 to u8)"))?;
    let array = flat(bytes, &header, scalar)?;
    let labels: Result<Vec<i32>, NpyError> = array
        .bytes
        .chunks_exact(scalar.size())
        .enumerate()
        .map(|(point, number)| {
            let value = scalar.read_integer(number, array.order).unwrap_or(i128::MAX);
            i32::try_from(value).map_err(|_| NpyError::Label { point, value })
        })
        .collect();
    Ok(array.layout.in_rows(labels?))
}

/// Reads one number per point, such as its standard error, from an array of `N` or `H × W` numbers in single or double
/// precision.
///
/// # Errors
/// [`NpyError`] when the file is no whole NPY file or its array is of another kind.
pub fn read_scalars(mut bytes: &[u8]) -> Result<Vec<f64>, NpyError> {
    let header = header::parse(&mut bytes).map_err(Failure::content)?;
    let scalar = float(&header)?;
    let array = flat(bytes, &header, scalar)?;
    let column = Column { bytes: array.bytes, stride: scalar.size(), offset: 0, scalar };
    let mut numbers = vec![f64::NAN; array.layout.count()];
    fill(numbers.as_chunks_mut::<1>().0, 0, column, array.order);
    Ok(array.layout.in_rows(numbers))
}

impl Layout {
    /// Number of points.
    fn count(self) -> usize {
        self.rows * self.columns
    }

    /// Values in file order put in C order, point by point.
    fn in_rows<T: Copy>(self, values: Vec<T>) -> Vec<T> {
        // An empty array may still have rows without end.
        if !self.fortran || values.is_empty() {
            return values;
        }
        let mut in_rows = Vec::with_capacity(values.len());
        for row in 0..self.rows {
            in_rows.extend(values.iter().skip(row).step_by(self.rows));
        }
        in_rows
    }
}

fn float(header: &Header) -> Result<Scalar, NpyError> {
    let float = header.scalar.filter(|scalar| !scalar.is_integer());
    float.ok_or_else(|| wrong_type(header, "f4 or f8"))
}

fn wrong_type(header: &Header, expected: &'static str) -> NpyError {
    NpyError::Type { descr: header.descr.clone(), expected }
}

/// One number per point.
fn flat<'a>(bytes: &'a [u8], header: &Header, scalar: Scalar) -> Result<Array<'a>, NpyError> {
    let (rows, columns) = match header.shape[..] {
        [points] => (points, 1),
        [height, width] => (height, width),
        _ => return Err(NpyError::Shape { shape: header.shape.clone(), expected: "(N,) or (H, W)" }),
    };
    let layout = layout(&bytes, header, scalar, [rows, columns], 1)?;
    let numbers = bytes.get(place(header.body)..).unwrap_or_default();
    let numbers = numbers.get(..layout.count() * scalar.size()).unwrap_or(numbers);
    Ok(Array { bytes: numbers, order: header.order, layout })
}

/// Holds rows and columns of so many `numbers` a point against the bytes there are.
fn layout<B: Bytes>(
    bytes: &B,
    header: &Header,
    scalar: Scalar,
    [rows, columns]: [u64; 2],
    numbers: usize,
) -> Result<Layout, NpyError> {
    let present = bytes.left(header.body);
    let whole = || {
        let (rows, columns) = (usize::try_from(rows).ok()?, usize::try_from(columns).ok()?);
        let size = rows.checked_mul(columns)?.checked_mul(numbers)?.checked_mul(scalar.size())?;
        (size <= present).then_some(Layout { rows, columns, fortran: header.fortran })
    };
    whole().ok_or_else(|| NpyError::Truncated {
        shape: header.shape.clone(),
        size: scalar.size(),
        offset: place(header.body),
        present,
    })
}
