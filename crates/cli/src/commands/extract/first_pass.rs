//! The first pass over the inputs: their points into the map.

use std::time::Instant;

use rayon::prelude::*;
use terrace::{CellSizeSample, Frame, InsertError, Inserted, Mapper, Scan, Sigma};
use terrace_io::planes_json::Timings;
use terrace_io::{PlyExtent, ReadError, Source};

use super::chunks::{Chunks, Reading, bytes, length};
use super::inputs::Inputs;
use crate::error::CliError;
use crate::progress::{Points, Progress};

/// What the stage is called.
const READING: &str = "reading";
/// So many points of the first scan are held until they have shown their cell size: as many as are all looked at for it.
const MOST_HELD: usize = 1 << 20;
/// Points that a thread measures at once.
const AT_ONCE: usize = 1 << 14;

/// Reads the sources, as many at a time as there are threads, and inserts them in order, chunk by chunk. A source that cannot be read is
/// reported and left out; of one that fails after its first chunk the points before are used, which is reported too. What the points span is
/// found with `with_extent`.
///
/// # Errors
/// [`CliError`] when none could be used.
pub fn insert_all(
    mapper: &mut Mapper,
    sources: &[Source],
    reading: Reading,
    with_extent: bool,
    progress: &mut Progress,
    timings: &mut Timings,
) -> Result<Inputs, CliError> {
    let bytes = bytes(sources);
    let points = progress.begin_points(READING, bytes);
    let mut inputs = Inputs::default();
    inputs.extent = with_extent.then(PlyExtent::default);
    let mut pass = FirstPass { mapper, reading, progress, points, timings, bytes, read: 0, inputs };
    let mut begun = Instant::now();
    reading.begin_each(sources, |source, opened| {
        pass.timings.load += begun.elapsed().as_secs_f64();
        pass.source(source, opened);
        begun = Instant::now();
        Ok::<_, CliError>(())
    })?;
    let inputs = pass.inputs;
    match inputs.last_skipped() {
        Some(last) if inputs.used() == 0 => {
            Err(CliError::NothingUsable { inputs: sources.len(), last: last.to_owned() })
        }
        _ => Ok(inputs),
    }
}

struct FirstPass<'a, 'p> {
    mapper: &'a mut Mapper,
    reading: Reading<'a>,
    progress: &'p mut Progress,
    points: Points,
    timings: &'p mut Timings,
    /// Bytes of all files, and of those so far.
    bytes: u64,
    read: u64,
    inputs: Inputs,
}

impl<'a> FirstPass<'a, '_> {
    fn source(&mut self, source: &'a Source, opened: Result<(Chunks<'a>, Scan), ReadError>) {
        let outcome = opened
            .map_err(|error| error.to_string())
            .and_then(|(chunks, first)| self.begin(source, chunks, first));
        self.read += length(source);
        match outcome {
            Ok(()) => self.progress.advance_points(&mut self.points, 0, self.read),
            Err(reason) => {
                self.progress.warn(&format!("left out: {reason}"));
                self.inputs.skip(source, reason);
            }
        }
    }

    /// Inserts a source, unless its beginning is refused.
    fn begin(&mut self, source: &'a Source, chunks: Chunks<'a>, first: Scan) -> Result<(), String> {
        if source.pose_noise.is_some() && !has_pose(source, &first) {
            return Err(format!(
                "{}: the pose of the scan is said to be uncertain, but it is not known: give --poses, or a PCD with a \
                 VIEWPOINT",
                source.path.display()
            ));
        }
        let refused = |error: InsertError| format!("{}: {error}", source.path.display());
        let (mut chunks, begun) = if self.mapper.wants_cell_size() {
            self.choose_cell_size(source, chunks, first)?
        } else {
            (chunks, first)
        };
        let mut used = Used { points: 0, inserted: None };
        let pose_noise = source.pose_noise;
        let first = |mapper: &mut Mapper, scan: &Scan| mapper.insert_from(scan, pose_noise);
        let cut = match self.insert(&mut used, &mut chunks, begun, first).map_err(refused)? {
            Ok(next) => self.follow(&mut used, &mut chunks, next).map_err(|cut| match cut {
                Cut::Read(error) => error.to_string(),
                Cut::Insert(error) => refused(error),
            }),
            Err(error) => Err(error.to_string()),
        };
        self.inputs.not_measured += chunks.not_measured();
        if let Some(Inserted { out_of_range, first_refusal: Some(first), .. }) = used.inserted {
            let path = source.path.display();
            self.progress.warn(&format!("{path}: {out_of_range} points left out; the first: {first}"));
        }
        if let Err(reason) = &cut {
            self.progress.warn(&format!("only the first {} points are used: {reason}", used.points));
        }
        self.inputs.take(source, used.points, cut.err());
        Ok(())
    }

    /// Inserts what comes after the first chunk.
    fn follow(&mut self, used: &mut Used, chunks: &mut Chunks, mut next: Option<Scan>) -> Result<(), Cut> {
        while let Some(chunk) = next {
            let read = self.insert(used, chunks, chunk, Mapper::insert_more).map_err(Cut::Insert)?;
            next = read.map_err(Cut::Read)?;
        }
        Ok(())
    }

    /// Inserts a chunk, and reads the next one meanwhile.
    fn insert(
        &mut self,
        used: &mut Used,
        chunks: &mut Chunks,
        chunk: Scan,
        insert: impl FnOnce(&mut Mapper, &Scan) -> Result<Inserted, InsertError> + Send,
    ) -> Result<Result<Option<Scan>, ReadError>, InsertError> {
        let (begun, points) = (Instant::now(), chunk.len());
        let errors_known = !matches!(chunk.sigma(), Sigma::Unknown);
        let (mapper, spans) = (&mut *self.mapper, self.inputs.extent.is_some());
        let work = |chunk: &Scan| {
            let inserting = Instant::now();
            let inserted = insert(mapper, chunk)?;
            Ok::<_, InsertError>((inserted, spans.then(|| extent(chunk)), inserting.elapsed()))
        };
        let (done, next) = chunks.next_beside(chunk, work);
        let (inserted, extent, took) = done?;
        self.timings.grid += took.as_secs_f64();
        self.timings.load += begun.elapsed().saturating_sub(took).as_secs_f64();
        self.inputs.errors_known |= errors_known;
        if let (Some(all), Some(extent)) = (&mut self.inputs.extent, extent) {
            *all = both(*all, extent);
        }
        used.points += points;
        let before = used.inserted.map_or((0, None), |all| (all.out_of_range, all.first_refusal));
        used.inserted = Some(Inserted {
            out_of_range: before.0 + inserted.out_of_range,
            first_refusal: before.1.or(inserted.first_refusal),
            ..inserted
        });
        self.progress.advance_points(&mut self.points, points, self.read + chunks.bytes_read());
        Ok(next)
    }

    /// A scan of one chunk shows its cell size when it is inserted. One of some is held until it has shown its own; one of more is read to its
    /// end for it, and begun again.
    fn choose_cell_size(
        &mut self,
        source: &'a Source,
        mut chunks: Chunks<'a>,
        first: Scan,
    ) -> Result<(Chunks<'a>, Scan), String> {
        let reading = Instant::now();
        let told = |error: ReadError| error.to_string();
        let (mut points, mut later) = (first.len(), Vec::new());
        while points <= MOST_HELD {
            let Some(chunk) = chunks.next().map_err(told)? else { break };
            points += chunk.len();
            later.push(chunk);
        }
        if later.is_empty() {
            return Ok((chunks, first));
        }
        let (sample, held) = if points <= MOST_HELD {
            let mut sample = CellSizeSample::new(source.pose_noise);
            sample.push(&first);
            for chunk in &later {
                sample.push(chunk);
            }
            chunks.hold(later);
            (sample, Some((chunks, first)))
        } else {
            let sampled = self.sample(source, chunks, std::iter::once(first).chain(later));
            self.points = self.progress.begin_points(READING, self.bytes);
            (sampled.map_err(told)?, None)
        };
        let present = sample.present();
        let chosen = sample.choose().ok_or(InsertError::NoCellSize { present });
        let begun = chosen.and_then(|choice| self.mapper.begin_with(choice));
        begun.map_err(|error| format!("{}: {error}", source.path.display()))?;
        let begun = held.map_or_else(|| self.reading.begin(source).map_err(told), Ok);
        self.timings.load += reading.elapsed().as_secs_f64();
        begun
    }

    /// Points of all of a scan that is begun.
    fn sample(
        &mut self,
        source: &Source,
        mut chunks: Chunks<'a>,
        mut begun: impl Iterator<Item = Scan>,
    ) -> Result<CellSizeSample, ReadError> {
        let mut points = self.progress.begin_points("cell size", length(source));
        let mut sample = CellSizeSample::new(source.pose_noise);
        let mut next = begun.next();
        while let Some(chunk) = next {
            let points_of_chunk = chunk.len();
            let mut work = |chunk: &Scan| sample.push(chunk);
            next = match begun.next() {
                Some(second) => {
                    work(&chunk);
                    chunks.recycle(chunk);
                    Some(second)
                }
                None => chunks.next_beside(chunk, work).1?,
            };
            self.progress.advance_points(&mut points, points_of_chunk, chunks.bytes_read());
        }
        Ok(sample)
    }
}

/// What was used of a source.
struct Used {
    points: usize,
    inserted: Option<Inserted>,
}

/// Why the rest of a source is not used.
enum Cut {
    Read(ReadError),
    Insert(InsertError),
}

/// Whether it is known where the sensor stood, and not only taken as the origin.
fn has_pose(source: &Source, scan: &Scan) -> bool {
    source.pose.is_some() || matches!(scan.frame(), Frame::World { sensor: Some(_) })
}

/// How many points a scan has, and how far they reach.
fn extent(scan: &Scan) -> PlyExtent {
    let of_part = |first: usize| {
        let part = (first..scan.len()).take(AT_ONCE);
        PlyExtent::of(part.filter_map(|at| scan.world_position(at)))
    };
    let parts = (0..scan.len().div_ceil(AT_ONCE)).into_par_iter().map(|part| of_part(part * AT_ONCE));
    parts.reduce(PlyExtent::default, both)
}

fn both(a: PlyExtent, b: PlyExtent) -> PlyExtent {
    PlyExtent { points: a.points + b.points, largest: a.largest.max(b.largest) }
}
