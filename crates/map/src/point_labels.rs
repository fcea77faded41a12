//! Labels of points that were not kept, as they are read again.

use std::borrow::Cow;

use rayon::prelude::*;
use terrace_grid::{CellId, CellIndex, VoxelGrid};
use terrace_types::{Frame, PlaneId, Scan};

use crate::facing::{Counter, Seen, face_sensors};
use crate::mapper::{FineCells, Kept};
use crate::regions::RegionLabels;
use crate::{ExtractError, Mapper, PlaneMap, Stage};

/// Points that are labelled by a thread at once.
const AT_ONCE: usize = 1 << 14;

/// Tells of which plane points are that are given once more: [`Mapper::extract_streamed`].
#[derive(Debug, Clone)]
pub struct PointLabels<'m> {
    of: Of<'m>,
    by: By,
    /// Whether points are still counted.
    counts: bool,
}

/// The map of the points.
#[derive(Debug, Clone)]
enum Of<'m> {
    Lent(&'m Mapper),
    /// Given away, with what is left of the cells that points were added to if their sums are not.
    Given(Box<(Mapper, Option<CellIndex>)>),
}

impl Of<'_> {
    fn mapper(&self) -> &Mapper {
        match self {
            Self::Lent(mapper) => mapper,
            Self::Given(given) => &given.0,
        }
    }

    fn cells(&self) -> Option<Cells<'_>> {
        let index = match self {
            Self::Lent(_) => None,
            Self::Given(given) => given.1.as_ref(),
        };
        index.map(Cells::Index).or_else(|| self.mapper().fine().map(Cells::Grid))
    }
}

/// What tells the cells of points.
#[derive(Clone, Copy)]
enum Cells<'c> {
    Grid(&'c VoxelGrid),
    Index(&'c CellIndex),
}

impl Cells<'_> {
    fn find_all(self, points: &[[f64; 3]], cells: &mut Vec<Option<CellId>>, places: &mut Vec<[f32; 3]>) {
        match self {
            Self::Grid(grid) => grid.find_all(points, cells, places),
            Self::Index(index) => index.find_all(points, cells, places),
        }
    }
}

#[derive(Debug, Clone)]
enum By {
    /// Points were kept, and so are labels; of each view those up to a place were told.
    Kept {
        labels: Vec<Option<PlaneId>>,
        told: Vec<usize>,
    },
    /// The plane of each cell, and how many points of each plane each view saw.
    Cells {
        planes: Vec<Option<PlaneId>>,
        counter: Counter,
        seen: Vec<Seen>,
    },
    Regions(Box<RegionLabels>),
}

impl Mapper {
    /// The planes of what was inserted so far, without the labels of points, and what labels the points when they are given once more.
    ///
    /// Of regions `points`, `centroid` and `rms` are then what samples of the points say, up to sixteen of each cell of half the edge, and
    /// so is the order of the planes, which stays. No plane faces its sensors yet. [`PointLabels::finish`] makes up for that, but for
    /// the order, and for planes with fewer points than [`min_points`](crate::Grown::min_points) in the end, which stay. Where no cell
    /// has more points than its sample, the result is that of [`Mapper::extract`].
    ///
    /// ```
    /// use terrace::{Frame, Mapper, Params, Scan, Sigma};
    ///
    /// // A floor that comes in ten chunks.
    /// let chunk = |i: u32| {
    ///     let point = |k: u32| [0.02 * f64::from(k % 100), 0.02 * f64::from(10 * i + k / 100), 0.0];
    ///     let frame = Frame::World { sensor: Some([1.0, 1.0, 1.0]) };
    ///     Scan::new((0..1000).map(point).collect(), Sigma::Uniform(0.005), frame)
    /// };
    /// let mut mapper = Mapper::streaming(Params { cell_size: Some(0.1), ..Params::default() })?;
    /// mapper.insert(&chunk(0)?)?;
    /// for i in 1..10 {
    ///     mapper.insert_more(&chunk(i)?)?;
    /// }
    /// let (mut map, mut labels) = mapper.extract_streamed(|_| {})?;
    /// let (mut of_chunk, mut labelled) = (Vec::new(), 0);
    /// for i in 0..10 {
    ///     labels.label(0, &chunk(i)?, &mut of_chunk);
    ///     labelled += of_chunk.iter().flatten().count();
    /// }
    /// labels.finish(&mut map);
    /// assert_eq!((map.planes.len(), map.summary().labelled), (1, labelled));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`Mapper::extract`].
    pub fn extract_streamed(
        &self,
        begins: impl FnMut(Stage),
    ) -> Result<(PlaneMap, PointLabels<'_>), ExtractError> {
        let (fine, kept) = (self.fine_cells(), Cow::Borrowed(self.kept()));
        let (map, by, _) = self.planes_and_labels(fine, kept, begins)?;
        Ok((map, PointLabels { of: Of::Lent(self), by, counts: true }))
    }

    /// As [`extract_streamed`](Self::extract_streamed), to the bit, of a map that is not needed any more: where regions are grown, the sums
    /// of its cells and the samples of their points are forgotten as soon as they are not needed either.
    ///
    /// # Errors
    /// As [`Mapper::extract`]; the map is gone then, too.
    pub fn into_streamed(
        mut self,
        begins: impl FnMut(Stage),
    ) -> Result<(PlaneMap, PointLabels<'static>), ExtractError> {
        let kept = Cow::Owned(self.take_kept());
        let given =
            if self.is_streaming() && self.params().grows().is_some() { self.take_fine() } else { None };
        let (map, by, index) = match given {
            Some(cells) => self.planes_and_labels(Some(cells), kept, begins)?,
            None => self.planes_and_labels(self.fine_cells(), kept, begins)?,
        };
        if index.is_some() {
            self.forget_samples();
        }
        Ok((map, PointLabels { of: Of::Given(Box::new((self, index))), by, counts: true }))
    }

    fn planes_and_labels(
        &self,
        cells: Option<FineCells<'_>>,
        kept: Cow<'_, [Kept]>,
        begins: impl FnMut(Stage),
    ) -> Result<(PlaneMap, By, Option<CellIndex>), ExtractError> {
        let views = self.views().len();
        Ok(match self.params().grows() {
            _ if !self.is_streaming() => {
                let mut map = self.extract_kept(cells, kept, begins)?;
                let labels = std::mem::take(&mut map.labels);
                (map, By::Kept { labels, told: vec![0; views] }, None)
            }
            Some(regions) => {
                let (map, labels, index) = self.regions_streamed(cells, &regions, begins)?;
                (map, By::Regions(Box::new(labels)), index)
            }
            None => {
                let (map, planes) = self.clusters(&kept, begins)?;
                let counter = Counter::new(map.planes.len());
                (map, By::Cells { planes, counter, seen: vec![Seen::new(); views] }, None)
            }
        })
    }
}

impl PointLabels<'_> {
    /// Puts the plane of each point of a chunk into `labels`, in place of what is there. `view` is the number of its scan in the order
    /// of insertion, from 0. All points of all scans are to be given once before [`finish`](Self::finish), chunks of any size; those of a
    /// scan, where a map keeps its points, in the order of insertion.
    pub fn label(&mut self, view: usize, chunk: &Scan, labels: &mut Vec<Option<PlaneId>>) {
        labels.clear();
        labels.resize(chunk.len(), None);
        let Some(cells) = self.of.cells() else { return };
        match &mut self.by {
            By::Kept { labels: kept, told } => {
                let views = self.of.mapper().views();
                let before: usize = views.iter().take(view).map(|view| view.points).sum();
                let (Some(told), Some(of)) = (told.get_mut(view), views.get(view)) else { return };
                if *told >= of.points {
                    *told = 0;
                }
                let known = kept.iter().skip(before + *told).take(of.points - *told);
                labels.iter_mut().zip(known).for_each(|(label, known)| *label = *known);
                *told += chunk.len();
            }
            By::Cells { planes, counter, seen } => {
                let plane = |cell: &Option<CellId>| planes.get((*cell)?.index()).copied().flatten();
                in_parts(
                    cells,
                    chunk,
                    labels,
                    || (),
                    |(), cells, _, labels| {
                        labels.iter_mut().zip(cells).for_each(|(label, cell)| *label = plane(cell));
                    },
                );
                if let Some(seen) = seen.get_mut(view).filter(|_| self.counts) {
                    counter.count(labels, seen);
                }
            }
            By::Regions(regions) => {
                in_parts(
                    cells,
                    chunk,
                    labels,
                    || regions.tally(),
                    |tally, cells, places, labels| {
                        regions.label(cells, places, labels, tally);
                    },
                );
                regions.counted(self.counts.then_some(view));
            }
        }
    }

    /// Turns the planes to the sensors by what each view saw of their cells, where points are not given again. Of regions these are the
    /// cells that nine in ten points of one plane make up.
    pub(crate) fn face_by_cells(&self, map: &mut PlaneMap) {
        let planes = match &self.by {
            By::Kept { .. } => return,
            By::Cells { planes, .. } => planes,
            By::Regions(regions) => &regions.of_cells,
        };
        let mapper = self.of.mapper();
        let Some(seen) = mapper.seen() else { return };
        let coarse = mapper.params().grows().and_then(|_| mapper.coarse());
        let of_grid = |cell: CellId| coarse.map_or(Some(cell), |coarse| coarse.of.get(cell.index()).copied());
        let views = mapper.views();
        let mut points = vec![Seen::new(); views.len()];
        for (cell, sighting) in seen.all(views.len().saturating_sub(1)) {
            let plane = of_grid(cell).and_then(|cell| planes.get(cell.index()).copied().flatten());
            if let Some((id, of_view)) = plane.zip(points.get_mut(sighting.view as usize)) {
                *of_view.entry(id).or_default() += u64::from(sighting.points);
            }
        }
        face_sensors(&mut map.planes, &points, views);
    }

    /// Gives the planes their points as they were labelled one by one, and turns them to the sensors that saw them. What is labelled
    /// afterwards is not counted: points can be given again, to be drawn or outlined.
    pub fn finish(&mut self, map: &mut PlaneMap) {
        if !std::mem::take(&mut self.counts) {
            return;
        }
        match &self.by {
            By::Kept { .. } => {}
            By::Cells { seen, .. } => face_sensors(&mut map.planes, seen, self.of.mapper().views()),
            By::Regions(regions) => {
                let seen = regions.finish(&mut map.planes);
                face_sensors(&mut map.planes, &seen, self.of.mapper().views());
            }
        }
    }
}

/// Memory of a thread.
#[derive(Default)]
struct Part {
    world: Vec<[f64; 3]>,
    cells: Vec<Option<CellId>>,
    places: Vec<[f32; 3]>,
}

/// Finds the cells and places of points, and hands them out together with their labels, on all threads, which each have one of what
/// `begin` makes for as many parts as they take on end.
fn in_parts<T>(
    grid: Cells<'_>,
    chunk: &Scan,
    labels: &mut [Option<PlaneId>],
    begin: impl Fn() -> T + Sync,
    label: impl Fn(&mut T, &[Option<CellId>], &[[f32; 3]], &mut [Option<PlaneId>]) + Sync,
) {
    let frame = chunk.frame();
    let parts = chunk.points().par_chunks(AT_ONCE).zip(labels.par_chunks_mut(AT_ONCE));
    let of_part = |(part, of_thread): &mut (Part, T),
                   (points, labels): (&[[f64; 3]], &mut [Option<PlaneId>])| {
        let Part { world, cells, places } = part;
        let points = match frame {
            Frame::World { .. } => points,
            Frame::Sensor { pose } => {
                world.clear();
                world.extend(points.iter().map(|point| pose.transform(*point)));
                world
            }
        };
        cells.clear();
        places.clear();
        grid.find_all(points, cells, places);
        label(of_thread, cells, places, labels);
    };
    parts.for_each_init(|| (Part::default(), begin()), of_part);
}
