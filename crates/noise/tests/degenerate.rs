//! Points at the sensor, numbers that are none, surfaces seen from their edge, and ends of the range of numbers.

// A test has no caller to report to; results are exact.
#![allow(clippy::unwrap_used, clippy::float_cmp)]

use std::f64::consts::FRAC_PI_2;

use terrace_noise::{
    CommonNoise, Covariance, Kinect, ParameterError, PointNoise, PoseNoise, PoseNoiseError, ScanNoise,
    ScanNoiseError, SensorNoise, Sight, Uniform, jacobian,
};

const NOT_FINITE: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

fn read(text: &str) -> SensorNoise {
    text.parse().unwrap()
}

fn all() -> [SensorNoise; 5] {
    [
        "uniform:0.01",
        "axes:1,2,3",
        "kinect",
        "stereo:fb=80,disparity=0.2,focal=700",
        "lidar:range=0.02,angle=1mrad",
    ]
    .map(read)
}

#[test]
fn no_ray_leads_nowhere() {
    assert_eq!(Sight::new([1.0; 3], [1.0; 3]), None);
    assert_eq!(Sight::new([0.0; 3], [f64::MIN_POSITIVE / 4.0, 0.0, 0.0]), None);
    assert_eq!(Sight::new([f64::MAX, 0.0, 0.0], [f64::MIN, 0.0, 0.0]), None);
    let sight = Sight::new([0.0; 3], [1.0, 0.0, 0.0]).unwrap();
    for bad in NOT_FINITE {
        for i in 0..3 {
            let mut place = [1.0; 3];
            place[i] = bad;
            assert_eq!(Sight::new([0.0; 3], place), None);
            assert_eq!(Sight::new(place, [0.0; 3]), None);
            assert_eq!(sight.with_axis(place), None);
            assert_eq!(sight.with_normal(place), None);
            assert_eq!(PointNoise { axial: 1.0, lateral: 1.0 }.covariance(place), None);
            assert_eq!(Covariance::isotropic(1.0).along(place), None);
            assert_eq!(jacobian([0.0; 3], place), None);
            assert_eq!(CommonNoise::new(None, Some(0.1)).unwrap().at(place, [0.0; 3]), None);
        }
        assert_eq!(sight.with_incidence(bad), None);
    }
    assert_eq!(sight.with_axis([0.0; 3]), None);
    assert_eq!(sight.with_normal([0.0; 3]), None);
    assert_eq!(PointNoise { axial: 1.0, lateral: 1.0 }.covariance([0.0; 3]), None);
    assert_eq!(sight.with_incidence(-0.1), None);
    assert_eq!(sight.with_incidence(1.58), None);
}

#[test]
fn absent_points_have_no_noise_and_points_at_the_sensor_only_what_needs_no_ray() {
    for noise in all() {
        let scan = ScanNoise::new(noise, Some([1.0; 3])).unwrap();
        assert_eq!(scan.covariance([1.0; 3]), noise.constant(), "{noise}");
        assert_eq!(scan.covariance_on([1.0; 3], [0.0, 0.0, 1.0]), noise.constant());
        for bad in NOT_FINITE {
            assert_eq!(scan.covariance([0.0, bad, 0.0]), None);
        }
        assert_eq!(scan.covariances([]).count(), 0);
    }
}

#[test]
fn a_scan_without_a_sensor_takes_only_models_that_need_none() {
    for noise in all() {
        let scan = ScanNoise::new(noise, None);
        if noise.needs_sensor() {
            assert_eq!(scan, Err(ScanNoiseError::SensorUnknown { noise }));
        } else {
            assert_eq!(scan.unwrap().covariance([3.0; 3]), noise.constant());
        }
        assert!(ScanNoise::new(noise, Some([f64::NAN, 0.0, 0.0])).is_err());
        assert!(ScanNoise::new(noise, Some([0.0; 3])).unwrap().with_axis([0.0; 3]).is_err());
    }
}

#[test]
fn a_surface_seen_from_its_edge_has_no_kinect_noise() {
    let kinect = Kinect::default();
    assert_eq!(kinect.axial(1.0, Some(FRAC_PI_2)), None);
    assert_eq!(kinect.lateral(1.0, Some(FRAC_PI_2)), None);
    let sight = Sight::new([0.0; 3], [0.0, 0.0, 1.0]).unwrap().with_incidence(FRAC_PI_2).unwrap();
    assert_eq!(kinect.covariance(&sight), None);
    // One step before, the formula gives what it gives.
    let nearly = kinect.axial(1.0, Some(FRAC_PI_2.next_down())).unwrap();
    assert!(nearly.is_finite() && nearly > 1e20);
    // A lidar does not ask for the angle.
    assert!(read("lidar:range=0.02,angle=1mrad").covariance(&sight).is_some());
}

#[test]
fn an_unknown_normal_leaves_the_noise_of_an_unknown_normal() {
    let scan = ScanNoise::new(read("kinect"), Some([0.0; 3])).unwrap();
    let point = [0.0, 0.3, 2.0];
    assert_eq!(scan.covariance_on(point, [f64::NAN; 3]), scan.covariance(point));
    assert_ne!(scan.covariance_on(point, [0.0, 1.0, 1.0]), scan.covariance(point));
}

#[test]
fn near_the_kinect_the_formula_goes_on() {
    let kinect = Kinect::default();
    assert!((kinect.axial(0.1, None).unwrap() - 0.001_371).abs() < 1e-15);
    assert!(kinect.axial(f64::MIN_POSITIVE, Some(1.0)).unwrap().is_finite());
    for z in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e200] {
        assert_eq!(kinect.axial(z, None), None, "{z}");
    }
    assert!(!kinect.valid_depths().contains(&0.1) && kinect.valid_depths().contains(&2.0));
}

#[test]
fn what_is_behind_a_camera_has_no_noise() {
    for noise in [read("kinect"), read("stereo:fb=80,disparity=0.2,focal=700")] {
        let scan = ScanNoise::new(noise, Some([0.0; 3])).unwrap().with_axis([0.0, 0.0, 1.0]).unwrap();
        assert!(scan.covariance([1.0, 0.0, 0.1]).is_some());
        assert_eq!(scan.covariance([1.0, 0.0, 0.0]), None);
        assert_eq!(scan.covariance([1.0, 0.0, -1.0]), None);
    }
}

#[test]
fn huge_ranges_have_a_finite_noise_or_none() {
    for noise in all() {
        for size in [1e7, 1e76, 1e154, 1e200, 1e307] {
            let sight = Sight::new([0.0; 3], [size, size, 0.0]).unwrap();
            if let Some(covariance) = noise.covariance(&sight) {
                assert!(covariance.entries().iter().all(|x| x.is_finite()), "{noise} at {size}");
            }
        }
        assert!(noise.covariance(&Sight::new([0.0; 3], [1e7, 1e7, 0.0]).unwrap()).is_some());
    }
    assert_eq!(Uniform::from_metres(1e200).map(SensorNoise::Uniform).unwrap().constant(), None);
}

#[test]
fn no_error_at_all_is_a_model_too() {
    for text in
        ["uniform:0", "axes:0,0,0", "stereo:fb=1,disparity=0,focal=1,pixel=0", "lidar:range=0,angle=0"]
    {
        let sight = Sight::new([0.0; 3], [1.0, 2.0, 3.0]).unwrap();
        let covariance = read(text).covariance(&sight).unwrap();
        assert!(covariance.entries().iter().all(|x| *x == 0.0), "{text}");
    }
}

#[test]
fn a_pose_covariance_that_is_none_is_refused_with_its_place() {
    let good = PoseNoise::from_radians(0.1, 0.01).unwrap().covariance();
    assert_eq!(PoseNoise::from_covariance(good).unwrap().covariance(), good);
    assert!(PoseNoise::from_covariance([[0.0; 6]; 6]).is_ok(), "an exact pose");

    let with = |row: usize, column: usize, value: f64| {
        let mut covariance = good;
        covariance[row][column] = value;
        PoseNoise::from_covariance(covariance).unwrap_err()
    };
    assert!(matches!(with(2, 4, f64::NAN), PoseNoiseError::NotFinite { row: 2, column: 4, .. }));
    assert_eq!(with(3, 3, -1.0), PoseNoiseError::NegativeVariance { index: 3, value: -1.0 });
    let skew = PoseNoiseError::NotSymmetric { row: 4, column: 1, lower: 1e-4, upper: 0.0 };
    assert_eq!(with(4, 1, 1e-4), skew);

    let mut covariance = good;
    (covariance[0][5], covariance[5][0]) = (0.0011, 0.0011);
    let refused = PoseNoise::from_covariance(covariance).unwrap_err();
    assert!(
        matches!(refused, PoseNoiseError::NotSemidefinite { defect } if (defect - 0.1).abs() < 1e-9),
        "{refused}"
    );

    // Without variance there is no covariance, however small the one and large the other.
    for (variance, entry) in [(0.0, 1e-30), (0.0, 1e300), (1e-300, 1e300), (5e-324, -1.0)] {
        let mut covariance = good;
        covariance[5][5] = variance;
        (covariance[0][5], covariance[5][0]) = (entry, entry);
        let refused = PoseNoise::from_covariance(covariance);
        assert!(matches!(refused, Err(PoseNoiseError::NotSemidefinite { .. })), "{variance} {entry}");
    }
}

#[test]
fn a_matrix_that_does_not_rotate_is_refused() {
    let covariance = [[0.0; 6]; 6];
    let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    assert!(PoseNoise::from_sensor_frame(covariance, identity).is_ok());
    for value in [-1.0, 1.1, 0.0, f64::NAN, f64::INFINITY] {
        let mut matrix = identity;
        matrix[1][1] = value;
        let refused = PoseNoise::from_sensor_frame(covariance, matrix);
        assert!(matches!(refused, Err(PoseNoiseError::NotARotation { .. })), "{value}: {refused:?}");
    }
}

#[test]
fn parameters_are_refused_by_name() {
    let refused = PoseNoise::from_radians(0.1, -1.0).unwrap_err();
    assert_eq!(refused, ParameterError::NotADeviation { name: "rotation", value: -1.0 });
    let refused = CommonNoise::new(None, Some(-0.5)).unwrap_err();
    assert_eq!(refused.to_string(), "floor is -0.5; allowed is any finite number from 0 up");
    assert_eq!(
        Kinect::from_focal_pixels(0.0),
        Err(ParameterError::NotPositive { name: "focal", value: 0.0 })
    );
}
