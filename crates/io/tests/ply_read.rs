//! PLY files of every variant read to exact values, and bad ones to the right error.

#![allow(clippy::unwrap_used, clippy::panic, clippy::float_cmp)]
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

mod formats_support;

use formats_support::{
    Column, PLY_ENCODINGS, PlyEncoding, PlyExtras, Type, columns, plain_columns, ply_bytes, rows, same,
};
use proptest::prelude::*;
use terrace_io::ply::{self, PlyError};
use terrace_io::{Cloud, FieldChoice};
use terrace_types::Sigma;

fn read(bytes: &[u8]) -> Result<Cloud, PlyError> {
    ply::read(bytes, &FieldChoice::Automatic)
}

/// An ascii file with the properties x, y and z as float.
fn ascii(count: &str, body: &str) -> Vec<u8> {
    format!(
        "ply\nformat ascii 1.0\nelement vertex {count}\nproperty float x\nproperty float y\nproperty float z\n\
         end_header\n{body}"
    )
    .into_bytes()
}

/// A little-endian file with this header after the format, and this body.
fn binary(header: &str, body: &[u8]) -> Vec<u8> {
    [format!("ply\nformat binary_little_endian 1.0\n{header}end_header\n").as_bytes(), body].concat()
}

const XYZ: &str = "property float x\nproperty float y\nproperty float z\n";

#[test]
fn ascii_numbers_keep_double_precision() {
    let cloud = read(&ascii("3", "5000000.125 -1e-3 .5\n\n nan INF -inf \r\n0.1 +2 -0")).unwrap();
    assert_eq!(cloud.format, "PLY ascii");
    assert_eq!(cloud.points[0], [5_000_000.125, -0.001, 0.5]);
    assert!(cloud.points[1][0].is_nan());
    assert_eq!(cloud.points[1][1..], [f64::INFINITY, f64::NEG_INFINITY]);
    assert_eq!(cloud.points[2], [0.1, 2.0, 0.0]);
    assert_eq!((cloud.sigma, cloud.viewpoint), (Sigma::Unknown, None));
}

#[test]
fn no_vertices_is_an_empty_cloud() {
    assert_eq!(read(&ascii("0", "")).unwrap().points, [[0.0; 3]; 0]);
    assert_eq!(read(&binary(&format!("element vertex 0\n{XYZ}"), &[])).unwrap().points.len(), 0);
}

#[test]
fn big_endian_literal() {
    let mut file =
        format!("ply\nformat binary_big_endian 1.0\nelement vertex 1\n{XYZ}end_header\n").into_bytes();
    file.extend([0x3f, 0x80, 0, 0, 0xc0, 0x20, 0, 0, 0x7f, 0xc0, 0, 0]);
    let cloud = read(&file).unwrap();
    assert_eq!(cloud.points[0][..2], [1.0, -2.5]);
    assert!(cloud.points[0][2].is_nan());
    assert_eq!(cloud.format, "PLY binary_big_endian");
}

#[test]
fn standard_errors_by_choice() {
    let axes = ["sigma_y", "SIGMA_X", "sigma_z"];
    let names = ["z", "x", "y"].into_iter().chain(axes);
    let make = |(i, name): (usize, &str)| Column {
        name: name.into(),
        ty: if i % 2 == 0 { Type::F64 } else { Type::F32 },
        values: vec![i as f64, i as f64 + 10.0],
    };
    let columns: Vec<Column> = names.enumerate().map(make).collect();
    for encoding in PLY_ENCODINGS {
        for list in [false, true] {
            let file = ply_bytes(&columns, encoding, PlyExtras { list, ..PlyExtras::default() });
            let sigma = |choice: &FieldChoice| ply::read(&file, choice).map(|cloud| cloud.sigma);
            assert_eq!(
                sigma(&FieldChoice::Automatic),
                Ok(Sigma::PerAxis(vec![[4.0, 3.0, 5.0], [14.0, 13.0, 15.0]]))
            );
            assert_eq!(sigma(&FieldChoice::Ignore), Ok(Sigma::Unknown));
            assert_eq!(sigma(&FieldChoice::Named("sigma_z".into())), Ok(Sigma::PerPoint(vec![5.0, 15.0])));
            let missing = sigma(&FieldChoice::Named("error".into())).unwrap_err();
            assert!(missing.to_string().contains("`error`; it has: z, x, y"), "{missing}");
        }
    }
    let cloud = read(&ply_bytes(&plain_columns(2), PlyEncoding::Big, PlyExtras::default())).unwrap();
    assert_eq!(cloud.sigma, Sigma::PerPoint(vec![0.0625; 2]));
}

#[test]
fn unknown_properties_and_elements() {
    // A property of a type that the format does not have cannot be stepped over.
    let header = format!("element vertex 1\n{XYZ}property colour c\n");
    assert!(matches!(read(&binary(&header, &[0; 16])), Err(PlyError::Header { line: 7, .. })));
    // Elements without properties take no bytes, however many there are.
    let header = format!("element nothing {}\nelement vertex 1\n{XYZ}", u64::MAX);
    assert_eq!(read(&binary(&header, &[0; 12])).unwrap().points, [[0.0; 3]]);
    let ascii = String::from_utf8(ascii("1", "1 2 3\n")).unwrap();
    let ascii = ascii.replace("element vertex", "element nothing 99999999999\nelement vertex");
    assert_eq!(read(ascii.as_bytes()).unwrap().points, [[1.0, 2.0, 3.0]]);
}

#[test]
fn list_properties() {
    let header = "element vertex 1\nproperty list uchar float x\nproperty float y\nproperty float z\n";
    assert_eq!(read(&binary(header, &[0; 20])), Err(PlyError::ListProperty { name: "x".into() }));

    let header = format!("element face 1\nproperty list int short corner\nelement vertex 1\n{XYZ}");
    let body = |length: i32| [&length.to_le_bytes()[..], &[0; 16]].concat();
    assert_eq!(read(&binary(&header, &body(2))).unwrap().points, [[0.0; 3]]);
    let negative = read(&binary(&header, &body(-1))).unwrap_err();
    assert!(matches!(&negative, PlyError::ListLength { record: 0, length: -1, .. }), "{negative}");
    let long = read(&binary(&header, &body(i32::MAX))).unwrap_err();
    assert!(matches!(&long, PlyError::TruncatedRecord { record: 0, .. }), "{long}");
    // A list of as many items as there are in a u64: the product with the item size overflows.
    let header = format!("element face 1\nproperty list uint64 double corner\nelement vertex 1\n{XYZ}");
    let long = read(&binary(&header, &[0xff; 40])).unwrap_err();
    assert!(matches!(&long, PlyError::TruncatedRecord { .. }), "{long}");
    // The length of a list must be a whole number.
    let header = format!("element face 1\nproperty list float short corner\nelement vertex 1\n{XYZ}");
    assert!(matches!(read(&binary(&header, &[0; 40])), Err(PlyError::Header { line: 4, .. })));
}

#[test]
fn ascii_lists() {
    let header = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty list uchar int l\n\
                  property float y\nproperty float z\nend_header\n";
    let file = |body: &str| [header, body].concat().into_bytes();
    assert_eq!(read(&file("1 2 9 9 2 3\n4 0 5 6")).unwrap().points, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    let errors = [
        ("1 2 9 9 2 3\n4 1 5 6\n", "line 10 ends before property `z`"),
        ("1 2 9 9 2 3\n4 0 5 6 7\n", "line 10 goes on with `7` after the last property"),
        ("1 2 9 9 2 3\n4 -1 5 6\n", "line 10: `-1` is no value for property `l`"),
        ("1 18446744073709551615 9\n", "line 9 ends before property `l`"),
        ("1 2 9 9 2 3e\n", "line 9: `3e` is no value for property `z`"),
        ("1 2 9 9 2 3\n", "the file ends after 1 of 2 records of the element `vertex`"),
    ];
    for (body, message) in errors {
        assert_eq!(read(&file(body)).unwrap_err().to_string(), message);
    }
}

#[test]
fn count_far_beyond_the_size() {
    for count in ["4", "1000000000000", "700000000000000000"] {
        let header = format!("element vertex {count}\n{XYZ}");
        let error = read(&binary(&header, &[0; 36])).unwrap_err();
        assert!(matches!(error, PlyError::Truncated { stride: 12, present: 36, .. }), "{error}");
        let error = read(&ascii(count, "1 2 3\n4 5 6\n7 8 9\n")).unwrap_err();
        assert!(matches!(error, PlyError::MissingLines { found: 3, .. }), "{error}");
    }
}

#[test]
fn count_times_stride_overflow() {
    // 12 · count wraps to 4 and to 12.
    for count in [u64::MAX / 12 + 1, u64::MAX / 12 + 2, u64::MAX] {
        let error = read(&binary(&format!("element vertex {count}\n{XYZ}"), &[0; 36])).unwrap_err();
        assert_eq!(error, PlyError::TooLarge { element: "vertex".into(), count, stride: 12 });
        // Also in an element that is only stepped over.
        let header = format!("element vertex 3\n{XYZ}element more {count}\nproperty int a\n");
        assert!(read(&binary(&header, &[0; 36])).is_err());
    }
}

#[test]
fn negative_counts() {
    for count in ["-1", "-0", "1.0", "18446744073709551616", "many"] {
        let error = read(&ascii(count, "1 2 3\n")).unwrap_err();
        assert!(matches!(error, PlyError::Header { line: 3, .. }), "{error}");
    }
}

#[test]
fn headers_that_are_none() {
    let message = |bytes: &[u8]| read(bytes).unwrap_err().to_string();
    assert_eq!(message(b"plx\n"), "a PLY file starts with the line `ply`, this one with `plx`");
    assert_eq!(message(b"ply\nend_header\n"), "the header has no `format` line");
    assert_eq!(message(b"ply\nformat ascii 1.0\nend_header\n"), "the file has no element `vertex`");
    assert_eq!(message(b"ply\nformat ascii 1.0\n"), "the header ends after line 2 without `end_header`");
    assert!(message(b"ply\nproperty int a\n").contains("line 2: expected an element before its properties"));
    assert!(message(b"ply\nformat octal 1.0\n").contains("found `format octal 1.0`"));
    let no_z = "ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nproperty int y\nend_header\n1 2\n";
    assert_eq!(message(no_z.as_bytes()), "the element `vertex` has no property `z`; it has: x, y");
}

#[test]
fn bytes_that_look_like_line_ends_start_the_body() {
    // 0x0d0a0d0a as the first float of a file whose header ends its lines with CRLF.
    let mut file = format!("ply\nformat binary_little_endian 1.0\nelement vertex 1\n{XYZ}end_header\n")
        .replace('\n', "\r\n")
        .into_bytes();
    file.extend([0x0a, 0x0d, 0x0a, 0x0d, 0, 0, 0, 0, 0, 0, 0, 0]);
    assert_eq!(read(&file).unwrap().points[0][0], f64::from(f32::from_le_bytes([0x0a, 0x0d, 0x0a, 0x0d])));
}

fn extras() -> impl Strategy<Value = PlyExtras> {
    (0_usize..6, 0_usize..6, any::<bool>(), any::<bool>()).prop_map(
        |(faces_before, faces_after, list, crlf)| PlyExtras { faces_before, faces_after, list, crlf },
    )
}

proptest! {
    #[test]
    fn what_was_written_is_read(columns in columns(), extras in extras()) {
        for encoding in PLY_ENCODINGS {
            let cloud = read(&ply_bytes(&columns, encoding, extras)).unwrap();
            prop_assert!(same(&cloud.points, &rows(&columns, ["x", "y", "z"])), "{encoding:?}");
        }
    }

    /// Another implementation reads the same.
    #[test]
    fn ply_rs_agrees(columns in columns(), extras in extras()) {
        use ply_rs_bw::ply::{DefaultElement, Property};
        let number = |property: &Property| match property {
            Property::Char(v) => f64::from(*v),
            Property::UChar(v) => f64::from(*v),
            Property::Short(v) => f64::from(*v),
            Property::UShort(v) => f64::from(*v),
            Property::Int(v) => f64::from(*v),
            Property::UInt(v) => f64::from(*v),
            Property::Float(v) => f64::from(*v),
            Property::Double(v) => *v,
            list => panic!("{list:?}"),
        };
        for encoding in [PlyEncoding::Little, PlyEncoding::Big] {
            let file = ply_bytes(&columns, encoding, PlyExtras { crlf: false, ..extras });
            let parser = ply_rs_bw::parser::Parser::<DefaultElement>::new();
            let theirs = parser.read_ply(&mut &file[..]).unwrap();
            let theirs: Vec<_> = theirs.payload["vertex"].iter().map(|v| ["x", "y", "z"].map(|n| number(&v[n]))).collect();
            prop_assert!(same(&read(&file).unwrap().points, &theirs));
        }
    }
}
