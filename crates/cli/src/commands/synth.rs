//! `terrace synth`: a scan of a scene with known planes.

use terrace_io::planes_json::{PlaneRecord, PlanesFile, Summary};
use terrace_io::{LabelsWriter, MeasuredPoint, PlyExtent, PlyWriter};
use terrace_synth::{Params, Scene, SceneKind, TruePlane};

use crate::args::SynthArgs;
use crate::error::CliError;
use crate::progress::Progress;

/// Points made at a time.
const CHUNK: usize = 1 << 18;

/// What became of one pass over a scene.
enum Pass {
    Whole(Made),
    /// Points reach farther than the file of points was made for.
    Farther(PlyExtent),
}

struct Made {
    planes: Vec<TruePlane>,
    extent: PlyExtent,
    labelled: u64,
}

/// Makes the points chunk by chunk and writes each as it comes, so that memory does not grow with their number.
pub fn run(args: &SynthArgs) -> Result<(), CliError> {
    let kind = SceneKind::from(args.scene);
    let points = args.points.unwrap_or(kind.default_points());
    let scene = Scene::sized(kind, points);
    let params = Params { points: args.points, sigma: args.sigma, seed: args.seed };
    let mut progress = Progress::new(args.quiet);

    // How far points reach is known when the last is made. Hardly any scene needs double precision; one that does is
    // made again, with the same points.
    let mut extent = PlyExtent { points: points as u64, largest: 0.0 };
    let made = loop {
        match write_scene(args, &scene, &params, extent, &mut progress)? {
            Pass::Whole(made) => break made,
            Pass::Farther(reach) => extent = reach,
        }
    };

    let mut file = PlanesFile { planes: made.planes.iter().map(record).collect(), ..PlanesFile::default() };
    file.parameters.insert("scene".into(), kind.name().into());
    file.parameters.insert("seed".into(), args.seed.into());
    file.parameters.insert("sigma".into(), args.sigma.into());
    file.parameters.insert("truth".into(), true.into());
    file.summary = Some(Summary {
        points: made.extent.points,
        labelled: made.labelled,
        planes: made.planes.len() as u64,
        normal_uncertainty_mean: None,
        optimised: None,
    });
    file.write(&args.out.join("planes.json"))?;
    progress.finish();
    if !args.quiet {
        outln!(
            "{}: {} points of {} planes in {}",
            kind,
            made.extent.points,
            made.planes.len(),
            args.out.display()
        );
    }
    Ok(())
}

/// Writes points and labels, unless points reach so far that they need double precision and `extent` does not say so.
fn write_scene(
    args: &SynthArgs,
    scene: &Scene,
    params: &Params,
    extent: PlyExtent,
    progress: &mut Progress,
) -> Result<Pass, CliError> {
    let mut chunks = scene.chunks(params, CHUNK)?;
    progress.begin("points", usize::try_from(extent.points).unwrap_or(usize::MAX));
    let mut points_file = PlyWriter::create(&args.out.join("points.ply"), extent)?;
    let mut labels_file = LabelsWriter::create(&args.out.join("labels.npy"), extent.points)?;
    let mut found = PlyExtent::default();
    let mut labelled = 0;
    for chunk in &mut chunks {
        let labels = &chunk.scan.labels;
        found.add(chunk.scan.scan.world_points().flatten().map(|p| p.position));
        if found.is_double() && !extent.is_double() {
            return Ok(Pass::Farther(PlyExtent { points: extent.points, largest: found.largest }));
        }
        let points = chunk.scan.scan.world_points().zip(labels).filter_map(|(point, plane)| {
            let point = point?;
            // One value for all axes: the largest, as the paper takes it.
            let sigma = point.sigma.map_or(0.0, |s| s[0].max(s[1]).max(s[2]));
            Some(MeasuredPoint { position: point.position, plane: *plane, sigma })
        });
        points_file.push(points)?;
        labels_file.push(labels.iter().copied())?;
        labelled += labels.iter().flatten().count() as u64;
        progress.advance(labels.len());
    }
    progress.spin("to disk");
    points_file.finish()?;
    labels_file.finish()?;
    Ok(Pass::Whole(Made { planes: chunks.planes(), extent: found, labelled }))
}

fn record(plane: &TruePlane) -> PlaneRecord {
    let mut record = PlaneRecord::new(plane.id, &plane.plane, plane.points as u64);
    record.name = Some(plane.name.to_owned());
    record.centroid = plane.centroid;
    record
}
