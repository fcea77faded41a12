//! Pages of a file, looked at before they are unpacked.
//!
//! A page says in its header how large it is unpacked and how many values it has, and readers take memory for what it says. Here that is
//! held against the size of the file, so that a few damaged bytes cannot ask for gigabytes.

use parquet::file::metadata::{ColumnChunkMetaData, ParquetMetaData, RowGroupMetaData};
use parquet::file::reader::ChunkReader;

use crate::thrift::{Thrift, Value};
use crate::{MapFileError, PageError};

/// Headers of pages of numbers are shorter.
const LONGEST_HEADER: usize = 1024;
/// Unpacked, a page is at most so many times as large: Snappy copies up to 64 bytes for three.
const UNPACKED: i64 = 64;
/// Small pages may be anything.
const SMALL: i64 = 1 << 12;
/// Values of a column of lists, empty ones included, for each byte of the file. A row alone takes more than a hundred.
const VALUES: u64 = 2;

/// Looks at all pages of the columns whose numbers `wanted` tells.
///
/// # Errors
/// [`MapFileError::Page`] for the first that cannot be.
pub(crate) fn check_pages<R: ChunkReader>(
    file: &R,
    metadata: &ParquetMetaData,
    wanted: impl Fn(usize) -> bool,
) -> Result<(), MapFileError> {
    let most = i64::try_from(file.len().saturating_mul(VALUES)).unwrap_or(i64::MAX);
    let mut rows = 0_i64;
    let mut values = vec![0_i64; metadata.file_metadata().schema_descr().num_columns()];
    for group in metadata.row_groups() {
        rows = sum(rows, group.num_rows(), most).map_err(|error| refused(group, 0, 0, error))?;
        for (number, column) in group.columns().iter().enumerate().filter(|(number, _)| wanted(*number)) {
            let refused = |(offset, error)| refused(group, number, offset, error);
            if let Some(all) = values.get_mut(number) {
                *all = sum(*all, column.num_values(), most).map_err(|error| refused((0, error)))?;
            }
            check_column(file, column).map_err(refused)?;
        }
    }
    Ok(())
}

fn refused(group: &RowGroupMetaData, column: usize, offset: u64, error: PageError) -> MapFileError {
    let column = group.columns().get(column).map(|column| column.column_path().string());
    MapFileError::Page { column: column.unwrap_or_default(), offset, error }
}

/// The sum of two numbers that are at least zero, if it is no larger than `most`.
fn sum(before: i64, more: i64, most: i64) -> Result<i64, PageError> {
    let sum = before.checked_add(more).filter(|sum| more >= 0 && *sum <= most);
    sum.ok_or(PageError::Values { values: more, most })
}

fn check_column<R: ChunkReader>(file: &R, column: &ColumnChunkMetaData) -> Result<(), (u64, PageError)> {
    let packed = column.compressed_size();
    let first = column.dictionary_page_offset().unwrap_or(column.data_page_offset());
    let outside = PageError::Outside { bytes: packed, file: file.len() };
    let start = u64::try_from(first).map_err(|_| (0, outside))?;
    let length = u64::try_from(packed).map_err(|_| (start, outside))?;
    let end = start.checked_add(length).filter(|end| *end <= file.len()).ok_or((start, outside))?;
    let (mut at, mut values) = (start, 0);
    while at < end {
        let header = page_header(file, at, end).ok_or((at, PageError::Header))?;
        if let PageKind::Data = header.kind {
            values = sum(values, header.values, column.num_values()).map_err(|error| (at, error))?;
        }
        header.check(end - at).map_err(|error| (at, error))?;
        // Within the column, by the check.
        at += header.length + header.packed.cast_unsigned();
    }
    if values == column.num_values() {
        Ok(())
    } else {
        Err((start, PageError::Values { values, most: column.num_values() }))
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum PageKind {
    Data,
    Dictionary,
}

/// What the header of a page says.
#[derive(Debug, Clone, Copy)]
struct PageHeader {
    kind: PageKind,
    /// Bytes of the header.
    length: u64,
    unpacked: i64,
    packed: i64,
    values: i64,
    /// Bytes of the levels in front, which are not packed.
    levels: i64,
}

impl PageHeader {
    /// Whether it can be so within so many bytes.
    fn check(&self, bytes: u64) -> Result<(), PageError> {
        let Self { unpacked, packed, values, levels, .. } = *self;
        let room = i64::try_from(bytes).unwrap_or(i64::MAX) - self.length.cast_signed();
        if !(0..=room).contains(&packed) {
            return Err(PageError::Outside { bytes: packed, file: bytes });
        }
        let most = packed.saturating_mul(UNPACKED).saturating_add(SMALL);
        if !(0..=most).contains(&unpacked) || !(0..=unpacked.min(packed)).contains(&levels) {
            return Err(PageError::Packed { packed, bytes: unpacked });
        }
        if self.kind == PageKind::Dictionary && !(0..=unpacked).contains(&values) {
            return Err(PageError::Values { values, most: unpacked });
        }
        Ok(())
    }
}

/// The header of the page that begins there; `None` when there is none, or one of a kind that no column of numbers has.
fn page_header<R: ChunkReader>(file: &R, at: u64, end: u64) -> Option<PageHeader> {
    let length = usize::try_from(end - at).unwrap_or(usize::MAX).min(LONGEST_HEADER);
    let bytes = file.get_bytes(at, length).ok()?;
    let mut thrift = Thrift::new(&bytes);
    let [mut kind, mut unpacked, mut packed] = [None; 3];
    // By the field that each kind has: of data, of a dictionary, of data in the second version.
    let mut of_kind: [Option<(i64, i64)>; 3] = [None; 3];
    thrift.structure(|thrift, field, value| match (field, value) {
        (1, Value::Number(number)) => kind.replace(number).is_none().then_some(()),
        (2, Value::Number(number)) => unpacked.replace(number).is_none().then_some(()),
        (3, Value::Number(number)) => packed.replace(number).is_none().then_some(()),
        (5 | 7 | 8, Value::Structure) => {
            let place = match field {
                5 => 0,
                7 => 1,
                _ => 2,
            };
            let own = numbers(thrift, field == 8)?;
            of_kind[place].replace(own).is_none().then_some(())
        }
        (_, Value::Structure) => thrift.pass_over_structure(),
        _ => Some(()),
    })?;
    let (kind, (values, levels)) = match kind? {
        0 => (PageKind::Data, of_kind[0]?),
        2 => (PageKind::Dictionary, of_kind[1]?),
        3 => (PageKind::Data, of_kind[2]?),
        _ => return None,
    };
    let length = thrift.read() as u64;
    Some(PageHeader { kind, length, unpacked: unpacked?, packed: packed?, values, levels })
}

/// The number of values of a page, and the bytes of its levels where they are told.
fn numbers(thrift: &mut Thrift, second_version: bool) -> Option<(i64, i64)> {
    let (mut values, mut levels) = (None, 0_i64);
    thrift.structure(|thrift, field, value| match (field, value) {
        (1, Value::Number(number)) => values.replace(number).is_none().then_some(()),
        (5 | 6, Value::Number(bytes)) if second_version => {
            levels = levels.checked_add(bytes).filter(|_| bytes >= 0)?;
            Some(())
        }
        (_, Value::Structure) => thrift.pass_over_structure(),
        _ => Some(()),
    })?;
    Some((values?, levels))
}
