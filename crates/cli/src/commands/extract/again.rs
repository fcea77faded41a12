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
    /// Hands out all points with their labels, chunk by chunk, and reads the next chunk meanwhile.
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
        let mut of_chunk = Vec::new();
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
                let (labels, each, of_chunk) = (&mut *labels, &mut each, &mut of_chunk);
                let mut work = |chunk: &Scan| {
                    let labelling = Instant::now();
                    labels.label(view, chunk, of_chunk);
                    let labelled = labelling.elapsed();
                    (labelled, each(chunk, of_chunk), labelling.elapsed())
                };
                // What is behind the points that were used could not be read before.
                let ((labelled, outcome, worked), following) = if left == 0 && !whole {
                    (work(&chunk), Ok(None))
                } else {
                    chunks.next_beside(chunk, work)
                };
                outcome?;
                timings.label += labelled.as_secs_f64();
                timings.load += begun.elapsed().saturating_sub(worked).as_secs_f64();
                progress.advance_points(&mut told, points, read + chunks.bytes_read());
                next = following?;
            }
            waiting = Instant::now();
            if left > 0 {
                return Err(changed());
            }
            view += 1;
            read += length(source);
            Ok(())
        })
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
