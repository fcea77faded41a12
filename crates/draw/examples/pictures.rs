//! Draws a small cloud and a staircase into a folder: that of the first argument, or the temporary one.

use std::path::PathBuf;
use terrace_draw::{Bounds, CloudPicture, Image, Sample, Staircase, Step, View, label_colour};
use terrace_synth::{Params, Scene, SceneKind};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args_os().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    for kind in SceneKind::ALL {
        let (views, cut): ([[f64; 2]; 2], _) = match kind {
            SceneKind::Table => ([[-115.0, 10.0], [-20.0, 35.0]], f64::INFINITY),
            SceneKind::Room => ([[-60.0, 52.0], [125.0, 52.0]], 2.3),
            SceneKind::Corridor => ([[-120.0, 45.0], [-30.0, 45.0]], 2.2),
        };
        let cloud = Scene::new(kind).generate(&Params::default())?.merged();
        let points = cloud.scan.points();
        let bounds = Bounds::of(points.iter().copied()).ok_or("no points")?;
        let mut pictures = Vec::new();
        for [azimuth, elevation] in views {
            let view = View::from_degrees(azimuth, elevation)?.with_perspective_degrees(35.0)?;
            let mut picture = CloudPicture::new(800, 640, view, bounds)?
                .with_title(&format!("{kind} from azimuth {azimuth}°"))
                .with_cut_above(cut);
            for (point, label) in points.iter().zip(&cloud.labels) {
                picture.add(*point, label_colour(*label));
            }
            pictures.push(picture.image()?);
        }
        if let [left, right] = pictures.as_slice() {
            let path = folder.join(format!("terrace-{kind}.png"));
            std::fs::write(&path, Image::beside(left, right)?.png()?)?;
            println!("{}", path.display());
        }
    }

    let chart = staircase();
    for (name, bytes) in [("svg", chart.svg(800, 480)?.into_bytes()), ("png", chart.png(800, 480)?)] {
        let path = folder.join(format!("terrace-staircase.{name}"));
        std::fs::write(&path, bytes)?;
        println!("{}", path.display());
    }
    Ok(())
}

/// A made-up cost of a threshold, with a gap where it was never asked for.
fn staircase() -> Staircase {
    let steps: Vec<Step> =
        [(0.0, 0.06, 1.9), (0.06, 0.14, 1.3), (0.14, 0.45, 0.42), (0.5, 0.72, 0.61), (0.72, 1.0, 1.12)]
            .map(|(low, high, value)| Step { low, high, value })
            .to_vec();
    let first_in_step = |x: f64| steps.iter().any(|s| s.low <= x && x < s.low + 0.09);
    let samples = (0..40).map(|k| (f64::from(k) * 0.618_034).fract()).filter_map(|x| {
        let step = steps.iter().find(|s| s.low <= x && x < s.high)?;
        Some(Sample { x, value: step.value, evaluated: first_in_step(x) })
    });
    Staircase {
        title: "cost of the threshold φ".into(),
        samples: samples.collect(),
        best: Some([0.236, 0.42]),
        steps: steps.clone(),
        ..Staircase::new("threshold φ", "β", [0.0, 1.0])
    }
}
