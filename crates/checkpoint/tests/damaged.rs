//! Files that are no maps, and maps that were damaged.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod common;

use std::sync::Arc;

use arrow_array::{Array, ArrayRef, Float64Array, RecordBatch, UInt8Array};
use arrow_schema::{Field, Schema};
use bytes::Bytes;
use common::{all, file, map, room};
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use terrace::{Mapper, Params, PartsError};
use terrace_checkpoint::{METADATA_KEY, MapFileError, read_map};

fn small() -> Vec<u8> {
    let params = Params { cell_size: Some(0.5), ..Params::default() };
    file(&map(params, &room(3000, 1)))
}

/// No sum of a map is NaN, and cells have the points of the views.
fn check(mapper: &Mapper) {
    let parts = mapper.parts().unwrap();
    let mut points = 0;
    for cell in parts.cells() {
        points += cell.sums.count();
        assert!(cell.sums.sum().iter().all(|x| x.is_finite()) && cell.sums.second().is_finite());
        assert!(cell.sums.noise().is_finite());
    }
    let of_views =
        mapper.views().iter().map(|view| view.points - view.absent - view.out_of_range).sum::<usize>();
    assert_eq!(points, of_views as u64);
    let _ = mapper.extract();
}

#[test]
fn what_is_cut_off_is_no_map() {
    let bytes = small();
    let ends = (0..64).chain((64..bytes.len()).step_by(97)).chain(bytes.len() - 64..bytes.len());
    for end in ends {
        assert!(read_map(bytes[..end].to_vec()).is_err(), "{end}");
    }
}

#[test]
fn flipped_bits_are_an_error_or_a_map() {
    let bytes = small();
    assert!(read_map(bytes.clone()).is_ok());
    let (mut refused, mut random) = (0, 7_u64);
    let variants = 1500;
    for variant in 0..variants {
        let mut damaged = bytes.clone();
        for _ in 0..=variant % 3 {
            random = random.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            // Half of them in the description of the file, at its end.
            let behind = if variant % 2 == 0 { bytes.len() } else { bytes.len().min(9000) };
            let at = bytes.len() - 1 - (random >> 33) as usize % behind;
            damaged[at] ^= 1 << (random >> 29 & 7);
        }
        match read_map(damaged) {
            Ok(mapper) => check(&mapper),
            Err(_) => refused += 1,
        }
    }
    assert!(refused > variants / 2, "{refused}");
}

#[test]
fn bytes_that_are_anything_are_no_map() {
    let mut random = 11_u64;
    let bytes = small();
    for variant in 0..300_usize {
        let mut damaged = bytes.clone();
        let at = variant * (bytes.len() - 64) / 300;
        for byte in &mut damaged[at..at + 48] {
            random = random.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            *byte = (random >> 56) as u8;
        }
        if let Ok(mapper) = read_map(damaged) {
            check(&mapper);
        }
    }
    for other in [&b""[..], b"PAR1", b"PAR1PAR1", b"ply\nformat ascii 1.0\n", &[0; 1000]] {
        assert!(matches!(read_map(other.to_vec()), Err(MapFileError::Parquet(_))));
    }
}

/// The file with other metadata and columns.
fn changed(
    bytes: &[u8],
    metadata: impl Fn(String) -> Option<String>,
    column: impl Fn(&str, &ArrayRef) -> Option<ArrayRef>,
) -> Vec<u8> {
    let reader = ParquetRecordBatchReaderBuilder::try_new(Bytes::copy_from_slice(bytes)).unwrap();
    let entries = reader.metadata().file_metadata().key_value_metadata().unwrap().clone();
    let entry = entries.into_iter().find(|entry| entry.key == METADATA_KEY).unwrap();
    let changed =
        metadata(entry.value.unwrap()).map(|value| vec![KeyValue::new(METADATA_KEY.to_owned(), value)]);
    let batches: Vec<RecordBatch> = reader.build().unwrap().map(Result::unwrap).collect();
    let batches: Vec<RecordBatch> = batches
        .iter()
        .map(|batch| {
            let columns: Vec<(Field, ArrayRef)> = (batch.schema().fields().iter().zip(batch.columns()))
                .filter_map(|(field, array)| {
                    let array = column(field.name(), array)?;
                    Some((Field::new(field.name(), array.data_type().clone(), array.null_count() > 0), array))
                })
                .collect();
            let (fields, arrays): (Vec<Field>, Vec<ArrayRef>) = columns.into_iter().unzip();
            RecordBatch::try_new(Arc::new(Schema::new(fields)), arrays).unwrap()
        })
        .collect();
    let mut out = Vec::new();
    let properties = WriterProperties::builder().set_key_value_metadata(changed).build();
    let mut writer = ArrowWriter::try_new(&mut out, batches[0].schema(), Some(properties)).unwrap();
    for batch in &batches {
        writer.write(batch).unwrap();
    }
    writer.close().unwrap();
    out
}

/// Leaves a column as it is.
const SAME: fn(&str, &ArrayRef) -> Option<ArrayRef> = |_, array| Some(Arc::clone(array));

#[test]
fn the_error_tells_what_is_wrong() {
    let bytes = small();
    let refused = |file: Vec<u8>| read_map(file).unwrap_err();
    // Written by others, without compression and with dictionaries: the same map.
    let again = read_map(changed(&bytes, Some, SAME)).unwrap();
    assert_eq!(all(&again), all(&read_map(bytes.clone()).unwrap()));

    assert!(matches!(refused(changed(&bytes, |_| None, SAME)), MapFileError::NoMap));
    let with = |from: &'static str, to: &'static str| {
        refused(changed(
            &bytes,
            |text| {
                assert!(text.contains(from), "{text}");
                Some(text.replacen(from, to, 1))
            },
            SAME,
        ))
    };
    assert!(matches!(with("\"version\":2", "\"version\":1,\"old\":0"), MapFileError::Version { found: 1 }));
    assert!(matches!(with("\"version\":2", "\"version\":3,\"new\":0"), MapFileError::Version { found: 3 }));
    assert!(matches!(with("{", "["), MapFileError::Metadata(_)));
    assert!(matches!(with("\"voxel\"", "\"pixel\""), MapFileError::Setting { name: "assignment", .. }));
    assert!(matches!(
        with("\"cell_size\":0.5", "\"cell_size\":-0.5"),
        MapFileError::Map(PartsError::Params(_))
    ));
    assert!(matches!(with("\"cell_size\":0.5", "\"cell_size\":0.25"), MapFileError::Cell { .. }));
    assert!(matches!(with("\"absent\":0", "\"absent\":1"), MapFileError::Map(PartsError::ViewPoints { .. })));
    assert!(matches!(with("[[0.0001,0.0", "[[-0.0001,0.0"), MapFileError::Pose { view: 0, .. }));

    let column = |of: &'static str, to: &dyn Fn(&ArrayRef) -> Option<ArrayRef>| {
        let change = |name: &str, array: &ArrayRef| if name == of { to(array) } else { SAME(name, array) };
        refused(changed(&bytes, Some, change))
    };
    let error = column("points", &|_| None);
    assert_eq!(error.to_string(), "the column points is missing, it must be UInt64");
    let numbers = |value: Option<f64>| {
        move |array: &ArrayRef| -> Option<ArrayRef> {
            Some(Arc::new(Float64Array::from(vec![value; array.len()])))
        }
    };
    let error = column("x", &numbers(Some(1.0)));
    assert_eq!(error.to_string(), "the column x is Float64, it must be Int32");
    assert!(matches!(column("seen", &numbers(Some(1.0))), MapFileError::Column { name: "seen", .. }));
    assert!(matches!(column("sum_x", &numbers(None)), MapFileError::Null { name: "sum_x" }));
    for wrong in [f64::NAN, f64::INFINITY, -1e3] {
        let error = column("noise_yy", &numbers(Some(wrong)));
        assert!(matches!(error, MapFileError::Cell { row: 0, error: PartsError::Sums { .. } }), "{error}");
    }
    let error = column("sample_halvings", &|array| Some(Arc::new(UInt8Array::from(vec![31; array.len()]))));
    assert!(matches!(error, MapFileError::Cell { row: 0, error: PartsError::Sample { .. } }), "{error}");
    // Twice the same cells.
    let error = column("y", &|array| {
        let zeros = arrow_array::Int32Array::from(vec![0; array.len()]);
        Some(Arc::new(zeros))
    });
    assert!(matches!(error, MapFileError::Cell { error: PartsError::SameKey { .. }, .. }), "{error}");
}

#[test]
fn a_page_with_too_few_bytes_for_its_values_is_told() {
    // Found by flipped bits: the decoder of floats panics. What is packed is said not to be.
    let mut damaged = small();
    let path = b"\x18\x08noise_xy\x15\x02";
    let at = damaged.windows(path.len()).position(|bytes| bytes == path).unwrap();
    damaged[at + path.len() - 1] = 0;
    let error = read_map(damaged).unwrap_err();
    assert!(matches!(error, MapFileError::Undecodable), "{error}");
}

#[test]
fn a_page_that_asks_for_gigabytes_is_not_unpacked() {
    let bytes = small();
    // The first page: its type, its size unpacked as a number of two or three bytes, its size packed.
    assert_eq!([bytes[4], bytes[6]], [0x15, 0x15]);
    let end = 7 + bytes[7..].iter().position(|byte| *byte < 0x80).unwrap();
    let mut damaged = bytes[..7].to_vec();
    // 2³¹ − 2, in five bytes; the places behind no longer hold, which does not matter here.
    damaged.extend([0xfc, 0xff, 0xff, 0xff, 0x0f]);
    damaged.extend(&bytes[end + 1..]);
    let error = read_map(damaged).unwrap_err();
    assert!(matches!(error, MapFileError::Page { .. }), "{error}");
}
