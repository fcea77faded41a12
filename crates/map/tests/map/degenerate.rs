//! Bad and odd input: nothing panics, and what comes out is defined.

use terrace::{Assignment, ExtractError, InsertError, Mapper, Params, Sigma};
use terrace_grid::GridError;

use crate::common::{
    CLUSTERED, PRESETS, bits, check_sound, cloud, lattice, map, mapper, rough, square, tenth, tenth_map,
    turned, unknown, unoptimised, with_optimise,
};

#[test]
fn no_points() {
    for preset in PRESETS {
        let mut mapper = Mapper::new(tenth(preset)).unwrap();
        assert_eq!(mapper.extract(), Err(ExtractError::Empty));
        assert_eq!(mapper.uncertain_clusters().err(), Some(ExtractError::Empty));
        let inserted = mapper.insert(&unknown(&[])).unwrap();
        assert_eq!((inserted.points, inserted.absent, inserted.out_of_range), (0, 0, 0));
        assert!(mapper.is_empty());
        assert_eq!(mapper.extract(), Err(ExtractError::Empty));
    }
}

#[test]
fn no_cell_size_shows_in_few_points_or_in_one_place() {
    let spread = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [f64::NAN; 3]];
    let together = vec![[1.0, 2.0, 3.0]; 1000];
    for (points, present) in [(&spread[..0], 0), (&spread[..], 3), (&together, 1000)] {
        for preset in PRESETS {
            let mut mapper = Mapper::new(preset()).unwrap();
            assert_eq!(mapper.insert(&unknown(points)), Err(InsertError::NoCellSize { present }));
            assert!(mapper.is_empty() && mapper.grid().is_none());
            // The map is as it was: the next scan may show a cell size.
            mapper.insert(&unknown(&square(0.0))).unwrap();
            assert_eq!(mapper.extract().unwrap().planes.len(), 1);
        }
    }
}

#[test]
fn one_two_or_three_points_make_no_plane() {
    let points = [[0.01, 0.02, 0.03], [0.04, 0.01, 0.03], [0.02, 0.07, 0.03]];
    for preset in PRESETS {
        for count in 1..=3 {
            let params = Params { tau: Some(1), min_cells: 0, ..tenth(preset) };
            let found = map(params, &[&unknown(&points[..count])]);
            check_sound(&found);
            assert!(found.planes.is_empty());
            assert_eq!(found.labels, vec![None; count]);
            assert_eq!(found.summary().normal_uncertainty_mean, None);
            assert_eq!((found.cell_counts.dense, found.cell_counts.clustered), (1, 0));
        }
    }
}

#[test]
fn equal_points_make_no_plane() {
    for preset in PRESETS {
        let (inserted, found) = tenth_map(preset, &vec![[1.23, 4.56, 7.89]; 1000]);
        assert_eq!(inserted.points, 1000);
        assert!(found.planes.is_empty());
        assert_eq!((found.cell_counts.occupied, found.cell_counts.clustered), (1, 0));
    }
}

#[test]
fn points_on_a_line_make_no_plane() {
    let line: Vec<_> = (0..5000).map(|i| [0.001 * f64::from(i), 0.013, 0.017]).collect();
    let slanted: Vec<_> = line.iter().map(|p| turned(*p)).collect();
    for preset in PRESETS {
        for points in [&line, &slanted] {
            let (_, found) = tenth_map(preset, points);
            assert!(found.planes.is_empty() && found.cell_counts.clustered == 0);
        }
    }
}

#[test]
fn an_exactly_flat_square_is_one_exact_plane() {
    // In the middle of cells, on a face of them, at −0, and at no height in particular.
    for height in [0.05, 0.3, -0.0, -0.017] {
        for preset in PRESETS {
            let (_, found) = tenth_map(preset, &square(height));
            check_sound(&found);
            assert_eq!(found.planes.len(), 1);
            let plane = &found.planes[0];
            assert_eq!(plane.points, 10_000);
            // Regions know the place of a point within its cell to 16 bits; planes are those of the sums.
            let rounding = if found.used.grown.is_some() { 1e-8 } else { 1e-14 };
            assert!(crate::common::angle(plane.plane.normal(), [0.0, 0.0, 1.0]) < rounding);
            assert!((plane.plane.d() + height).abs() < rounding);
            assert!(plane.rms < 1e-6 && plane.normal_uncertainty.unwrap().iter().all(|s| *s < 1e-6));
        }
    }
}

#[test]
fn an_exactly_flat_turned_square_is_one_plane() {
    let points: Vec<_> = square(0.05).into_iter().map(turned).collect();
    let truth = terrace::Plane::through(
        points[0],
        [
            turned([0.0, 0.0, 1.0])[0] - turned([0.0; 3])[0],
            turned([0.0, 0.0, 1.0])[1] - turned([0.0; 3])[1],
            turned([0.0, 0.0, 1.0])[2] - turned([0.0; 3])[2],
        ],
    )
    .unwrap();
    for preset in PRESETS {
        let (_, found) = tenth_map(preset, &points);
        check_sound(&found);
        assert_eq!(found.planes.len(), 1);
        let plane = &found.planes[0];
        // Of clusters, corner cells of fewer points than τ are left out.
        let (least, rounding) = if found.used.grown.is_some() { (10_000, 1e-8) } else { (9_801, 1e-9) };
        assert!(plane.points >= least, "{}", plane.points);
        assert!(crate::common::angle(plane.plane.normal(), truth.normal()) < rounding);
        assert!(points.iter().all(|p| plane.plane.signed_distance(*p).abs() < rounding));
        assert!(plane.rms < 1e-6);
    }
}

#[test]
fn points_that_are_not_finite_are_absent() {
    let good = rough(0.05);
    let mut points = Vec::new();
    for (k, point) in good.iter().enumerate() {
        points.push(*point);
        let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY][k % 3];
        let mut other = *point;
        other[k % 2] = bad;
        points.push(other);
    }
    for preset in PRESETS {
        let (inserted, found) = tenth_map(preset, &points);
        assert_eq!((inserted.points, inserted.absent, inserted.out_of_range), (good.len(), good.len(), 0));
        let (_, without) = tenth_map(preset, &good);
        assert_eq!(found.planes, without.planes);
        for (k, label) in without.labels.iter().enumerate() {
            assert_eq!(found.labels[2 * k], *label);
            assert_eq!(found.labels[2 * k + 1], None);
        }
    }
}

#[test]
fn a_scan_of_absent_points_adds_nothing() {
    for preset in PRESETS {
        let mut mapper = Mapper::new(tenth(preset)).unwrap();
        let inserted = mapper.insert(&unknown(&[[f64::NAN; 3]; 7])).unwrap();
        assert_eq!((inserted.points, inserted.absent, mapper.len()), (0, 7, 7));
        assert_eq!(mapper.extract(), Err(ExtractError::Empty));
        mapper.insert(&unknown(&square(0.05))).unwrap();
        let found = mapper.extract().unwrap();
        assert_eq!(found.labels.len(), 10_007);
        assert!(found.labels[..7].iter().all(Option::is_none));
        assert!(found.labels[7..].iter().all(Option::is_some));
    }
}

#[test]
fn sigma_zero_is_as_if_unknown() {
    for preset in PRESETS {
        let exact = map(preset(), &[&cloud(rough(0.05), Sigma::Uniform(0.0))]);
        assert_eq!(bits(&exact), bits(&map(preset(), &[&unknown(&rough(0.05))])));
        assert_eq!(exact.planes.len(), 1);
    }
}

#[test]
fn sigma_huge_leaves_no_normal_certain_enough() {
    for preset in PRESETS {
        for sigma in [1e3, 1e100, 1e152, 1e153, 1e200, f64::MAX] {
            let found = map(tenth(preset), &[&cloud(rough(0.05), Sigma::Uniform(sigma))]);
            check_sound(&found);
            assert!(found.planes.is_empty(), "sigma {sigma}");
            assert_eq!(found.cell_counts.clustered, 0);
            assert!(found.cell_counts.dense > 0);
        }
    }
}

#[test]
fn one_point_of_huge_sigma_spoils_its_surroundings_alone() {
    let points = rough(0.05);
    let mut sigmas = vec![0.001; points.len()];
    sigmas[5_050] = f64::MAX;
    // By voxel, the cells around lose their normals. By expected distance no other point joins a cell of infinite
    // distance, which so is not dense.
    let scan = cloud(points, Sigma::PerPoint(sigmas));
    for (preset, without_normal) in CLUSTERED.into_iter().zip([9, 0]) {
        let found = map(tenth(preset), &[&scan]);
        check_sound(&found);
        assert_eq!(found.labels[5_050], None);
        assert_eq!(found.planes.len(), 1);
        assert_eq!(found.cell_counts.dense - found.cell_counts.clustered, without_normal);
    }
    let found = map(tenth(Params::default), &[&scan]);
    check_sound(&found);
    assert_eq!(found.planes.len(), 1);
    // The cell of a tenth of a metre that the point is in holds 25.
    assert!(found.planes[0].points >= 10_000 - 25, "{}", found.planes[0].points);
}

#[test]
fn coordinates_beyond_the_voxel_index_are_counted_and_left_out() {
    let near = rough(0.05);
    let mut points = near.clone();
    let far = [[2e8, 0.0, 0.0], [0.0, -2e8, 0.0], [0.0, 0.0, 1e300], [f64::MAX, f64::MAX, f64::MAX]];
    points.extend(far);
    for preset in PRESETS {
        let (inserted, found) = tenth_map(preset, &points);
        assert_eq!((inserted.points, inserted.absent, inserted.out_of_range), (near.len(), 0, 4));
        assert_eq!(
            inserted.first_refusal,
            Some(GridError::OutOfRange { position: [2e8, 0.0, 0.0], size: 0.1 })
        );
        let (_, without) = tenth_map(preset, &near);
        assert_eq!(found.planes, without.planes);
        assert_eq!(found.labels[near.len()..], [None; 4]);
    }
    // All of them: the map stays empty.
    for preset in PRESETS {
        let mut mapper = Mapper::new(tenth(preset)).unwrap();
        assert_eq!(mapper.insert(&unknown(&far)).unwrap().out_of_range, 4);
        assert_eq!(mapper.extract(), Err(ExtractError::Empty));
    }
}

#[test]
fn the_smallest_and_the_largest_cells() {
    for preset in PRESETS {
        let tiny = Params { cell_size: Some(1e-100), ..preset() };
        let mut mapper = Mapper::new(tiny).unwrap();
        assert_eq!(mapper.insert(&unknown(&square(0.05))).unwrap().out_of_range, 10_000);
        let all_in_one = Params { cell_size: Some(1e100), ..preset() };
        let found = map(all_in_one, &[&unknown(&square(0.05))]);
        assert_eq!((found.cell_counts.occupied, found.planes.len()), (1, 0));
    }
}

#[test]
fn points_on_voxel_faces_belong_to_one_cell_each() {
    // Every point on a corner of eight voxels.
    let points: Vec<_> = lattice(40, 0.25).into_iter().map(|[x, y]| [x - 5.0, y - 5.0, 0.5]).collect();
    let clusters = unoptimised(Params::clusters());
    let by_distance = Params { assignment: Assignment::ExpectedDistance, ..clusters };
    for params in [Params::default(), clusters, by_distance] {
        let params = Params { cell_size: Some(0.25), tau: Some(1), ..params };
        let found = map(params, &[&unknown(&points)]);
        check_sound(&found);
        assert_eq!(found.cell_counts.occupied, points.len());
        assert_eq!((found.planes.len(), found.planes[0].points), (1, 1600));
        assert_eq!(found.planes[0].plane.coefficients(), [0.0, 0.0, 1.0, -0.5]);
    }
}

#[test]
fn the_same_scan_twice_gives_the_same_plane_with_less_uncertainty() {
    let scan = cloud(rough(0.05), Sigma::Uniform(0.002));
    for params in [tenth(Params::default), tenth(Params::clusters)] {
        let (once, twice) = (map(params, &[&scan]), map(params, &[&scan, &scan]));
        check_sound(&twice);
        assert_eq!((once.planes.len(), twice.planes.len()), (1, 1));
        let (a, b) = (&once.planes[0], &twice.planes[0]);
        assert_eq!((2 * a.points, a.cells), (b.points, b.cells));
        for i in 0..4 {
            assert!((a.plane.coefficients()[i] - b.plane.coefficients()[i]).abs() < 1e-12);
        }
        assert!((a.rms - b.rms).abs() < 1e-12);
        let [once_off, twice_off] = [a, b].map(|plane| plane.normal_uncertainty.unwrap());
        assert!((0..3).all(|i| twice_off[i] < once_off[i]));
        assert_eq!(twice.labels[..scan.len()], once.labels);
        assert_eq!(twice.labels[scan.len()..], once.labels);
    }
}

#[test]
fn two_walls_one_voxel_apart_are_one_cluster_and_its_rms_tells() {
    // Normals alone do not tell parallel surfaces apart whose cells touch. The plane found lies between the two.
    let mut points = rough(0.05);
    points.extend(rough(0.15));
    for preset in CLUSTERED {
        let (_, found) = tenth_map(preset, &points);
        check_sound(&found);
        assert_eq!(found.planes.len(), 1);
        let plane = &found.planes[0];
        assert!(crate::common::angle(plane.plane.normal(), [0.0, 0.0, 1.0]) < 1e-3);
        assert!((plane.plane.d() + 0.1).abs() < 1e-3 && (plane.rms - 0.05).abs() < 1e-3);
    }
}

#[test]
fn two_walls_one_voxel_apart_are_two_regions() {
    let mut points = rough(0.05);
    points.extend(rough(0.15));
    let stated = cloud(points.clone(), Sigma::Uniform(6e-4));
    // Where errors are to be found from the scatter, a cell is to be smaller than the gap.
    for (params, scan) in [(tenth(Params::default), &stated), (Params::default(), &unknown(&points))] {
        let found = map(params, &[scan]);
        check_sound(&found);
        assert_eq!(found.planes.len(), 2);
        assert!(found.planes.iter().all(|p| p.rms < 1e-3));
        let [lower, upper] = [0, 10_000].map(|first| found.labels[first]);
        assert!(lower.is_some() && upper.is_some() && lower != upper);
        assert!(found.labels[..10_000].iter().all(|l| *l == lower));
        assert!(found.labels[10_000..].iter().all(|l| *l == upper));
    }
}

#[test]
fn two_walls_with_an_empty_cell_between_are_two_planes() {
    let mut points = rough(0.05);
    points.extend(rough(0.25));
    for preset in PRESETS {
        let (_, found) = tenth_map(preset, &points);
        check_sound(&found);
        assert_eq!(found.planes.len(), 2);
        assert!(found.planes.iter().all(|p| p.points == 10_000 && p.rms < 1e-3));
        assert!(found.labels[..10_000].iter().all(|l| *l == found.labels[0]));
        assert!(found.labels[10_000..].iter().all(|l| *l == found.labels[10_000]));
    }
}

/// A floor and a wall that meet at a right angle.
fn corner() -> Vec<[f64; 3]> {
    rough(0.0).into_iter().flat_map(|[x, y, z]| [[x, y, z + 0.05], [z + 0.05, x, y]]).collect()
}

#[test]
fn a_threshold_of_zero_joins_nothing_that_has_errors() {
    for preset in CLUSTERED {
        let params = Params { phi: 0.0, min_cells: 1, ..unoptimised(tenth(preset)) };
        let found = map(params, &[&cloud(corner(), Sigma::Uniform(0.001))]);
        check_sound(&found);
        assert!(found.planes.iter().all(|p| p.cells == 1));
        assert_eq!(found.planes.len(), found.cell_counts.clustered);
        let optimised = map(Params { phi: 0.0, ..tenth(preset) }, &[&unknown(&corner())]);
        check_sound(&optimised);
    }
}

#[test]
fn a_threshold_of_one_joins_floor_and_wall_until_it_is_optimised() {
    for preset in CLUSTERED {
        let params = Params { phi: 1.0, ..tenth(preset) };
        let scan = cloud(corner(), Sigma::Uniform(0.001));
        let merged = map(unoptimised(params), &[&scan]);
        check_sound(&merged);
        assert_eq!(merged.planes.len(), 1);
        assert!(merged.planes[0].rms > 0.1);
        let split = map(params, &[&scan]);
        check_sound(&split);
        assert_eq!(split.optimised.len(), 1);
        assert!(split.planes.len() >= 2 && split.planes[..2].iter().all(|p| p.rms < 0.02));
    }
}

#[test]
fn thresholds_that_leave_nothing_over() {
    let scan = cloud(rough(0.05), Sigma::Uniform(0.001));
    for preset in CLUSTERED {
        let none_dense = map(Params { tau: Some(u64::MAX), ..tenth(preset) }, &[&scan]);
        assert_eq!((none_dense.cell_counts.dense, none_dense.planes.len()), (0, 0));
        let none_certain = map(Params { omega: 1e-300, ..tenth(preset) }, &[&scan]);
        assert_eq!((none_certain.cell_counts.clustered, none_certain.planes.len()), (0, 0));
        let none_large = map(Params { min_cells: usize::MAX, ..tenth(preset) }, &[&scan]);
        assert!(none_large.planes.is_empty() && none_large.labels.iter().all(Option::is_none));
        let deep = map(Params { depth: u32::MAX, ..tenth(preset) }, &[&scan]);
        assert_eq!(deep.planes.len(), 1);
    }
}

#[test]
fn weights_too_large_for_the_cost_are_an_error_of_the_search() {
    let params = Params { phi: 1.0, ..tenth(Params::clusters) };
    let scan = cloud(corner(), Sigma::Uniform(0.001));
    let params = with_optimise(params, |o| (o.weight_uncertainty, o.weight_clusters) = (f64::MAX, f64::MAX));
    let refused = mapper(params, &[&scan]).extract();
    assert!(matches!(refused, Err(ExtractError::Search(_))), "{refused:?}");
}
