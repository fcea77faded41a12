//! Draws a small cloud and a staircase into a folder: that of the first argument, or the temporary one.

use std::path::PathBuf;
use terrace_draw::{Bounds, CloudPicture, Image, Sample, Staircase, Step, View, label_colour};
use terrace_synth::{Params, Scene, SceneKind};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args_os().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    for kind in SceneKind::ALL {
        let views = match kind {
            SceneKind::Table | SceneKind::Desk => [[-115.0, 25.0], [-75.0, 35.0]],
            SceneKind::Room => [[-60.0, 48.0], [125.0, 48.0]],
            SceneKind::Corridor => [[-120.0, 40.0], [-30.0, 40.0]],
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
                if matches!(kind, SceneKind::Table | SceneKind::Desk)
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

    let chart = staircase();
    for (name, bytes) in [("svg", chart.svg(1_600, 960)?.into_bytes()), ("png", chart.png(1_600, 960)?)] {
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
