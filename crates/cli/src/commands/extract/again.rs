//! The inputs read again, for the labels of their points.

use std::time::Instant;

use terrace::{PlaneId, PointLabels, Scan};
use terrace_io::planes_json::Timings;
use terrace_io::{LabelledPoint, LabelsWriter, PlyWriter};

use super::chunks::{Reading, bytes, length};
use super::inputs::Inputs;
use crate::error::CliError;
use crate::progress::Progress;

/// What is needed to read the inputs again and label their points.
pub struct Again<'a, 'm> {
    pub inputs: &'a Inputs,
    pub reading: Reading<'a>,
    pub labels: &'a mut PointLabels<'m>,
}

impl Again<'_, '_> {
    /// Hands out all points with their labels, chunk by chunk. While a chunk is labelled, the one before is handed out and the next one read.
    ///
    /// # Errors
    /// [`CliError`] when a file cannot be read or no longer has as many points, and what `each` returns.
    pub fn read(
        &mut self,
        what: &'static str,
        progress: &mut Progress,
        timings: &mut Timings,
        mut each: impl FnMut(&Scan, &[Option<PlaneId>]) -> Result<(), CliError> + Send,
    ) -> Result<(), CliError> {
        let Self { inputs, reading, labels } = self;
        let mut told = progress.begin_points(what, bytes(inputs.sources()));
        let (mut view, mut read) = (0, 0);
        // The chunk before, which is not handed out yet, and memory for the labels of the next.
        let mut before: Option<(Scan, Vec<Option<PlaneId>>)> = None;
        let mut spare = Vec::new();
        let mut waiting = Instant::now();
        reading.begin_each(inputs.sources(), |source, begun| {
            let (mut chunks, first) = begun?;
            let changed = || CliError::Changed { path: source.path.clone() };
            let (count, whole) = inputs.points_of(view);
            let (mut next, mut left) = (Some(first), count);
            timings.load += waiting.elapsed().as_secs_f64();
            while let Some(chunk) = next {
                let (begun, points) = (Instant::now(), chunk.len());
                left = left.checked_sub(points).ok_or_else(changed)?;
                let mut of_chunk = std::mem::take(&mut spare);
                let mut work = || {
                    let working = Instant::now();
                    let outcome = before.as_ref().map_or(Ok(()), |(scan, labels)| each(scan, labels));
                    let labelling = Instant::now();
                    labels.label(view, &chunk, &mut of_chunk);
                    (outcome, labelling.elapsed(), working.elapsed())
                };
                // What is behind the points that were used could not be read before.
                let ((outcome, labelled, worked), following) =
                    if left == 0 && !whole { (work(), Ok(None)) } else { chunks.beside(work) };
                outcome?;
                timings.label += labelled.as_secs_f64();
                timings.load += begun.elapsed().saturating_sub(worked).as_secs_f64();
                progress.advance_points(&mut told, points, read + chunks.bytes_read());
                if let Some((scan, labels)) = before.replace((chunk, of_chunk)) {
                    chunks.recycle(scan);
                    spare = labels;
                }
                next = following?;
            }
            waiting = Instant::now();
            if left > 0 {
                return Err(changed());
            }
            view += 1;
            read += length(source);
            Ok(())
        })?;
        before.map_or(Ok(()), |(scan, labels)| each(&scan, &labels))
    }
}

/// Present points of a chunk with their labels.
pub fn labelled<'s>(
    scan: &'s Scan,
    labels: &'s [Option<PlaneId>],
) -> impl Iterator<Item = LabelledPoint> + 's {
    let points = scan.world_positions().zip(labels);
    points.filter_map(|(position, plane)| Some(LabelledPoint { position: position?, plane: *plane }))
}

/// `labels.npy`, and `points.ply` where it is asked for, while they are written.
pub struct Labelled {
    pub labels: LabelsWriter,
    pub points: Option<PlyWriter<LabelledPoint>>,
}

impl Labelled {
    /// Adds a chunk.
    pub fn push(&mut self, scan: &Scan, labels: &[Option<PlaneId>]) -> Result<(), CliError> {
        self.labels.push(labels.iter().copied())?;
        if let Some(points) = &mut self.points {
            points.push(labelled(scan, labels))?;
        }
        Ok(())
    }

    /// Gives the files their names.
    pub fn finish(self) -> Result<(), CliError> {
        self.labels.finish()?;
        Ok(self.points.map_or(Ok(()), PlyWriter::finish)?)
    }
}
