//! Points of a scan in the world.

use rayon::prelude::*;
use terrace_grid::PointErrors;
use terrace_types::{Frame, Scan, Sigma};

/// Some points of a scan in the world, with their errors there.
#[derive(Debug, Default)]
pub(crate) struct World {
    points: Vec<[f64; 3]>,
    axes: Vec<[f64; 3]>,
    covariances: Vec<[f64; 6]>,
}

impl World {
    pub(crate) fn part<'s>(
        &'s mut self,
        scan: &'s Scan,
        range: std::ops::Range<usize>,
    ) -> (&'s [[f64; 3]], PointErrors<'s>) {
        let points = &scan.points()[range.clone()];
        let Frame::Sensor { pose } = scan.frame() else {
            let errors = match scan.sigma() {
                Sigma::Unknown => PointErrors::None,
                Sigma::Uniform(sigma) => PointErrors::Same(*sigma),
                Sigma::PerPoint(all) => PointErrors::Each(&all[range]),
                Sigma::PerAxis(all) => PointErrors::Axes(&all[range]),
                Sigma::Covariance(all) => PointErrors::Covariances(&all[range]),
            };
            return (points, errors);
        };
        points
            .par_iter()
            .with_min_len(1 << 13)
            .map(|point| pose.transform(*point))
            .collect_into_vec(&mut self.points);
        // An error that is the same along every axis is the same in every frame.
        let errors = match scan.sigma() {
            Sigma::Unknown => PointErrors::None,
            Sigma::Uniform(sigma) => PointErrors::Same(*sigma),
            Sigma::PerPoint(all) => PointErrors::Each(&all[range]),
            Sigma::PerAxis(all) => {
                let turned =
                    all[range].par_iter().with_min_len(1 << 13).map(|sigma| pose.rotate_sigma(*sigma));
                turned.collect_into_vec(&mut self.axes);
                PointErrors::Axes(&self.axes)
            }
            Sigma::Covariance(all) => {
                let turned = all[range].par_iter().with_min_len(1 << 13).map(|covariance| {
                    let mut turned = pose.rotate_covariance(*covariance);
                    for diagonal in [0, 3, 5] {
                        // Rounding may leave a variance of zero a little below it.
                        turned[diagonal] = turned[diagonal].max(0.0);
                    }
                    turned
                });
                turned.collect_into_vec(&mut self.covariances);
                PointErrors::Covariances(&self.covariances)
            }
        };
        (&self.points, errors)
    }
}
