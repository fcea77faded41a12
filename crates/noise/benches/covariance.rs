//! Covariances of the points of one depth image, and of a pose.

// A bench has no caller to report to.
#![allow(clippy::unwrap_used)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use terrace_noise::{PoseNoise, ScanNoise, SensorNoise};

/// The points of a slanted wall, as a depth image of 640×480.
fn image() -> Vec<[f64; 3]> {
    (0..480)
        .flat_map(|v| (0..640).map(move |u| (f64::from(u - 320) / 585.0, f64::from(v - 240) / 585.0)))
        .map(|(x, y)| {
            let z = 2.0 / (1.0 - 0.5 * x);
            [x * z, y * z, z]
        })
        .collect()
}

fn covariance(c: &mut Criterion) {
    let points = image();
    for text in
        ["uniform:0.01", "kinect", "stereo:fb=80,disparity=0.2,focal=700", "lidar:range=0.02,angle=1mrad"]
    {
        let noise: SensorNoise = text.parse().unwrap();
        let scan = ScanNoise::new(noise, Some([0.0; 3])).unwrap().with_axis([0.0, 0.0, 1.0]).unwrap();
        c.bench_function(&format!("640x480 points/{text}"), |b| {
            b.iter(|| {
                let covariances = scan.covariances(black_box(&points).iter().copied());
                covariances.flatten().map(|covariance| covariance.entries()[5]).sum::<f64>()
            });
        });
    }
    let pose = PoseNoise::from_radians(0.01, 0.001).unwrap();
    c.bench_function("640x480 points/pose", |b| {
        b.iter(|| {
            let all = black_box(&points).iter().filter_map(|point| pose.at([0.0; 3], *point));
            all.map(|covariance| covariance.entries()[5]).sum::<f64>()
        });
    });
}

criterion_group!(benches, covariance);
criterion_main!(benches);
