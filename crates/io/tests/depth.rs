//! Depth images: every pixel to its point, and images that are none.
#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    clippy::float_cmp,
    reason = "a test may fail, and compares exactly"
)]

mod common;

use common::{depth_png, png};
use png::{BitDepth, ColorType};
use proptest::prelude::*;
use terrace_io::{DepthError, DepthImage, Intrinsics, IntrinsicsError};

proptest! {
    #[test]
    fn pixel_to_point_to_pixel(
        width in 1_u32..9,
        raw in prop::collection::vec(any::<u16>(), 9 * 8),
        fx in 100.0..1000.0_f64, fy in prop_oneof![100.0..1000.0_f64, -1000.0..-100.0_f64],
        cx in 0.0..8.0_f64, cy in 0.0..8.0_f64, scale in 500.0..6000.0_f64,
    ) {
        let raw = &raw[..(width * 8) as usize];
        let image = DepthImage::read(&depth_png(width, raw)).unwrap();
        prop_assert_eq!((image.width, image.height, image.raw.as_slice()), (width, 8, raw));
        let camera = Intrinsics::new(fx, fy, cx, cy).unwrap();
        let points = image.points(&camera, scale).unwrap();
        prop_assert_eq!(points.len(), raw.len());
        for (index, (point, raw)) in points.iter().zip(raw).enumerate() {
            if *raw == 0 || *raw == 65535 {
                prop_assert!(point.iter().all(|x| x.is_nan()));
                continue;
            }
            let [u, v] = camera.project(*point);
            prop_assert!((u - f64::from(index as u32 % width)).abs() < 1e-9);
            prop_assert!((v - f64::from(index as u32 / width)).abs() < 1e-9);
            prop_assert!((point[2] * scale - f64::from(*raw)).abs() < 1e-9);
        }
    }
}

#[test]
fn other_pngs_say_what_they_are() {
    for (colour, bits, data, expected) in [
        (ColorType::Grayscale, BitDepth::Eight, vec![0; 4], "8-bit grey;"),
        (ColorType::Rgb, BitDepth::Eight, vec![0; 12], "8-bit RGB;"),
        (ColorType::Rgba, BitDepth::Sixteen, vec![0; 32], "16-bit RGB with alpha"),
        (ColorType::Indexed, BitDepth::Eight, vec![0; 4], "8-bit palette"),
        (ColorType::GrayscaleAlpha, BitDepth::Sixteen, vec![0; 16], "16-bit grey with alpha"),
    ] {
        let bytes = png(2, 2, colour, bits, &data);
        assert!(!DepthImage::is_depth_png(&bytes));
        let message = DepthImage::read(&bytes).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
    }
    assert!(DepthImage::is_depth_png(&depth_png(1, &[7])));
}

#[test]
fn empty_and_no_png() {
    for bytes in [&b""[..], b"\x89PNG\r\n\x1a\n", b"ply\n", &[0; 100]] {
        assert!(matches!(DepthImage::read(bytes), Err(DepthError::Damaged { .. })));
    }
}

#[test]
fn truncated_at_every_byte() {
    let raw: Vec<u16> = (0..60).map(|i| 1000 + i * 37 % 500).collect();
    let whole = depth_png(10, &raw);
    for end in 0..whole.len() {
        // Cut behind the last pixel the image is there; before, it must not be.
        if let Ok(image) = DepthImage::read(&whole[..end]) {
            assert_eq!(image.raw, raw, "cut at {end}");
        }
    }
}

#[test]
fn any_flipped_byte() {
    let whole = depth_png(6, &[1500; 36]);
    for at in 0..whole.len() {
        let mut bytes = whole.clone();
        bytes[at] ^= 0x55;
        let _ = DepthImage::read(&bytes);
    }
}

#[test]
fn header_claims_more_pixels_than_the_file_holds() {
    for (width, height) in [(65_535, 65_535), (1 << 31, 1), (u32::MAX >> 1, u32::MAX >> 1), (5000, 5000)] {
        let bytes = with_size(&depth_png(1, &[1500]), width, height);
        let error = DepthImage::read(&bytes).unwrap_err();
        assert!(matches!(error, DepthError::TooLarge { .. } | DepthError::Damaged { .. }), "{error}");
    }
}

#[test]
fn image_without_pixels() {
    assert!(DepthImage::read(&with_size(&depth_png(1, &[1500]), 0, 5)).is_err());
    let image = DepthImage { width: 0, height: 0, raw: vec![] };
    let camera = Intrinsics::new(1.0, 1.0, 0.0, 0.0).unwrap();
    assert_eq!(image.points(&camera, 1000.0).unwrap().len(), 0);
}

#[test]
fn scale_zero_negative_nan_subnormal() {
    let image = DepthImage { width: 1, height: 1, raw: vec![1000] };
    let camera = Intrinsics::new(1.0, 1.0, 0.0, 0.0).unwrap();
    for scale in [0.0, -1000.0, f64::NAN, f64::INFINITY, 1e-310] {
        assert!(matches!(image.points(&camera, scale), Err(DepthError::Scale { .. })));
    }
}

#[test]
fn intrinsics_from_text() {
    let icl: Intrinsics = "481.2,-480,319.5,239.5".parse().unwrap();
    assert_eq!(icl.parameters(), [481.2, -480.0, 319.5, 239.5]);
    for bad in ["", "1,2,3", "1,2,3,4,5", "a,b,c,d", "1 2 3 4"] {
        assert!(matches!(bad.parse::<Intrinsics>(), Err(IntrinsicsError::NotFourNumbers { .. })), "{bad}");
    }
    for bad in ["0,1,1,1", "1,NaN,1,1", "inf,1,1,1"] {
        assert!(matches!(bad.parse::<Intrinsics>(), Err(IntrinsicsError::FocalLength { .. })), "{bad}");
    }
    assert!(matches!("1,1,NaN,1".parse::<Intrinsics>(), Err(IntrinsicsError::PrincipalPoint { .. })));
}

#[test]
fn intrinsics_from_files() {
    let keys = br#"{"w": 640, "h": 480, "fx": 525.0, "fy": 524, "cx": 319.5, "cy": 239.5}"#;
    let open3d = br#"{"width": 640, "intrinsic_matrix": [525.0, 0, 0, 0, 524, 0, 319.5, 239.5, 1]}"#;
    let matrix = b"5.25e2 0. 3.195e2\n0. 524 2.395e+02\n0. 0. 1.";
    for bytes in [&keys[..], open3d, matrix] {
        assert_eq!(Intrinsics::from_bytes(bytes).unwrap().parameters(), [525.0, 524.0, 319.5, 239.5]);
    }
    let error = |bytes: &[u8]| Intrinsics::from_bytes(bytes).unwrap_err();
    assert_eq!(error(b""), IntrinsicsError::NotNineNumbers { found: 0 });
    assert_eq!(error(b"1 2 3 x"), IntrinsicsError::NotNineNumbers { found: 3 });
    assert_eq!(error(b"\xff\xfe"), IntrinsicsError::NotText);
    assert_eq!(error(br#"{"fx": 1}"#), IntrinsicsError::MissingKey { key: "fy" });
    let transposed = error(b"525 0 0  0 525 0  319.5 239.5 1");
    assert!(matches!(transposed, IntrinsicsError::NotAPinhole { row: 2, column: 0, .. }));
    assert!(matches!(error(b"{"), IntrinsicsError::Json { .. }));
    for end in 0..open3d.len() {
        assert!(Intrinsics::from_bytes(&open3d[..end]).is_err());
    }
}

/// The image with another size in its header, and a checksum that fits.
fn with_size(bytes: &[u8], width: u32, height: u32) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    bytes[16..20].copy_from_slice(&width.to_be_bytes());
    bytes[20..24].copy_from_slice(&height.to_be_bytes());
    let mut crc = u32::MAX;
    for byte in &bytes[12..29] {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg());
        }
    }
    bytes[29..33].copy_from_slice(&(!crc).to_be_bytes());
    bytes
}
