//! PCD files of every variant read to exact values, and bad ones to the right error.

#![allow(clippy::unwrap_used, clippy::panic, clippy::float_cmp)]
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

mod formats_support;

use formats_support::{
    Column, PCD_DATA, PcdData, Type, columns, packed, pcd_bytes, plain_columns, rows, same,
};
use proptest::prelude::*;
use terrace_io::pcd::{self, LzfError, PcdError};
use terrace_io::{Cloud, FieldChoice};
use terrace_types::{Pose, PoseError, Sigma};

fn read(bytes: &[u8]) -> Result<Cloud, PcdError> {
    pcd::read(bytes, &FieldChoice::Automatic)
}

/// A file of two points with these lines before `DATA`.
fn with_lines(lines: &str, data: &str, body: &[u8]) -> Vec<u8> {
    [format!("# a comment\nVERSION 0.7\n{lines}\nDATA {data}\n").as_bytes(), body].concat()
}

const XYZ: &str = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1";

#[test]
fn tolerant_headers() {
    let expected = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.5]];
    let headers = [
        "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 1\nPOINTS 2",
        "COLUMNS x y z\nPOINTS 2",
        "FIELDS x y z\nWIDTH 1\nHEIGHT 2",
        "FIELDS x y z\nWIDTH 2\n\n# more\nTYPE F F F",
        "POINTS 2\nCOUNT 1 1 1\nTYPE f f f\nSIZE 8 8 8\nFIELDS X Y Z",
    ];
    for header in headers {
        let cloud = read(&with_lines(header, "ascii", b"1 2 3\n\n4 5 6.5")).unwrap();
        assert_eq!(cloud.points, expected, "{header}");
        assert_eq!((cloud.viewpoint, cloud.format), (None, "PCD ascii"));
        let crlf = String::from_utf8(with_lines(header, "ascii", b"1 2 3\n4 5 6.5\n")).unwrap();
        assert_eq!(read(crlf.replace('\n', "\r\n").as_bytes()).unwrap().points, expected);
    }
    let body: Vec<u8> = expected.as_flattened().iter().flat_map(|v| (*v as f32).to_le_bytes()).collect();
    let crlf = with_lines("COLUMNS x y z\r\nPOINTS 2\r", "binary\r", &body);
    assert_eq!(read(&crlf).unwrap().points, expected);
}

#[test]
fn padding_and_counts() {
    let lines = "FIELDS _ z histogram x _ y\nSIZE 1 4 2 8 1 1\nTYPE U F U F U I\nCOUNT 3 1 2 1 5 1\nPOINTS 2\nWIDTH 2";
    let mut rows = Vec::new();
    let mut columns: [Vec<u8>; 6] = Default::default();
    for i in 0..2_u8 {
        let fields = [
            vec![9; 3],
            (f32::from(i) + 0.5).to_le_bytes().to_vec(),
            vec![8; 4],
            (f64::from(i) - 0.1).to_le_bytes().to_vec(),
            vec![7; 5],
            vec![i.wrapping_sub(1)],
        ];
        rows.extend(fields.concat());
        columns.iter_mut().zip(fields).for_each(|(column, field)| column.extend(field));
    }
    let expected = [[-0.1, -1.0, 0.5], [0.9, 0.0, 1.5]];
    assert_eq!(read(&with_lines(lines, "binary", &rows)).unwrap().points, expected);
    let compressed = with_lines(lines, "binary_compressed", &packed(&columns.concat()));
    assert_eq!(read(&compressed).unwrap().points, expected);
    let text = "0 0 0 0.5 1 2 -0.1 0 0 0 0 0 -1\n0 0 0 1.5 1 2 0.9 0 0 0 0 0 0\n";
    assert_eq!(read(&with_lines(lines, "ascii", text.as_bytes())).unwrap().points, expected);
}

#[test]
fn viewpoints() {
    let file = |line: &str| with_lines(&format!("{XYZ}\nPOINTS 1\n{line}"), "ascii", b"1 2 3\n");
    let viewpoint = |line: &str| read(&file(line)).map(|cloud| cloud.viewpoint);
    assert_eq!(viewpoint(""), Ok(None));
    assert_eq!(viewpoint("VIEWPOINT 0 0 0 1 0 0 0"), Ok(Some(Pose::IDENTITY)));
    // Translation first, then the quaternion with its real part in front: a half turn about x.
    let pose = viewpoint("VIEWPOINT 1 2 3 0 1 0 0").unwrap().unwrap();
    assert_eq!(pose.translation(), [1.0, 2.0, 3.0]);
    assert_eq!(pose.rotate([1.0, 1.0, 1.0]), [1.0, -1.0, -1.0]);

    let quaternion = [0.0; 4];
    assert_eq!(
        viewpoint("VIEWPOINT 0 0 0 0 0 0 0"),
        Err(PcdError::Viewpoint { line: 8, source: PoseError::ZeroQuaternion { quaternion } })
    );
    for line in ["VIEWPOINT nan 0 0 1 0 0 0", "VIEWPOINT 0 0 0 inf 0 0 0"] {
        assert!(matches!(viewpoint(line), Err(PcdError::Viewpoint { line: 8, .. })), "{line}");
    }
    for line in ["VIEWPOINT", "VIEWPOINT 0 0 0 1 0 0", "VIEWPOINT 0 0 0 1 0 0 0 0", "VIEWPOINT 0 0 0 a 0 0 0"]
    {
        assert!(matches!(viewpoint(line), Err(PcdError::Header { line: 8, .. })), "{line}");
    }
}

#[test]
fn standard_errors_by_choice() {
    for data in PCD_DATA {
        let file = pcd_bytes(&plain_columns(2), data);
        let sigma = |choice: &FieldChoice| pcd::read(&file, choice).map(|cloud| cloud.sigma);
        assert_eq!(sigma(&FieldChoice::Automatic), Ok(Sigma::PerPoint(vec![0.0625; 2])));
        assert_eq!(sigma(&FieldChoice::Ignore), Ok(Sigma::Unknown));
        assert_eq!(sigma(&FieldChoice::Named("intensity".into())), Ok(Sigma::PerPoint(vec![0.0, 1000.0])));
        let missing = sigma(&FieldChoice::Named("s".into())).unwrap_err().to_string();
        assert_eq!(missing, "the file has no field `s`; it has: x, y, z, sigma, intensity");
        let mut columns = plain_columns(2);
        for name in ["sigma_x", "sigma_y", "sigma_z"] {
            columns.push(Column { name: name.into(), ty: Type::F32, values: vec![0.5, name.len() as f64] });
        }
        columns.retain(|column| column.name != "sigma");
        let cloud = read(&pcd_bytes(&columns, data)).unwrap();
        assert_eq!(cloud.sigma, Sigma::PerAxis(vec![[0.5; 3], [7.0; 3]]));
    }
}

#[test]
fn points_that_are_not_width_times_height() {
    for (points, width, height) in [(2, 3, 1), (2, 2, 2), (2, u64::MAX, 2)] {
        let lines = format!("{XYZ}\nWIDTH {width}\nHEIGHT {height}\nPOINTS {points}");
        let error = read(&with_lines(&lines, "ascii", b"1 2 3\n4 5 6\n")).unwrap_err();
        assert_eq!(error, PcdError::PointCount { points, width, height });
    }
    let lines = format!("{XYZ}\nWIDTH {}\nHEIGHT 3", u64::MAX);
    assert!(matches!(read(&with_lines(&lines, "binary", b"")), Err(PcdError::PointCount { .. })));
}

#[test]
fn count_far_beyond_the_size() {
    for count in ["3", "1000000000000", "700000000000000000"] {
        let lines = format!("{XYZ}\nPOINTS {count}");
        let error = read(&with_lines(&lines, "binary", &[0; 24])).unwrap_err();
        assert!(matches!(error, PcdError::Truncated { stride: 12, present: 24, .. }), "{error}");
        let error = read(&with_lines(&lines, "ascii", b"1 2 3\n4 5 6\n")).unwrap_err();
        assert!(matches!(error, PcdError::MissingLines { found: 2, .. }), "{error}");
        let error = read(&with_lines(&lines, "binary_compressed", &packed(&[0; 24]))).unwrap_err();
        assert!(matches!(error, PcdError::UnpackedSize { unpacked: 24, stride: 12, .. }), "{error}");
    }
}

#[test]
fn count_times_stride_overflow() {
    for data in ["binary", "binary_compressed"] {
        // 12 · points wraps to 4 and to 12.
        for points in [u64::MAX / 12 + 1, u64::MAX / 12 + 2, u64::MAX] {
            let error = read(&with_lines(&format!("{XYZ}\nPOINTS {points}"), data, &[0; 48])).unwrap_err();
            assert_eq!(error, PcdError::TooLarge { points, stride: 12 });
        }
        // The size of a point itself overflows, in one product and in the sum.
        for (size, count) in [(u64::MAX, 2), (u64::MAX - 4, 1)] {
            let lines =
                format!("FIELDS x y z a\nSIZE 4 4 4 {size}\nTYPE F F F U\nCOUNT 1 1 1 {count}\nPOINTS 1");
            let error = read(&with_lines(&lines, data, &[0; 48])).unwrap_err();
            assert_eq!(error, PcdError::TooLarge { points: 1, stride: usize::MAX });
        }
    }
    // In text a field of many numbers is only a short line.
    let lines = format!("FIELDS x y z a\nCOUNT 1 1 1 {}\nPOINTS 1", u64::MAX);
    let error = read(&with_lines(&lines, "ascii", b"1 2 3 4\n")).unwrap_err();
    assert_eq!(error, PcdError::ShortLine { line: 7, field: "a".into() });
}

#[test]
fn negative_counts() {
    for line in [
        "POINTS -1",
        "POINTS 1\nWIDTH -1",
        "POINTS 1\nSIZE 4 4 -4",
        "POINTS 1\nCOUNT 1 1 -1",
        "POINTS",
        "POINTS 1 1",
    ] {
        let error = read(&with_lines(&format!("{XYZ}\n{line}"), "binary", &[0; 24])).unwrap_err();
        assert!(matches!(error, PcdError::Header { .. }), "{line}: {error}");
    }
}

#[test]
fn unknown_fields_and_types() {
    // What is not read may be of any type and size.
    let lines = "FIELDS x y z odd\nSIZE 4 4 4 3\nTYPE F F F Q\nPOINTS 1";
    assert_eq!(read(&with_lines(lines, "binary", &[0; 15])).unwrap().points, [[0.0; 3]]);
    for (lines, kind, size, count) in [
        ("FIELDS x y z\nSIZE 4 4 2\nTYPE F F F\nPOINTS 1", 'F', 2, 1),
        ("FIELDS x y z\nSIZE 4 4 4\nTYPE F F Q\nPOINTS 1", 'Q', 4, 1),
        ("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 2\nPOINTS 1", 'F', 4, 2),
    ] {
        let error = read(&with_lines(lines, "binary", &[0; 48])).unwrap_err();
        assert_eq!(error, PcdError::FieldType { name: "z".into(), kind, size, count });
    }
    let message = |lines: &str, data: &str| read(&with_lines(lines, data, &[0; 48])).unwrap_err().to_string();
    assert_eq!(message("FIELDS x y\nPOINTS 1", "ascii"), "the file has no field `z`; it has: x, y");
    assert_eq!(message("FIELDS x y z\nSIZE 4 4\nPOINTS 1", "ascii"), "`SIZE` has 2 entries for 3 fields");
    assert_eq!(message("POINTS 1", "ascii"), "the header has no `FIELDS` line");
    assert_eq!(message("FIELDS x y z", "ascii"), "the header has no `POINTS` line");
    assert!(
        message(XYZ, "zip").starts_with("line 7: expected `DATA` with ascii, binary or binary_compressed")
    );
    assert!(message("FILEDS x y z", "ascii").starts_with("line 3: expected a key"));
}

#[test]
fn ascii_lines() {
    let message = |body: &str| {
        read(&with_lines(&format!("{XYZ}\nPOINTS 2"), "ascii", body.as_bytes())).unwrap_err().to_string()
    };
    assert_eq!(message("1 2 3\n4 5\n"), "line 10 ends before field `z`");
    assert_eq!(message("1 2 3\n4 5 6 7\n"), "line 10 goes on with `7` after the last field");
    assert_eq!(message("1 2 3\n\n4 5 6,5\n"), "line 11: `6,5` is no value for field `z`");
    assert_eq!(message("1 2 3\n"), "the file ends after 1 of 2 points");
}

#[test]
fn compressed_bomb() {
    let most = u32::MAX / 12;
    let lines = format!("{XYZ}\nPOINTS {most}");
    let size = most * 12;
    // A few bytes that are said to hold 4 GB, and the longest copies there are: still 88 for one.
    for copies in [0, 1000] {
        let mut stream = vec![0, b'a'];
        stream.extend([0xe0, 255, 0].repeat(copies));
        let yields = 1 + copies * 264;
        let body = [&(stream.len() as u32).to_le_bytes()[..], &size.to_le_bytes(), &stream].concat();
        let error = read(&with_lines(&lines, "binary_compressed", &body)).unwrap_err();
        let source = LzfError::Size { unpacked: yields, announced: size as usize };
        assert!(matches!(&error, PcdError::Compressed { source: s, .. } if *s == source), "{error}");
    }
    // A stream that yields more than it says stops there.
    let stream = [&[0, b'a'][..], &[0xe0, 255, 0].repeat(1000)].concat();
    let body = [&(stream.len() as u32).to_le_bytes()[..], &24_u32.to_le_bytes(), &stream].concat();
    let error = read(&with_lines(&format!("{XYZ}\nPOINTS 2"), "binary_compressed", &body)).unwrap_err();
    let source = LzfError::Size { unpacked: 265, announced: 24 };
    assert!(matches!(&error, PcdError::Compressed { source: s, .. } if *s == source), "{error}");
}

#[test]
fn empty_clouds() {
    for data in ["ascii", "binary", "binary_compressed"] {
        let cloud = read(&with_lines(&format!("{XYZ}\nWIDTH 0\nHEIGHT 0\nPOINTS 0"), data, b"")).unwrap();
        assert_eq!(cloud.points.len(), 0, "{data}");
    }
}

proptest! {
    #[test]
    fn what_was_written_is_read(columns in columns()) {
        for data in PCD_DATA {
            let cloud = read(&pcd_bytes(&columns, data)).unwrap();
            prop_assert!(same(&cloud.points, &rows(&columns, ["x", "y", "z"])), "{data:?}");
            prop_assert_eq!(cloud.viewpoint, Some(Pose::IDENTITY));
        }
    }

    #[test]
    fn damaged_streams_never_panic(at in any::<prop::sample::Index>(), byte in any::<u8>()) {
        let mut file = pcd_bytes(&plain_columns(300), PcdData::Compressed);
        let at = file.len() - 1 - at.index(600);
        file[at] = byte;
        let _ = read(&file);
    }
}
