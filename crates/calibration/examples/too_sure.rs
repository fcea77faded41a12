//! Five estimators of the same 3-vector: an honest one, one too sure, one too careful, one with outliers and one that is
//! too sure in half of its cases and too careful in the other. NEES does not see the last; coverage does.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace_calibration::{Calibration, CalibrationError, squared_mahalanobis, table};

/// A normal variable with mean 0 and deviation 1, by Box and Muller.
fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let (radius, turn): (f64, f64) = (1.0 - rng.random::<f64>(), rng.random());
    (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * turn).cos()
}

fn main() -> Result<(), CalibrationError> {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let names = ["honest", "too sure", "too careful", "outliers", "now this, now that"];
    let mut calibrations = Vec::new();
    for case in 0..names.len() {
        let mut calibration = Calibration::new(3)?;
        for turn in 0..2000 {
            // By how much the predicted variances are wrong, and by how much this error is.
            let (predicted, blunder) = match case {
                1 => (0.5, 1.0),
                2 => (2.0, 1.0),
                3 if turn % 50 == 0 => (1.0, 8.0),
                4 => (if turn % 2 == 0 { 0.6 } else { 3.0 }, 1.0),
                _ => (1.0, 1.0),
            };
            let error: [f64; 3] = std::array::from_fn(|_| normal(&mut rng) * blunder);
            let covariance = [[predicted, 0.0, 0.0], [0.0, predicted, 0.0], [0.0, 0.0, predicted]];
            match squared_mahalanobis(error, covariance) {
                Some(nees) => calibration.push(nees)?,
                None => calibration.refuse(),
            }
        }
        calibrations.push(calibration);
    }
    let named: Vec<_> = names.into_iter().zip(&calibrations).collect();
    print!("{}", table(&named));
    println!();
    for (name, calibration) in named {
        if let (Some(ratio), Some(test)) = (calibration.median_ratio(), calibration.kolmogorov_smirnov()) {
            println!(
                "{name:<18}  median ratio {ratio:.3}, Kolmogorov-Smirnov {:.3} (p {:.2e})",
                test.statistic, test.p_value
            );
        }
    }
    Ok(())
}
