//! The covariance of planes against repeated noisy measurements of a known plane.

// A test has no caller to report to.
#![allow(clippy::unwrap_used)]

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace_normals::{CovariantPlane, Degenerate};
use terrace_stats::{Stats, SymmetricMatrix3, UncertainVector};

type V = [f64; 3];

fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: V) -> V {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

fn gauss(rng: &mut ChaCha8Rng) -> f64 {
    let (u, v): (f64, f64) = (1.0 - rng.random::<f64>(), rng.random());
    (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

/// A patch of a plane with a known error at each of its points.
struct Patch {
    centre: V,
    normal: V,
    axes: [V; 2],
    half: [f64; 2],
}

impl Patch {
    fn at_random(centre: V, half: [f64; 2], rng: &mut ChaCha8Rng) -> Self {
        let normal = unit([gauss(rng), gauss(rng), gauss(rng)]);
        let other = if normal[0].abs() < 0.7 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let first = unit(cross(normal, other));
        Self { centre, normal, axes: [first, cross(normal, first)], half }
    }

    /// Points in strips along the first axis, one cell each, with the error that `deviation` draws at (u, v) in −1 to 1, and
    /// its covariance.
    fn cells(
        &self,
        points: usize,
        rng: &mut ChaCha8Rng,
        error: impl Fn(&Self, [f64; 2], &mut ChaCha8Rng) -> (V, SymmetricMatrix3),
    ) -> Vec<Stats> {
        let mut cells = vec![Stats::new(self.centre); 12];
        for _ in 0..points {
            let at = [rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0)];
            let (moved, covariance) = error(self, at, rng);
            let [a, b] = [at[0] * self.half[0], at[1] * self.half[1]];
            let point =
                [0, 1, 2].map(|i| self.centre[i] + a * self.axes[0][i] + b * self.axes[1][i] + moved[i]);
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 11")]
            let strip = ((at[0] + 1.0) * 6.0) as usize;
            cells[strip.min(11)].push_covariant(point, &covariance);
        }
        cells
    }

    /// Squared error of tilt and offset in units of the predicted covariance, by the three degrees of freedom.
    fn nees(&self, plane: &CovariantPlane) -> f64 {
        let fit = &plane.fit;
        let sign = dot(self.normal, fit.normal).signum();
        let along = sign * dot(self.normal, fit.normal);
        let tilts = fit.axes.map(|axis| sign * dot(self.normal, axis) / along);
        let apart = [0, 1, 2].map(|i| self.centre[i] - fit.centroid[i]);
        let error = [tilts[0], tilts[1], sign * dot(self.normal, apart)];
        dot(error, solve(&plane.tilt_offset, error)) / 3.0
    }
}

/// `M⁻¹ b` by Cramer's rule.
fn solve(matrix: &SymmetricMatrix3, b: V) -> V {
    let rows = matrix.rows();
    let determinant = dot(rows[0], cross(rows[1], rows[2]));
    [0, 1, 2].map(|i| {
        let mut replaced = rows;
        replaced[i] = b;
        dot(replaced[0], cross(replaced[1], replaced[2])) / determinant
    })
}

/// Mean NEES and reduced χ² over many planes; both are 1 when the covariances are right.
fn over_many(
    centre: V,
    half: [f64; 2],
    points: usize,
    error: impl Fn(&Patch, [f64; 2], &mut ChaCha8Rng) -> (V, SymmetricMatrix3),
) -> (f64, f64) {
    const PLANES: usize = 2000;
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let (mut nees, mut chi) = (0.0, 0.0);
    for _ in 0..PLANES {
        let patch = Patch::at_random(centre, half, &mut rng);
        let plane = CovariantPlane::of_cells(&patch.cells(points, &mut rng, &error)).unwrap().unwrap();
        nees += patch.nees(&plane) / PLANES as f64;
        chi += plane.reduced_chi_squared / PLANES as f64;
    }
    (nees, chi)
}

fn isotropic(sigma: f64, rng: &mut ChaCha8Rng) -> (V, SymmetricMatrix3) {
    let moved = [0, 1, 2].map(|_| sigma * gauss(rng));
    (moved, SymmetricMatrix3::diagonal([sigma * sigma; 3]))
}

/// Five standard errors of a mean of 2000 χ² of three degrees of freedom, by three: 5 √(2/3/2000).
const NEAR: f64 = 0.1;

#[track_caller]
fn calibrated((nees, chi): (f64, f64)) {
    assert!((nees - 1.0).abs() < NEAR, "NEES {nees}");
    assert!((chi - 1.0).abs() < 0.02, "reduced chi squared {chi}");
}

#[test]
fn equal_errors_on_a_patch() {
    calibrated(over_many([0.3, -0.2, 1.0], [0.6, 0.4], 400, |_, _, rng| isotropic(0.01, rng)));
}

#[test]
fn a_thin_patch_with_large_errors() {
    calibrated(over_many([0.0; 3], [0.3, 0.1], 400, |_, _, rng| isotropic(0.02, rng)));
}

#[test]
fn far_from_the_origin() {
    calibrated(over_many([1e7, -1e7, 1e7], [0.6, 0.4], 400, |_, _, rng| isotropic(0.01, rng)));
}

#[test]
fn errors_from_1_to_12_millimetres_in_one_patch() {
    let error =
        |_: &Patch, at: [f64; 2], rng: &mut ChaCha8Rng| isotropic(0.001 + 0.0055 * (at[0] + 1.0), rng);
    calibrated(over_many([0.0, 0.0, 2.0], [0.6, 0.4], 600, error));
}

/// Without taking them out of the scatter, errors along an oblique ray turn the plane: NEES is then above 10.
#[test]
fn errors_along_an_oblique_ray() {
    let error = |patch: &Patch, _: [f64; 2], rng: &mut ChaCha8Rng| {
        let ray = unit([0, 1, 2].map(|i| patch.normal[i] + 0.9 * patch.axes[0][i]));
        let along = 0.03 * gauss(rng);
        (ray.map(|r| along * r), SymmetricMatrix3::outer(ray.map(|r| 0.03 * r)))
    };
    calibrated(over_many([0.0; 3], [0.5, 0.4], 2000, error));
}

#[test]
fn the_coefficients_vary_as_told() {
    const RUNS: usize = 4000;
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let patch = Patch::at_random([2.0, -1.0, 3.0], [0.6, 0.4], &mut rng);
    let (mut sum, mut second) = ([0.0; 4], [[0.0; 4]; 4]);
    let mut predicted = [[0.0; 4]; 4];
    for _ in 0..RUNS {
        let cells = patch.cells(200, &mut rng, |_, _, rng| isotropic(0.01, rng));
        let plane = CovariantPlane::of_cells(&cells).unwrap().unwrap();
        let sign = dot(plane.fit.normal, patch.normal).signum();
        let coefficients = plane.coefficients().map(|c| sign * c);
        let told = plane.covariance_of_coefficients();
        for i in 0..4 {
            sum[i] += coefficients[i] / RUNS as f64;
            for j in 0..4 {
                second[i][j] += coefficients[i] * coefficients[j] / RUNS as f64;
                predicted[i][j] += told[i][j] / RUNS as f64;
            }
        }
    }
    for i in 0..4 {
        for j in 0..4 {
            let seen = second[i][j] - sum[i] * sum[j];
            let scale = (predicted[i][i] * predicted[j][j]).sqrt();
            assert!((seen - predicted[i][j]).abs() < 0.1 * scale, "{i} {j}: {seen} {}", predicted[i][j]);
        }
    }
}

#[test]
fn the_covariance_of_the_coefficients_keeps_the_length_of_the_normal() {
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    let patch = Patch::at_random([1.0, 2.0, 3.0], [0.5, 0.3], &mut rng);
    let plane = CovariantPlane::of_cells(&patch.cells(50, &mut rng, |_, _, rng| isotropic(0.01, rng)))
        .unwrap()
        .unwrap();
    let covariance = plane.covariance_of_coefficients();
    let scale = covariance[3][3];
    for row in covariance {
        let along: f64 = (0..3).map(|i| row[i] * plane.fit.normal[i]).sum();
        assert!(along.abs() < 1e-14 * scale.max(1.0), "{along}");
    }
    for i in 0..4 {
        for j in 0..4 {
            assert!((covariance[i][j] - covariance[j][i]).abs() <= 1e-15 * scale);
        }
    }
}

#[test]
fn what_determines_no_plane_or_knows_no_error() {
    let none: [Stats; 0] = [];
    assert_eq!(CovariantPlane::of_cells(&none), Err(Degenerate::TooFew { found: 0 }));
    let cell = |points: &[V], sigma: f64| {
        let mut cell = Stats::new([0.0; 3]);
        for point in points {
            cell.push(&UncertainVector::isotropic(*point, sigma));
        }
        cell
    };
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    assert_eq!(CovariantPlane::of_cells(&[cell(&corners[..3], 0.1)]), Err(Degenerate::TooFew { found: 3 }));
    assert_eq!(CovariantPlane::of_cells(&[cell(&corners, 0.0)]), Ok(None));
    // A line that only its errors make wide.
    let line: Vec<V> = (0..9).map(|i| [f64::from(i), 0.001 * f64::from(i % 2), 0.0]).collect();
    assert!(CovariantPlane::of_cells(&[cell(&line, 0.01)]).is_err());
    assert!(CovariantPlane::of_cells(&[cell(&[[2.0; 3]; 5], 0.1)]).is_err());
    assert_eq!(CovariantPlane::of_cells(&[cell(&[[f64::NAN; 3]; 5], 0.1)]), Err(Degenerate::NotFinite));
    let exact = CovariantPlane::of_cells(&[cell(&corners, 0.1)]).unwrap().unwrap();
    // Four corners of a square known to 0.1: the offset to 0.1/√4.
    assert!((exact.tilt_offset.get(2, 2) - 0.0025).abs() < 1e-12);
}

#[test]
fn a_cell_without_errors_does_not_outweigh_all_others() {
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let patch = Patch::at_random([0.0; 3], [0.5, 0.3], &mut rng);
    let mut cells = patch.cells(200, &mut rng, |_, _, rng| isotropic(0.01, rng));
    let mut exact = Stats::new([0.0; 3]);
    exact.push(&UncertainVector::exact([0.0; 3]));
    cells.push(exact);
    let plane = CovariantPlane::of_cells(&cells).unwrap().unwrap();
    assert!(plane.tilt_offset.is_finite() && patch.nees(&plane) < 6.0);
}

/// A floor seen at a grazing angle by a ranger without errors across its rays, from two places whose heights are wrong: turned into the
/// rays, the plane has points that weigh without end.
#[test]
fn errors_that_points_share_keep_a_plane_from_turning_into_their_rays() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let (sigma, pose) = (0.02, 0.08);
    let ray = unit([15.0, 0.0, -1.5]);
    let along = SymmetricMatrix3::outer(ray.map(|x| sigma * x));
    let mut cells = vec![Stats::new([15.5, 0.0, 0.0]); 2];
    for _ in 0..400 {
        let x: f64 = rng.random_range(14.5..16.5);
        let off = sigma * gauss(&mut rng);
        let (band, height) = if x < 15.5 { (0, pose) } else { (1, -pose) };
        let point = [x, rng.random_range(-0.5..0.5), height];
        cells[band].push_covariant([0, 1, 2].map(|i| point[i] + off * ray[i]), &along);
    }
    let shared = SymmetricMatrix3::diagonal([0.0, 0.0, pose * pose]);
    let sums = || cells.iter().map(|cell| (cell.moments(), shared));
    // As a surface that was grown through both bands is turned: nearly along the rays.
    let turned = unit([-ray[2], 0.0, ray[0]]);
    let alone =
        CovariantPlane::near([15.5, 0.0, 0.0], sums().map(|(cell, _)| cell), turned).unwrap().unwrap();
    let together = CovariantPlane::near_with_shared([15.5, 0.0, 0.0], sums(), turned).unwrap().unwrap();
    let deviation = |plane: &CovariantPlane| plane.tilt_offset.get(2, 2).sqrt();
    // Sure to a tenth of a millimetre, where scans are apart by 16 cm and points are off by 2 cm.
    assert!(deviation(&alone) < 1e-4, "{}", deviation(&alone));
    for (cell, shared) in sums() {
        let most = 1.0 / shared.quadratic_form(together.fit.normal);
        let [own, bounded] = [alone.weight(cell), together.weight_with_shared(cell, &shared)];
        assert!(bounded <= most && own > 10.0 * most, "{own} and {bounded}, at most {most}");
    }
}

#[test]
fn where_points_share_no_errors_nothing_changes() {
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    let patch = Patch::at_random([1.0, 2.0, 3.0], [1.0, 0.5], &mut rng);
    let isotropic = |_: &Patch, at: [f64; 2], rng: &mut ChaCha8Rng| {
        let sigma = 0.01 + 0.005 * at[0];
        ([0; 3].map(|_| sigma * gauss(rng)), SymmetricMatrix3::diagonal([sigma * sigma; 3]))
    };
    let cells = patch.cells(300, &mut rng, isotropic);
    let sums = cells.iter().map(Stats::moments);
    let none = sums.clone().map(|cell| (cell, SymmetricMatrix3::ZERO));
    let plane = CovariantPlane::near(patch.centre, sums, patch.normal).unwrap();
    assert_eq!(CovariantPlane::near_with_shared(patch.centre, none, patch.normal), Ok(plane));
    // Points without errors of their own tell nothing, whatever they share.
    let exact: Vec<Stats> = cells.iter().map(|cell| cell.with_noise(SymmetricMatrix3::ZERO)).collect();
    let shared = exact.iter().map(|cell| (cell.moments(), SymmetricMatrix3::diagonal([1.0; 3])));
    assert_eq!(CovariantPlane::near_with_shared(patch.centre, shared, patch.normal), Ok(None));
}
