//! Known shapes come out with their areas and holes.
#![allow(clippy::unwrap_used, clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "tests")]

use std::f64::consts::PI;

use terrace_extent::{
    ExtentError, Footprint, OutlineOptions, PlaneExtent, PlaneFrame, Polygon, suggested_resolution,
};
use terrace_types::Plane;

fn frame() -> PlaneFrame {
    let plane = Plane::through([5e5, 5e6, 100.0], [0.3, -0.5, 0.8]).unwrap();
    PlaneFrame::new(&plane, [5e5 + 1.0, 5e6, 101.0]).unwrap()
}

/// Points of a shape on a grid of this spacing, turned.
fn sampled(inside: impl Fn(f64, f64) -> bool, spacing: f64, turn: f64) -> Vec<[f64; 3]> {
    let (frame, (sin, cos)) = (frame(), turn.sin_cos());
    let steps = (4.0 / spacing).ceil() as i32;
    let mut points = Vec::new();
    for i in -steps..steps {
        for j in -steps..steps {
            let (x, y) = ((f64::from(i) + 0.37) * spacing, (f64::from(j) + 0.61) * spacing);
            if inside(x, y) {
                points.push(frame.to_world([cos * x - sin * y, sin * x + cos * y]));
            }
        }
    }
    points
}

fn outlined(points: &[[f64; 3]], resolution: f64, options: &OutlineOptions) -> Vec<Polygon> {
    let mut footprint = Footprint::new(frame(), resolution).unwrap();
    for point in points {
        footprint.add(*point).unwrap();
    }
    footprint.outline(options).unwrap()
}

fn outline(points: &[[f64; 3]], spacing: f64) -> Vec<Polygon> {
    outlined(points, suggested_resolution(spacing), &OutlineOptions::for_spacing(spacing))
}

/// Largest error of the area in pixels' widths along the border, for all turns and spacings.
fn check(inside: fn(f64, f64) -> bool, area: f64, holes: usize) {
    for spacing in [0.01, 0.02, 0.04] {
        for turn in [0.0, 0.1, 0.4, PI / 4.0, 2.0] {
            let polygons = outline(&sampled(inside, spacing, turn), spacing);
            assert_eq!(polygons.len(), 1);
            assert_eq!(polygons[0].holes().len(), holes, "{spacing} {turn}");
            let moved = (polygons[0].area() - area) / polygons[0].perimeter();
            assert!(moved.abs() < 0.5 * suggested_resolution(spacing), "{spacing} {turn}: moved by {moved}");
            assert!((polygons[0].area() / area - 1.0).abs() < 0.045);
        }
    }
}

#[test]
fn rectangle() {
    check(|x, y| x.abs() < 2.0 && y.abs() < 1.25, 10.0, 0);
    // Straight borders and sharp corners, whatever the turn.
    let polygons = outline(&sampled(|x, y| x.abs() < 2.0 && y.abs() < 1.25, 0.01, 0.3), 0.01);
    assert!(polygons[0].outer().len() <= 8, "{}", polygons[0].outer().len());
    assert!((polygons[0].perimeter() - 13.0).abs() < 0.05);
}

#[test]
fn l_shape() {
    check(|x, y| x.abs() < 1.5 && y.abs() < 1.5 && (x < -0.5 || y < -0.5), 5.0, 0);
}

#[test]
fn disc() {
    check(|x, y| x.hypot(y) < 1.0, PI, 0);
}

#[test]
fn plate_with_holes() {
    check(
        |x, y| {
            x.abs() < 1.5 && y.abs() < 1.5 && (x - 0.7).hypot(y - 0.7) > 0.5 && (x + 0.7).hypot(y + 0.7) > 0.5
        },
        9.0 - PI / 2.0,
        2,
    );
}

#[test]
fn dense_points_do_not_widen() {
    for turn in [0.0, 0.3, PI / 4.0] {
        let points = sampled(|x, y| x.abs() < 1.0 && y.abs() < 1.0, 0.005, turn);
        // Forty points along a pixel.
        let polygons = outlined(&points, 0.2, &OutlineOptions::closing(0.2));
        let moved = (polygons[0].area() - 4.0) / polygons[0].perimeter();
        assert!(moved.abs() < 0.1, "{turn}: {moved}");
    }
}

#[test]
fn pixels_smaller_than_the_spacing_make_no_sieve() {
    let points = sampled(|x, y| x.abs() < 1.0 && y.abs() < 1.0, 0.05, 0.2);
    let polygons = outlined(&points, 0.01, &OutlineOptions::for_spacing(0.05));
    assert_eq!((polygons.len(), polygons[0].holes().len()), (1, 0));
    // Half a spacing inside, as told.
    assert!((polygons[0].area().sqrt() / 2.0 - (1.0 - 0.02)).abs() < 0.01, "{}", polygons[0].area());
}

#[test]
fn patches_islands_and_small_holes() {
    let two = sampled(|x, y| y.abs() < 0.5 && (x.abs() - 1.0).abs() < 0.4, 0.02, 0.5);
    let polygons = outline(&two, 0.02);
    assert_eq!(polygons.len(), 2);
    assert!(polygons.iter().all(|p| (p.area() - 0.8).abs() < 0.03 && p.holes().is_empty()));
    // A frame with a plate inside; with its hole filled it is one with the plate.
    let framed = |x: f64, y: f64| {
        let far = x.abs().max(y.abs());
        !(0.5..=1.0).contains(&far) && far < 1.5
    };
    let points = sampled(framed, 0.02, 0.2);
    let polygons = outline(&points, 0.02);
    assert_eq!(polygons.iter().map(|p| p.holes().len()).collect::<Vec<_>>(), [1, 0]);
    assert!((polygons[0].area() - 5.0).abs() < 0.2 && (polygons[1].area() - 1.0).abs() < 0.05);
    let filled = OutlineOptions { min_hole_area: 4.5, ..OutlineOptions::closing(0.06) };
    let polygons = outlined(&points, 0.03, &filled);
    assert_eq!((polygons.len(), polygons[0].holes().len()), (1, 0));
    assert!((polygons[0].area() - 9.0).abs() < 0.2);
    let large = OutlineOptions { min_area: 2.0, ..OutlineOptions::closing(0.06) };
    assert_eq!(outlined(&points, 0.03, &large).len(), 1);
}

#[test]
fn too_many_pixels_become_larger_in_any_order() {
    let points = sampled(|x, y| x.hypot(y) < 1.0, 0.01, 0.0);
    let of = |points: &mut dyn Iterator<Item = &[f64; 3]>| {
        let mut footprint = Footprint::with_max_pixels(frame(), 0.01, 1000).unwrap();
        points.for_each(|p| footprint.add(*p).unwrap());
        assert!(footprint.occupied() <= 1000);
        assert!((footprint.resolution() - 0.08).abs() < 1e-12, "{}", footprint.resolution());
        PlaneExtent::of(&footprint, &OutlineOptions::closing(0.08)).unwrap()
    };
    let extent = of(&mut points.iter());
    assert_eq!(extent, of(&mut points.iter().rev()));
    assert!((extent.area() - PI).abs() < 0.1, "{}", extent.area());
}

#[test]
fn nothing_and_single_points() {
    let mut footprint = Footprint::new(frame(), 0.1).unwrap();
    let options = OutlineOptions::closing(0.3);
    assert_eq!(footprint.outline(&options), Ok(Vec::new()));
    footprint.add(frame().origin()).unwrap();
    let polygons = footprint.outline(&options).unwrap();
    assert_eq!(polygons.len(), 1);
    assert!(polygons[0].area() > 0.0 && polygons[0].area() <= 0.01 + 1e-12);
}

#[test]
fn what_cannot_be_meant_is_refused() {
    let refused = |resolution| Footprint::new(frame(), resolution).err();
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-300] {
        assert!(matches!(refused(bad), Some(ExtentError::Resolution { .. })));
    }
    assert!(matches!(
        Footprint::with_max_pixels(frame(), 1.0, 3).err(),
        Some(ExtentError::PixelLimit { limit: 3, .. })
    ));
    let mut footprint = Footprint::new(frame(), 1e-3).unwrap();
    for bad in [f64::NAN, f64::INFINITY] {
        assert!(matches!(footprint.add([0.0, bad, 0.0]), Err(ExtentError::PointNotFinite { .. })));
    }
    assert!(matches!(footprint.add([1e9, 0.0, 0.0]), Err(ExtentError::TooFar { .. })));
    assert_eq!(footprint.occupied(), 0);
    let outline = |options| footprint.outline(&options).err();
    assert!(matches!(outline(OutlineOptions::closing(-0.1)), Some(ExtentError::Size { name: "gap", .. })));
    assert!(matches!(outline(OutlineOptions::closing(1.0)), Some(ExtentError::GapTooWide { .. })));
    let nan = OutlineOptions { tolerance: Some(f64::NAN), ..OutlineOptions::closing(0.0) };
    assert!(matches!(outline(nan), Some(ExtentError::Size { name: "tolerance", .. })));
    let plane = Plane::through([0.0; 3], [0.0, 0.0, 1.0]).unwrap();
    assert!(matches!(
        PlaneFrame::new(&plane, [f64::NAN, 0.0, 0.0]).err(),
        Some(ExtentError::PointNotFinite { .. })
    ));
}
