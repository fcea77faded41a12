//! Trajectories: every kind there and back, and files that are none.
#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    clippy::float_cmp,
    reason = "a test may fail, and compares exactly"
)]

mod common;

use std::fmt::Write;

use common::{difference, matrix, poses};
use npyz::WriterBuilder;
use proptest::prelude::*;
use terrace_io::trajectory::{TrajectoryError, TrajectoryFormat, read};
use terrace_types::{Pose, PoseError};

/// Each kind of text file, and the kind it must be taken for.
fn written(all: &[([f64; 3], [f64; 4])], separator: &str) -> Vec<(TrajectoryFormat, String)> {
    let join = |values: &[f64]| values.iter().map(f64::to_string).collect::<Vec<_>>().join(separator);
    let mut texts = [const { String::new() }; 5];
    texts[0] += "# timestamp tx ty tz qx qy qz qw\n\n";
    for (index, (t, q)) in all.iter().enumerate() {
        let m = matrix(&Pose::from_quaternion(*t, *q).unwrap());
        let flat = m.concat();
        let block = m.map(|row| join(&row)).join("\n");
        let tum = [&[index as f64 * 0.1][..], t, q].concat();
        writeln!(texts[0], "{}", join(&tum)).unwrap();
        writeln!(texts[1], "{}", join(&flat[..12])).unwrap();
        writeln!(texts[2], "{}", join(&flat)).unwrap();
        writeln!(texts[3], "{block}\n").unwrap();
        writeln!(texts[4], "{index} {index} {}\n{block}", index + 1).unwrap();
    }
    let formats = [
        TrajectoryFormat::Tum,
        TrajectoryFormat::Kitti,
        TrajectoryFormat::MatrixLines,
        TrajectoryFormat::MatrixBlocks,
        TrajectoryFormat::Open3dLog,
    ];
    formats.into_iter().zip(texts).collect()
}

fn npy(all: &[Pose], order: npyz::Order, single: bool) -> Vec<u8> {
    let mut values: Vec<f64> = all.iter().flat_map(|p| matrix(p).concat()).collect();
    if order == npyz::Order::Fortran {
        let c = values.clone();
        for (at, value) in values.iter_mut().enumerate() {
            let (pose, entry) = (at % all.len(), at / all.len());
            *value = c[16 * pose + 4 * (entry % 4) + entry / 4];
        }
    }
    let mut bytes = Vec::new();
    let shape = [all.len() as u64, 4, 4];
    if single {
        let options = npyz::WriteOptions::new().default_dtype().order(order).shape(&shape);
        let mut out = options.writer(&mut bytes).begin_nd().unwrap();
        out.extend(values.iter().map(|x| *x as f32)).unwrap();
        out.finish().unwrap();
    } else {
        let options = npyz::WriteOptions::new().default_dtype().order(order).shape(&shape);
        let mut out = options.writer(&mut bytes).begin_nd().unwrap();
        out.extend(values).unwrap();
        out.finish().unwrap();
    }
    bytes
}

proptest! {
    #[test]
    fn there_and_back_as_text(
        all in prop::collection::vec(poses(), 1..6),
        separator in prop::sample::select(vec![" ", ",", ", ", "\t", "  "]),
        line_end in prop::sample::select(vec!["\n", "\r\n", ",\n", " \n"]),
    ) {
        for (format, text) in written(&all, separator) {
            // A comma may end a line of numbers, not an empty one or a comment.
            let text: String = text.lines().filter(|l| !l.is_empty()).map(|line| {
                if line.starts_with('#') { format!("{line}\n") } else { format!("{line}{line_end}") }
            }).collect();
            let trajectory = read(text.as_bytes()).unwrap();
            prop_assert_eq!(trajectory.format, format);
            prop_assert_eq!(trajectory.poses.len(), all.len());
            for (index, (stamped, (t, q))) in trajectory.poses.iter().zip(&all).enumerate() {
                prop_assert!(difference(&stamped.pose, &Pose::from_quaternion(*t, *q).unwrap()) < 1e-12);
                let time = (format == TrajectoryFormat::Tum).then_some(index as f64 * 0.1);
                prop_assert_eq!(stamped.time, time);
            }
        }
    }

    #[test]
    fn there_and_back_as_npy(all in prop::collection::vec(poses(), 1..6), fortran in any::<bool>(), single in any::<bool>()) {
        let all: Vec<Pose> = all.iter().map(|(t, q)| Pose::from_quaternion(*t, *q).unwrap()).collect();
        let order = if fortran { npyz::Order::Fortran } else { npyz::Order::C };
        let trajectory = read(&npy(&all, order, single)).unwrap();
        prop_assert_eq!(trajectory.format, TrajectoryFormat::Npy);
        prop_assert_eq!(trajectory.poses.len(), all.len());
        let tolerance = if single { 1e-3 } else { 1e-12 };
        for (stamped, pose) in trajectory.poses.iter().zip(&all) {
            prop_assert!(difference(&stamped.pose, pose) < tolerance);
        }
    }

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let _ = read(&bytes);
        let _ = read(&[b"\x93NUMPY", bytes.as_slice()].concat());
    }
}

#[test]
fn truncated_at_every_byte() {
    let all = [([1.0, 2.0, 3.5], [0.1, -0.2, 0.3, 0.9]), ([4.0, 5.0, 6.5], [0.5, 0.5, 0.5, 0.5])];
    for (format, text) in written(&all, " ") {
        for end in 0..text.len() {
            match read(&text.as_bytes()[..end]) {
                Ok(cut) => assert!(!cut.poses.is_empty() && cut.poses.len() <= 2, "{format} cut at {end}"),
                Err(error) => assert!(!error.to_string().is_empty()),
            }
        }
    }
    let all = all.map(|(t, q)| Pose::from_quaternion(t, q).unwrap());
    let bytes = npy(&all, npyz::Order::C, false);
    for end in 0..bytes.len() {
        assert!(read(&bytes[..end]).is_err(), "cut at {end}");
    }
}

#[test]
fn npy_header_with_huge_numbers() {
    for shape in [
        "(99999999999999999999, 4, 4)",
        "(4294967296, 4294967296, 4294967296)",
        "(576460752303423488, 4, 4)",
        "(9000000000000000, 4, 4)",
        "(-1, 4, 4)",
        "((((4, 4), 4), 4), 4)",
    ] {
        let text = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((text.len() as u16).to_le_bytes());
        bytes.extend(text.as_bytes());
        bytes.extend([0; 128]);
        assert!(read(&bytes).is_err(), "{shape}");
    }
    assert!(read(b"\x93NUMPY\x02\x00\xff\xff\xff\xff{").is_err());
    let deep = [b"\x93NUMPY\x01\x00\xf0\xf0".to_vec(), vec![b'('; 0xf0f0]].concat();
    assert!(read(&deep).is_err());
}

#[test]
fn npy_of_other_shape_or_kind() {
    let shaped = |shape: &[u64]| {
        let mut bytes = Vec::new();
        let options = npyz::WriteOptions::new().default_dtype().shape(shape);
        let mut out = options.writer(&mut bytes).begin_nd().unwrap();
        out.extend(vec![0.0_f64; shape.iter().product::<u64>() as usize]).unwrap();
        out.finish().unwrap();
        read(&bytes)
    };
    assert_eq!(shaped(&[5, 3]), Err(TrajectoryError::NpyShape { shape: vec![5, 3] }));
    assert_eq!(shaped(&[0, 4, 4]), Err(TrajectoryError::Empty));
    assert!(matches!(shaped(&[4, 4]), Err(TrajectoryError::PoseInArray { index: 0, .. })));
}

#[test]
fn empty() {
    for text in ["", "\n\n", "# nothing\n", "\u{feff}"] {
        assert_eq!(read(text.as_bytes()), Err(TrajectoryError::Empty));
    }
}

#[test]
fn wrong_number_of_columns() {
    let found = |text: &str| read(text.as_bytes()).unwrap_err();
    assert_eq!(found("1 2 3 4 5\n"), TrajectoryError::UnknownShape { line: 1, found: 5 });
    assert_eq!(found(&"1 ".repeat(40)), TrajectoryError::UnknownShape { line: 1, found: 17 });
    let format = TrajectoryFormat::Tum;
    let expected = TrajectoryError::Columns { line: 3, found: 7, expected: 8, format };
    assert_eq!(found("0 0 0 0 0 0 0 1\n# note\n0 0 0 0 0 0 1\n"), expected);
    let format = TrajectoryFormat::MatrixBlocks;
    let expected = TrajectoryError::Columns { line: 2, found: 3, expected: 4, format };
    assert_eq!(found("1 0 0 0\n0 1 0\n"), expected);
    assert_eq!(found("\n1 0 0 0\n0 1 0 0\n0 0 1 0\n"), TrajectoryError::Incomplete { line: 2 });
    // A 3x3 camera matrix is no trajectory.
    let format = TrajectoryFormat::Open3dLog;
    let expected = TrajectoryError::Columns { line: 2, found: 3, expected: 4, format };
    assert_eq!(found("585 0 320\n0 585 240\n0 0 1\n"), expected);
}

#[test]
fn values_that_are_no_numbers() {
    let expected =
        |line, column, text: &str| Err(TrajectoryError::NotANumber { line, column, text: text.to_owned() });
    assert_eq!(read(b"0 0 0 0 0 0 0 1\n1 0 0 x 0 0 0 1\n"), expected(2, 4, "x"));
    assert_eq!(read(b"1,0,,0\n"), expected(1, 3, ""));
    assert_eq!(read(b"-1.#IND 0 0 0\n"), expected(1, 1, "-1.#IND"));
    assert_eq!(read(b"0 0 0 0\n\xff\n"), Err(TrajectoryError::NotText { line: 2 }));
}

#[test]
fn pose_not_finite() {
    for value in ["NaN", "-inf", "inf"] {
        let text = format!("1 0 0 0\n0 1 0 0\n0 0 1 {value}\n0 0 0 1\n");
        let error = read(text.as_bytes()).unwrap_err();
        assert!(matches!(error, TrajectoryError::Pose { line: 1, error: PoseError::NotFinite { .. } }));
    }
    let error = read(b"NaN 0 0 0 0 0 0 1\n").unwrap_err();
    assert!(matches!(error, TrajectoryError::Time { line: 1, .. }));
}

#[test]
fn pose_not_orthonormal() {
    let error = read(b"1 0 0 0 0 1 0 0 0 0 1 0\n2 0 0 0 0 1 0 0 0 0 1 0\n").unwrap_err();
    assert!(matches!(error, TrajectoryError::Pose { line: 2, error: PoseError::NotARotation { .. } }));
    let error = read(b"-1 0 0 0 0 1 0 0 0 0 1 0\n").unwrap_err();
    assert!(matches!(error, TrajectoryError::Pose { line: 1, error: PoseError::Mirrored }));
    let transposed = read(b"1 0 0 0 0 1 0 0 0 0 1 0 5 6 7 1\n").unwrap_err();
    assert!(matches!(transposed, TrajectoryError::Pose { line: 1, error: PoseError::NotRigid { .. } }));
}

#[test]
fn zero_quaternion() {
    let error = read(b"0 1 2 3 0 0 0 0\n").unwrap_err();
    assert!(matches!(error, TrajectoryError::Pose { line: 1, error: PoseError::ZeroQuaternion { .. } }));
}

#[test]
fn time_stamp_in_the_corner_of_the_matrix() {
    let text = "1.000000,0,0,-0.5,\n0,1,0,0,\n0,0,1,2,\n0.000000,0,0,1630577758.569490,\n";
    let trajectory = read(text.as_bytes()).unwrap();
    assert_eq!(trajectory.poses[0].pose.translation(), [-0.5, 0.0, 2.0]);
}
