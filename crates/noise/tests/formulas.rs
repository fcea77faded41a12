//! The models against values worked out by hand from their sources.

// A test has no caller to report to.
#![allow(clippy::unwrap_used)]

use std::f64::consts::{FRAC_PI_3, FRAC_PI_4, FRAC_PI_6};

use terrace_noise::{CommonNoise, Kinect, Lidar, PoseNoise, SensorNoise, Sight, Stereo, StereoParameters};

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12
}

/// θ/(π/2 − θ) is ½ at 30°, 1 at 45°, 2 at 60°, so that all terms are round numbers.
#[test]
fn the_kinect_along_the_ray() {
    let kinect = Kinect::default();
    for (z, incidence, sigma) in [
        (0.4, None, 0.0012),
        (1.4, None, 0.0031),
        (2.4, None, 0.0088),
        (3.4, None, 0.0183),
        (1.0, Some(0.0), 0.001_884),
        (1.0, Some(FRAC_PI_6), 0.001_909),
        (1.0, Some(FRAC_PI_4), 0.001_984),
        (1.0, Some(FRAC_PI_3), 0.002_284),
        // 0.0012 + 0.0019 · 12.96 + 0.00005 · 4
        (4.0, Some(FRAC_PI_3), 0.026_024),
        // 80°: (80/10)² = 64; 0.0012 + 0.0019 · 0.36 + 0.0064
        (1.0, Some(80_f64.to_radians()), 0.008_284),
    ] {
        let found = kinect.axial(z, incidence).unwrap();
        assert!(close(found, sigma), "at {z} m and {incidence:?}: {found} instead of {sigma}");
    }
}

#[test]
fn without_an_incidence_the_kinect_is_the_quadratic_alone_to_the_last_bit() {
    for millimetres in 1..=u16::MAX {
        let z = f64::from(millimetres) / 1000.0;
        let quadratic = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4);
        assert_eq!(Kinect::default().axial(z, None).unwrap().to_bits(), quadratic.to_bits(), "{z}");
    }
}

#[test]
fn the_kinect_across_the_ray() {
    let kinect = Kinect::from_focal_pixels(500.0).unwrap();
    for (z, incidence, pixels) in [
        (1.0, None, 0.8),
        (3.0, Some(0.0), 0.8),
        (1.0, Some(FRAC_PI_6), 0.8175),
        (2.0, Some(FRAC_PI_4), 0.835),
        (2.0, Some(FRAC_PI_3), 0.87),
    ] {
        assert!(
            close(kinect.lateral(z, incidence).unwrap(), pixels * z / 500.0),
            "at {z} m and {incidence:?}"
        );
    }
}

#[test]
fn a_normal_gives_the_incidence_from_either_side() {
    let sight = Sight::new([0.0; 3], [0.0, 0.0, 1.0]).unwrap();
    for normal in [[0.0, 1.0, 1.0], [0.0, -3.0, -3.0]] {
        assert!(close(sight.with_normal(normal).unwrap().incidence().unwrap(), FRAC_PI_4));
    }
    assert!(close(sight.with_normal([0.0, 2.0, 0.0]).unwrap().incidence().unwrap(), 2.0 * FRAC_PI_4));
}

/// A camera of 50 mm baseline and f = 640 px that matches to 0.1 px: 0.1 / (640 · 0.05) = 1/320 of z² .
#[test]
fn stereo() {
    let parameters =
        StereoParameters { focal_times_baseline: 32.0, disparity: 0.1, focal: 640.0, pixel: 0.5 };
    let stereo = Stereo::new(parameters).unwrap();
    let noise = stereo.at(&Sight::new([1.0; 3], [1.0, 1.0, 3.0]).unwrap()).unwrap();
    assert!(close(noise.axial, 0.0125) && close(noise.lateral, 0.001_562_5), "{noise:?}");
    assert!(close(*stereo.valid_depths().end(), 32.0));
}

#[test]
fn off_the_middle_of_the_image_an_error_of_depth_goes_along_the_slanted_ray() {
    let text = "stereo:fb=100,disparity=0.1,focal=500,pixel=0";
    let noise: SensorNoise = text.parse().unwrap();
    let sight = Sight::new([0.0; 3], [3.0, 0.0, 4.0]).unwrap().with_axis([0.0, 0.0, 1.0]).unwrap();
    // σ_z = 16 · 0.001; along the ray it is 5/4 of that, across there is nothing.
    let covariance = noise.covariance(&sight).unwrap();
    assert!(close(covariance.along([0.0, 0.0, 1.0]).unwrap().sqrt(), 0.016));
    assert!(close(covariance.along([3.0, 0.0, 4.0]).unwrap().sqrt(), 0.020));
    assert!(covariance.along([4.0, 0.0, -3.0]).unwrap() < 1e-18);

    // And an error in the image goes along the image.
    let noise: SensorNoise = "stereo:fb=100,disparity=0,focal=500,pixel=1".parse().unwrap();
    let [xx, xy, xz, yy, yz, zz] = noise.covariance(&sight).unwrap().entries();
    assert!(close(xx.sqrt(), 0.008) && close(yy.sqrt(), 0.008));
    assert!([xy, xz, yz, zz].iter().all(|entry| close(*entry, 0.0)));
}

#[test]
fn a_lidar() {
    let lidar = Lidar::from_degrees(0.02, 0.1).unwrap();
    let noise = lidar.at(&Sight::new([0.0; 3], [0.0, 100.0, 0.0]).unwrap()).unwrap();
    assert!(close(noise.axial, 0.02));
    // 100 m times 0.1°, that is π/18 m.
    assert!(close(noise.lateral, 0.174_532_925_199_432_96));
}

#[test]
fn a_lidar_looks_at_no_axis() {
    let lidar = Lidar::from_radians(0.02, 0.001).unwrap();
    let sight = Sight::new([0.0; 3], [-5.0, 2.0, 1.0]).unwrap();
    assert_eq!(lidar.covariance(&sight), lidar.covariance(&sight.with_axis([1.0, 0.0, 0.0]).unwrap()));
}

#[test]
fn a_pose_moves_points_by_the_length_of_the_lever() {
    let pose = PoseNoise::from_degrees(0.0, 1.0).unwrap();
    let [x, y, z] = pose.at([1.0, 0.0, 0.0], [1.0, 0.0, 10.0]).unwrap().deviations();
    let arc = 10.0 * 1_f64.to_radians();
    assert!(close(x, arc) && close(y, arc) && close(z, 0.0));

    let common = CommonNoise::new(Some(pose), Some(0.01)).unwrap();
    let [x, _, z] = common.at([1.0, 0.0, 0.0], [1.0, 0.0, 10.0]).unwrap().deviations();
    assert!(close(x, arc.hypot(0.01)) && close(z, 0.01));
}
