//! The loops, each on the furnished room of `terrace-synth`: made anew, and prepared outside of what is counted.

use std::hint::black_box;

use terrace::{Connectivity, FitTo, Frame, Mapper, Params, Scan, Search, SeedOrder, Sigma, choose_cell_size};
use terrace_cluster::Grower;
use terrace_depth::{Camera, PlaneFinder};
use terrace_grid::{CellId, DenseCells, PointErrors, VoxelGrid, Walk};
use terrace_normals::{UncertainNormal, estimate, fit_plane, symmetric_eigen_batch};
use terrace_regions::{Cell, Field, Found, Sample, Samples, Settings, find};
use terrace_stats::{Stats, SymmetricMatrix3, UncertainVector};
use terrace_synth::Scene;

use crate::Outcome;

const POINTS: usize = 300_000;
/// Points of a dense cell: the least that is chosen by itself.
const TAU: u64 = 4;

/// A loop that is counted.
pub(crate) struct Loop {
    pub(crate) name: &'static str,
    /// What its instructions are told for each of.
    pub(crate) of: &'static str,
    /// Runs it, and tells for how many of these.
    pub(crate) run: fn() -> Outcome<usize>,
}

const fn named(name: &'static str, of: &'static str, run: fn() -> Outcome<usize>) -> Loop {
    Loop { name, of, run }
}

pub(crate) const ALL: [Loop; 16] = [
    named("choose the cell size", "point", cell_size),
    named("cells and sums", "point", || insert(&Room::new()?)),
    named("cells and sums, shuffled", "point", || insert(&Room::new()?.shuffled())),
    named("cells found again", "point", find_again),
    named("samples", "point", samples),
    named("cells of twice the edge", "cell", halved),
    named("eigen-solver", "matrix", eigen),
    named("plane fit", "cell", planes),
    named("min-max normal", "cell", normals),
    named("clusters", "cell", clusters),
    named("search for φ", "evaluation", phi),
    named("regions", "cell", regions),
    named("labels", "point", labels),
    named("depth image", "pixel", depth_image),
    named("insert and extract, default", "point", || extract(Params::default())),
    named("insert and extract, clusters", "point", || extract(Params::clusters())),
];

/// Boxes before a slanted wall, off by up to a centimetre from pixel to pixel, in millimetres.
fn depth_image() -> Outcome<usize> {
    const SIZE: [usize; 2] = [640, 480];
    let raw = |at: usize| {
        let (u, v) = (at % SIZE[0], at / SIZE[0]);
        let is_box = u / 80 % 2 == 1 && v / 96 % 2 == 1;
        let depth = if is_box { 1500 + u / 4 } else { 2600 - v / 2 + u / 8 };
        u16::try_from(depth + at * 48_271 % 12 + at * 16_807 % 11)
    };
    let raw = (0..SIZE[0] * SIZE[1]).map(raw).collect::<Result<Vec<u16>, _>>()?;
    let camera = Camera::new(SIZE, [585.0, 585.0], [319.5, 239.5], 1000.0)?;
    let mut finder = PlaneFinder::new(camera, Some("kinect".parse()?), terrace_depth::Settings::default())?;
    let found = counted(|| finder.find(&raw))?;
    if found.planes.len() < 3 { Err("the boxes are no longer found".into()) } else { Ok(raw.len()) }
}

/// The function below as callgrind calls it.
pub(crate) const COUNTED: &str = "instructions::loops::counted";

/// What is counted: all from the call to the return.
#[inline(never)]
fn counted<T>(work: impl FnOnce() -> T) -> T {
    black_box(work())
}

fn scans() -> Outcome<Vec<Scan>> {
    let params = terrace_synth::Params { points: Some(POINTS), ..Default::default() };
    Ok(Scene::room().generate(&params)?.scans.into_iter().map(|made| made.scan).collect())
}

/// The points in the world, view after view, with their errors and the cell size of the first view.
struct Room {
    cell_size: f64,
    points: Vec<[f64; 3]>,
    sigmas: Vec<f64>,
}

impl Room {
    fn new() -> Outcome<Self> {
        let scans = scans()?;
        let cell_size = scans.first().and_then(choose_cell_size).ok_or("no cell size")?.cell_size;
        let (mut points, mut sigmas) = (Vec::new(), Vec::new());
        for scan in &scans {
            let (Frame::Sensor { pose }, Sigma::PerPoint(errors)) = (scan.frame(), scan.sigma()) else {
                return Err("the room is no longer seen by sensors with errors of each point".into());
            };
            points.extend(scan.points().iter().map(|point| pose.transform(*point)));
            sigmas.extend(errors);
        }
        Ok(Self { cell_size, points, sigmas })
    }

    /// Every point once, far from the one before: a step that has no divisor in common with the count.
    fn shuffled(&self) -> Self {
        let at = |i: usize| i * 48_271 % self.points.len();
        Self {
            cell_size: self.cell_size,
            points: (0..self.points.len()).map(|i| self.points[at(i)]).collect(),
            sigmas: (0..self.points.len()).map(|i| self.sigmas[at(i)]).collect(),
        }
    }
}

/// A room in cells of half the cell size.
struct Gridded {
    grid: VoxelGrid,
    cells: Vec<Option<CellId>>,
    places: Vec<[i16; 3]>,
}

impl Gridded {
    fn of(room: &Room) -> Outcome<Self> {
        let mut grid = VoxelGrid::of_halves(room.cell_size)?;
        let (mut cells, mut places) = (Vec::new(), Vec::new());
        let errors = PointErrors::Each(&room.sigmas);
        grid.insert_all(&room.points, errors, &mut cells, Some(&mut places))?;
        Ok(Self { grid, cells, places })
    }

    fn cell(&self, point: usize) -> Option<u32> {
        self.cells[point].and_then(|cell| u32::try_from(cell.index()).ok())
    }

    fn samples(&self) -> Samples {
        let mut samples = Samples::new(self.grid.place_unit());
        samples.push_all(|point| self.cell(point), &self.places);
        samples
    }

    fn found(&self, fine: &[Cell], samples: &Samples) -> Outcome<Found> {
        Ok(find(
            Field::of(fine, self.grid.cell_size())?,
            self.cells.len() as u64,
            |cell| u32::try_from(cell).map_or(Sample::EMPTY, |cell| samples.sample(cell)),
            &Settings::default(),
        )?)
    }

    fn fine(&self) -> Vec<Cell> {
        self.grid
            .founded()
            .map(|cell| Cell { key: cell.key(), is_wide: false, stats: cell.stats() })
            .collect()
    }
}

/// Dense cells of the cell size.
struct Dense {
    graph: DenseCells,
    stats: Vec<Stats>,
}

impl Dense {
    fn new() -> Outcome<Self> {
        let (grid, _) = Gridded::of(&Room::new()?)?.grid.halved()?;
        let graph = grid.dense(TAU, Connectivity::Corners);
        let stats = graph.cells().iter().filter_map(|id| Some(grid.get(*id)?.stats())).collect();
        Ok(Self { graph, stats })
    }

    fn normals(&self) -> Vec<Option<UncertainVector>> {
        let mut walk = Walk::default();
        let normal = |cell| {
            let around = walk.neighbourhood(&self.graph, cell, 1);
            estimate(around.iter().map(|near| &self.stats[*near as usize]), FitTo::Points).ok()
        };
        let normals = (0..self.graph.len()).map(normal);
        normals.map(|normal| normal.as_ref().map(UncertainNormal::as_vector)).collect()
    }
}

fn cell_size() -> Outcome<usize> {
    let scans = scans()?;
    let first = scans.first().ok_or("no scan")?;
    counted(|| choose_cell_size(first)).ok_or("no cell size")?;
    Ok(first.len())
}

fn insert(room: &Room) -> Outcome<usize> {
    Ok(counted(|| Gridded::of(room))?.cells.len())
}

fn find_again() -> Outcome<usize> {
    let room = Room::new()?;
    let grid = Gridded::of(&room)?.grid;
    let (mut cells, mut places) = (Vec::new(), Vec::new());
    counted(|| grid.find_all(&room.points, &mut cells, &mut places));
    Ok(cells.len())
}

fn samples() -> Outcome<usize> {
    let gridded = Gridded::of(&Room::new()?)?;
    counted(|| gridded.samples());
    Ok(gridded.cells.len())
}

fn halved() -> Outcome<usize> {
    let grid = Gridded::of(&Room::new()?)?.grid;
    counted(|| grid.halved())?;
    Ok(grid.len())
}

fn eigen() -> Outcome<usize> {
    let stats = Dense::new()?.stats;
    let matrices: Vec<SymmetricMatrix3> = stats.iter().filter_map(Stats::covariance).collect();
    let (batches, _) = matrices.as_chunks::<4>();
    counted(|| {
        let solved = batches.iter().flat_map(symmetric_eigen_batch);
        solved.map(|eigen| eigen.vectors[0][0]).sum::<f64>()
    });
    Ok(4 * batches.len())
}

fn planes() -> Outcome<usize> {
    let stats = Dense::new()?.stats;
    counted(|| stats.iter().filter_map(|cell| Some(fit_plane(cell).ok()?.normal[0])).sum::<f64>());
    Ok(stats.len())
}

fn normals() -> Outcome<usize> {
    let dense = Dense::new()?;
    Ok(counted(|| dense.normals()).len())
}

fn clusters() -> Outcome<usize> {
    let dense = Dense::new()?;
    let (normals, Params { omega, phi, .. }) = (dense.normals(), Params::clusters());
    counted(|| -> Outcome<usize> {
        let neighbours = |cell| dense.graph.neighbours(cell);
        let mut grower = Grower::new(&normals, neighbours, omega, SeedOrder::MostCertain)?;
        Ok(grower.grow(phi)?.len())
    })?;
    Ok(normals.len())
}

fn phi() -> Outcome<usize> {
    let mut mapper = Mapper::new(Params::clusters())?;
    for scan in scans()? {
        mapper.insert(&scan)?;
    }
    let uncertain = mapper.uncertain_clusters()?;
    let clusters: Vec<_> = uncertain.iter().collect();
    let search = |of: &terrace::UncertainCluster<'_>| of.search(Search::default());
    let found = counted(|| clusters.iter().map(search).collect::<Result<Vec<_>, _>>())?;
    Ok(found.iter().map(|minimum| minimum.evaluations).sum())
}

fn regions() -> Outcome<usize> {
    let gridded = Gridded::of(&Room::new()?)?;
    let (fine, samples) = (gridded.fine(), gridded.samples());
    counted(|| gridded.found(&fine, &samples))?;
    Ok(fine.len())
}

fn labels() -> Outcome<usize> {
    let gridded = Gridded::of(&Room::new()?)?;
    let found = gridded.found(&gridded.fine(), &gridded.samples())?;
    let mut labels = vec![None; gridded.cells.len()];
    #[allow(clippy::cast_possible_truncation, reason = "a power of two")]
    let unit = gridded.grid.place_unit() as f32;
    counted(|| {
        let points = (0..).zip(&gridded.places).zip(&mut labels);
        let metres = |place: &[i16; 3]| place.map(|x| f32::from(x) * unit);
        let points = points.map(|((at, place), to)| (gridded.cell(at), metres(place), to));
        found.labeller.label_all(points, |to, label| *to = label)
    });
    Ok(labels.len())
}

fn extract(params: Params) -> Outcome<usize> {
    let scans = scans()?;
    let map = counted(|| -> Outcome<terrace::PlaneMap> {
        let mut mapper = Mapper::new(params)?;
        for scan in &scans {
            mapper.insert(scan)?;
        }
        Ok(mapper.extract()?)
    })?;
    Ok(map.labels.len())
}
