//! What must hold for any points.
#![allow(clippy::unwrap_used, reason = "tests")]

use geo::{Contains, MultiPolygon, Validation};
use proptest::prelude::*;
use terrace_extent::{Footprint, Mesh, OutlineOptions, PlaneExtent, PlaneFrame, Polygon};
use terrace_types::Plane;

/// Blobs and single points, in pixels.
fn points() -> impl Strategy<Value = Vec<[f64; 2]>> {
    let blob = (-30.0..30.0_f64, -30.0..30.0_f64, 0.5..12.0_f64, 0.5..12.0_f64, any::<bool>());
    let single = prop::collection::vec((-40.0..40.0_f64, -40.0..40.0_f64), 0..40);
    (prop::collection::vec(blob, 0..8), single).prop_map(|(blobs, single)| {
        let mut points: Vec<[f64; 2]> = single.into_iter().map(|(x, y)| [x, y]).collect();
        for (x, y, w, h, round) in blobs {
            for i in -12..=12 {
                for j in -12..=12 {
                    let (u, v) = (f64::from(i) / 12.0, f64::from(j) / 12.0);
                    if !round || (0.3..1.0).contains(&u.hypot(v)) {
                        points.push([x + w * u, y + h * v]);
                    }
                }
            }
        }
        points
    })
}

fn extent(points: &[[f64; 2]], normal: [f64; 3], options: &OutlineOptions) -> PlaneExtent {
    let frame = PlaneFrame::new(&Plane::through([3.0, -2.0, 1.0], normal).unwrap(), [0.0; 3]).unwrap();
    let mut footprint = Footprint::new(frame, 1.0).unwrap();
    for point in points {
        footprint.add(frame.to_world(*point)).unwrap();
    }
    PlaneExtent::of(&footprint, options).unwrap()
}

fn to_geo(polygon: &Polygon) -> geo::Polygon {
    let ring = |ring: &[[f64; 2]]| ring.iter().map(|p| (p[0], p[1])).collect::<geo::LineString>();
    geo::Polygon::new(ring(polygon.outer()), polygon.holes().iter().map(|hole| ring(hole)).collect())
}

fn normals() -> impl Strategy<Value = [f64; 3]> {
    (-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64)
        .prop_filter("a direction", |(x, y, z)| x.hypot(*y).hypot(*z) > 0.1)
        .prop_map(|(x, y, z)| [x, y, z])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn frames_are_right_handed_and_go_back(normal in normals(), point in prop::array::uniform3(-9.0..9.0_f64)) {
        let plane = Plane::through([3.0, -2.0, 1.0], normal).unwrap();
        let frame = PlaneFrame::new(&plane, [5.0, 5.0, 5.0]).unwrap();
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let ([u, v], n) = (frame.axes(), frame.normal());
        for (a, b, expected) in [(u, u, 1.0), (v, v, 1.0), (u, v, 0.0), (u, n, 0.0), (v, n, 0.0)] {
            prop_assert!((dot(a, b) - expected).abs() < 1e-14);
        }
        let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        prop_assert!((dot(cross, n) - 1.0).abs() < 1e-14);
        prop_assert!(plane.signed_distance(frame.origin()).abs() < 1e-14);
        let foot = frame.to_world(frame.to_plane(point));
        let distance = plane.signed_distance(point);
        prop_assert!((0..3).all(|i| (foot[i] + distance * n[i] - point[i]).abs() < 1e-13));
    }

    #[test]
    fn polygons_are_valid_and_their_triangles_cover_them(
        points in points(),
        normal in normals(),
        gap in 0.0..8.0_f64,
        tolerance in 0.0..4.0_f64,
        min_hole_area in prop_oneof![Just(0.0), 0.0..40.0_f64],
        queries in prop::collection::vec((-45.0..45.0_f64, -45.0..45.0_f64), 60),
    ) {
        let options = OutlineOptions {
            gap, min_hole_area, tolerance: Some(tolerance), ..OutlineOptions::closing(gap)
        };
        let extent = extent(&points, normal, &options);
        let all = MultiPolygon::new(extent.polygons().iter().map(to_geo).collect());
        prop_assert!(all.is_valid(), "{:?}", all.check_validation());
        let mut mesh = Mesh::new();
        mesh.add(&extent, [1, 2, 3]).unwrap();
        prop_assert!((mesh.area() - extent.area()).abs() <= 1e-9 * extent.area());
        let corners: Vec<[[f64; 2]; 3]> = mesh
            .triangles()
            .iter()
            .map(|t| t.map(|k| extent.frame().to_plane(mesh.positions()[k as usize])))
            .collect();
        let side = |a: [f64; 2], b: [f64; 2], p: [f64; 2]| {
            (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
        };
        // Counter-clockwise about the normal.
        prop_assert!(corners.iter().all(|[a, b, c]| side(*a, *b, *c) > 0.0));
        for (x, y) in queries {
            let p = [x, y];
            let triangles = corners
                .iter()
                .filter(|[a, b, c]| side(*a, *b, p) > 0.0 && side(*b, *c, p) > 0.0 && side(*c, *a, p) > 0.0)
                .count();
            let inside = all.contains(&geo::Point::new(x, y));
            prop_assert_eq!(triangles, usize::from(inside));
            prop_assert_eq!(extent.polygons().iter().any(|polygon| polygon.contains(p)), inside);
        }
    }

    #[test]
    fn order_makes_no_difference(points in points(), turn in any::<prop::sample::Index>()) {
        let options = OutlineOptions::closing(2.0);
        let first = extent(&points, [0.2, 0.3, 0.4], &options);
        let mut other = points.clone();
        other.reverse();
        if !other.is_empty() {
            let by = turn.index(other.len());
            other.rotate_left(by);
        }
        prop_assert_eq!(first, extent(&other, [0.2, 0.3, 0.4], &options));
    }
}
