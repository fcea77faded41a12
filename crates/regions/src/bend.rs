//! Whether a surface is bent.

use faer::linalg::solvers::{DenseSolveCore, Solve};
use faer::{Mat, Side};

/// Columns of points determine a curved surface from so many on.
const FEWEST: usize = 8;
/// Numbers in a quadric over a plane: a height, two slopes, three curvatures.
const FREEDOMS: usize = 6;

/// Points of a surface over a small place of its plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Column {
    /// How many.
    pub points: f64,
    /// Their mean place in the plane, in metres.
    pub place: [f64; 2],
    /// And their mean height over it, in metres.
    pub height: f64,
}

/// How a surface is bent: the quadric through its columns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bend {
    /// How far the normal turns over the surface, rms, in radians.
    pub turn: f64,
    /// How far the surface is off its plane, rms, in metres.
    pub rms: f64,
    /// How far its columns are off the quadric beyond the errors of their points, rms, in metres.
    pub left: f64,
    /// How sure that is, in standard errors. Scatter of the columns about the quadric beyond their errors counts as error.
    pub significance: f64,
}

impl Bend {
    /// `None` when the columns determine no quadric. `variance` is that of a point's error along the normal, in m².
    pub fn of(columns: &[Column], variance: f64) -> Option<Self> {
        if columns.len() < FEWEST || variance <= 0.0 {
            return None;
        }
        let points: f64 = columns.iter().map(|column| column.points).sum();
        let mean =
            |of: &dyn Fn(&Column) -> f64| columns.iter().map(|c| c.points * of(c)).sum::<f64>() / points;
        let middle = [0, 1].map(|i| mean(&|c| c.place[i]));
        // In units of its own extent, so that all numbers are of one size.
        let extent = [0, 1].map(|i| mean(&|c| (c.place[i] - middle[i]).powi(2)).sqrt());
        let at = |c: &Column| [0, 1].map(|i| (c.place[i] - middle[i]) / extent[i]);
        let row = |c: &Column| {
            let [u, v] = at(c);
            [1.0, u, v, u * u, u * v, v * v]
        };

        let mut normal = Mat::<f64>::zeros(FREEDOMS, FREEDOMS);
        let mut right = Mat::<f64>::zeros(FREEDOMS, 1);
        for column in columns {
            let (weight, row) = (column.points / variance, row(column));
            for i in 0..FREEDOMS {
                for j in 0..FREEDOMS {
                    normal[(i, j)] += weight * row[i] * row[j];
                }
                right[(i, 0)] += weight * row[i] * column.height;
            }
        }
        let factors = normal.llt(Side::Lower).ok()?;
        let found = factors.solve(&right);
        let covariance = factors.inverse();
        let curvature = Mat::from_fn(3, 1, |i, _| found[(i + 3, 0)]);
        let of_curvature = Mat::from_fn(3, 3, |i, j| covariance[(i + 3, j + 3)]);
        let pulled = of_curvature.llt(Side::Lower).ok()?.solve(&curvature);
        let significance: f64 = (0..3).map(|i| curvature[(i, 0)] * pulled[(i, 0)]).sum();

        let [uu, uv, vv] = [0, 1, 2].map(|i| curvature[(i, 0)]);
        let bent = |c: &Column| {
            let [u, v] = at(c);
            uu * u * u + uv * u * v + vv * v * v
        };
        let level = mean(&bent);
        let slope = |c: &Column| {
            let [u, v] = at(c);
            ((2.0 * uu * u + uv * v) / extent[0]).powi(2) + ((2.0 * vv * v + uv * u) / extent[1]).powi(2)
        };
        let residual = |c: &Column| {
            let told: f64 = row(c).iter().enumerate().map(|(i, x)| found[(i, 0)] * x).sum();
            c.points / variance * (c.height - told).powi(2)
        };
        let freedom = columns.len().saturating_sub(FREEDOMS).max(1) as f64;
        let scatter = (columns.iter().map(residual).sum::<f64>() / freedom).max(1.0);
        let left = ((scatter - 1.0) * freedom * variance / points).sqrt();
        let bend = Self {
            turn: mean(&slope).sqrt(),
            rms: mean(&|c| (bent(c) - level).powi(2)).sqrt(),
            left,
            significance: (significance.max(0.0) / scatter).sqrt(),
        };
        (bend.turn.is_finite() && bend.significance.is_finite()).then_some(bend)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    fn columns(height: impl Fn(f64, f64) -> f64) -> Vec<Column> {
        let place = |k: u32| [0.05 * f64::from(k % 20) - 0.5, 0.05 * f64::from(k / 20) - 0.3];
        (0..240)
            .map(|k| {
                let place = place(k);
                Column { points: 10.0, place, height: height(place[0], place[1]) }
            })
            .collect()
    }

    #[test]
    fn too_few_columns_and_columns_in_a_line_determine_none() {
        assert_eq!(Bend::of(&[], 1e-4), None);
        let all = columns(|_, _| 0.0);
        assert_eq!(Bend::of(&all[..7], 1e-4), None);
        assert_eq!(Bend::of(&all[..20], 1e-4), None);
        assert_eq!(Bend::of(&all, 0.0), None);
        let unknown = Column { height: f64::NAN, ..all[0] };
        assert_eq!(Bend::of(&[&all[..], &[unknown]].concat(), 1e-4), None);
    }

    #[test]
    fn a_cylinder_turns_as_far_as_its_arc() {
        let radius = 2.0;
        let bend = Bend::of(&columns(|u, _| u * u / (2.0 * radius)), 1e-4).unwrap();
        // Places are even over one metre: the angle u / R has the deviation 1 / (R √12).
        assert!((bend.turn - 0.2887 / radius).abs() < 0.002, "{bend:?}");
        assert!(bend.significance > 20.0, "{bend:?}");
    }

    #[test]
    fn what_a_quadric_does_not_explain_is_left() {
        let smooth = |u: f64, v: f64| u * u / 4.0 + v * v / 6.0;
        let exact = Bend::of(&columns(smooth), 1e-4).unwrap();
        assert_eq!(exact.left.to_bits(), 0.0_f64.to_bits());
        // Steps of 3 cm from column to column, of which 1e-4 / 10 m² are the errors of ten points.
        let step = |u: f64| if (20.0 * u).round() % 2.0 == 0.0 { 0.03 } else { -0.03 };
        let stepped = Bend::of(&columns(|u, v| smooth(u, v) + step(u)), 1e-4).unwrap();
        assert!((stepped.left - (9e-4_f64 - 1e-5).sqrt()).abs() < 2e-4, "{stepped:?}");
        assert!((stepped.rms / exact.rms - 1.0).abs() < 0.05, "{stepped:?} {exact:?}");
    }

    #[test]
    fn noise_on_a_plane_is_not_significant() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let mut above = 0;
        for _ in 0..200 {
            let noisy: Vec<Column> = columns(|u, v| 0.3 * u - 0.1 * v)
                .into_iter()
                .map(|c| {
                    let noise: f64 = (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
                    Column { height: c.height + 0.01 * noise / c.points.sqrt(), ..c }
                })
                .collect();
            let bend = Bend::of(&noisy, 1e-4).unwrap();
            above += usize::from(bend.significance > 3.0);
        }
        // χ² of three freedoms exceeds nine in 2.9 of a hundred cases.
        assert!((1..=16).contains(&above), "{above} of 200");
    }

    proptest! {
        #[test]
        fn slopes_and_heights_do_not_bend(a in -2.0..2.0_f64, b in -2.0..2.0_f64, c in -9.0..9.0_f64) {
            let bend = Bend::of(&columns(|u, v| a * u + b * v + c), 1e-4).unwrap();
            prop_assert!(bend.turn < 1e-9 && bend.significance < 1e-4, "{:?}", bend);
        }

        #[test]
        fn the_turn_does_not_depend_on_the_frame(angle in 0.0..3.0_f64, k in 0.01..1.0_f64, l in -1.0..1.0_f64) {
            let still = Bend::of(&columns(|u, v| k * u * u + l * v * v), 1e-4).unwrap();
            let turned: Vec<Column> = columns(|u, v| k * u * u + l * v * v)
                .into_iter()
                .map(|c| {
                    let ([u, v], (sin, cos)) = (c.place, angle.sin_cos());
                    Column { place: [cos * u - sin * v + 7.0, sin * u + cos * v - 2.0], ..c }
                })
                .collect();
            let turned = Bend::of(&turned, 1e-4).unwrap();
            prop_assert!((turned.turn - still.turn).abs() <= 1e-7 * (1.0 + still.turn));
        }
    }
}
