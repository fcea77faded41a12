//! A single depth image: its planes by tiles of pixels, without a map.

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::time::Instant;

use serde_json::{Map, Value, json};
use terrace::{Frame, PlaneId, Pose, Scan, Sigma};
use terrace_depth::{Camera, DepthPlane, DepthPlanes, PlaneFinder, Settings};
use terrace_draw::Bounds;
use terrace_io::depth::DepthImage;
use terrace_io::planes_json::{PlaneRecord, PlanesFile, Summary, TiltOffset, Timings};
use terrace_io::{ErrorSource, Intrinsics, LabelsWriter, PlyExtent, PlyWriter, ReadOptions, Source};

use super::again::{Labelled, labelled};
use super::inputs::Inputs;
use crate::args::Preset;
use crate::error::CliError;
use crate::extract_args::ExtractArgs;
use crate::picture::{TwoSides, write_png};
use crate::progress::Progress;

/// Bytes that tell a depth image.
const HEAD: u64 = 26;
/// Rows of the table.
const ROWS: usize = 20;

/// A depth image and what is needed to see it in space.
pub struct Lone<'s> {
    source: &'s Source,
    image: DepthImage,
    intrinsics: Intrinsics,
}

impl<'s> Lone<'s> {
    /// The only source, if it is a depth image that can be read and nothing is asked for that takes cells.
    pub fn of(args: &ExtractArgs, sources: &'s [Source], options: &ReadOptions) -> Option<Self> {
        let [source] = sources else { return None };
        let takes_cells = args.preset != Preset::Default
            || args.cell.is_some()
            || args.method.tau.is_some()
            || args.method.join.is_some()
            || args.method.floor.is_some()
            || args.extent
            || !args.mesh.is_empty()
            || args.method.about_clusters().is_some()
            || source.pose_noise.is_some();
        #[cfg(feature = "parquet")]
        let takes_cells = takes_cells || args.save_map.is_some();
        if takes_cells {
            return None;
        }
        // What cannot be read is told by the way that reads everything.
        let image = DepthImage::read(&depth_png(&source.path)?).ok()?;
        Some(Self { source, image, intrinsics: options.intrinsics? })
    }

    fn camera(&self, options: &ReadOptions) -> Result<Camera, CliError> {
        let [fx, fy, cx, cy] = self.intrinsics.entries();
        // Not more than 32 bits of columns and rows fit a computer of 32 bits or more.
        let size = [self.image.width, self.image.height].map(|edge| edge as usize);
        Ok(Camera::new(size, [fx, fy], [cx, cy], options.depth_scale)?)
    }

    /// The pixels as points.
    fn scan(&self, options: &ReadOptions) -> Result<Scan, CliError> {
        let points = self.image.points(&self.intrinsics, options.depth_scale)?;
        let pose = self.source.pose.unwrap_or(Pose::IDENTITY);
        Ok(Scan::new(points, Sigma::Unknown, Frame::Sensor { pose })?)
    }

    /// Finds the planes and writes everything that is asked for.
    pub fn extract(
        &self,
        args: &ExtractArgs,
        options: &ReadOptions,
        progress: &mut Progress,
        (start, mut timings): (Instant, Timings),
    ) -> Result<(), CliError> {
        let noise = match &options.errors {
            ErrorSource::Model(noise) => Some(*noise),
            ErrorSource::FromFile(_) => None,
        };
        let defaults = Settings::default();
        let settings = Settings {
            tilt: args.method.max_tilt.unwrap_or(defaults.tilt),
            reach: args.method.reach.unwrap_or(defaults.reach),
            min_points: args.method.min_points,
            min_area: args.method.min_area,
            ..defaults
        };
        let mut finder = PlaneFinder::new(self.camera(options)?, noise, settings)?;
        timings.load = start.elapsed().as_secs_f64();
        let finding = Instant::now();
        let mut found = finder.find(&self.image.raw)?;
        timings.grow = Some(finding.elapsed().as_secs_f64());
        if let Some(pose) = &self.source.pose {
            found.planes.iter_mut().for_each(|plane| *plane = plane.moved(pose));
        }
        let writing = Instant::now();
        self.write_points(args, options, &found, progress)?;
        timings.write = writing.elapsed().as_secs_f64();
        timings.total = start.elapsed().as_secs_f64();
        let mut inputs = Inputs::default();
        inputs.take(self.source, self.image.raw.len(), None);
        let mut parameters = parameters(&found, &settings);
        parameters.extend(inputs.parameters(args));
        let records =
            (0..).zip(&found.planes).filter_map(|(at, plane)| record(at, plane, !args.method.no_covariance));
        let summary = Summary {
            points: self.image.raw.len() as u64,
            labelled: found.planes.iter().map(|plane| plane.points).sum(),
            planes: found.planes.len() as u64,
            normal_uncertainty_mean: None,
            optimised: None,
        };
        let file = PlanesFile {
            parameters,
            planes: records.collect(),
            summary: Some(summary),
            timings_seconds: Some(timings),
        };
        file.write(&args.out.join("planes.json"))?;
        progress.finish();
        if !args.quiet {
            out!("{}", told(&file, args, timings.grow.unwrap_or_default()));
        }
        Ok(())
    }

    fn write_points(
        &self,
        args: &ExtractArgs,
        options: &ReadOptions,
        found: &DepthPlanes,
        progress: &mut Progress,
    ) -> Result<(), CliError> {
        progress.spin("writing");
        let labels = LabelsWriter::create(&args.out.join("labels.npy"), found.labels.len() as u64)?;
        let scan = self.scan(options)?;
        let positions = || scan.world_points().flatten().map(|point| point.position);
        let points = if args.no_points {
            None
        } else {
            Some(PlyWriter::create(&args.out.join("points.ply"), PlyExtent::of(positions()))?)
        };
        let mut written = Labelled { labels, points };
        written.push(&scan, &found.labels)?;
        if args.picture {
            let on_planes = labelled(&scan, &found.labels).filter(|p| p.plane.is_some()).map(|p| p.position);
            if let Some(bounds) = Bounds::of(on_planes) {
                let mut picture = TwoSides::new(bounds, args.up, &format!("{} planes", found.planes.len()))?;
                let inside =
                    |p: [f64; 3]| (0..3).all(|i| (bounds.min()[i]..=bounds.max()[i]).contains(&p[i]));
                labelled(&scan, &found.labels)
                    .filter(|point| inside(point.position))
                    .for_each(|point| picture.add(point.position, point.plane));
                write_png(&args.out.join("planes.png"), &picture.image()?.png()?)?;
            }
        }
        written.finish()
    }
}

/// The bytes of a file whose first ones are those of a depth image: others may be larger than memory.
fn depth_png(path: &Path) -> Option<Vec<u8>> {
    let mut file = File::open(path).ok()?;
    let mut bytes = Vec::new();
    file.by_ref().take(HEAD).read_to_end(&mut bytes).ok()?;
    if !DepthImage::is_depth_png(&bytes) {
        return None;
    }
    file.read_to_end(&mut bytes).ok()?;
    Some(bytes)
}

fn parameters(found: &DepthPlanes, settings: &Settings) -> Map<String, Value> {
    let image = json!({
        "tile": DepthPlanes::TILE,
        "tilt": settings.tilt,
        "reach": settings.reach,
        "turn": settings.turn,
        "min_points": found.min_points,
        "min_area": found.min_area,
        "noise_scale": found.noise_scale,
        "points": found.points,
    });
    Map::from_iter([("image".to_owned(), image)])
}

fn record(at: usize, plane: &DepthPlane, with_covariance: bool) -> Option<PlaneRecord> {
    let mut record = PlaneRecord::new(PlaneId::from_index(at)?, &plane.plane, plane.points);
    record.centroid = Some(plane.centroid);
    if let Some(covariant) = plane.covariant.as_ref().filter(|_| with_covariance) {
        // The same for a plane whose normal is turned round: all signs change at once.
        record.covariance = Some(covariant.covariance_of_coefficients());
        record.tilt_offset_covariance = Some(TiltOffset {
            at: covariant.fit.centroid,
            axes: covariant.fit.axes,
            matrix: covariant.tilt_offset.rows(),
        });
        record.reduced_chi_squared = Some(plane.reduced_chi_squared);
        record.growth = Some(plane.growth);
    }
    record.area = Some(plane.area);
    record.rms = Some(plane.rms);
    Some(record)
}

/// What was found, for people.
fn told(file: &PlanesFile, args: &ExtractArgs, seconds: f64) -> String {
    let mut text =
        "  id    points   area m2        a        b        c          d  rms mm tilt deg   off mm\n"
            .to_owned();
    for plane in file.planes.iter().take(ROWS) {
        let [a, b, c, d] = plane.coefficients;
        let (area, rms) = (plane.area.unwrap_or_default(), 1000.0 * plane.rms.unwrap_or_default());
        let sure = plane.tilt_offset_covariance.as_ref().map_or_else(
            || format!(" {:>8} {:>8}", "-", "-"),
            |of| format!(" {:>8.3} {:>8.3}", of.largest_tilt().to_degrees(), 1000.0 * of.offset()),
        );
        text += &format!(
            "{:>4} {:>9} {area:>9.3} {a:>8.4} {b:>8.4} {c:>8.4} {d:>10.4} {rms:>7.2}{sure}\n",
            plane.id, plane.points
        );
    }
    if file.planes.len() > ROWS {
        text += &format!("  ... and {} more in planes.json\n", file.planes.len() - ROWS);
    }
    if file.parameters.get("errors").is_none_or(Value::is_null) {
        text += "standard errors of the depths are not given (--sigma, --sensor); found from how flat tiles scatter\n";
    }
    let (labelled, points) =
        file.summary.as_ref().map_or((0, 0), |summary| (summary.labelled, summary.points));
    text += &format!(
        "{} planes, {labelled} of {points} pixels labelled, in {:.1} ms; one depth image, by tiles of {} pixels (with --cell, as a \
         cloud of points)\nwritten to {}\n",
        file.planes.len(),
        1000.0 * seconds,
        DepthPlanes::TILE,
        args.out.display()
    );
    text
}
