//! Copies of a scan with noise of the size that the scan states.

use crate::draws::{Draws, Purpose};
use crate::factor::{apply, factor, rows};
use crate::synthetic::fitting;
use terrace_types::{Scan, Sigma};

/// A copy of a scan with every present point moved by Gaussian noise of its own stated error.
///
/// Stated standard errors act independently along the axes of the scan's frame; a stated covariance
/// ([`Sigma::Covariance`]) is drawn from as a whole, whatever its rank: one along a ray moves its point along that ray.
/// The stated errors, the frame, and absent points stay as they are, and so do all points of a scan whose errors are
/// unknown. An error of zero leaves its coordinate as it is, to the last bit.
///
/// Copies with different `stream`s are independent of each other, and of [`misplaced`](crate::misplaced) and
/// [`Scene::generate`](crate::Scene::generate) with the same seed. The same seed and stream give the same bits, and each
/// point the same standard normal deviates whatever the errors are: models of noise are compared on equal luck.
///
/// A model of noise often depends on where a point is measured, and an estimator is told what the model says there. Here
/// the copy tells what the original stated; to tell the other, [`stated`](crate::stated()) follows. Noise that leaves the
/// range of numbers makes a point absent.
///
/// ```
/// use terrace_synth::perturbed;
/// use terrace_types::{Frame, Scan, Sigma};
///
/// // A point 2 m ahead, uncertain by 3 cm along the ray alone, and one that is known exactly.
/// let sigma = Sigma::Covariance(vec![[0.0, 0.0, 0.0, 0.0, 0.0, 9e-4], [0.0; 6]]);
/// let exact = Scan::new(vec![[0.0, 0.0, 2.0]; 2], sigma, Frame::World { sensor: None })?;
/// let noisy = perturbed(&exact, 7, 0);
/// let [x, y, z] = noisy.points()[0];
/// assert!((x, y) == (0.0, 0.0) && z != 2.0 && (z - 2.0).abs() < 0.2);
/// assert_eq!(noisy.points()[1], [0.0, 0.0, 2.0]);
/// # Ok::<(), terrace_types::ScanError>(())
/// ```
#[must_use = "the noisy copy is returned"]
pub fn perturbed(scan: &Scan, seed: u64, stream: u64) -> Scan {
    let sigma = scan.sigma();
    if *sigma == Sigma::Unknown {
        return scan.clone();
    }
    let mut draws = Draws::new(Purpose::Points, seed, stream);
    let moved = scan.points().iter().enumerate().map(|(index, point)| {
        // Absent points take their share of the deviates, so that those of the others do not depend on them.
        let deviates = draws.next();
        if !point.iter().all(|x| x.is_finite()) {
            return *point;
        }
        let error = error(sigma, index, deviates);
        // Adding zero would make 0 of −0.
        [0, 1, 2].map(|i| if error[i] == 0.0 { point[i] } else { point[i] + error[i] })
    });
    // No point is present that was absent before, so that the errors still fit.
    fitting(moved.collect(), sigma.clone(), scan.frame())
}

fn error(sigma: &Sigma, index: usize, deviates: [f64; 3]) -> [f64; 3] {
    if let Some(covariance) = sigma.covariance_of(index) {
        return apply(&factor(&rows(covariance)), deviates);
    }
    let sigma = sigma.of(index).unwrap_or([0.0; 3]);
    [0, 1, 2].map(|i| sigma[i] * deviates[i])
}
