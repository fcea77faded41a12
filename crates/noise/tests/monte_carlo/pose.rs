//! Poses with errors, correlated among each other, seen at a point.

use terrace_noise::{PoseNoise, jacobian};

use crate::{TOLERANCE, add, agrees, apply, normal, rng, rotation, turned};

const SENSOR: [f64; 3] = [100.0, 50.0, -3.0];
const TURN: [f64; 3] = [0.3, 2.0, -0.7];

/// A mix of six independent errors; rotations of about a hundredth of a radian.
const MIX: [[f64; 6]; 6] = [
    [0.020, 0.0, 0.0, 0.005, 0.0, 0.0],
    [0.004, 0.030, 0.0, 0.0, -0.010, 0.0],
    [0.0, 0.006, 0.010, 0.0, 0.0, 0.008],
    [0.003, 0.0, 0.0, 0.008, 0.0, 0.0],
    [0.0, -0.004, 0.002, 0.0, 0.005, 0.0],
    [0.0, 0.0, 0.006, -0.001, 0.0, 0.010],
];

fn covariance() -> [[f64; 6]; 6] {
    MIX.map(|a| MIX.map(|b| a.iter().zip(b).map(|(x, y)| x * y).sum()))
}

/// One error of a pose: translation and rotation.
fn draw(rng: &mut rand::rngs::ChaCha8Rng) -> ([f64; 3], [f64; 3]) {
    let white = [0; 6].map(|_| normal(rng));
    let [a, b, c, d, e, f] = MIX.map(|row| row.iter().zip(white).map(|(x, y)| x * y).sum());
    ([a, b, c], [d, e, f])
}

#[test]
fn poses_perturbed_along_the_world_scatter_a_point_as_predicted() {
    let noise = PoseNoise::from_covariance(covariance()).unwrap();
    for (seed, lever) in [(1, [0.0; 3]), (2, [5.0, -1.0, 2.0]), (3, [-0.3, 40.0, 3.0])] {
        let mut rng = rng(seed);
        agrees(noise.at(SENSOR, add(SENSOR, lever)).unwrap(), TOLERANCE, || {
            let (translation, omega) = draw(&mut rng);
            add(add(SENSOR, translation), turned(omega, lever))
        });
    }
}

#[test]
fn poses_perturbed_along_the_sensor_scatter_a_point_as_predicted() {
    let noise = PoseNoise::from_sensor_frame(covariance(), rotation(TURN)).unwrap();
    for (seed, local) in [(4, [5.0, -1.0, 2.0]), (5, [-0.3, 0.5, 30.0])] {
        let mut rng = rng(seed);
        let point = add(SENSOR, apply(rotation(TURN), local));
        agrees(noise.at(SENSOR, point).unwrap(), TOLERANCE, || {
            let (translation, omega) = draw(&mut rng);
            add(SENSOR, apply(rotation(TURN), add(turned(omega, local), translation)))
        });
    }
}

#[test]
fn the_jacobian_is_the_derivative_of_the_moved_point() {
    let point = [103.0, 47.0, 8.0];
    let lever = add(point, SENSOR.map(|x| -x));
    let jacobian = jacobian(SENSOR, point).unwrap();
    let step = 1e-6;
    for k in 0..6 {
        let moved = |sign: f64| {
            let mut error = [0.0; 6];
            error[k] = sign * step;
            let [a, b, c, d, e, f] = error;
            add([a, b, c], turned([d, e, f], lever))
        };
        let (ahead, behind) = (moved(1.0), moved(-1.0));
        for i in 0..3 {
            let slope = (ahead[i] - behind[i]) / (2.0 * step);
            assert!((slope - jacobian[i][k]).abs() < 1e-8, "row {i}, column {k}: {slope}");
        }
    }
}
