//! The errors of several scans as those of one in the world.

use crate::factor::{factor, rows};
use crate::synthetic::LabelledScan;
use crate::vector::dot;
use terrace_types::{Frame, Scan, Sigma, WorldPoint};

/// What is needed to say the errors of a scan, from the least to the most.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    PerPoint,
    PerAxis,
    Covariance,
    Unknown,
}

/// The errors of all points of the scans along the axes of the world, with zeros for absent points. Unknown when those
/// of one scan are, or leave the range of numbers.
pub(crate) fn errors_in_world(scans: &[LabelledScan]) -> Sigma {
    let kinds = scans.iter().filter(|s| s.scan.present() > 0).map(|s| match s.scan.sigma() {
        Sigma::Unknown => Kind::Unknown,
        Sigma::Uniform(_) | Sigma::PerPoint(_) => Kind::PerPoint,
        Sigma::PerAxis(_) => Kind::PerAxis,
        Sigma::Covariance(_) => Kind::Covariance,
    });
    let sigma = match kinds.max().unwrap_or(Kind::PerPoint) {
        Kind::PerPoint => all(scans, 0.0, |_, _, p| p.sigma.map(|s| s[0])).map(per_point),
        Kind::PerAxis => {
            let valid = |s: &[f64; 3]| s.iter().all(|s| Sigma::is_valid(*s));
            all(scans, [0.0; 3], |_, _, p| p.sigma.filter(valid)).map(Sigma::PerAxis)
        }
        Kind::Covariance => all(scans, [0.0; 6], covariance).map(Sigma::Covariance),
        Kind::Unknown => None,
    };
    sigma.unwrap_or(Sigma::Unknown)
}

/// An error for each point, if each present one has one.
fn all<T: Copy>(
    scans: &[LabelledScan],
    absent: T,
    of: impl Fn(&Scan, usize, &WorldPoint) -> Option<T>,
) -> Option<Vec<T>> {
    let points =
        scans.iter().flat_map(|s| s.scan.world_points().enumerate().map(move |(i, p)| (&s.scan, i, p)));
    points.map(|(scan, index, point)| point.map_or(Some(absent), |p| of(scan, index, &p))).collect()
}

/// One error for each point; equal errors become one.
pub(crate) fn per_point(sigmas: Vec<f64>) -> Sigma {
    match sigmas.first() {
        Some(first) if sigmas.iter().all(|s| s.to_bits() == first.to_bits()) => Sigma::Uniform(*first),
        _ => Sigma::PerPoint(sigmas),
    }
}

fn covariance(scan: &Scan, index: usize, point: &WorldPoint) -> Option<[f64; 6]> {
    let told = point.covariance.or_else(|| {
        let [x, y, z] = point.sigma?;
        Some([x * x, 0.0, 0.0, y * y, 0.0, z * z])
    })?;
    if Sigma::is_valid_covariance(told) {
        return Some(told);
    }
    // Turning one of low rank may leave a variance a little below zero; turning its root does not.
    let Frame::Sensor { pose } = scan.frame() else { return None };
    let root = factor(&rows(scan.sigma().covariance_of(index)?));
    let columns = [0, 1, 2].map(|k| pose.rotate(root.map(|row| row[k])));
    let turned = [0, 1, 2].map(|i| columns.map(|column| column[i]));
    let again = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(i, j)| dot(turned[i], turned[j]));
    Sigma::is_valid_covariance(again).then_some(again)
}
