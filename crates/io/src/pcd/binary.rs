//! The body of a binary PCD file: point after point, or packed with LZF field after field.

use terrace_types::Sigma;

use super::PcdError;
use super::header::Header;
use super::lzf;
use crate::cloud::fields::Wanted;
use crate::cloud::records::{ByteOrder, Column, Scalar};

pub(super) fn read(
    bytes: &[u8],
    header: &Header,
    wanted: Wanted,
) -> Result<(Vec<[f64; 3]>, Sigma), PcdError> {
    let (stride, size) = header.sizes()?;
    let rest = bytes.get(header.body..).unwrap_or_default();
    let block = rest.get(..size).ok_or(PcdError::Truncated {
        points: header.points,
        stride,
        offset: header.body,
        present: rest.len(),
    })?;
    let count = size.checked_div(stride).unwrap_or(0);
    let starts = starts(header);
    let column = |field| Column {
        bytes: block,
        stride,
        offset: starts.get(field).copied().unwrap_or(0),
        scalar: scalar(header, field),
    };
    Ok(wanted.gather(ByteOrder::Little, count, column))
}

pub(super) fn read_compressed(
    bytes: &[u8],
    header: &Header,
    wanted: Wanted,
) -> Result<(Vec<[f64; 3]>, Sigma), PcdError> {
    let (stride, size) = header.sizes()?;
    // PCL writes nothing after the header of an empty cloud.
    if size == 0 {
        return Ok(wanted.gather(ByteOrder::Little, 0, |field| Column {
            bytes: &[],
            stride,
            offset: 0,
            scalar: scalar(header, field),
        }));
    }
    let (packed, unpacked) = sizes_of_packed(bytes, header.body)?;
    if unpacked != size {
        let offset = header.body + 4;
        return Err(PcdError::UnpackedSize { offset, unpacked, points: header.points, stride });
    }
    let offset = header.body + 8;
    let block = lzf::unpack(packed, unpacked).map_err(|source| PcdError::Compressed { offset, source })?;
    let count = size.checked_div(stride).unwrap_or(0);
    let starts = starts(header);
    let column = |field| {
        let scalar = scalar(header, field);
        // Each field is a block of its own; what the points before it take is `count` times its offset in a point.
        let offset = starts.get(field).map_or(0, |start| start * count);
        Column { bytes: &block, stride: scalar.size(), offset, scalar }
    };
    Ok(wanted.gather(ByteOrder::Little, count, column))
}

/// The packed bytes and the size they are said to have unpacked.
fn sizes_of_packed(bytes: &[u8], offset: usize) -> Result<(&[u8], usize), PcdError> {
    let rest = bytes.get(offset..).unwrap_or_default();
    let truncated = |needed, offset, present| PcdError::TruncatedCompressed { needed, offset, present };
    let (packed, rest) = rest.split_first_chunk().ok_or_else(|| truncated(8, offset, rest.len()))?;
    let (unpacked, rest) = rest.split_first_chunk().ok_or_else(|| truncated(8, offset, rest.len() + 4))?;
    // A size that this machine cannot count is more than is there.
    let [packed, unpacked] =
        [packed, unpacked].map(|size| usize::try_from(u32::from_le_bytes(*size)).unwrap_or(usize::MAX));
    let packed = rest.get(..packed).ok_or_else(|| truncated(packed, offset + 8, rest.len()))?;
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
