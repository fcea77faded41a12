//! From cells and points to planes and labels.

use rayon::prelude::*;

use crate::again::{grow_again, is_sure};
use crate::around::Arounds;
use crate::bend::Bend;
use crate::cell::Noise;
use crate::exact::{by_points, samples_of};
use crate::field::Field;
use crate::flat::{Fitted, Flat};
use crate::grow::{Growth, Region as Surface, grow};
use crate::labeller::{Labeller, Measure};
use crate::labels::{Looking, Piece, Points, Whereabouts, by_region, pieces};
use crate::mixture::Mixture;
use crate::parts::take_apart;
use crate::shares::{Share, in_order};
use crate::surface::Looks;
use crate::{Cell, RegionsError, Sample, Settings, Step};

/// Points are taken to be known no better than to this share of a coarser cell: what is smaller is not looked at as a shape.
const FLOOR: f64 = 0.05;
/// Where planes scatter by more than this, in units of the variance of errors, errors are not all there is: surfaces or sensors are
/// bent.
const TRUSTED: f64 = 1.05;
/// Cells may then lie off by so many standard deviations of the others of their region.
const SPREAD: f64 = 3.0;
/// Errors are taken for larger than stated by this at most, as a variance.
const MOST_SCALE: f64 = 10.0;
/// A plane is as wide as so many of its cells: those in the edge of two surfaces make a strip that is along neither.
const NARROWEST: f64 = 3.0;
/// Without a setting: the share of all points, their least number and that which is always enough; the share of the area of all
/// planes, and the number of coarser cells that is always enough. Fewer are where errors are stated: a plane is then known by them to
/// be one, whatever else there is.
const SHARE_OF_POINTS: f64 = 0.004;
const FEWEST_POINTS: f64 = 20.0;
const ENOUGH_POINTS: f64 = 250.0;
const SHARE_OF_AREA: f64 = 0.0025;
const ENOUGH_CELLS: f64 = 50.0;
const ENOUGH_CERTAIN_CELLS: f64 = 12.0;
/// Samples tell how many points a plane has to about this share of them: which have enough is told for good when points are
/// [measured](Found::by_measures).
const UNSURE: f64 = 0.02;
/// A part that does not touch the rest is a plane of its own when it has this share of the points, and so many times the fewest of a
/// plane: a wall that is seen in pieces is one wall.
const SHARE_OF_PART: f64 = 0.1;
const PART: f64 = 2.0;
/// A bend is seen from so many standard errors on, and from this share of what else the surface is off, rms: a sensor bends flat surfaces.
const SIGNIFICANT: f64 = 4.0;
const SHARE_OF_SCATTER: f64 = 0.7;

/// A plane and how well it is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region {
    /// Unit normal; which way it points means nothing.
    pub normal: [f64; 3],
    /// A point of the plane: the mean of the points it was fitted to, in metres.
    pub point: [f64; 3],
    /// Number of points with its label.
    pub points: u64,
    /// Their mean, in metres.
    pub centroid: [f64; 3],
    /// Their root mean square distance from the plane, in metres.
    pub rms: f64,
    /// The area they cover, in m².
    pub area: f64,
    /// Mean squared distance of the points it was fitted to, in units of their errors.
    pub reduced_chi_squared: f64,
    /// Standard error of the orientation where it is least sure, in radians, were the points' errors independent.
    pub tilt: f64,
    /// How the surface of its points is bent; `None` for too few.
    pub bend: Option<Bend>,
    /// Regions of one number are parts of the same plane that do not touch.
    pub surface: u32,
}

/// Planes and the points of each.
#[derive(Debug, Clone, PartialEq)]
pub struct Segmentation {
    /// The planes, those with most points first.
    pub regions: Vec<Region>,
    /// For each point the number of its plane, from 0.
    pub labels: Vec<Option<u32>>,
    /// How many points of each cell are of which plane, in the order of the cells.
    pub shares: Vec<Share>,
    /// What the variances of errors were multiplied by, because planes scatter by more: 1 where stated errors are all there is.
    pub noise_scale: f64,
    /// The fewest points and the least area of a plane, in m².
    pub min_points: f64,
    /// See [`min_points`](Self::min_points).
    pub min_area: f64,
}

/// Planes, found from the sums of cells and samples of their points.
#[derive(Debug, Clone)]
pub struct Found {
    /// The planes, those with most points first. Points are counted by the samples, so that a plane may have a fiftieth less than are asked for
    /// until they are [measured](Self::by_measures).
    pub regions: Vec<Region>,
    /// How many points of each cell are of which plane, by the samples, in the order of the cells.
    pub shares: Vec<Share>,
    /// What the variances of errors were multiplied by, because planes scatter by more: 1 where stated errors are all there is.
    pub noise_scale: f64,
    /// The fewest points and the least area of a plane, in m².
    pub min_points: f64,
    /// See [`min_points`](Self::min_points).
    pub min_area: f64,
    /// Tells of which plane each point is.
    pub labeller: Labeller,
}

/// Finds the planes of a scene.
///
/// `cells` have an edge of `edge` metres and different keys: half of what noise and spacing suggest for a cell, since regions
/// are looked for at once, twice, four and eight times that. `points` are those the cells are sums of.
///
/// # Errors
/// [`RegionsError`] for cells or points that contradict each other, and settings out of their range.
pub fn segment(
    cells: &[Cell],
    edge: f64,
    points: Points,
    settings: &Settings,
) -> Result<Segmentation, RegionsError> {
    points.check(cells.len())?;
    settings.validate()?;
    let field = Field::of(cells, edge)?;
    let samples = samples_of(points);
    let of_cell = |cell: usize| u32::try_from(cell).map_or(Sample::EMPTY, |cell| samples.sample(cell));
    let known = points.cells.iter().flatten().count();
    Ok(by_points(find(field, known as u64, of_cell, settings)?, points))
}

/// Finds the planes of a scene without its points: from the [sums of cells](Field), and a sample of the points of each. Points are
/// labelled afterwards, with [`Found::labeller`].
///
/// `points` is the number of all points, `samples` gives some points of each cell, by its place among the cells: see
/// [`Samples`](crate::Samples).
///
/// # Errors
/// [`RegionsError::Setting`] for a setting out of its range.
pub fn find<'s>(
    field: Field,
    points: u64,
    samples: impl Fn(usize) -> Sample<'s> + Sync,
    settings: &Settings,
) -> Result<Found, RegionsError> {
    Ok(Grown::of(field, settings)?.find(points, samples))
}

/// Regions as they were grown, before samples of points are looked at. [`find`] is both steps: the first grows regions one after the
/// other, on one thread, and leaves others to what does not need it; the second works on all.
#[derive(Debug)]
pub struct Grown {
    field: Field,
    regions: Vec<Surface>,
    noise: Noise,
    settings: Settings,
}

impl Grown {
    /// Grows regions over cells.
    ///
    /// # Errors
    /// [`RegionsError::Setting`] for a setting out of its range.
    pub fn of(field: Field, settings: &Settings) -> Result<Self, RegionsError> {
        Self::beside(field, settings, || ()).map(|(grown, ())| grown)
    }

    /// As [`of`](Self::of), and does other work meanwhile: what comes before growth is on all threads, and growth on one.
    ///
    /// # Errors
    /// As [`of`](Self::of); the other work is not done then.
    pub fn beside<R: Send>(
        mut field: Field,
        settings: &Settings,
        other: impl FnOnce() -> R + Send,
    ) -> Result<(Self, R), RegionsError> {
        settings.validate()?;
        field.begin_growth();
        let grow = || {
            let grown = grow_as_noise_allows(&field, settings);
            field.end_growth();
            grown
        };
        let ((regions, noise), done) = rayon::join(grow, other);
        Ok((Self { field, regions, noise, settings: *settings }, done))
    }

    /// Finds the planes by samples of points, as [`find`] does.
    pub fn find<'s>(self, points: u64, samples: impl Fn(usize) -> Sample<'s> + Sync) -> Found {
        let Self { mut field, regions: mut grown, noise, settings } = self;
        grown.retain(|region| {
            let [_, across, _] = region.fitted.fit.variances;
            // A strip of the width w scatters by w² / 12.
            !settings.takes(Step::Certain)
                || region.fitted.tilt <= settings.tilt
                    && (12.0 * across).sqrt() >= NARROWEST * field.mean_edge(&region.cells)
        });
        let fewest = (SHARE_OF_POINTS * points as f64).clamp(FEWEST_POINTS, ENOUGH_POINTS);
        let fewest = settings.min_points.map_or(fewest, |fewest| fewest as f64);
        let fewest = if settings.takes(Step::Size) { fewest } else { 1.0 };
        let samples = |cell: usize| samples(field.order[cell] as usize);
        let by_samples = (1.0 - UNSURE) * fewest;
        let mixture = Mixture { field: &field, noise, samples, settings: &settings, fewest: by_samples };
        let mut of_cells = mixture.solve(&grown);
        mixture.recount(&mut of_cells);
        let mut pieces = pieces(&of_cells);

        let (numbers, from) = take_apart(
            &field,
            &pieces,
            grown.len(),
            PART * fewest,
            if settings.takes(Step::Parts) { SHARE_OF_PART } else { f64::INFINITY },
        );
        let surface_of: Vec<u32> = (0..).take(grown.len()).chain(from).collect();
        for (piece, number) in pieces.iter_mut().zip(numbers) {
            piece.region = number;
        }
        let pieces_of = by_region(&pieces, surface_of.len());
        let samples = |cell: usize| mixture.weighted(cell);
        let looking = Looking { field: &field, of_cells: &of_cells, reach: settings.reach, samples };
        let looks_flat = |region: &Region| {
            let curved = |bend: Bend| {
                bend.turn > settings.turn
                    && bend.significance > SIGNIFICANT
                    && bend.rms > SHARE_OF_SCATTER * bend.left
            };
            !settings.takes(Step::Curved) || !region.bend.is_some_and(curved)
        };
        let region = |((number, surface), of): ((u32, &u32), &Vec<u32>)| {
            let pieces: Vec<Piece> = of.iter().map(|at| pieces[*at as usize]).collect();
            let fitted = &grown[*surface as usize].fitted;
            let pieces = looking.at(&pieces, *surface, &fitted.plane);
            let region = Region::of(&field, noise, fitted, *surface, &pieces)?;
            looks_flat(&region).then_some((number, region))
        };
        let numbered = (0..u32::MAX).into_par_iter().zip(&surface_of).zip(&pieces_of);
        let mut found: Vec<(u32, Region)> = numbered.filter_map(region).collect();
        // From 0: the sum of no floating-point numbers is −0.
        let all = found.iter().fold(0.0, |sum, (_, region)| sum + region.area);
        let enough = if settings.errors_are_stated { ENOUGH_CERTAIN_CELLS } else { ENOUGH_CELLS };
        let least = (SHARE_OF_AREA * all).min(enough * field.coarse_edge().powi(2));
        let least = settings.min_area.unwrap_or(least);
        let least = if settings.takes(Step::Size) { least } else { 0.0 };
        found.retain(|(_, region)| region.area >= least && region.points as f64 >= by_samples);
        found.sort_by_key(|(number, region)| (std::cmp::Reverse(region.points), *number));
        let mut rank: Vec<Option<u32>> = vec![None; surface_of.len()];
        for (new, (old, _)) in (0..).zip(&found) {
            rank[*old as usize] = Some(new);
        }
        // What labels points is as large as what told which cells touch.
        field.levels.clear();
        let anchors = std::mem::take(&mut field.anchors);
        let share = |piece: &Piece| {
            let region = rank[piece.region as usize]?;
            Some(Share { cell: field.order[piece.cell as usize], region, points: piece.points })
        };
        let shares = || in_order(field.order.len(), pieces.iter().filter_map(share));
        let plane =
            |(_, region): &(u32, Region)| Flat { normal: region.normal.into(), point: region.point.into() };
        let planes = found.iter().map(plane).collect();
        let numbers = |first: u32| {
            let begin = pieces.partition_point(|piece| piece.cell < first);
            let mut of_pieces = pieces[begin..].iter().peekable();
            let (surface_of, rank) = (&surface_of, &rank);
            move |cell: u32, region: u32| {
                while of_pieces.next_if(|piece| piece.cell < cell).is_some() {}
                let same = |piece: &&Piece| piece.cell == cell && surface_of[piece.region as usize] == region;
                // What no sampled point is of has the number of the largest part.
                rank[of_pieces
                    .clone()
                    .take_while(|piece| piece.cell == cell)
                    .find(same)
                    .map_or(region, |piece| piece.region) as usize]
            }
        };
        let (labeller, shares) =
            rayon::join(|| Labeller::of(&field, anchors, of_cells, settings.reach, numbers, planes), shares);
        Found {
            shares,
            regions: found.into_iter().map(|(_, region)| region).collect(),
            noise_scale: noise.scale,
            min_points: fewest,
            min_area: least,
            labeller,
        }
    }
}

impl Found {
    /// The same planes with points as they were counted and measured one by one, those with most points first; planes with fewer than
    /// are asked for are none. Tells the new number of each plane, if it is one: the [labeller](Self::labeller) keeps the numbers of
    /// before.
    pub fn by_measures(&mut self, measures: &[Measure]) -> Vec<Option<u32>> {
        let points = |at: usize| measures.get(at).map_or(0, |measure| measure.points);
        let is_one = |at: &usize| points(*at) > 0 && points(*at) as f64 >= self.min_points;
        let mut order: Vec<usize> = (0..self.regions.len()).filter(is_one).collect();
        order.sort_by_key(|at| std::cmp::Reverse(points(*at)));
        let mut numbers: Vec<Option<u32>> = vec![None; self.regions.len()];
        for (new, old) in (0..).zip(&order) {
            numbers[*old] = Some(new);
        }
        let measured = |at: &usize| {
            let region = self.regions[*at];
            let measured = measures.get(*at).and_then(|measure| self.labeller.mean_and_rms(*at, measure));
            // Points that are not those of the cells leave it as it was.
            let (centroid, rms) = measured.unwrap_or((region.centroid, region.rms));
            Region { points: points(*at), centroid, rms, ..region }
        };
        self.regions = order.iter().map(measured).collect();
        let share = |share: Share| Some(Share { region: numbers[share.region as usize]?, ..share });
        // A list that is made of another and is no longer stays where that is.
        self.shares = std::mem::take(&mut self.shares).into_iter().filter_map(share).collect();
        numbers
    }
}

impl Region {
    /// What the labelled points of a grown region look like; `None` without any.
    fn of(
        field: &Field,
        noise: Noise,
        fitted: &Fitted,
        surface: u32,
        pieces: &[(Piece, Whereabouts)],
    ) -> Option<Self> {
        let looks = Looks::of(field, fitted, pieces);
        (looks.points > 0).then(|| Self {
            normal: fitted.plane.normal.to_array(),
            point: fitted.plane.point.to_array(),
            points: looks.points,
            centroid: looks.centroid.to_array(),
            rms: looks.rms,
            area: looks.area,
            reduced_chi_squared: fitted.reduced_chi_squared,
            tilt: fitted.tilt,
            // Errors that are larger than stated do not hide a bend.
            bend: looks.bend(fitted.variance / noise.scale),
            surface,
        })
    }
}

/// The regions, and the errors that explain them.
///
/// Stated errors are trusted while planes are as flat as they say. Where they are not, or where errors were found from scatter,
/// which tells nothing of what neighbouring points share, the cells of a region may scatter by more, and the errors are taken to be
/// as large as most points then show.
fn grow_as_noise_allows(field: &Field, settings: &Settings) -> (Vec<Surface>, Noise) {
    let floor = (FLOOR * field.coarse_edge()).powi(2);
    let stated = Noise { scale: 1.0, floor };
    let mut arounds = Arounds::of(field);
    let growth = |noise: Noise, spread: f64| Growth { noise, spread, without: settings.leave_out };
    if settings.errors_are_stated || !settings.takes(Step::Bent) {
        let strict = grow(&mut arounds, growth(stated, 0.0));
        if usual_chi_squared(strict.iter()) <= TRUSTED || !settings.takes(Step::Bent) {
            return (strict, stated);
        }
    }
    let tilt = if settings.takes(Step::Certain) { settings.tilt } else { f64::INFINITY };
    let first = grow(&mut arounds, growth(stated, SPREAD));
    let sure: Vec<&Surface> =
        first.par_iter().filter(|region| is_sure(field, stated, region, tilt)).collect();
    let scale = usual_chi_squared(sure).clamp(1.0, MOST_SCALE);
    let noise = Noise { scale, floor };
    // With errors as stated they would be the same again.
    let grown = if scale > 1.0 { grow(&mut arounds, growth(noise, SPREAD)) } else { first };
    (grow_again(&mut arounds, growth(noise, SPREAD), grown, tilt), noise)
}

/// That of the region which has half of the points on smoother ones.
fn usual_chi_squared<'g>(regions: impl IntoIterator<Item = &'g Surface>) -> f64 {
    let mut seen: Vec<(f64, f64)> =
        regions.into_iter().map(|r| (r.fitted.reduced_chi_squared, r.fitted.points())).collect();
    seen.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = seen.iter().map(|(_, points)| points).sum::<f64>() / 2.0;
    let mut sum = 0.0;
    let middle = seen.iter().find(|(_, points)| {
        sum += points;
        sum >= half
    });
    middle.map_or(1.0, |(value, _)| *value)
}
