//! Draws small clouds, a staircase and a Q-Q plot into a folder: that of the first argument, or the temporary one.

use std::path::PathBuf;
use terrace_draw::{
    Bounds, CloudPicture, Image, QqPlot, QqSeries, Sample, Staircase, Step, View, label_colour,
};
use terrace_synth::{Params, Scene, SceneKind};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args_os().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    for kind in SceneKind::ALL {
        let views = match kind {
            SceneKind::Room | SceneKind::Building => [[-60.0, 48.0], [125.0, 48.0]],
            SceneKind::Corridor => [[-120.0, 40.0], [-30.0, 40.0]],
            _ => [[-115.0, 25.0], [-75.0, 35.0]],
        };
        let scans = Scene::new(kind).generate(&Params::default())?;
        let cloud = scans.merged();
        let points = cloud.scan.points();
        let bounds = Bounds::of(points.iter().copied()).ok_or("no points")?;
        let mut pictures = Vec::new();
        for [azimuth, elevation] in views {
            let view = View::from_degrees(azimuth, elevation)?.with_perspective_degrees(35.0)?;
            let mut picture = CloudPicture::new(800, 640, view, bounds)?
                .with_title(&format!("{kind} from azimuth {azimuth}°"));
            for (point, label) in points.iter().zip(&cloud.labels) {
                // What would be seen from behind is left out, so that one looks into rooms.
                let plane = label.and_then(|id| scans.planes.get(id.index()));
                if !matches!(kind, SceneKind::Room | SceneKind::Building | SceneKind::Corridor)
                    || plane.is_none_or(|plane| view.faces(plane.plane.normal()))
                {
                    picture.add(*point, label_colour(*label));
                }
            }
            pictures.push(picture.image());
        }
        if let [left, right] = pictures.as_slice() {
            let path = folder.join(format!("terrace-{kind}.png"));
            std::fs::write(&path, Image::beside(left, right)?.png()?)?;
            println!("{}", path.display());
        }
    }

    let (stairs, qq) = (staircase(), qq_plot());
    for (name, bytes) in [
        ("staircase.svg", stairs.svg(1_600, 960)?.into_bytes()),
        ("staircase.png", stairs.png(1_600, 960)?),
        ("qq.svg", qq.svg(800, 640)?.into_bytes()),
        ("qq.png", qq.png(800, 640)?),
    ] {
        let path = folder.join(format!("terrace-{name}"));
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
    // Of the samples on a step only the first was evaluated.
    let mut visited = vec![false; steps.len()];
    let samples = (0..40).map(|k| (f64::from(k) * 0.618_034).fract()).filter_map(|x| {
        let (step, visited) = steps.iter().zip(&mut visited).find(|(s, _)| s.low <= x && x < s.high)?;
        Some(Sample { x, value: step.value, evaluated: !std::mem::replace(visited, true) })
    });
    Staircase {
        title: "cost of the threshold φ".into(),
        samples: samples.collect(),
        best: Some([0.236, 0.42]),
        steps: steps.clone(),
        ..Staircase::new("threshold φ", "β", [0.0, 1.0])
    }
}

/// Made-up distances of errors with two coordinates: honest ones, ones twice as large as claimed, and outliers.
fn qq_plot() -> QqPlot {
    // With two degrees of freedom the distance expected below a share p is √(−2 ln(1 − p)).
    let expected = |p: f64| (-2.0 * (1.0 - p).ln()).sqrt();
    let series = |name: &str, observed: &dyn Fn(f64) -> f64| QqSeries {
        name: name.into(),
        points: (0..200).map(|k| expected((f64::from(k) + 0.5) / 200.0)).map(|e| [e, observed(e)]).collect(),
    };
    // Where the empirical share is within 0.1 of the true one.
    let band = (2..=53).map(|k| {
        let e = f64::from(k) / 16.0;
        let p = 1.0 - (-e * e / 2.0).exp();
        [e, expected((p - 0.1).max(0.0)), if p < 0.9 { expected(p + 0.1) } else { f64::INFINITY }]
    });
    QqPlot {
        title: "errors of planes".into(),
        series: vec![
            series("honest", &|e| e * (1.0 + 0.02 * (9.0 * e).sin())),
            series("too sure", &|e| 1.6 * e),
            series("with outliers", &|e| if e > 2.4 { 1.5 * e.powi(2) } else { 0.9 * e }),
            QqSeries { name: "never seen".into(), points: Vec::new() },
        ],
        band: band.collect(),
        range: None,
    }
}
