//! Input at the edge of what has a meaning: refused with its values, or a defined result.

// Values are handed through unchanged, so they are compared exactly; a test has no caller to report to.
#![allow(clippy::float_cmp, clippy::unwrap_used)]

use terrace_types::{
    Frame, MAX_ROTATION_DEVIATION, Plane, PlaneError, PlaneId, Pose, PoseError, Scan, ScanError, Sigma,
    SigmaError,
};

const NAN: f64 = f64::NAN;
const INF: f64 = f64::INFINITY;
const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const WORLD: Frame = Frame::World { sensor: None };

#[test]
fn a_scan_of_no_points() {
    for sigma in [Sigma::Unknown, Sigma::Uniform(0.1), Sigma::PerPoint(vec![]), Sigma::PerAxis(vec![])] {
        let scan = Scan::new(vec![], sigma, WORLD).unwrap();
        assert!(scan.is_empty());
        assert_eq!((scan.len(), scan.present(), scan.world_points().len()), (0, 0, 0));
        assert_eq!(scan.world_point(0), None);
    }
}

#[test]
fn a_scan_of_one_point() {
    let scan = Scan::new(vec![[1.0, 2.0, 3.0]], Sigma::PerPoint(vec![0.5]), WORLD).unwrap();
    let point = scan.world_point(0).unwrap();
    assert_eq!((point.position, point.sigma), ([1.0, 2.0, 3.0], Some([0.5; 3])));
    assert_eq!(scan.world_point(1), None);
    assert_eq!(scan.sensor_position(), None);
}

#[test]
fn equal_points_stay_as_many() {
    let scan = Scan::new(vec![[1.0; 3]; 4], Sigma::Unknown, WORLD).unwrap();
    assert_eq!(scan.world_points().flatten().filter(|p| p.position == [1.0; 3]).count(), 4);
}

#[test]
fn a_point_with_one_bad_coordinate_is_absent() {
    for bad in [NAN, INF, -INF] {
        for axis in 0..3 {
            let mut point = [1.0; 3];
            point[axis] = bad;
            let scan = Scan::new(vec![point, [2.0; 3]], Sigma::Uniform(0.1), WORLD).unwrap();
            assert_eq!((scan.len(), scan.present()), (2, 1));
            assert_eq!(scan.world_points().map(|p| p.is_some()).collect::<Vec<_>>(), [false, true]);
        }
    }
}

#[test]
fn errors_of_other_number_than_points() {
    for (sigma, sigmas) in [
        (Sigma::PerPoint(vec![0.1; 3]), 3),
        (Sigma::PerPoint(vec![]), 0),
        (Sigma::PerAxis(vec![[0.1; 3]]), 1),
    ] {
        let refused = SigmaError::CountMismatch { sigmas, points: 2 };
        assert_eq!(Scan::new(vec![[0.0; 3]; 2], sigma.clone(), WORLD), Err(ScanError::Sigma(refused)));
        let scan = Scan::new(vec![[0.0; 3]; 2], Sigma::Unknown, WORLD).unwrap();
        assert_eq!(scan.with_sigma(sigma), Err(refused));
    }
}

#[test]
fn a_bad_error_of_a_present_point_is_refused() {
    for bad in [-0.1, -f64::MIN_POSITIVE, INF] {
        let points = vec![[0.0; 3]; 3];
        let per_point = Sigma::PerPoint(vec![0.1, bad, 0.1]);
        let refused = SigmaError::NotAStandardError { point: 1, value: bad };
        assert_eq!(Scan::new(points.clone(), per_point, WORLD), Err(refused.into()));
        for axis in 0..3 {
            let mut sigma = [0.1; 3];
            sigma[axis] = bad;
            let per_axis = Sigma::PerAxis(vec![[0.1; 3], [0.1; 3], sigma]);
            let refused = SigmaError::NotAStandardError { point: 2, value: bad };
            assert_eq!(Scan::new(points.clone(), per_axis, WORLD), Err(refused.into()));
        }
        let refused = SigmaError::NotAStandardError { point: 0, value: bad };
        assert_eq!(Scan::new(points, Sigma::Uniform(bad), WORLD), Err(refused.into()));
    }
    let nan = Scan::new(vec![[0.0; 3]], Sigma::PerPoint(vec![NAN]), WORLD);
    assert!(
        matches!(nan, Err(ScanError::Sigma(SigmaError::NotAStandardError { point: 0, value })) if value.is_nan())
    );
}

#[test]
fn a_bad_covariance_of_a_present_point_is_refused() {
    let scan = |entries: [f64; 6], x: f64| {
        let sigma = Sigma::Covariance(vec![[0.0; 6], entries]);
        Scan::new(vec![[0.0; 3], [x; 3]], sigma, Frame::World { sensor: None })
    };
    for bad in [
        [f64::NAN, 0.0, 0.0, 1.0, 0.0, 1.0],
        [1.0, 0.0, 0.0, f64::INFINITY, 0.0, 1.0],
        [1.0, 0.0, 0.0, 1.0, 0.0, -1e-9],
        [1.0, 1.1, 0.0, 1.0, 0.0, 1.0],
        // Each pair of axes could be, all three cannot.
        [1.0, -0.9, -0.9, 1.0, -0.9, 1.0],
    ] {
        let error = scan(bad, 1.0).unwrap_err();
        assert!(matches!(error, ScanError::Sigma(SigmaError::NotACovariance { point: 1, .. })), "{error}");
        assert!(scan(bad, f64::NAN).is_ok());
    }
    assert!(scan([0.0; 6], 1.0).is_ok());
    assert_eq!(
        scan([4.0, 0.0, 0.0, 9.0, 0.0, 1.0], 1.0).unwrap().world_point(1).unwrap().sigma,
        Some([2.0, 3.0, 1.0])
    );
    let few = Scan::new(vec![[0.0; 3]], Sigma::Covariance(vec![]), Frame::World { sensor: None });
    assert_eq!(few, Err(ScanError::Sigma(SigmaError::CountMismatch { sigmas: 0, points: 1 })));
}

#[test]
fn a_bad_error_of_an_absent_point_is_tolerated() {
    let points = vec![[NAN; 3], [0.0; 3]];
    for bad in [-1.0, NAN, INF] {
        let scan = Scan::new(points.clone(), Sigma::PerPoint(vec![bad, 0.1]), WORLD).unwrap();
        assert_eq!(scan.world_point(0), None);
        assert_eq!(scan.world_point(1).unwrap().sigma, Some([0.1; 3]));
        assert!(Scan::new(points.clone(), Sigma::PerAxis(vec![[bad; 3], [0.1; 3]]), WORLD).is_ok());
    }
}

#[test]
fn errors_of_zero_and_of_a_thousand_kilometres_are_errors() {
    assert!(Sigma::is_valid(0.0) && Sigma::is_valid(1e6) && !Sigma::is_valid(-1e-9));
    assert!(Scan::new(vec![[0.0; 3]; 2], Sigma::PerPoint(vec![0.0, 1e6]), WORLD).is_ok());
}

#[test]
fn beyond_the_end_there_is_no_error() {
    assert_eq!(Sigma::Unknown.of(0), None);
    assert_eq!(Sigma::PerPoint(vec![0.1]).of(1), None);
    assert_eq!(Sigma::PerAxis(vec![]).of(0), None);
}

#[test]
fn a_sensor_nowhere_is_refused() {
    for bad in [NAN, INF] {
        let frame = Frame::World { sensor: Some([0.0, bad, 0.0]) };
        let refused = Scan::new(vec![], Sigma::Unknown, frame).unwrap_err();
        assert!(matches!(refused, ScanError::SensorNotFinite { position } if position[0] == 0.0));
    }
}

#[test]
fn a_normal_without_direction_is_refused() {
    for normal in
        [[0.0; 3], [-0.0; 3], [1e-320, 0.0, 0.0], [NAN, 1.0, 0.0], [0.0, INF, 1.0], [0.0, 0.0, -INF]]
    {
        let refused = Plane::through([0.0; 3], normal);
        assert!(matches!(refused, Err(PlaneError::NoDirection { .. })), "{normal:?} gave {refused:?}");
    }
}

#[test]
fn a_normal_of_any_length_is_made_a_unit_one() {
    // Squares of these entries underflow or overflow.
    for length in [1e-307, 1e-160, 1e-155, 1.0, 1e155, 1e307] {
        let plane = Plane::through([0.0; 3], [3.0 * length, 0.0, -4.0 * length]).unwrap();
        let [x, y, z] = plane.normal();
        assert!((x - 0.6).abs() < 1e-15 && y == 0.0 && (z + 0.8).abs() < 1e-15, "{length:e} gave {plane:?}");
    }
}

#[test]
fn a_plane_through_no_point_is_refused() {
    for point in [[NAN, 0.0, 0.0], [0.0, INF, 0.0], [f64::MAX; 3]] {
        // The last is a point, but its distance from the origin is beyond f64.
        let refused = Plane::through(point, [1.0, 1.0, 1.0]);
        assert!(matches!(refused, Err(PlaneError::PointNotFinite { .. })), "{point:?} gave {refused:?}");
    }
}

#[test]
fn plane_numbers_end_where_signed_labels_end() {
    let last = i32::MAX.cast_unsigned();
    assert_eq!(PlaneId::new(0), None);
    assert_eq!(PlaneId::new(last).map(PlaneId::get), Some(last));
    assert_eq!(PlaneId::label(PlaneId::new(last)), i32::MAX);
    assert_eq!(PlaneId::new(last + 1), None);
    assert_eq!(PlaneId::new(u32::MAX), None);
    assert_eq!(PlaneId::from_index(last as usize - 1), PlaneId::new(last));
    assert_eq!(PlaneId::from_index(last as usize), None);
    assert_eq!(PlaneId::from_index(usize::MAX), None);
    assert_eq!(PlaneId::from_index(usize::MAX - 1), None);
    assert_eq!(PlaneId::from_index(7).map(PlaneId::index), Some(7));
    assert_eq!(PlaneId::label(None), 0);
    assert_eq!(PlaneId::new(17).unwrap().to_string(), "17");
}

#[test]
fn a_nearly_orthonormal_matrix_is_accepted_up_to_the_limit() {
    // Scaled by s, every row's square is s² instead of 1; sheared by h, two rows have the product h.
    let scaled = |s: f64| Pose::new(IDENTITY.map(|row| row.map(|x| x * s)), [0.0; 3]);
    let sheared = |h: f64| Pose::new([[1.0, 0.0, 0.0], [h, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]);
    for part in [-0.99, 0.5, 0.99] {
        let deviation = part * MAX_ROTATION_DEVIATION;
        for pose in [scaled((1.0 + deviation).sqrt()), sheared(deviation)] {
            assert_eq!(pose.unwrap().rotation().map(|row| row.map(|x| (x * 1e12).round() / 1e12)), IDENTITY);
        }
    }
    for part in [-1.01, 1.01, 100.0] {
        let deviation = part * MAX_ROTATION_DEVIATION;
        for pose in [scaled((1.0 + deviation).sqrt()), sheared(deviation)] {
            let Err(PoseError::NotARotation { deviation: found }) = pose else {
                panic!("{part} gave {pose:?}")
            };
            assert!((found - deviation.abs()).abs() < 1e-12, "{found} instead of {deviation}");
        }
    }
}

#[test]
fn each_pair_of_rows_is_looked_at() {
    // Of length 1 all three, so that only their product tells.
    for (row, column) in [(0, 1), (0, 2), (1, 2)] {
        let mut m = IDENTITY;
        (m[row][row], m[row][column]) = (0.8, 0.6);
        assert!(matches!(Pose::new(m, [0.0; 3]), Err(PoseError::NotARotation { .. })));
    }
    for row in 0..3 {
        let mut m = IDENTITY;
        m[row][row] = 1.1;
        assert!(matches!(Pose::new(m, [0.0; 3]), Err(PoseError::NotARotation { .. })));
    }
}

#[test]
fn matrices_that_do_not_rotate_are_refused() {
    assert!(matches!(Pose::new([[0.0; 3]; 3], [0.0; 3]), Err(PoseError::NotARotation { deviation: 1.0 })));
    assert!(matches!(Pose::new([[1e300; 3]; 3], [0.0; 3]), Err(PoseError::NotARotation { .. })));
}

#[test]
fn mirrored_matrices_are_refused() {
    for axis in 0..3 {
        let mut m = IDENTITY;
        m[axis][axis] = -1.0;
        assert_eq!(Pose::new(m, [0.0; 3]), Err(PoseError::Mirrored));
    }
    let exchanged = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    assert_eq!(Pose::new(exchanged, [0.0; 3]), Err(PoseError::Mirrored));
}

#[test]
fn entries_that_are_no_numbers_are_refused() {
    for bad in [NAN, INF, -INF] {
        let mut m = IDENTITY;
        m[1][2] = bad;
        for refused in [
            Pose::new(m, [0.0; 3]),
            Pose::new(IDENTITY, [0.0, bad, 0.0]),
            Pose::from_quaternion([0.0, 0.0, bad], [0.0, 0.0, 0.0, 1.0]),
            Pose::from_quaternion([0.0; 3], [bad, 0.0, 0.0, 1.0]),
        ] {
            let Err(PoseError::NotFinite { value }) = refused else { panic!("{refused:?}") };
            assert_eq!(value.to_bits(), bad.to_bits());
        }
    }
}

#[test]
fn a_zero_quaternion_is_refused() {
    for quaternion in [[0.0; 4], [-0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1e-320]] {
        let refused = Pose::from_quaternion([0.0; 3], quaternion);
        assert_eq!(refused, Err(PoseError::ZeroQuaternion { quaternion }));
    }
}

#[test]
fn a_quaternion_may_have_any_length_and_either_sign() {
    let pose = |scale: f64| {
        Pose::from_quaternion([0.0; 3], [1.0, -2.0, 3.0, 4.0].map(|q| q * scale)).unwrap().rotation()
    };
    for scale in [-1.0, 1e-300, 1e-160, 1e-5, 1e160, -1e300] {
        for (row, unit_row) in pose(scale).iter().zip(pose(1.0)) {
            for (entry, unit_entry) in row.iter().zip(unit_row) {
                assert!((entry - unit_entry).abs() < 1e-15, "scale {scale:e}");
            }
        }
    }
}

#[test]
fn the_last_row_of_a_matrix_is_that_of_a_rigid_motion() {
    let matrix = |row| [[1.0, 0.0, 0.0, 4.0], [0.0, 1.0, 0.0, 5.0], [0.0, 0.0, 1.0, 6.0], row];
    for row in [[0.0, 0.0, 0.0, 1.0], [1e-10, 0.0, 0.0, 1_700_000_000.0], [0.0, 0.0, 0.0, NAN]] {
        assert_eq!(Pose::from_matrix(matrix(row)).unwrap().translation(), [4.0, 5.0, 6.0]);
    }
    for row in [[0.1, 0.0, 0.0, 1.0], [0.0, -1e-3, 0.0, 1.0], [0.0, 0.0, INF, 1.0]] {
        assert_eq!(Pose::from_matrix(matrix(row)), Err(PoseError::NotRigid { row }));
    }
    assert!(matches!(Pose::from_matrix(matrix([0.0, NAN, 0.0, 1.0])), Err(PoseError::NotRigid { .. })));
}

#[test]
fn errors_name_what_they_refuse() {
    let text = |error: &dyn std::error::Error| error.to_string();
    assert_eq!(
        text(&Scan::new(vec![[0.0; 3]; 2], Sigma::PerPoint(vec![0.1, -0.5]), WORLD).unwrap_err()),
        "the standard error -0.5 of point 1 is not a finite number of metres from 0 up"
    );
    assert_eq!(
        text(&Plane::through([0.0; 3], [0.0; 3]).unwrap_err()),
        "the normal (0, 0, 0) has no direction"
    );
    let twice = Pose::new(IDENTITY.map(|row| row.map(|x| 2.0 * x)), [0.0; 3]).unwrap_err();
    assert_eq!(
        text(&twice),
        "the 3x3 part of the pose is not a rotation: it is 3 away from one (at most 0.001)"
    );
}

#[test]
fn a_pose_moves_without_a_rounding_of_its_rotation() {
    let pose = Pose::from_quaternion([1.0, 2.0, 3.0], [0.1, -0.2, 0.3, 0.9]).unwrap();
    let moved = pose.translated([0.5, -2.0, 4.0]).unwrap();
    assert_eq!((moved.rotation(), moved.translation()), (pose.rotation(), [1.5, 0.0, 7.0]));
    assert_eq!(pose.translated([0.0; 3]), Ok(pose));
    for nowhere in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(matches!(pose.translated([0.0, nowhere, 0.0]), Err(PoseError::NotFinite { .. })));
    }
    let far = pose.translated([f64::MAX, 0.0, 0.0]).unwrap();
    assert!(matches!(far.translated([f64::MAX, 0.0, 0.0]), Err(PoseError::NotFinite { .. })));
}
