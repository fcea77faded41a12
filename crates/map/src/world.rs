//! Points of a scan in the world.

use std::ops::Range;

use rayon::prelude::*;
use terrace_grid::{Motion, PointErrors};
use terrace_types::{Frame, Pose, Scan, Sigma};

/// Points that are handed to a thread at once.
pub(crate) const AT_ONCE: usize = 1 << 13;

/// Some points of a scan in the world, with their errors there.
#[derive(Debug, Default)]
pub(crate) struct World {
    points: Vec<[f64; 3]>,
    axes: Vec<[f64; 3]>,
    covariances: Vec<[f64; 6]>,
}

/// Points from the sensor to the world.
struct Transform<'a> {
    pose: &'a Pose,
    from: &'a [[f64; 3]],
    to: &'a mut [[f64; 3]],
}

impl pulp::WithSimd for Transform<'_> {
    type Output = ();

    // Into what it is dispatched to: the same instructions, for several points at a time where the processor can.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        for (to, from) in self.to.iter_mut().zip(self.from) {
            *to = self.pose.transform(*from);
        }
    }
}

impl World {
    /// Some points of a scan in the world, with their errors there.
    pub(crate) fn part<'s>(
        &'s mut self,
        scan: &'s Scan,
        range: Range<usize>,
    ) -> (&'s [[f64; 3]], PointErrors<'s>) {
        self.make(scan, range.clone());
        self.made(scan, range)
    }

    /// Takes points of a scan into the world, if they are not there.
    pub(crate) fn make(&mut self, scan: &Scan, range: Range<usize>) {
        let Frame::Sensor { pose } = scan.frame() else { return };
        let points = &scan.points()[range.clone()];
        self.points.resize(points.len(), [0.0; 3]);
        let parts = points.par_chunks(AT_ONCE).zip(self.points.par_chunks_mut(AT_ONCE));
        parts.for_each(|(from, to)| pulp::Arch::new().dispatch(Transform { pose: &pose, from, to }));
        match scan.sigma() {
            Sigma::Unknown | Sigma::Uniform(_) | Sigma::PerPoint(_) => {}
            Sigma::PerAxis(all) => {
                let turned =
                    all[range].par_iter().with_min_len(AT_ONCE).map(|sigma| pose.rotate_sigma(*sigma));
                turned.collect_into_vec(&mut self.axes);
            }
            Sigma::Covariance(all) => {
                let turned = all[range].par_iter().with_min_len(AT_ONCE).map(|covariance| {
                    let mut turned = pose.rotate_covariance(*covariance);
                    for diagonal in [0, 3, 5] {
                        // Rounding may leave a variance of zero a little below it.
                        turned[diagonal] = turned[diagonal].max(0.0);
                    }
                    turned
                });
                turned.collect_into_vec(&mut self.covariances);
            }
        }
    }

    /// What was [made](Self::make) of the same points last.
    pub(crate) fn made<'s>(
        &'s self,
        scan: &'s Scan,
        range: Range<usize>,
    ) -> (&'s [[f64; 3]], PointErrors<'s>) {
        let points = if is_there(scan) { &scan.points()[range.clone()] } else { &self.points };
        let errors = errors_there(scan, range).unwrap_or(match scan.sigma() {
            Sigma::PerAxis(_) => PointErrors::Axes(&self.axes),
            _ => PointErrors::Covariances(&self.covariances),
        });
        (points, errors)
    }
}

fn is_there(scan: &Scan) -> bool {
    matches!(scan.frame(), Frame::World { .. })
}

/// The errors of some points of a scan that are the same in the world; `None` where they are to be turned.
pub(crate) fn errors_there(scan: &Scan, range: Range<usize>) -> Option<PointErrors<'_>> {
    Some(match scan.sigma() {
        Sigma::Unknown => PointErrors::None,
        // One that is the same along every axis is the same in every frame.
        Sigma::Uniform(sigma) => PointErrors::Same(*sigma),
        Sigma::PerPoint(all) => PointErrors::Each(&all[range]),
        Sigma::PerAxis(all) if is_there(scan) => PointErrors::Axes(&all[range]),
        Sigma::Covariance(all) if is_there(scan) => PointErrors::Covariances(&all[range]),
        Sigma::PerAxis(_) | Sigma::Covariance(_) => return None,
    })
}

/// What takes points of a scan into the world, if they are not there.
pub(crate) fn motion(scan: &Scan) -> Option<Box<Motion<'static>>> {
    let Frame::Sensor { pose } = scan.frame() else { return None };
    Some(Box::new(move |from, to| pulp::Arch::new().dispatch(Transform { pose: &pose, from, to })))
}
