//! How far planes reach: their polygons, areas and meshes, from the points of the inputs read once more.

use std::path::Path;

use rayon::prelude::*;
use serde::Serialize;
use terrace::{ExtractedPlane, PlaneId, PlaneMap};
use terrace_extent::{
    ExtentError, Footprint, MOST_PIXELS, Mesh, OutlineOptions, PlaneExtent, PlaneFrame, suggested_resolution,
};
use terrace_io::planes_json::Timings;
use terrace_io::{WriteError, palette, write_atomically};

use super::again::{Again, labelled};
use super::inputs::Inputs;
use crate::error::CliError;
use crate::progress::Progress;

/// Pixels that all planes hold together, about half a gigabyte. Planes share them by their cells; one that needs more has
/// larger pixels.
const PIXELS: usize = 1 << 24;

/// Pixels that even the smallest plane may hold.
const LEAST_PIXELS: usize = 1 << 12;

/// Edges of cells in spacings, where the spacing is not known: what cell sizes are chosen by.
const SPACINGS_PER_CELL: f64 = 5.0;

/// Parts of the largest coordinate that no spacing is smaller than: some thousand times what a double tells apart.
const PARTS: f64 = (1_u64 << 40) as f64;

/// What is known of how far the planes of a map reach.
pub struct Extents {
    spacing: f64,
    gap: f64,
    /// In the order of the planes; none where points are too few for an outline.
    planes: Vec<Option<Outlined>>,
}

struct Outlined {
    id: PlaneId,
    resolution: f64,
    extent: PlaneExtent,
}

/// `extents.json`.
#[derive(Serialize)]
struct Document<'a> {
    format: &'static str,
    version: u32,
    spacing: f64,
    gap: f64,
    planes: Vec<Record<'a>>,
}

#[derive(Serialize)]
struct Record<'a> {
    id: u32,
    resolution: f64,
    #[serde(flatten)]
    extent: &'a PlaneExtent,
}

impl Extents {
    /// Reads the points again and outlines each plane.
    ///
    /// # Errors
    /// [`CliError`] when a file cannot be read again. A plane that cannot be outlined is reported and has no extent.
    pub fn of(map: &PlaneMap, again: &mut Again, progress: &mut Progress) -> Result<Self, CliError> {
        let spacing = spacing(map, again.inputs);
        let options = OutlineOptions::for_spacing(spacing);
        let footprints = footprints(map, again, spacing, progress)?;
        progress.begin("outlines", footprints.len());
        let outlined: Vec<_> = footprints
            .into_par_iter()
            .map(|footprint| {
                let footprint = footprint?;
                let extent = PlaneExtent::of(&footprint, &options)?;
                progress.advance(1);
                Ok((footprint.resolution(), extent))
            })
            .collect();
        let planes = map.planes.iter().zip(outlined).map(|(plane, outlined): (_, Result<_, ExtentError>)| {
            let id = plane.id;
            let report = |e| progress.warn(&format!("plane {} has no extent: {e}", id.get()));
            let (resolution, extent) = outlined.map_err(report).ok()?;
            (!extent.polygons().is_empty()).then_some(Outlined { id, resolution, extent })
        });
        Ok(Self { spacing, gap: options.gap, planes: planes.collect() })
    }

    /// Area of a plane in square metres.
    pub fn area(&self, plane: PlaneId) -> Option<f64> {
        Some(self.planes.get(plane.index())?.as_ref()?.extent.area())
    }

    /// The polygons of all planes as JSON; a damaged file is never left behind.
    ///
    /// # Errors
    /// [`WriteError`] when it cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        let planes = self.outlined().map(|outlined| Record {
            id: outlined.id.get(),
            resolution: outlined.resolution,
            extent: &outlined.extent,
        });
        let document = Document {
            format: "terrace-extents",
            version: 1,
            spacing: self.spacing,
            gap: self.gap,
            planes: planes.collect(),
        };
        write_atomically(path, |out| {
            serde_json::to_writer(&mut *out, &document).map_err(std::io::Error::from)?;
            Ok(out.write_all(b"\n")?)
        })
    }

    /// The polygons of all planes as triangles. One that cannot be cut into triangles is reported and left out.
    pub fn mesh(&self, progress: &Progress) -> Mesh {
        let mut mesh = Mesh::new();
        for Outlined { id, extent, .. } in self.outlined() {
            if let Err(e) = mesh.add_numbered(id.get(), extent, palette::colour(*id)) {
                progress.warn(&format!("plane {} is not in the mesh: {e}", id.get()));
            }
        }
        mesh
    }

    fn outlined(&self) -> impl Iterator<Item = &Outlined> {
        self.planes.iter().flatten()
    }
}

/// Distance between neighbouring points in metres, as far as it is known.
fn spacing(map: &PlaneMap, inputs: &Inputs) -> f64 {
    let known = map.used.chosen.map(|chosen| chosen.spacing);
    let reach = inputs.extent().map_or(0.0, |extent| extent.largest);
    known.unwrap_or(map.used.cell_size / SPACINGS_PER_CELL).max(reach / PARTS)
}

/// Where the points of each plane are.
fn footprints(
    map: &PlaneMap,
    again: &mut Again,
    spacing: f64,
    progress: &mut Progress,
) -> Result<Vec<Result<Footprint, ExtentError>>, CliError> {
    let cells: usize = map.planes.iter().map(|plane| plane.cells).sum();
    let empty = |plane: &ExtractedPlane| {
        let share = plane.cells as f64 / cells as f64 * PIXELS as f64;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 2^24")]
        let pixels = (share as usize).clamp(LEAST_PIXELS, MOST_PIXELS);
        let frame = PlaneFrame::new(&plane.plane, plane.centroid)?;
        Footprint::with_max_pixels(frame, suggested_resolution(spacing), pixels)
    };
    let mut footprints: Vec<_> = map.planes.iter().map(empty).collect();
    again.read("extents", progress, &mut Timings::default(), |scan, labels| {
        for point in labelled(scan, labels) {
            let place = point.plane.and_then(|plane| footprints.get_mut(plane.index()));
            if let Some(place) = place
                && let Ok(footprint) = place
                && let Err(e) = footprint.add(point.position)
            {
                *place = Err(e);
            }
        }
        Ok(())
    })?;
    Ok(footprints)
}
