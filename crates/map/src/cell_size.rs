//! A cell size from the data.

use std::borrow::Cow;

use rayon::prelude::*;
use terrace_noise::PoseNoise;
use terrace_normals::symmetric_eigen;
use terrace_stats::{Stats, UncertainVector};
use terrace_types::Scan;

use crate::close_up::CloseUp;
use crate::nearest::{Near, nearest};

/// Cells are this many point spacings wide, so that a flat cell holds about twenty-five points.
const SPACINGS: f64 = 5.0;
/// Cells are this many standard errors wide, so that noise does not scatter a surface over several layers.
const SIGMAS: f64 = 6.0;
/// Places at which the scan is looked at.
const SAMPLES: usize = 256;
/// Points whose stated errors are looked at: these vary more from place to place than what neighbours show, and a look costs little. So the
/// same place has cells of the same size, however densely it is scanned.
const STATED: usize = 1 << 12;
/// The spacing follows from the distance of this neighbour, the noise from a plane through this many.
const NEAR: usize = 8;
const PATCH: usize = 30;
/// Neighbours of places looked at closely: all, or one in so many. They show noise that is below this share of their spacing.
const THINNED: [u64; 2] = [1, 4];
const SHOWN: f64 = 0.5;
/// The first guess is doubled at most so often, which covers every scan that is not one far-away point and the rest.
const DOUBLINGS: usize = 24;

/// A cell size and what it follows from, in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellSizeChoice {
    /// The cell size: the larger of five spacings and six standard errors.
    pub cell_size: f64,
    /// Median distance between neighbouring points, as if they lay on a square lattice: `d₈ √(π/8)` with `d₈` the
    /// distance of the eighth neighbour.
    pub spacing: f64,
    /// Median standard error (of an uncertain pose, that of nine points in ten): the larger of what is stated of points and pose
    /// together and the rms distance of a point's thirty neighbours
    /// from their plane. Neighbours show noise of up to about twice the spacing; state it when it is larger. Scans of
    /// fewer than sixty points show none.
    pub sigma: f64,
}

/// Chooses a cell size for scans like this one, from 256 places spread evenly over its points. `None` when there are
/// too few points, or most are in one place.
pub fn choose_cell_size(scan: &Scan) -> Option<CellSizeChoice> {
    choose_from(scan, None)
}

/// As [`choose_cell_size`], for a scan whose pose is only known to within `pose`: its errors count as the points' own, for
/// scans lie as far apart.
pub(crate) fn choose_from(scan: &Scan, pose: Option<&PoseNoise>) -> Option<CellSizeChoice> {
    choose_by_share(scan, pose, 1.0, None)
}

/// As [`choose_from`], for a scan of which this is a share, spread evenly over its points. Scans are of surfaces: all points are closer to
/// each other by the root of it. Where neighbours close up show noise, it is theirs that counts, and their spacing.
pub(crate) fn choose_by_share(
    scan: &Scan,
    pose: Option<&PoseNoise>,
    share: f64,
    close_up: Option<&CloseUp>,
) -> Option<CellSizeChoice> {
    let points: Cow<'_, [[f64; 3]]> = if scan.present() == scan.len() {
        scan.points().into()
    } else {
        scan.points().iter().copied().filter(|p| p.iter().all(|x| x.is_finite())).collect()
    };
    let close_up = close_up.and_then(Seen::close_up);
    let Seen { spacing, noise } = close_up.or_else(|| Some(Seen::of(&points)?.of_share(share)))?;
    let sigma = noise.max(stated_sigma(scan, pose));
    let cell_size = (SPACINGS * spacing).max(SIGMAS * sigma);
    (cell_size.is_normal() && spacing > 0.0).then_some(CellSizeChoice { cell_size, spacing, sigma })
}

/// What neighbours show at most places.
struct Seen {
    spacing: f64,
    noise: f64,
}

impl Seen {
    /// What neighbours show in places whose points are all kept, the nearest ones first; `None` where noise is larger than they show.
    fn close_up(close_up: &CloseUp) -> Option<Self> {
        let mut seen =
            THINNED.into_iter().filter_map(|so_many| Some((Self::of(&close_up.one_in(so_many))?, so_many)));
        let (seen, so_many) = seen.find(|(seen, _)| seen.noise < SHOWN * seen.spacing)?;
        Some(seen.of_share(1.0 / so_many as f64))
    }

    /// The same of all points, of which these are a share.
    fn of_share(self, share: f64) -> Self {
        Self { spacing: self.spacing * share.sqrt(), ..self }
    }

    fn of(points: &[[f64; 3]]) -> Option<Self> {
        if points.len() <= NEAR {
            return None;
        }
        let stride = points.len().div_ceil(SAMPLES);
        // Half a stride in, so that a scan's first row or ring is not favoured.
        let samples: Vec<[f64; 3]> = points.iter().copied().skip(stride / 2).step_by(stride).collect();
        let mut reach = first_reach(&samples, points.len())?;
        let mut local = vec![Local::default(); samples.len()];
        for _ in 0..DOUBLINGS {
            look_around(points, &samples, reach, &mut local);
            let mut spacings: Vec<f64> = local.iter().filter_map(|l| l.spacing).collect();
            let mut noises: Vec<f64> = local.iter().filter_map(|l| l.noise).collect();
            let most = |seen: &[f64]| 2 * seen.len() > samples.len();
            if most(&spacings) && (most(&noises) || points.len() < 2 * PATCH) {
                return Some(Self {
                    spacing: median(&mut spacings)?,
                    noise: median(&mut noises).unwrap_or(0.0),
                });
            }
            reach *= 2.0;
        }
        None
    }
}

/// What the neighbours of a place show.
#[derive(Debug, Clone, Copy, Default)]
struct Local {
    spacing: Option<f64>,
    noise: Option<f64>,
}

/// A distance within which a few dozen neighbours are expected, were the points spread over the sides of a box that
/// holds most of the samples.
fn first_reach(samples: &[[f64; 3]], points: usize) -> Option<f64> {
    let extent = [0, 1, 2].map(|axis| {
        let mut x: Vec<f64> = samples.iter().map(|p| p[axis]).collect();
        x.sort_by(f64::total_cmp);
        x[x.len() * 9 / 10] - x[x.len() / 10]
    });
    let [a, b, c] = extent;
    let area = (a * b).max(b * c).max(c * a).max(a.max(b).max(c).powi(2) / 100.0);
    let reach = 4.0 * (area / points as f64).sqrt();
    (reach.is_normal()).then_some(reach)
}

/// Looks within `reach` of those samples that had too few neighbours so far: the others have those that they had.
fn look_around(points: &[[f64; 3]], samples: &[[f64; 3]], reach: f64, local: &mut [Local]) {
    let open: Vec<usize> = (0..samples.len()).filter(|at| local[*at].noise.is_none()).collect();
    let places: Vec<[f64; 3]> = open.iter().map(|at| samples[*at]).collect();
    let found = nearest(points, &places, reach, PATCH);
    let of_each: Vec<Local> = places
        .par_iter()
        .zip(&found)
        .map(|(sample, near)| Local { spacing: spacing_of(near), noise: noise_of(sample, near) })
        .collect();
    for (at, of_sample) in open.into_iter().zip(of_each) {
        local[at] = of_sample;
    }
}

/// `near` begins with the sample itself.
fn spacing_of(near: &[Near]) -> Option<f64> {
    near.get(NEAR).map(|(squared, _)| (squared * std::f64::consts::PI / NEAR as f64).sqrt())
}

fn noise_of(sample: &[f64; 3], near: &[Near]) -> Option<f64> {
    let patch = near.get(..PATCH)?;
    let mut stats = Stats::new(*sample);
    for (_, point) in patch {
        stats.push(&UncertainVector::exact(*point));
    }
    // Three of the patch's freedoms went into its plane.
    let variance =
        symmetric_eigen(&stats.covariance()?).values[0].max(0.0) * PATCH as f64 / (PATCH - 3) as f64;
    Some(variance.sqrt())
}

fn stated_sigma(scan: &Scan, pose: Option<&PoseNoise>) -> f64 {
    let of_pose = |position| {
        let shared = pose.and_then(|pose| pose.at(scan.sensor_position()?, position));
        shared.map_or([0.0; 3], |covariance| covariance.deviations())
    };
    let stride = scan.len().div_ceil(STATED).max(1);
    let mut sigmas: Vec<f64> = (0..scan.len())
        .step_by(stride)
        .filter_map(|i| {
            let point = scan.world_point(i)?;
            let (own, shared) = (point.sigma.unwrap_or([0.0; 3]), of_pose(point.position));
            (point.sigma.is_some() || pose.is_some()).then(|| [0, 1, 2].map(|i| own[i].hypot(shared[i])))
        })
        .map(|s| s[0].max(s[1]).max(s[2]))
        .collect();
    // Where scans lie apart by the errors of their poses, most of them must fit into a cell, not half.
    let rank = if pose.is_some() { sigmas.len() * 9 / 10 } else { sigmas.len() / 2 };
    sigmas.sort_by(f64::total_cmp);
    sigmas.get(rank).copied().unwrap_or(0.0)
}

fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
