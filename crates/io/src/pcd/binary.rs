//! The body of a binary PCD file: point after point, or packed with LZF field after field.

use std::ops::Range;

use super::PcdError;
use super::header::Header;
use super::lzf;
use crate::bytes::{Bytes, Failure, Outcome, place};
use crate::cloud::fields::Rows;
use crate::cloud::records::{ByteOrder, Column, Scalar};

/// Adds `points` of a file that holds them one after the other to `rows`.
pub(super) fn read<B: Bytes>(
    bytes: &mut B,
    header: &Header,
    points: Range<u64>,
    rows: &mut Rows,
) -> Outcome<(), PcdError, B> {
    let (stride, size) = header.sizes()?;
    let present = bytes.left(header.body);
    if size > present {
        let offset = place(header.body);
        return Err(PcdError::Truncated { points: header.points, stride, offset, present }.into());
    }
    let starts = starts(header);
    let field = |index| (starts.get(index).copied().unwrap_or(0), scalar(header, index));
    let (first, count) = counted(&points);
    let at = header.body + (first * stride) as u64;
    rows.gather_records(bytes, at, stride, count, ByteOrder::Little, field).map_err(Failure::Input)
}

/// The bytes of all fields, one field after the other.
pub(super) fn unpack<B: Bytes>(bytes: &mut B, header: &Header) -> Outcome<Vec<u8>, PcdError, B> {
    let (stride, size) = header.sizes()?;
    // PCL writes nothing after the header of an empty cloud.
    if size == 0 {
        return Ok(Vec::new());
    }
    let (packed, unpacked) = sizes_of_packed(bytes, header.body)?;
    if unpacked != size {
        let offset = place(header.body + 4);
        return Err(PcdError::UnpackedSize { offset, unpacked, points: header.points, stride }.into());
    }
    let offset = header.body + 8;
    let packed = bytes.whole(offset, packed).map_err(Failure::Input)?;
    let damaged = |source| PcdError::Compressed { offset: place(offset), source };
    Ok(lzf::unpack(&packed, unpacked).map_err(damaged)?)
}

/// Adds `points` of an unpacked block to `rows`.
pub(super) fn read_unpacked(
    block: &[u8],
    header: &Header,
    points: Range<u64>,
    rows: &mut Rows,
) -> Result<(), PcdError> {
    let (stride, size) = header.sizes()?;
    let all = size.checked_div(stride).unwrap_or(0);
    let starts = starts(header);
    let (first, count) = counted(&points);
    rows.reserve(count);
    rows.gather(ByteOrder::Little, count, |field| {
        let scalar = scalar(header, field);
        // Each field is a block of its own; what the fields before it take is the number of points times its offset in
        // a point.
        let offset = starts.get(field).map_or(0, |start| start * all) + first * scalar.size();
        Column { bytes: block, stride: scalar.size(), offset, scalar }
    });
    Ok(())
}

/// Index of the first of some points and their number, which [`Header::sizes`] has made sure can be counted.
fn counted(points: &Range<u64>) -> (usize, usize) {
    let [first, end] = [points.start, points.end].map(|index| usize::try_from(index).unwrap_or(usize::MAX));
    (first, end - first)
}

/// The sizes of the packed bytes and, as they say, of the unpacked ones.
fn sizes_of_packed<B: Bytes>(bytes: &mut B, offset: u64) -> Outcome<(usize, usize), PcdError, B> {
    let truncated =
        |needed, offset, present| PcdError::TruncatedCompressed { needed, offset: place(offset), present };
    let present = bytes.left(offset);
    let start = bytes.window(offset, 8).map_err(Failure::Input)?;
    let (packed, rest) = start.split_first_chunk().ok_or_else(|| truncated(8, offset, present))?;
    let unpacked = rest.first_chunk().ok_or_else(|| truncated(8, offset, present))?;
    // A size that this machine cannot count is more than is there.
    let [packed, unpacked] =
        [packed, unpacked].map(|size| usize::try_from(u32::from_le_bytes(*size)).unwrap_or(usize::MAX));
    if packed > present - 8 {
        return Err(truncated(packed, offset + 8, present - 8).into());
    }
    Ok((packed, unpacked))
}

/// Where each field starts in a point. [`Header::sizes`] has made sure that the sum can be counted.
fn starts(header: &Header) -> Vec<usize> {
    let mut at = 0;
    header
        .fields
        .iter()
        .map(|field| {
            let start = at;
            at += field.size * field.count;
            start
        })
        .collect()
}

/// The type of a field that is read, which was checked to be one number.
fn scalar(header: &Header, field: usize) -> Scalar {
    header.fields.get(field).and_then(super::header::Field::scalar).unwrap_or(Scalar::U8)
}
