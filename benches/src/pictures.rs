//! Truth beside result, as pictures.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use terrace::{PlaneId, Scan};
use terrace_draw::{Bounds, CloudPicture, DrawError, Image, View, label_colour};
use terrace_eval::Evaluation;

use crate::labelled::{Entry, Labelled};
use crate::overlap::Part;
use crate::scenes::SceneError;
use crate::{Score, value};

/// Edges of each of the two views, in pixels.
const SIZE: (usize, usize) = (500, 400);
/// Full angle of view in degrees of what is not seen by a camera.
const ANGLE: f64 = 50.0;
/// Rooms are looked into from above and from below: without what is higher, then without what is lower, in metres.
const ROOM: [f64; 2] = [0.2, 2.5];
/// Fewer points than these are drawn as small cubes, for their surfaces cannot be closed.
const FEW: usize = 5_000;
/// Points of no plane.
const NONE: Paint = Paint { colour: [80, 80, 80], striped: false };
/// Points that no count looks at.
const UNCOUNTED: Paint = Paint { colour: [225, 225, 225], striped: false };
/// The stripes of found planes that are no true one.
const STRIPE: [u8; 3] = [255, 0, 255];
/// Stripes, and gaps between them, along the diagonal of a scene.
const STRIPES: f64 = 150.0;

#[derive(Debug, Clone, Copy)]
struct Paint {
    colour: [u8; 3],
    striped: bool,
}

/// From where a scene is looked at.
#[derive(Debug, Clone, Copy)]
enum Look {
    /// From the sensor, with these places of the axes right, down and forward, and their signs.
    Sensor([(usize, f64); 3]),
    /// From this azimuth and elevation, in degrees, what lies between two heights; up is z.
    Around { azimuth: f64, elevation: f64, heights: [f64; 2] },
}

/// Writes `NAME.png`: the points by their true planes, and beside it by those found. What was found has the colour of the
/// true plane with which its IoU is above one half; without such a one it has another, with stripes.
///
/// # Errors
/// When no point is on a true plane, or the file cannot be written.
pub fn write(folder: &Path, entry: &Entry, scene: &Labelled, score: &Score) -> Result<(), SceneError> {
    let looks = Look::at(entry);
    let views =
        looks.into_iter().map(|look| sides(look, entry, scene, score)).collect::<Result<Vec<_>, _>>()?;
    let sheet = Image::tiled(views.as_flattened(), 2)?;
    fs::create_dir_all(folder)?;
    Ok(fs::write(folder.join(format!("{}.png", entry.name)), sheet.png()?)?)
}

/// By truth, and by what was found.
fn sides(look: Look, entry: &Entry, scene: &Labelled, score: &Score) -> Result<[Image; 2], SceneError> {
    let places: Vec<Option<[f64; 3]>> =
        scene.scans.iter().flat_map(Scan::world_points).map(|point| look.seen(point?.position)).collect();
    // What the planes span: single outliers must not shrink the picture.
    let on_planes = places.iter().zip(&scene.truth).filter(|(_, truth)| **truth > 0);
    let bounds = Bounds::of(on_planes.filter_map(|(place, _)| *place)).ok_or("no true plane to draw")?;
    let extent = [0, 1, 2].map(|i| bounds.max()[i] - bounds.min()[i]);
    let width = extent.iter().map(|x| x * x).sum::<f64>().sqrt() / STRIPES;
    let cube = if places.len() < FEW { cube(width) } else { vec![[0.0; 3]] };

    let of = |name| value(&score.measures, name);
    let count = |name| of(name).unwrap_or_default();
    let f1 = of("f1_80").map(|f1| format!(", F1@.8 {f1:.3}")).unwrap_or_default();
    let mut sides = [
        look.picture(bounds, &format!("{}, true planes: {}", entry.name, count("true_planes")))?,
        look.picture(bounds, &format!("found planes: {}{f1}", count("found_planes")))?,
    ];
    let found = found_paints(scene, score);
    for ((place, truth), label) in places.iter().zip(&scene.truth).zip(&score.found) {
        let Some(place) = *place else { continue };
        let paints = match truth {
            ..0 => [UNCOUNTED; 2],
            _ => [true_paint(*truth), found.get(label).copied().unwrap_or(NONE)],
        };
        for (side, paint) in sides.iter_mut().zip(paints) {
            for step in &cube {
                side.add([0, 1, 2].map(|i| place[i] + step[i]), paint.at(place, width));
            }
        }
    }
    Ok(sides.map(|side| side.image()))
}

impl Look {
    fn at(entry: &Entry) -> Vec<Self> {
        let around = |azimuth, elevation, heights| Self::Around { azimuth, elevation, heights };
        let all = [-f64::INFINITY, f64::INFINITY];
        match (entry.group, entry.name.as_str()) {
            ("roomframe" | "mosd-boxes" | "mosd-bare" | "nyuv2_planes", _) => {
                vec![Self::Sensor([(0, 1.0), (1, 1.0), (2, 1.0)])]
            }
            // This camera has y upwards.
            ("evops_icl", _) => vec![Self::Sensor([(0, 1.0), (1, -1.0), (2, 1.0)])],
            ("synpeb", _) => vec![Self::Sensor([(1, -1.0), (2, -1.0), (0, 1.0)])],
            (_, "room300k" | "synth-room-3M") => {
                vec![around(-125.0, 50.0, [all[0], ROOM[1]]), around(-125.0, -50.0, [ROOM[0], all[1]])]
            }
            // All three planes are seen from there.
            (_, "table") => vec![around(-107.0, 11.0, all)],
            ("roofs", _) => vec![around(-125.0, 60.0, all)],
            _ => vec![around(-125.0, 35.0, all)],
        }
    }

    /// Where a point is drawn; nowhere when it lies behind the sensor, or is cut away.
    ///
    /// The logarithm of depth makes this keep small angles along the axis of the sensor, and with them light and shade.
    fn seen(self, place: [f64; 3]) -> Option<[f64; 3]> {
        match self {
            Self::Sensor(axes) => {
                let [right, down, forward] = axes.map(|(axis, sign)| sign * place[axis]);
                (forward > 0.0).then(|| [right / forward, down / forward, forward.ln()])
            }
            Self::Around { heights: [low, high], .. } => (low..=high).contains(&place[2]).then_some(place),
        }
    }

    /// An empty picture.
    fn picture(self, bounds: Bounds, title: &str) -> Result<CloudPicture, DrawError> {
        let picture = |view| Ok(CloudPicture::new(SIZE.0, SIZE.1, view, bounds)?.with_title(title));
        match self {
            Self::Sensor(_) => picture(View::from_degrees(-90.0, 0.0)?.with_up([0.0, -1.0, 0.0])?),
            Self::Around { azimuth, elevation, .. } => {
                picture(View::from_degrees(azimuth, elevation)?.with_perspective_degrees(ANGLE)?)
            }
        }
    }
}

/// Steps to the points of a small cube.
fn cube(step: f64) -> Vec<[f64; 3]> {
    let steps = [-step, 0.0, step];
    let square = |x: f64| steps.into_iter().flat_map(move |y| steps.map(|z| [x, y, z]));
    steps.into_iter().flat_map(square).collect()
}

/// The paint of each found plane.
fn found_paints(scene: &Labelled, score: &Score) -> BTreeMap<i32, Paint> {
    let last = scene.truth.iter().max().copied().unwrap_or(0);
    let is_same = |part: &Part| part.label > 0 && part.iou > Evaluation::HALF;
    let paint = |found: i32| match score.overlaps.in_found(found).into_iter().find(is_same) {
        Some(part) => true_paint(part.label),
        // A colour that no true plane has.
        None => Paint { striped: true, ..true_paint(last.saturating_add(found)) },
    };
    let planes = score.overlaps.found().map(|(label, _)| label).filter(|label| *label > 0);
    planes.map(|label| (label, paint(label))).collect()
}

fn true_paint(label: i32) -> Paint {
    let plane = u32::try_from(label).ok().and_then(PlaneId::new);
    plane.map_or(NONE, |plane| Paint { colour: label_colour(Some(plane)), striped: false })
}

impl Paint {
    /// The colour at a place, with stripes of this width.
    fn at(self, place: [f64; 3], width: f64) -> [u8; 3] {
        // An odd direction: stripes of planes along the axes differ from their edges.
        let along = (0.8 * place[0] + 0.5 * place[1] + 0.65 * place[2]) / width;
        if self.striped && along.rem_euclid(2.0) < 1.0 { STRIPE } else { self.colour }
    }
}
