//! Points at once against points one by one, and against themselves on other numbers of threads.

// Values are the same to the bit; a test has no caller to report to; places are rounded on purpose.
#![allow(clippy::float_cmp, clippy::unwrap_used, clippy::cast_possible_truncation)]

use proptest::prelude::*;
use rayon::ThreadPoolBuilder;
use terrace_grid::{
    Assignment, CellId, GridError, Motion, PointErrors, PointVoxels, Taken, VoxelGrid, VoxelKey,
};
use terrace_stats::{Moments, SymmetricMatrix3, UncertainVector};

/// Errors that own their lists.
#[derive(Debug, Clone)]
enum Owned {
    None,
    Same(f64),
    Each(Vec<f64>),
    Axes(Vec<[f64; 3]>),
    Covariances(Vec<[f64; 6]>),
}

impl Owned {
    fn borrowed(&self) -> PointErrors<'_> {
        match self {
            Self::None => PointErrors::None,
            Self::Same(sigma) => PointErrors::Same(*sigma),
            Self::Each(sigmas) => PointErrors::Each(sigmas),
            Self::Axes(sigmas) => PointErrors::Axes(sigmas),
            Self::Covariances(covariances) => PointErrors::Covariances(covariances),
        }
    }

    fn insert(&self, grid: &mut VoxelGrid, point: [f64; 3], at: usize) -> Result<CellId, GridError> {
        let error = match self {
            Self::None => [0.0; 3],
            Self::Same(sigma) => [*sigma; 3],
            Self::Each(sigmas) => [sigmas[at]; 3],
            Self::Axes(sigmas) => sigmas[at],
            Self::Covariances(all) => return grid.insert_covariant(point, &SymmetricMatrix3(all[at])),
        };
        grid.insert(&UncertainVector { value: point, error })
    }
}

/// To the power of two below 2⁻¹⁴ of an edge: to 16 bits, where points are in the voxel of their cell. No zero is negative.
fn rounded(x: f64, size: f64) -> i16 {
    let unit = size.log2().floor().exp2() * (-14_f64).exp2();
    (x / unit).round_ties_even() as i16
}

/// All that comes of an insertion.
#[derive(Debug, Clone, PartialEq)]
struct Outcome {
    cells: Vec<Option<CellId>>,
    places: Vec<[i16; 3]>,
    taken: Vec<Taken>,
    sums: Vec<(VoxelKey, CellId, Moments)>,
}

/// Inserts the points in two calls, the second into a grid that holds cells.
fn at_once(rule: Assignment, size: f64, points: &[[f64; 3]], errors: &Owned, threads: usize) -> Outcome {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let mut grid = VoxelGrid::new(size, rule).unwrap();
    let (mut cells, mut places) = (Vec::new(), Vec::new());
    let half = points.len() / 2;
    let taken = [0..half, half..points.len()].map(|range| {
        let errors = match errors.borrowed() {
            PointErrors::Each(sigmas) => PointErrors::Each(&sigmas[range.clone()]),
            PointErrors::Axes(sigmas) => PointErrors::Axes(&sigmas[range.clone()]),
            PointErrors::Covariances(all) => PointErrors::Covariances(&all[range.clone()]),
            all => all,
        };
        let way = if range.start > 0 { threads } else { 1 };
        let points = &points[range];
        let insert = || {
            if way == 1 {
                return grid.insert_all(points, errors, &mut cells, Some(&mut places));
            }
            // From the other side of the origin.
            let turned: Vec<[f64; 3]> = points.iter().map(|point| point.map(|x| -x)).collect();
            let turn: &Motion<'_> = &|from: &[[f64; 3]], to: &mut [[f64; 3]]| {
                to.iter_mut().zip(from).for_each(|(to, from)| *to = from.map(|x| -x));
            };
            let Some(locator) = grid.locator().filter(|_| way == 3) else {
                return grid.insert_alone(&turned, Some(turn), errors, &mut cells, Some(&mut places));
            };
            // In memory that was used before, for more points and for those of a part of them that cannot be inserted.
            let mut voxels = PointVoxels::default();
            locator.locate(&vec![[f64::NAN, 0.0, 1.0]; 1000], None, PointErrors::Same(0.01), &mut voxels)?;
            locator.locate(&turned, Some(turn), errors, &mut voxels)?;
            places.extend_from_slice(voxels.places());
            grid.insert_located(&voxels, (&turned, Some(turn)), errors, &mut cells)
        };
        pool.install(insert).unwrap()
    });
    Outcome { cells, places, taken: taken.into(), sums: sums(&grid) }
}

fn one_by_one(rule: Assignment, size: f64, points: &[[f64; 3]], errors: &Owned) -> Outcome {
    let mut grid = VoxelGrid::new(size, rule).unwrap();
    let (mut cells, mut places, mut taken) = (Vec::new(), Vec::new(), vec![Taken::default(); 2]);
    for (at, point) in points.iter().enumerate() {
        let taken = &mut taken[usize::from(at >= points.len() / 2)];
        let cell = errors.insert(&mut grid, *point, at);
        match cell {
            Ok(_) => taken.points += 1,
            Err(_) if !point.iter().all(|x| x.is_finite()) => taken.not_finite += 1,
            Err(refusal) => {
                taken.refused += 1;
                taken.first_refusal.get_or_insert(refusal);
            }
        }
        let centre = cell.ok().and_then(|cell| grid.get(cell)).map(|cell| cell.centre());
        places.push(
            centre
                .map_or([0; 3], |centre| [0, 1, 2].map(|i| rounded(point[i] - centre[i], grid.cell_size()))),
        );
        cells.push(cell.ok());
    }
    Outcome { cells, places, taken, sums: sums(&grid) }
}

fn sums(grid: &VoxelGrid) -> Vec<(VoxelKey, CellId, Moments)> {
    grid.iter().map(|cell| (cell.key(), cell.id(), *cell.stats().moments())).collect()
}

/// NaN shows in no comparison, but in what is printed; and so does the sign of 0.
fn bits(outcome: &Outcome) -> String {
    format!("{outcome:?}")
}

fn close(a: f64, b: f64, size: f64) -> bool {
    a.to_bits() == b.to_bits() || (a - b).abs() <= 1e-12 * a.abs().max(b.abs()).max(size)
}

/// The same cells, places and refusals; sums up to the rounding of numbers of `scale` each.
fn alike(a: &Outcome, b: &Outcome, size: f64) -> Result<(), TestCaseError> {
    prop_assert_eq!(&a.cells, &b.cells);
    prop_assert_eq!(&a.places, &b.places);
    prop_assert_eq!(format!("{:?}", a.taken), format!("{:?}", b.taken));
    prop_assert_eq!(a.sums.len(), b.sums.len());
    for ((key, id, a), (other, other_id, b)) in a.sums.iter().zip(&b.sums) {
        prop_assert_eq!((key, id, a.count()), (other, other_id, b.count()));
        let scale = size * a.weight();
        prop_assert!(close(a.weight(), b.weight(), 0.0));
        prop_assert!((0..3).all(|i| close(a.sum()[i], b.sum()[i], scale)), "{:?} {:?}", a, b);
        for i in 0..6 {
            prop_assert!(close(a.second().0[i], b.second().0[i], scale * size), "{:?} {:?}", a, b);
            let noise = a.noise().trace();
            let noise = if noise.is_finite() { noise } else { 0.0 };
            prop_assert!(close(a.noise().0[i], b.noise().0[i], noise), "{:?} {:?}", a, b);
        }
    }
    Ok(())
}

/// Coordinates in voxels: between and on faces, and now and then what is no place.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        12 => -9.0..9.0,
        6 => (-9i32..9).prop_map(f64::from),
        1 => (-9i32..9).prop_map(|k| f64::from(k).next_down()),
    ]
}

fn point() -> impl Strategy<Value = [f64; 3]> {
    let odd = prop_oneof![
        Just(f64::NAN),
        Just(f64::INFINITY),
        Just(f64::NEG_INFINITY),
        Just(1e9 + 0.5),
        Just(-1e9),
        Just(1e9 + 1.0),
        Just(-1e9 - 0.5),
        Just(2f64.powi(51) + 0.5),
        Just(-(2f64.powi(63))),
        Just(f64::MAX),
        Just(-0.0),
        Just(-f64::MIN_POSITIVE),
    ];
    prop_oneof![
        30 => prop::array::uniform3(coordinate()),
        1 => (prop::array::uniform3(coordinate()), odd, 0usize..3).prop_map(|(mut p, odd, axis)| {
            p[axis] = odd;
            p
        }),
    ]
}

/// Runs of points: each repeated a few times, a little apart.
fn points() -> impl Strategy<Value = Vec<[f64; 3]>> {
    let run = (point(), 1usize..12);
    prop::collection::vec(run, 0..60).prop_map(|runs| {
        let moved = |p: [f64; 3], n: usize| p.map(|x| x + 0.01 * n as f64);
        runs.into_iter().flat_map(|(p, n)| (0..n).map(move |i| moved(p, i))).collect()
    })
}

fn sigma() -> impl Strategy<Value = f64> {
    prop_oneof![
        60 => 0.0..0.1,
        2 => Just(1e200),
        1 => Just(-0.01),
        1 => Just(f64::NAN),
        1 => Just(f64::INFINITY),
    ]
}

fn errors(points: usize) -> impl Strategy<Value = Owned> {
    let covariance = (prop::array::uniform3(sigma()), prop::array::uniform3(-1e-3..1e-3))
        .prop_map(|(d, o)| [d[0], o[0], o[1], d[1], o[2], d[2]]);
    prop_oneof![
        Just(Owned::None),
        sigma().prop_map(Owned::Same),
        prop::collection::vec(sigma(), points).prop_map(Owned::Each),
        prop::collection::vec(prop::array::uniform3(sigma()), points).prop_map(Owned::Axes),
        prop::collection::vec(covariance, points).prop_map(Owned::Covariances),
    ]
}

fn input() -> impl Strategy<Value = (Vec<[f64; 3]>, Owned)> {
    points().prop_flat_map(|points| {
        let errors = errors(points.len());
        (Just(points), errors)
    })
}

proptest! {
    #[test]
    fn points_at_once_are_points_one_by_one(
        (points, errors) in input(), size in prop_oneof![Just(0.1), Just(0.25), Just(1.0), 0.01..3.0],
    ) {
        let points: Vec<_> = points.iter().map(|p| p.map(|x| x * size)).collect();
        for rule in [Assignment::Voxel, Assignment::ExpectedDistance] {
            let expected = one_by_one(rule, size, &points, &errors);
            let found = at_once(rule, size, &points, &errors, 1);
            alike(&found, &expected, size)?;
            for threads in 1..=3 {
                prop_assert_eq!(bits(&at_once(rule, size, &points, &errors, threads)), bits(&found));
            }
        }
    }
}

/// More than a chunk of points on two noisy walls far from the origin, in scan order or mixed up.
fn walls(points: u32, step: u32) -> Vec<[f64; 3]> {
    let at = |i: u32| {
        let (u, v) = (f64::from(i / 2 % 1000) * 0.004, f64::from(i / 2000) * 0.005);
        let noise = 0.03 * (f64::from(i) * 0.618_033_988_75).fract();
        if i.is_multiple_of(2) { [u, v, noise - 0.01] } else { [noise + 5e5, u, v - 4.0] }
    };
    (0..points).map(|i| at((u64::from(i) * u64::from(step) % u64::from(points)) as u32)).collect()
}

#[test]
fn many_points_in_any_order_on_any_number_of_threads() {
    let count = 1_150_001;
    let each: Vec<f64> = (0..count).map(|i| 0.001 * f64::from(1 + i % 7)).collect();
    for step in [1, 367_879] {
        let points = walls(count, step);
        for errors in [Owned::Same(0.01), Owned::Each(each.clone())] {
            let found = at_once(Assignment::Voxel, 0.05, &points, &errors, 1);
            alike(&found, &one_by_one(Assignment::Voxel, 0.05, &points, &errors), 0.05).unwrap();
            for threads in [2, 3] {
                assert!(found == at_once(Assignment::Voxel, 0.05, &points, &errors, threads));
            }
        }
    }
}

#[test]
fn one_by_one_and_at_once_in_turn() {
    let points = walls(3000, 7);
    let mut grid = VoxelGrid::new(0.1, Assignment::Voxel).unwrap();
    let mut expected = grid.clone();
    let (mut cells, mut one_by_one) = (Vec::new(), Vec::new());
    for (at, some) in points.chunks(500).enumerate() {
        if at.is_multiple_of(2) {
            cells.extend(some.iter().map(|p| grid.insert(&UncertainVector::exact(*p)).ok()));
        } else {
            grid.insert_all(some, PointErrors::None, &mut cells, None).unwrap();
        }
        one_by_one.extend(some.iter().map(|p| expected.insert(&UncertainVector::exact(*p)).ok()));
    }
    assert_eq!(cells, one_by_one);
    assert!(grid.iter().all(|cell| grid.find(cell.key()).unwrap().id() == cell.id()));
    assert_eq!(grid.iter().map(|cell| cell.density()).sum::<u64>(), 3000);
}

#[test]
fn voxels_of_another_grid_or_of_other_points_are_found_again() {
    let points = walls(1000, 7);
    let mut expected = VoxelGrid::new(0.1, Assignment::Voxel).unwrap();
    let mut cells = Vec::new();
    let taken = expected.insert_all(&points, PointErrors::Same(0.01), &mut cells, None).unwrap();
    let other = VoxelGrid::of_halves(0.2).unwrap();
    for (locator, points_of) in [(other.locator(), 1000), (expected.locator(), 999), (None, 0)] {
        let mut grid = VoxelGrid::new(0.1, Assignment::Voxel).unwrap();
        let (mut voxels, mut found) = (PointVoxels::default(), Vec::new());
        if let Some(locator) = locator {
            locator.locate(&points[..points_of], None, PointErrors::None, &mut voxels).unwrap();
        }
        let inserted = grid.insert_located(&voxels, (&points, None), PointErrors::Same(0.01), &mut found);
        assert_eq!((inserted, &found), (Ok(taken), &cells));
        assert_eq!(sums(&grid), sums(&expected));
    }
    assert!(VoxelGrid::new(0.1, Assignment::ExpectedDistance).unwrap().locator().is_none());
}

#[test]
fn voxels_that_were_found_with_errors_of_another_kind_are_found_again() {
    let mut points = walls(300, 7);
    points[17] = [f64::NAN; 3];
    let (sigmas, axes) = (vec![0.01; 300], vec![[0.02; 3]; 300]);
    let covariances = vec![[1e-4, 0.0, 0.0, 1e-4, 0.0, 1e-4]; 300];
    let kinds = [
        PointErrors::None,
        PointErrors::Each(&sigmas),
        PointErrors::Axes(&axes),
        PointErrors::Covariances(&covariances),
    ];
    for before in kinds {
        for errors in kinds {
            let mut grids = [0, 1].map(|_| VoxelGrid::new(0.1, Assignment::Voxel).unwrap());
            let (mut voxels, mut cells) = (PointVoxels::default(), [const { Vec::new() }; 2]);
            grids[0].locator().unwrap().locate(&points, None, before, &mut voxels).unwrap();
            let found = grids[0].insert_located(&voxels, (&points, None), errors, &mut cells[0]);
            let expected = grids[1].insert_alone(&points, None, errors, &mut cells[1], None);
            assert_eq!((found, &cells[0]), (expected, &cells[1]));
            assert_eq!(sums(&grids[0]), sums(&grids[1]));
        }
    }
}

#[test]
fn as_many_errors_as_points() {
    let points = [[0.0; 3]; 3];
    let mut grid = VoxelGrid::new(0.1, Assignment::Voxel).unwrap();
    let mut cells = Vec::new();
    for (given, errors) in [
        (2, PointErrors::Each(&[0.01; 2])),
        (4, PointErrors::Axes(&[[0.01; 3]; 4])),
        (0, PointErrors::Covariances(&[])),
    ] {
        let refused = grid.insert_all(&points, errors, &mut cells, None);
        assert_eq!(refused, Err(GridError::Lengths { points: 3, errors: given }));
        let mut voxels = PointVoxels::default();
        let locator = grid.locator().unwrap();
        locator.locate(&points, None, PointErrors::None, &mut voxels).unwrap();
        assert_eq!(grid.insert_located(&voxels, (&points, None), errors, &mut cells), refused);
        assert_eq!(locator.locate(&points, None, errors, &mut voxels).err(), refused.err());
        assert_eq!(voxels.places().len(), 3);
    }
    assert!(grid.is_empty() && cells.is_empty());
    assert_eq!(grid.insert_all(&[], PointErrors::None, &mut cells, None), Ok(Taken::default()));
}

proptest! {
    #[test]
    fn points_are_found_where_they_were_put(points in prop::collection::vec(prop::array::uniform3(-3.0..3.0_f64), 0..300), halves in any::<bool>()) {
        let mut grid = if halves { VoxelGrid::of_halves(0.5).unwrap() } else { VoxelGrid::new(0.25, Assignment::Voxel).unwrap() };
        let (mut cells, mut places) = (Vec::new(), Vec::new());
        let mut points = points;
        points.push([f64::NAN, 0.0, 0.0]);
        points.push([1e300, 0.0, 0.0]);
        grid.insert_all(&points, PointErrors::None, &mut cells, Some(&mut places)).unwrap();
        points.push([100.0; 3]);
        cells.push(None);
        let (mut found, mut found_places) = (Vec::new(), Vec::new());
        grid.find_all(&points, &mut found, &mut found_places);
        prop_assert_eq!(&found, &cells);
        let metres = |place: &[i16; 3]| place.map(|x| (f64::from(x) * grid.place_unit()) as f32);
        prop_assert_eq!(&found_places[..places.len()], &places.iter().map(metres).collect::<Vec<_>>()[..]);
        for (point, (cell, place)) in points.iter().zip(found.iter().zip(&found_places)) {
            let Some(cell) = cell.and_then(|cell| grid.get(cell)) else { continue };
            let anchor = cell.anchor();
            let expected = [0, 1, 2].map(|i| rounded(point[i] - anchor[i], grid.cell_size()));
            prop_assert_eq!(*place, metres(&expected));
        }
    }

    #[test]
    fn halves_add_up_to_the_whole(points in prop::collection::vec(prop::array::uniform3(-40..40_i32), 0..200)) {
        // Eighths of a metre: all sums are exact.
        let points: Vec<[f64; 3]> = points.iter().map(|point| point.map(|k| f64::from(k) / 8.0)).collect();
        let mut fine = VoxelGrid::of_halves(1.0).unwrap();
        let mut whole = VoxelGrid::new(1.0, Assignment::Voxel).unwrap();
        for grid in [&mut fine, &mut whole] {
            grid.insert_all(&points, PointErrors::Same(0.5), &mut Vec::new(), None).unwrap();
        }
        let (coarse, of) = fine.halved().unwrap();
        prop_assert_eq!(sums(&coarse), sums(&whole));
        for (cell, of) in fine.founded().zip(of) {
            prop_assert_eq!(cell.key().map(|k| k >> 1), coarse.get(of).unwrap().key());
            prop_assert_eq!(cell.anchor(), coarse.get(of).unwrap().centre());
        }
    }
}
