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
/// Points that a thread measures at once.
const AT_ONCE: usize = 1 << 14;

/// Reads the sources, as many at a time as there are threads, and inserts them in order, chunk by chunk. A source that cannot be read is
/// reported and left out; of one that fails after its first chunk the points before are used, which is reported too.
///
/// # Errors
/// [`CliError`] when none could be used.
pub fn insert_all(
    mapper: &mut Mapper,
    sources: &[Source],
    reading: Reading,
    progress: &mut Progress,
    timings: &mut Timings,
) -> Result<Inputs, CliError> {
    let bytes = bytes(sources);
    let points = progress.begin_points(READING, bytes);
    let inputs = Inputs::default();
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
        let (mut chunks, first) = if self.mapper.wants_cell_size() {
            self.choose_cell_size(source, chunks, first)?
        } else {
            (chunks, first)
        };
        let mut used = Used { points: 0, inserted: None };
        self.insert(&mut used, &first, |mapper, scan| mapper.insert_from(scan, source.pose_noise))
            .map_err(refused)?;
        let cut = self.follow(&mut used, &mut chunks, first).map_err(|cut| match cut {
            Cut::Read(error) => error.to_string(),
            Cut::Insert(error) => refused(error),
        });
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
    fn follow(&mut self, used: &mut Used, chunks: &mut Chunks, first: Scan) -> Result<(), Cut> {
        let mut spent = first;
        loop {
            self.progress.advance_points(&mut self.points, spent.len(), self.read + chunks.bytes_read());
            chunks.recycle(spent);
            let reading = Instant::now();
            let next = chunks.next();
            self.timings.load += reading.elapsed().as_secs_f64();
            let Some(chunk) = next.map_err(Cut::Read)? else { return Ok(()) };
            self.insert(used, &chunk, Mapper::insert_more).map_err(Cut::Insert)?;
            spent = chunk;
        }
    }

    fn insert(
        &mut self,
        used: &mut Used,
        chunk: &Scan,
        insert: impl FnOnce(&mut Mapper, &Scan) -> Result<Inserted, InsertError>,
    ) -> Result<(), InsertError> {
        let inserting = Instant::now();
        let inserted = insert(self.mapper, chunk)?;
        let extent = extent(chunk);
        self.inputs.extent.points += extent.points;
        self.inputs.extent.largest = self.inputs.extent.largest.max(extent.largest);
        self.inputs.errors_known |= !matches!(chunk.sigma(), Sigma::Unknown);
        self.timings.grid += inserting.elapsed().as_secs_f64();
        used.points += chunk.len();
        let before = used.inserted.map_or((0, None), |all| (all.out_of_range, all.first_refusal));
        used.inserted = Some(Inserted {
            out_of_range: before.0 + inserted.out_of_range,
            first_refusal: before.1.or(inserted.first_refusal),
            ..inserted
        });
        Ok(())
    }

    /// A scan of one chunk shows its cell size when it is inserted. One of more is read to its end for it, and begun again.
    fn choose_cell_size(
        &mut self,
        source: &'a Source,
        mut chunks: Chunks<'a>,
        first: Scan,
    ) -> Result<(Chunks<'a>, Scan), String> {
        let reading = Instant::now();
        let told = |error: ReadError| error.to_string();
        let Some(second) = chunks.next().map_err(told)? else { return Ok((chunks, first)) };
        let sampled = self.sample(source, chunks, [first, second]);
        self.points = self.progress.begin_points(READING, self.bytes);
        let (present, sample) = sampled.map_err(told)?;
        let chosen = sample.choose().ok_or(InsertError::NoCellSize { present });
        let begun = chosen.and_then(|choice| self.mapper.begin_with(choice));
        begun.map_err(|error| format!("{}: {error}", source.path.display()))?;
        let again = self.reading.begin(source).map_err(told);
        self.timings.load += reading.elapsed().as_secs_f64();
        again
    }

    /// Points of all of a scan that is begun, and how many are present.
    fn sample(
        &mut self,
        source: &Source,
        mut chunks: Chunks<'a>,
        begun: [Scan; 2],
    ) -> Result<(usize, CellSizeSample), ReadError> {
        let mut points = self.progress.begin_points("cell size", length(source));
        let mut sample = CellSizeSample::new(source.pose_noise);
        let mut present = 0;
        let mut push = |chunk: &Scan, read: u64| {
            sample.push(chunk);
            present += chunk.present();
            self.progress.advance_points(&mut points, chunk.len(), read);
        };
        for chunk in begun {
            push(&chunk, chunks.bytes_read());
            chunks.recycle(chunk);
        }
        while let Some(chunk) = chunks.next()? {
            push(&chunk, chunks.bytes_read());
            chunks.recycle(chunk);
        }
        Ok((present, sample))
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
        PlyExtent::of(part.filter_map(|at| Some(scan.world_point(at)?.position)))
    };
    let parts = (0..scan.len().div_ceil(AT_ONCE)).into_par_iter().map(|part| of_part(part * AT_ONCE));
    parts.reduce(PlyExtent::default, |a, b| PlyExtent {
        points: a.points + b.points,
        largest: a.largest.max(b.largest),
    })
}
