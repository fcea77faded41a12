//! Draws a plane from the side with its uncertainty, which grows away from the points, into the PNG of the first argument.

use std::path::PathBuf;

use terrace::{Mapper, Params, PlaneEstimate};
use terrace_draw::{Anchor, Canvas, Raster};
use terrace_io::planes_json::TiltOffset;
use terrace_synth::{Scene, SceneKind};
use terrace_types::Plane;

/// Pixels of the picture, and of the chart in it.
const SIZE: [usize; 2] = [1200, 600];
const CHART: [[f64; 2]; 2] = [[90.0, 70.0], [1170.0, 520.0]];
/// What the chart shows: metres along the plane, and across it.
const REACH: [f64; 2] = [1.5, 0.03];

const INK: [u8; 3] = [45, 45, 50];
const GRID: [u8; 3] = [228, 228, 232];
const POINT: [u8; 3] = [150, 155, 165];
const FOUND: [u8; 3] = [20, 80, 170];
const BANDS: [(f64, [u8; 3]); 2] = [(2.0, [221, 232, 247]), (1.0, [176, 204, 238])];
const TRUE: [u8; 3] = [205, 85, 20];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args_os()
        .nth(1)
        .map_or_else(|| std::env::temp_dir().join("uncertainty_band.png"), PathBuf::from);

    // Few points, so that the uncertainty can be seen beside the noise.
    let params = terrace_synth::Params { points: Some(150), seed: 1, ..terrace_synth::Params::default() };
    let scene = Scene::new(SceneKind::Strip).generate(&params)?;
    let scan = scene.merged().scan;
    let mut mapper = Mapper::new(Params { cell_size: Some(0.15), ..Params::default() })?;
    mapper.insert(&scan)?;
    let map = mapper.extract()?;
    let estimate = map.planes.first().and_then(|plane| plane.estimate).ok_or("no covariance")?;
    let truth = scene.planes.first().ok_or("no plane")?.plane;

    std::fs::write(&path, draw(&estimate, &truth, scan.points())?)?;
    println!("{}", path.display());
    Ok(())
}

fn draw(
    estimate: &PlaneEstimate,
    truth: &Plane,
    points: &[[f64; 3]],
) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let covariance = TiltOffset { at: estimate.centroid, axes: estimate.axes, matrix: estimate.tilt_offset };
    // The long side of the strip is where its tilt is surest.
    let long = usize::from(covariance.matrix[1][1] < covariance.matrix[0][0]);
    let (along, normal) = (covariance.axes[long], estimate.plane.normal());
    let on_plane = |u: f64| [0, 1, 2].map(|i| covariance.at[i] + u * along[i]);

    let mut canvas = Raster::new(SIZE[0], SIZE[1])?;
    let [[left, top], [right, bottom]] = CHART;
    let x = |u: f64| f64::midpoint(left, right) + u / REACH[0] * (right - left) / 2.0;
    let y = |v: f64| f64::midpoint(top, bottom) - v / REACH[1] * (bottom - top) / 2.0;
    let line = |canvas: &mut Raster, height: &dyn Fn(f64) -> f64, colour| {
        canvas.line([left, y(height(-REACH[0]))], [right, y(height(REACH[0]))], 3.0, colour);
    };

    for (sigmas, colour) in BANDS {
        for pixel in 0..1080 {
            let share = (f64::from(pixel) + 0.5) / 1080.0;
            let u = REACH[0] * (2.0 * share - 1.0);
            let half = (sigmas * covariance.distance(on_plane(u))).min(REACH[1]);
            let column = left + f64::from(pixel);
            canvas.rectangle([column, y(half)], [column + 1.0, y(-half)], colour);
        }
    }
    frame(&mut canvas, &x, &y);
    for point in points {
        let away = [0, 1, 2].map(|i| point[i] - covariance.at[i]);
        let [u, v] = [dot(away, along), dot(away, normal)];
        if u.abs() < REACH[0] && v.abs() < REACH[1] {
            canvas.disc([x(u), y(v)], 2.5, POINT);
        }
    }
    line(&mut canvas, &|_| 0.0, FOUND);
    let [a, b, c, d] = truth.coefficients();
    let true_height = |u: f64| -(dot([a, b, c], on_plane(u)) + d) / dot([a, b, c], normal);
    line(&mut canvas, &true_height, TRUE);
    legend(&mut canvas);
    Ok(canvas.into_image().png()?)
}

fn frame(canvas: &mut Raster, x: &dyn Fn(f64) -> f64, y: &dyn Fn(f64) -> f64) {
    let [[left, top], [right, bottom]] = CHART;
    for tick in -3..=3 {
        let u = 0.5 * f64::from(tick);
        canvas.line([x(u), top], [x(u), bottom], 1.0, GRID);
        canvas.text([x(u), bottom + 18.0], &format!("{u:.1}"), 14.0, Anchor::Middle, INK);
    }
    for tick in -2..=2 {
        let v = 10.0 * f64::from(tick);
        canvas.line([left, y(v / 1000.0)], [right, y(v / 1000.0)], 1.0, GRID);
        canvas.text([left - 10.0, y(v / 1000.0)], &format!("{v:.0}"), 14.0, Anchor::End, INK);
    }
    canvas.line([left, bottom], [right, bottom], 1.0, INK);
    canvas.line([left, top], [left, bottom], 1.0, INK);
    canvas.text([x(0.0), bottom + 48.0], "along the strip from the centroid (m)", 14.0, Anchor::Middle, INK);
    canvas.text([left - 60.0, top - 20.0], "across it (mm)", 14.0, Anchor::Start, INK);
}

fn legend(canvas: &mut Raster) {
    let entries = [
        (POINT, "points"),
        (FOUND, "plane found"),
        (BANDS[1].1, "standard error"),
        (BANDS[0].1, "twice that"),
        (TRUE, "true plane"),
    ];
    for (place, (colour, name)) in (0..).zip(entries) {
        let left = 110.0 + 220.0 * f64::from(place);
        canvas.rectangle([left, 18.0], [left + 22.0, 32.0], colour);
        canvas.text([left + 30.0, 25.0], name, 14.0, Anchor::Start, INK);
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
