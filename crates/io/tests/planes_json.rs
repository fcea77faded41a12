//! `planes.json` there and back, and files that are none.
#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    clippy::float_cmp,
    reason = "a test may fail, and compares exactly"
)]

use proptest::option;
use proptest::prelude::*;
use serde_json::json;
use terrace_io::planes_json::{
    PhiInterval, PlaneRecord, PlanesFile, PlanesJsonError, Summary, TiltOffset, Timings,
};
use terrace_io::{FileError, WriteErrorKind};
use terrace_types::{Plane, PlaneId};

fn number() -> impl Strategy<Value = f64> {
    prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO
}

fn record() -> impl Strategy<Value = PlaneRecord> {
    let vector = || prop::array::uniform3(number());
    let interval = (number(), option::of(number())).prop_map(|(lo, hi)| PhiInterval { lo, hi });
    let matrix = prop::array::uniform4(prop::array::uniform4(number()));
    let own = (vector(), prop::array::uniform2(vector()), prop::array::uniform3(vector()))
        .prop_map(|(at, axes, matrix)| TiltOffset { at, axes, matrix });
    (
        (any::<u32>(), option::of("\\PC{0,8}"), prop::array::uniform4(number()), option::of(vector())),
        (
            option::of(vector()),
            any::<u64>(),
            option::of(any::<u64>()),
            option::of(number()),
            option::of(number()),
        ),
        (option::of(number()), option::of(interval)),
        (
            option::of(matrix),
            option::of(own),
            option::of(number()),
            option::of(number()),
            option::of(vector()),
        ),
    )
        .prop_map(|(a, b, c, d)| PlaneRecord {
            id: a.0,
            name: a.1,
            coefficients: a.2,
            centroid: a.3,
            normal_uncertainty: b.0,
            covariance: d.0,
            tilt_offset_covariance: d.1,
            reduced_chi_squared: d.2,
            growth: d.3,
            min_max: d.4,
            points: b.1,
            cells: b.2,
            rms: b.3,
            area: b.4,
            phi: c.0,
            phi_interval: c.1,
        })
}

proptest! {
    #[test]
    fn there_and_back_to_the_last_bit(
        planes in prop::collection::vec(record(), 0..4),
        mean in option::of(prop::array::uniform3(number())),
        total in number(),
        seed in any::<u64>(), cell in number(),
    ) {
        let mut file = PlanesFile {
            planes,
            summary: Some(Summary { points: 5, labelled: 4, planes: 1, normal_uncertainty_mean: mean, optimised: None }),
            timings_seconds: Some(Timings { total, ..Timings::default() }),
            ..PlanesFile::default()
        };
        file.parameters.insert("seed".into(), json!(seed));
        file.parameters.insert("cell".into(), json!(cell));
        let text = file.to_json().unwrap();
        let back = PlanesFile::from_json(text.as_bytes()).unwrap();
        prop_assert_eq!(back.to_json().unwrap(), text);
        prop_assert_eq!(back, file);
    }
}

fn example() -> PlanesFile {
    let plane = Plane::through([0.0, 0.0, 1.5], [0.0, 0.0, 1.0]).unwrap();
    let record = PlaneRecord {
        centroid: Some([0.25, 0.5, 1.5]),
        normal_uncertainty: Some([0.01, 0.02, 0.0]),
        covariance: Some([
            [4e-8, 0.0, 0.0, -1e-8],
            [0.0, 1e-8, 0.0, -5e-9],
            [0.0; 4],
            [-1e-8, -5e-9, 0.0, 9.005e-6],
        ]),
        tilt_offset_covariance: Some(TiltOffset {
            at: [0.25, 0.5, 1.5],
            axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            matrix: [[4e-8, 0.0, 0.0], [0.0, 1e-8, 0.0], [0.0, 0.0, 9e-6]],
        }),
        reduced_chi_squared: Some(1.5),
        growth: Some(1.25),
        min_max: Some([0.001, 0.002, 0.0]),
        cells: Some(7),
        rms: Some(0.002),
        phi: Some(0.3),
        phi_interval: Some(PhiInterval { lo: 0.25, hi: None }),
        ..PlaneRecord::new(PlaneId::new(1).unwrap(), &plane, 120)
    };
    PlanesFile { planes: vec![record], ..PlanesFile::default() }
}

#[test]
fn layout_of_the_file() {
    let text = example().to_json().unwrap();
    let expected = json!({
        "format": "terrace-planes", "version": 1, "parameters": {},
        "planes": [{
            "id": 1, "coefficients": [0.0, 0.0, 1.0, -1.5], "centroid": [0.25, 0.5, 1.5],
            "normal_uncertainty": [0.01, 0.02, 0.0],
            "covariance": [
                [4e-8, 0.0, 0.0, -1e-8], [0.0, 1e-8, 0.0, -5e-9], [0.0, 0.0, 0.0, 0.0],
                [-1e-8, -5e-9, 0.0, 9.005e-6]
            ],
            "tilt_offset_covariance": {
                "at": [0.25, 0.5, 1.5], "axes": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
                "matrix": [[4e-8, 0.0, 0.0], [0.0, 1e-8, 0.0], [0.0, 0.0, 9e-6]]
            },
            "reduced_chi_squared": 1.5, "growth": 1.25, "min_max": [0.001, 0.002, 0.0],
            "points": 120, "cells": 7, "rms": 0.002,
            "phi": 0.3, "phi_interval": [0.25, null]
        }]
    });
    assert_eq!(serde_json::from_str::<serde_json::Value>(&text).unwrap(), expected);
    assert!(text.starts_with("{\n  \"format\": \"terrace-planes\",\n  \"version\": 1,\n"), "{text}");
}

#[test]
fn a_file_without_covariances_is_read() {
    let text = r#"{"format": "terrace-planes", "version": 1, "planes": [{"id": 1, "coefficients": [0, 0, 1, -1.5],
        "normal_uncertainty": [0.01, 0.02, 0], "points": 120}]}"#;
    let file = PlanesFile::from_json(text.as_bytes()).unwrap();
    let plane = &file.planes[0];
    assert!(plane.covariance.is_none() && plane.tilt_offset_covariance.is_none() && plane.min_max.is_none());
    assert!(plane.reduced_chi_squared.is_none() && plane.growth.is_none());
    let text = file.to_json().unwrap();
    assert!(!text.contains("covariance") && !text.contains("growth"), "{text}");
}

#[test]
fn stages_that_were_not_are_left_out_of_the_timings() {
    let with = |grow, extent| {
        let timings = Timings { grow, extent, ..Timings::default() };
        let file = PlanesFile { timings_seconds: Some(timings), ..example() };
        let text = file.to_json().unwrap();
        assert_eq!(PlanesFile::from_json(text.as_bytes()).unwrap(), file);
        serde_json::from_str::<serde_json::Value>(&text).unwrap()["timings_seconds"].clone()
    };
    let neither = with(None, None);
    assert!(neither.get("grow").is_none() && neither.get("extent").is_none(), "{neither}");
    let both = with(Some(0.5), Some(0.25));
    assert_eq!((&both["grow"], &both["extent"]), (&json!(0.5), &json!(0.25)));
    let stages = neither.as_object().unwrap().len();
    assert_eq!(both.as_object().unwrap().len(), stages + 2);
}

#[test]
fn both_covariances_tell_the_same_distances() {
    let file = example();
    let (of_coefficients, own) =
        (file.planes[0].covariance.unwrap(), file.planes[0].tilt_offset_covariance.unwrap());
    for point in [[0.25, 0.5, 1.5], [0.0, 0.0, 0.0], [8.0, -3.0, 1.0]] {
        let at = [point[0], point[1], point[2], 1.0];
        let variance: f64 =
            (0..4).flat_map(|i| (0..4).map(move |j| at[i] * of_coefficients[i][j] * at[j])).sum();
        assert!((variance.sqrt() - own.distance(point)).abs() < 1e-12, "{point:?}");
    }
    assert!((own.largest_tilt() - 2e-4).abs() < 1e-15);
    assert!((own.offset() - 3e-3).abs() < 1e-15);
}

#[test]
fn the_largest_tilt_is_that_of_any_axes() {
    let turned = |angle: f64| {
        let (s, c) = angle.sin_cos();
        let (large, small) = (9e-6, 1e-6);
        let (xx, xy, yy) =
            (c * c * large + s * s * small, s * c * (large - small), s * s * large + c * c * small);
        let matrix = [[xx, xy, 0.0], [xy, yy, 0.0], [0.0, 0.0, 1e-6]];
        TiltOffset { at: [0.0; 3], axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], matrix }
    };
    for angle in [0.0, 0.3, 1.0, 1.57, 2.5] {
        assert!((turned(angle).largest_tilt() - 3e-3).abs() < 1e-12, "{angle}");
    }
}

#[test]
fn fields_of_later_programs_are_passed_over() {
    let text = r#"{"version": 1, "format": "terrace-planes", "extra": [1], "planes": []}"#;
    assert_eq!(PlanesFile::from_json(text.as_bytes()).unwrap(), PlanesFile::default());
}

#[test]
fn unknown_format_and_version() {
    let read = |text: &str| PlanesFile::from_json(text.as_bytes()).unwrap_err();
    let version = read(r#"{"format": "terrace-planes", "version": 2, "planes": "new"}"#);
    assert!(matches!(version, PlanesJsonError::Version { found: 2 }));
    let format = read(r#"{"format": "other", "version": 1}"#);
    assert!(matches!(format, PlanesJsonError::Format { found } if found == "other"));
    for text in ["", "[]", "{}", "null", r#"{"format": 1, "version": 1}"#, &"[".repeat(100_000)] {
        assert!(matches!(read(text), PlanesJsonError::Json(_)));
    }
    let missing = read(r#"{"format": "terrace-planes", "version": 1}"#);
    assert!(missing.to_string().contains("planes"), "{missing}");
}

#[test]
fn truncated_at_every_byte() {
    let text = example().to_json().unwrap();
    let text = text.trim_end();
    for end in 0..text.len() {
        assert!(PlanesFile::from_json(&text.as_bytes()[..end]).is_err(), "cut at {end}");
    }
}

type Spoil = fn(&mut PlanesFile);

#[test]
fn nan_and_infinity_are_refused_by_name() {
    let spoil: [(&str, Spoil); 15] = [
        ("planes[0].coefficients", |f| f.planes[0].coefficients[3] = f64::NAN),
        ("planes[0].centroid", |f| f.planes[0].centroid = Some([f64::INFINITY; 3])),
        ("planes[0].normal_uncertainty", |f| f.planes[0].normal_uncertainty = Some([f64::NAN; 3])),
        ("planes[0].covariance", |f| f.planes[0].covariance = Some([[0.0, 0.0, 0.0, f64::NAN]; 4])),
        ("planes[0].tilt_offset_covariance", |f| {
            f.planes[0].tilt_offset_covariance.as_mut().unwrap().axes[1][2] = f64::INFINITY;
        }),
        ("planes[0].reduced_chi_squared", |f| f.planes[0].reduced_chi_squared = Some(f64::INFINITY)),
        ("planes[0].growth", |f| f.planes[0].growth = Some(f64::NAN)),
        ("planes[0].min_max", |f| f.planes[0].min_max = Some([0.0, 0.0, f64::NAN])),
        ("planes[0].area", |f| f.planes[0].area = Some(f64::INFINITY)),
        ("planes[0].rms", |f| f.planes[0].rms = Some(f64::NEG_INFINITY)),
        ("planes[0].phi", |f| f.planes[0].phi = Some(f64::NAN)),
        ("planes[0].phi_interval", |f| {
            f.planes[0].phi_interval = Some(PhiInterval { lo: 0.0, hi: Some(f64::INFINITY) });
        }),
        ("summary.normal_uncertainty_mean", |f| {
            let mean = Some([f64::NAN; 3]);
            f.summary = Some(Summary {
                points: 0,
                labelled: 0,
                planes: 0,
                normal_uncertainty_mean: mean,
                optimised: None,
            });
        }),
        ("timings_seconds", |f| f.timings_seconds = Some(Timings { label: f64::NAN, ..Timings::default() })),
        ("timings_seconds", |f| {
            f.timings_seconds = Some(Timings { grow: Some(f64::NAN), ..Timings::default() });
        }),
    ];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("planes.json");
    for (field, spoil) in spoil {
        let mut file = example();
        spoil(&mut file);
        let error = file.write(&path).unwrap_err();
        assert!(matches!(&error.kind, WriteErrorKind::NotFinite { what, .. } if what == field), "{error}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}

#[test]
fn file_on_disk() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("planes.json");
    assert!(matches!(PlanesFile::open(&path), Err(FileError::Io { .. })));
    example().write(&path).unwrap();
    assert_eq!(PlanesFile::open(&path).unwrap(), example());
    std::fs::write(&path, "{").unwrap();
    let message = PlanesFile::open(&path).unwrap_err().to_string();
    assert!(message.contains("planes.json") && message.contains("line 1"), "{message}");
}
