//! Texts that name a model, and texts that do not.

// Values are read exactly; a test has no caller to report to.
#![allow(clippy::unwrap_used, clippy::float_cmp)]

use terrace_noise::{
    Kinect, Lidar, PerAxis, PoseNoise, PoseSigma, SensorNoise, Stereo, StereoParameters, Uniform,
};

fn read(text: &str) -> SensorNoise {
    text.parse().unwrap()
}

fn message(text: &str) -> String {
    text.parse::<SensorNoise>().unwrap_err().to_string()
}

#[test]
fn every_model_can_be_named() {
    assert_eq!(read("uniform:0.01"), SensorNoise::Uniform(Uniform::from_metres(0.01).unwrap()));
    assert_eq!(
        read("axes:0.01,0.01,2e-2"),
        SensorNoise::PerAxis(PerAxis::from_metres([0.01, 0.01, 0.02]).unwrap())
    );
    assert_eq!(read("kinect"), SensorNoise::Kinect(Kinect::default()));
    assert_eq!(read("kinect:focal=525"), SensorNoise::Kinect(Kinect::from_focal_pixels(525.0).unwrap()));
    let stereo = StereoParameters { focal_times_baseline: 80.0, disparity: 0.2, focal: 700.0, pixel: 0.5 };
    assert_eq!(
        read("stereo:fb=80,disparity=0.2,focal=700"),
        SensorNoise::Stereo(Stereo::new(stereo).unwrap())
    );
    let stereo = StereoParameters { pixel: 0.25, ..stereo };
    assert_eq!(
        read("stereo: pixel = 0.25, focal=700 ,disparity=0.2,fb=80 "),
        SensorNoise::Stereo(Stereo::new(stereo).unwrap())
    );
    assert_eq!(
        read("lidar:range=0.02,angle=0.1deg,proportional=0.0001"),
        SensorNoise::Lidar(Lidar::from_degrees(0.02, 0.1).unwrap().with_proportional(0.0001).unwrap())
    );
}

#[test]
fn angles_have_units() {
    let angle = |text: &str| match read(&format!("lidar:range=0.02,angle={text}")) {
        SensorNoise::Lidar(lidar) => lidar.angle(),
        other => panic!("{other}"),
    };
    assert_eq!(angle("0.5deg"), 0.5_f64.to_radians());
    assert_eq!(angle("2mrad"), 0.002);
    assert_eq!(angle("0.002 rad"), 0.002);
    assert_eq!(angle("0.002"), 0.002);
}

#[test]
fn what_has_its_default_is_not_written() {
    for text in [
        "uniform:0.01",
        "axes:0.01,0.01,0.02",
        "kinect",
        "kinect:focal=525",
        "stereo:fb=80,disparity=0.2,focal=700",
        "stereo:fb=80,disparity=0.2,focal=700,pixel=0.25",
        "lidar:range=0.02,angle=0.001rad",
        "lidar:range=0.02,angle=0.001rad,proportional=0.0001",
    ] {
        assert_eq!(read(text).to_string(), text);
    }
    assert_eq!(read("kinect:focal=585").to_string(), "kinect");
}

#[test]
fn errors_name_the_key_and_the_value_and_what_is_allowed() {
    for (text, parts) in [
        ("", ["''", "kinect"]),
        ("tof:0.1", ["'tof'", "lidar:range"]),
        ("Kinect", ["'Kinect'", "kinect"]),
        ("uniform", ["uniform takes 1", "''"]),
        ("uniform:0.1,0.2", ["uniform takes 1", "'0.1,0.2'"]),
        ("uniform:thick", ["uniform is 'thick'", "a number"]),
        ("uniform:-0.1", ["uniform is -0.1", "from 0 up"]),
        ("uniform:NaN", ["uniform is NaN", "from 0 up"]),
        ("axes:1,2", ["axes takes 3", "'1,2'"]),
        ("axes:1,2,3,4", ["axes takes 3", "'1,2,3,4'"]),
        ("axes:1,inf,3", ["axes: y is inf", "from 0 up"]),
        ("kinect:focal=0", ["focal is 0", "above 0"]),
        ("kinect:0.1", ["kinect has no key '0.1'", "focal"]),
        ("kinect:focal", ["focal is ''", "a number"]),
        ("kinect:focal=500,", ["kinect has no key ''", "focal"]),
        ("stereo:fb=80,disparity=0.2", ["stereo needs the key 'focal'", "fb, disparity, focal, pixel"]),
        ("stereo:fb=80,disparity=-1,focal=700", ["disparity is -1", "from 0 up"]),
        ("stereo:fb=80,baseline=1", ["no key 'baseline'", "fb, disparity, focal, pixel"]),
        ("lidar", ["lidar needs the key 'range'", "range, angle, proportional"]),
        ("lidar:range=1,range=2,angle=1deg", ["'range' twice", "'2'"]),
        ("lidar:range=0.02,angle=0.1grad", ["angle is '0.1grad'", "deg, mrad or rad"]),
        ("lidar:range=0.02,angle=deg", ["angle is 'deg'", "deg, mrad or rad"]),
        ("lidar:range=0.02,angle=infdeg", ["angle is inf", "from 0 up"]),
        ("lidar:range=0.02,angle=-3deg", ["angle is -3", "from 0 up"]),
        ("lidar:range=0.02,angle=-3mrad", ["angle is -3", "from 0 up"]),
        ("lidar:range=0.02m,angle=1deg", ["range is '0.02m'", "a number"]),
    ] {
        let message = message(text);
        for part in parts {
            assert!(message.contains(part), "{text:?} says {message:?} without {part:?}");
        }
    }
}

#[test]
fn standard_deviations_of_a_pose() {
    let read = |text: &str| text.parse::<PoseSigma>().unwrap();
    let sigma = read("0.02,0.3deg");
    assert_eq!((sigma.translation(), sigma.rotation()), (0.02, 0.3_f64.to_radians()));
    assert_eq!(read(" 0.02 , 5 mrad ").rotation(), 0.005);
    assert_eq!(read("0,0rad").rotation(), 0.0);
    for sigma in [sigma, read("0.1,0.7mrad")] {
        assert_eq!(read(&sigma.to_string()), sigma);
    }
    assert_eq!(PoseNoise::from(sigma), PoseNoise::from_degrees(0.02, 0.3).unwrap());
}

#[test]
fn what_is_no_standard_deviation_of_a_pose() {
    let message = |text: &str| text.parse::<PoseSigma>().unwrap_err().to_string();
    for (text, told) in [
        ("", "T,R"),
        ("0.02", "'0.02' is not T,R"),
        ("0.02,0.3deg,1", "T,R"),
        ("0.02,0.3", "rotation is '0.3'; allowed is a number with deg, mrad or rad"),
        ("0.02,deg", "rotation is 'deg'"),
        ("wide,0.3deg", "translation is 'wide'"),
        ("-0.02,0.3deg", "translation is -0.02"),
        ("0.02,-0.3deg", "rotation is -0.3"),
        ("0.02,infrad", "rotation is inf"),
        ("nan,1mrad", "translation is NaN"),
    ] {
        assert!(message(text).contains(told), "{text}: {}", message(text));
    }
}
