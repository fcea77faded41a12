//! `terrace synth`: a scan of a scene with known planes.

use terrace_io::planes_json::{PlaneRecord, PlanesFile, Summary};
use terrace_io::{MeasuredPoint, PlyExtent, write_labels_npy, write_measured_ply};
use terrace_synth::{Params, Scene, TruePlane};

use crate::args::{self, SynthArgs};
use crate::error::CliError;
use crate::progress::Progress;

/// Points made at a time.
const CHUNK: usize = 1 << 18;

/// Makes the scene once for each file, so that memory does not grow with the number of points.
pub fn run(args: &SynthArgs) -> Result<(), CliError> {
    let scene = match args.scene {
        args::Scene::Table => Scene::table(),
        args::Scene::Desk => Scene::desk(),
        args::Scene::Strip => Scene::strip(),
        args::Scene::Patch => Scene::patch(),
        args::Scene::Room => Scene::room(),
        args::Scene::Corridor => Scene::corridor(),
    };
    let params = Params { points: args.points, sigma: args.sigma, seed: args.seed };
    let mut progress = Progress::new(args.quiet);

    progress.spin("measuring");
    let mut chunks = scene.chunks(&params, CHUNK)?;
    let mut extent = PlyExtent::default();
    let mut labelled = 0;
    for chunk in &mut chunks {
        let part = PlyExtent::of(chunk.scan.scan.world_points().flatten().map(|p| p.position));
        extent.points += part.points;
        extent.largest = extent.largest.max(part.largest);
        labelled += chunk.scan.labels.iter().flatten().count() as u64;
    }
    let planes = chunks.planes();

    progress.spin("points.ply");
    let points = scene.chunks(&params, CHUNK)?.flat_map(|chunk| {
        let labels = chunk.scan.labels;
        let points: Vec<_> = chunk.scan.scan.world_points().collect();
        points.into_iter().zip(labels).filter_map(|(point, plane)| {
            let point = point?;
            // One value for all axes: the largest, as the paper takes it.
            let sigma = point.sigma.map_or(0.0, |s| s[0].max(s[1]).max(s[2]));
            Some(MeasuredPoint { position: point.position, plane, sigma })
        })
    });
    write_measured_ply(&args.out.join("points.ply"), extent, points)?;

    progress.spin("labels.npy");
    let labels = scene.chunks(&params, CHUNK)?.flat_map(|chunk| chunk.scan.labels);
    write_labels_npy(&args.out.join("labels.npy"), labels, extent.points)?;

    let mut file = PlanesFile { planes: planes.iter().map(record).collect(), ..PlanesFile::default() };
    file.parameters.insert("scene".into(), scene.kind().name().into());
    file.parameters.insert("seed".into(), args.seed.into());
    file.parameters.insert("sigma".into(), args.sigma.into());
    file.parameters.insert("truth".into(), true.into());
    file.summary = Some(Summary {
        points: extent.points,
        labelled,
        planes: planes.len() as u64,
        normal_uncertainty_mean: None,
        optimised: None,
    });
    file.write(&args.out.join("planes.json"))?;
    progress.finish();
    if !args.quiet {
        println!(
            "{}: {} points of {} planes in {}",
            scene.kind(),
            extent.points,
            planes.len(),
            args.out.display()
        );
    }
    Ok(())
}

fn record(plane: &TruePlane) -> PlaneRecord {
    let mut record = PlaneRecord::new(plane.id, &plane.plane, plane.points as u64);
    record.name = Some(plane.name.to_owned());
    record.centroid = plane.centroid;
    record
}
