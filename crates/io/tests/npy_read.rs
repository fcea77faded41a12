//! NPY arrays of every type, order and shape read to exact values, and bad ones to the right error.

#![allow(clippy::unwrap_used, clippy::panic, clippy::float_cmp)]
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

mod formats_support;

use formats_support::{npy_bytes, same};
use npyz::WriterBuilder;
use proptest::prelude::*;
use terrace_io::npy::{self, NpyError};

fn f32s(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

#[test]
fn points_of_every_layout() {
    let values = [1.5, -2.0, 3.0, 4.0, f64::NAN, 6.0];
    let columns = [0, 3, 1, 4, 2, 5].map(|i: usize| values[i]);
    let expected = [[1.5, -2.0, 3.0], [4.0, f64::NAN, 6.0]];
    for (fortran, values) in [(false, values), (true, columns)] {
        let bytes = |of: &dyn Fn(f64) -> Vec<u8>| values.iter().flat_map(|v| of(*v)).collect::<Vec<u8>>();
        let files = [
            ("<f8", bytes(&|v| v.to_le_bytes().into())),
            (">f8", bytes(&|v| v.to_be_bytes().into())),
            ("<f4", bytes(&|v| (v as f32).to_le_bytes().into())),
            (">f4", bytes(&|v| (v as f32).to_be_bytes().into())),
        ];
        for (descr, data) in files {
            for shape in ["(2, 3)", "(2,3,)", "(2L, 3L)", "(1, 2, 3)", "(2, 1, 3)"] {
                let cloud = npy::read(&npy_bytes(descr, fortran, shape, &data)).unwrap();
                assert!(same(&cloud.points, &expected), "{descr} {shape} {fortran}: {:?}", cloud.points);
                assert_eq!(cloud.format, "NPY");
            }
        }
    }
}

#[test]
fn organised_clouds_row_by_row() {
    // 2 rows of 3 points; number k of point (i, j) is 100 i + 10 j + k.
    let at = |i: usize, j: usize, k: usize| (100 * i + 10 * j + k) as f32;
    let expected: Vec<[f64; 3]> =
        (0..2).flat_map(|i| (0..3).map(move |j| [0, 1, 2].map(|k| f64::from(at(i, j, k))))).collect();
    let c: Vec<f32> = (0..18).map(|n| at(n / 9, n / 3 % 3, n % 3)).collect();
    let fortran: Vec<f32> = (0..18).map(|n| at(n % 2, n / 2 % 3, n / 6)).collect();
    assert_eq!(npy::read(&npy_bytes("<f4", false, "(2, 3, 3)", &f32s(&c))).unwrap().points, expected);
    assert_eq!(npy::read(&npy_bytes("<f4", true, "(2, 3, 3)", &f32s(&fortran))).unwrap().points, expected);
}

#[test]
fn labels_of_every_width() {
    let read = |descr: &str, data: &[u8]| {
        let size = descr[2..].parse::<usize>().unwrap();
        npy::read_labels(&npy_bytes(descr, false, &format!("({},)", data.len() / size), data))
    };
    assert_eq!(read("|i1", &[1, 0xff, 0x80]), Ok(vec![1, -1, -128]));
    assert_eq!(read("|u1", &[1, 0xff]), Ok(vec![1, 255]));
    assert_eq!(read(">i2", &[0xff, 0xfe]), Ok(vec![-2]));
    assert_eq!(read("<u2", &[0xff, 0xff]), Ok(vec![65535]));
    assert_eq!(read("<i4", &[0, 0, 0, 0x80]), Ok(vec![i32::MIN]));
    assert_eq!(read("<i8", &[0xff; 8]), Ok(vec![-1]));
    assert_eq!(read(">u8", &[0, 0, 0, 0, 0x7f, 0xff, 0xff, 0xff]), Ok(vec![i32::MAX]));
    let too_large = [&[0; 4][..], &[0, 0, 0, 0x80]].concat();
    assert_eq!(read("<u4", &too_large), Err(NpyError::Label { point: 1, value: 1 << 31 }));
    assert_eq!(read("<u8", &[0xff; 8]), Err(NpyError::Label { point: 0, value: i128::from(u64::MAX) }));
    assert!(matches!(read("<f4", &[0; 8]), Err(NpyError::Type { .. })));
    assert_eq!(
        npy::read_labels(&npy_bytes("|i1", true, "(2, 3)", &[0, 3, 1, 4, 2, 5])),
        Ok(vec![0, 1, 2, 3, 4, 5])
    );
}

#[test]
fn one_number_per_point() {
    let file = npy_bytes("<f4", false, "(3,)", &f32s(&[0.5, 0.25, 0.125]));
    assert_eq!(npy::read_scalars(&file), Ok(vec![0.5, 0.25, 0.125]));
    let file = npy_bytes("<f4", true, "(2, 2)", &f32s(&[1.0, 3.0, 2.0, 4.0]));
    assert_eq!(npy::read_scalars(&file), Ok(vec![1.0, 2.0, 3.0, 4.0]));
    assert!(matches!(
        npy::read_scalars(&npy_bytes("<i4", false, "(3,)", &[0; 12])),
        Err(NpyError::Type { .. })
    ));
}

#[test]
fn other_shapes_and_types_are_named() {
    let message = |descr: &str, shape: &str| {
        npy::read(&npy_bytes(descr, false, shape, &[0; 96])).unwrap_err().to_string()
    };
    assert_eq!(message("<f4", "(4, 4)"), "the shape of the array is [4, 4] instead of (N, 3) or (H, W, 3)");
    assert_eq!(message("<f4", "(3,)"), "the shape of the array is [3] instead of (N, 3) or (H, W, 3)");
    assert_eq!(message("<f4", "()"), "the shape of the array is [] instead of (N, 3) or (H, W, 3)");
    assert_eq!(message("<i4", "(4, 3)"), "the type of the array is `<i4` instead of f4 or f8");
    assert_eq!(message("|O", "(4, 3)"), "the type of the array is `|O` instead of f4 or f8");
    assert_eq!(message("<f2", "(4, 3)"), "the type of the array is `<f2` instead of f4 or f8");
}

#[test]
fn count_far_beyond_the_size_and_overflow() {
    let most = u64::MAX;
    for shape in [
        "(3, 3)".to_owned(),
        "(1000000000000, 3)".to_owned(),
        format!("({most}, 3)"),
        format!("({}, 3)", most / 12 + 2),
        format!("({most}, {most}, 3)"),
        format!("({}, {}, 3)", 1_u64 << 32, 1_u64 << 32),
    ] {
        let error = npy::read(&npy_bytes("<f4", false, &shape, &[0; 24])).unwrap_err();
        assert!(matches!(error, NpyError::Truncated { size: 4, present: 24, .. }), "{shape}: {error}");
        let shape = shape.replace(", 3)", ",)");
        assert!(npy::read_labels(&npy_bytes("<i8", false, &shape, &[0; 16])).is_err());
        assert!(npy::read_scalars(&npy_bytes("<f8", true, &shape, &[0; 16])).is_err());
    }
}

#[test]
fn negative_counts() {
    let error = npy::read(&npy_bytes("<f4", false, "(-1, 3)", &[0; 24])).unwrap_err();
    let start = "byte 61: expected a whole number from 0 up, found `-1, 3), }";
    assert!(error.to_string().starts_with(start), "{error}");
    let error = npy::read(&npy_bytes("<f4", false, "(18446744073709551616, 3)", &[0; 24])).unwrap_err();
    assert!(matches!(error, NpyError::Header { .. }), "{error}");
}

#[test]
fn headers_that_are_none() {
    let file = |text: &str| {
        [b"\x93NUMPY\x01\x00", &(text.len() as u16).to_le_bytes()[..], text.as_bytes(), &[0; 12]].concat()
    };
    let good = "{\"shape\":(1,3),'fortran_order':False,'descr':'<f4'}";
    assert_eq!(npy::read(&file(good)).unwrap().points, [[0.0; 3]]);
    for bad in [
        "",
        "{}",
        "{'shape': (1, 3), 'descr': '<f4'}",
        "{'shape': (1 3), 'fortran_order': False, 'descr': '<f4'}",
        "{'shape': (1, 3), 'fortran_order': 0, 'descr': '<f4'}",
        "{'shape': (1, 3), 'fortran_order': False, 'descr': [('x', '<f4')]}",
        "{'shape': (1, 3), 'fortran_order': False, 'descr': '<f4', 'more': 1}",
        "{'shape': (1, 3), 'fortran_order': False, 'descr': '<f4",
    ] {
        let error = npy::read(&file(bad)).unwrap_err();
        assert!(matches!(error, NpyError::Header { .. }), "{bad}: {error}");
    }
    // Deep nesting is refused at its second bracket.
    let deep = "{".repeat(60_000);
    assert!(matches!(npy::read(&file(&deep)), Err(NpyError::Header { offset: 11, .. })));
    let mut version = file(good);
    version[6] = 4;
    assert_eq!(npy::read(&version), Err(NpyError::Version { major: 4, minor: 0 }));
    let mut long = file(good);
    long[8..10].fill(0xff);
    assert_eq!(npy::read(&long), Err(NpyError::TruncatedHeader { needed: 65_545, present: long.len() }));
}

proptest! {
    /// What another implementation writes.
    #[test]
    fn npyz_agrees(points in prop::collection::vec(prop::array::uniform3(prop::num::f64::ANY), 0..30), fortran in any::<bool>()) {
        let mut file = Vec::new();
        let order = if fortran { npyz::Order::Fortran } else { npyz::Order::C };
        let mut writer = npyz::WriteOptions::new()
            .default_dtype()
            .shape(&[points.len() as u64, 3])
            .order(order)
            .writer(&mut file)
            .begin_nd()
            .unwrap();
        let columns: Vec<f64> = (0..3).flat_map(|k| points.iter().map(move |p| p[k])).collect();
        let values = if fortran { &columns[..] } else { points.as_flattened() };
        writer.extend(values.iter().copied()).unwrap();
        writer.finish().unwrap();
        prop_assert!(same(&npy::read(&file).unwrap().points, &points));
    }
}
