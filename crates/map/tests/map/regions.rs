//! Planes that are grown as regions: labels point by point, steps, bends, joins, and what is chosen from the data.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace::{
    Assignment, Estimate, Join, Mapper, Params, PlaneId, PlaneMap, Regions, Scan, Sigma, Weighting,
    choose_cell_size,
};
use terrace_synth::Scene;

use crate::common::{angle, bits, check_sound, cloud, gauss, map, map_of, scans, tenth, unknown};

const SIGMA: f64 = 0.005;

fn with_regions(change: impl Fn(&mut Regions)) -> Params {
    let mut regions = Regions::default();
    change(&mut regions);
    Params { regions: Some(regions), ..tenth(Params::default) }
}

fn coplanar() -> Params {
    with_regions(|r| r.join = Join::Coplanar)
}

/// Random points of a rectangle at a height, with noise along z, 2 500 to the square metre.
fn patch(x: (f64, f64), y: (f64, f64), height: f64, seed: u64) -> Vec<[f64; 3]> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut count = 0;
    while f64::from(count) < 2500.0 * (x.1 - x.0) * (y.1 - y.0) {
        count += 1;
    }
    (0..count)
        .map(|_| {
            let z = height + SIGMA * gauss(&mut rng);
            [rng.random_range(x.0..x.1), rng.random_range(y.0..y.1), z]
        })
        .collect()
}

fn stated(points: &[[f64; 3]]) -> Scan {
    cloud(points.to_vec(), Sigma::Uniform(SIGMA))
}

/// The points of a floor, and those of a wall that stands on it along x = 0.
fn floor_and_wall() -> [Vec<[f64; 3]>; 2] {
    let upright = |[x, y, z]: [f64; 3]| [z, y, x];
    [
        patch((0.0, 2.0), (0.0, 2.0), 0.0, 1),
        patch((0.0, 2.0), (0.0, 2.0), 0.0, 2).into_iter().map(upright).collect(),
    ]
}

/// Of the labelled points of `a`, the share whose plane is, in `b`, the one that most points of that plane are of.
fn agreement(a: &PlaneMap, b: &PlaneMap) -> f64 {
    let mut shared = vec![vec![0_u64; b.planes.len() + 1]; a.planes.len()];
    for (one, other) in a.labels.iter().zip(&b.labels) {
        if let Some(one) = one {
            shared[one.index()][other.map_or(b.planes.len(), PlaneId::index)] += 1;
        }
    }
    let most: u64 = shared.iter().map(|of| of[..b.planes.len()].iter().copied().max().unwrap_or(0)).sum();
    most as f64 / a.summary().labelled as f64
}

#[test]
fn points_near_a_border_get_the_nearer_plane() {
    let [floor, wall] = floor_and_wall();
    let points = [floor.clone(), wall].concat();
    let found = map(tenth(Params::default), &[&stated(&points)]);
    check_sound(&found);
    assert_eq!(found.planes.len(), 2);
    let own = |first: usize| {
        let plane = found.labels[first].unwrap();
        (plane, found.planes[plane.index()].plane)
    };
    let ((on_floor, floor_plane), (on_wall, wall_plane)) = (own(0), own(floor.len()));
    let (mut near, mut right) = (0, 0);
    for (index, (point, label)) in points.iter().zip(&found.labels).enumerate() {
        let off = [floor_plane, wall_plane].map(|plane| plane.signed_distance(*point).abs());
        let truth = if index < floor.len() { on_floor } else { on_wall };
        right += usize::from(*label == Some(truth));
        // In the cells that both surfaces go through.
        if off.iter().all(|off| *off < 0.1) && (off[0] - off[1]).abs() > 3.0 * SIGMA {
            near += 1;
            let nearer = if off[0] < off[1] { on_floor } else { on_wall };
            assert!(label.is_none_or(|label| label == nearer), "{point:?} is off by {off:?}");
        }
    }
    assert!(near > 500, "{near}");
    assert!(right as f64 > 0.99 * points.len() as f64, "{right} of {}", points.len());
}

#[test]
fn a_door_recessed_by_a_few_standard_errors_is_apart() {
    let depth = 6.0 * SIGMA;
    let is_door = |[x, y, _]: &[f64; 3]| (1.0..1.9).contains(x) && *y < 2.0;
    let points: Vec<[f64; 3]> = patch((0.0, 4.0), (0.0, 2.5), 0.0, 3)
        .into_iter()
        .map(|[x, y, z]| if is_door(&[x, y, z]) { [x, y, z - depth] } else { [x, y, z] })
        .collect();
    for scan in [stated(&points), unknown(&points)] {
        let found = map(tenth(Params::default), &[&scan]);
        check_sound(&found);
        assert_eq!(found.planes.len(), 2);
        let right = |(point, label): &(&[f64; 3], &Option<PlaneId>)| {
            label.is_some_and(|id| id.index() == usize::from(is_door(point)))
        };
        let right = points.iter().zip(&found.labels).filter(right).count();
        assert!(right as f64 > 0.97 * points.len() as f64, "{right}");
        let between = found.planes[0].plane.d().abs() - found.planes[1].plane.d().abs();
        assert!((between.abs() - depth).abs() < SIGMA, "{between}");
    }
}

#[test]
fn a_sphere_with_noise_is_no_plane() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let points: Vec<[f64; 3]> = (0..40_000)
        .map(|_| {
            let z: f64 = rng.random_range(-1.0..1.0);
            let (sin, cos) = rng.random_range(0.0..std::f64::consts::TAU).sin_cos();
            let (across, radius) = ((1.0 - z * z).sqrt(), 1.0 + SIGMA * gauss(&mut rng));
            [across * cos, across * sin, z].map(|x| radius * x)
        })
        .collect();
    for scan in [stated(&points), unknown(&points)] {
        let found = map(tenth(Params::default), &[&scan]);
        check_sound(&found);
        assert_eq!(found.planes, []);
        assert!(found.labels.iter().all(Option::is_none));
    }
}

/// Two patches of the same floor, a metre apart, the second raised.
fn apart(raised: f64) -> Vec<[f64; 3]> {
    [patch((0.0, 2.0), (0.0, 2.0), 0.0, 5), patch((3.0, 5.0), (0.0, 1.5), raised, 6)].concat()
}

#[test]
fn coplanar_patches_are_one_plane_that_is_surer_when_asked_for() {
    let points = apart(0.0);
    let scan = stated(&points);
    let touching = map(tenth(Params::default), &[&scan]);
    check_sound(&touching);
    assert_eq!(touching.planes.len(), 2);
    let joined = map(coplanar(), &[&scan]);
    check_sound(&joined);
    assert_eq!(joined.planes.len(), 1);

    let one = &joined.planes[0];
    assert_eq!(one.points, touching.planes.iter().map(|p| p.points).sum::<u64>());
    assert_eq!(one.cells, touching.planes.iter().map(|p| p.cells).sum::<usize>());
    let labelled = |map: &PlaneMap| map.labels.iter().map(Option::is_some).collect::<Vec<_>>();
    assert_eq!(labelled(&joined), labelled(&touching));
    let of_points = points.iter().zip(&joined.labels).filter(|(_, label)| label.is_some());
    let mean_x = of_points.map(|(p, _)| p[0]).sum::<f64>() / one.points as f64;
    assert!((one.centroid[0] - mean_x).abs() < 1e-7);

    let estimate = one.estimate.unwrap();
    for part in &touching.planes {
        let part = part.estimate.unwrap();
        assert!(estimate.largest_tilt() < part.largest_tilt());
        // Nowhere along the line through both is the plane less sure than one of its parts is there.
        for x in [0.0, 1.0, 2.5, 4.0, 5.0] {
            let at = [x, 1.0, 0.0, 1.0];
            let variance = |c: [[f64; 4]; 4]| {
                (0..4).flat_map(|i| (0..4).map(move |j| at[i] * c[i][j] * at[j])).sum::<f64>()
            };
            assert!(variance(estimate.coefficients) < variance(part.coefficients), "{x}");
        }
    }
    assert!((estimate.reduced_chi_squared - 1.0).abs() < 0.1);
    assert!(angle(one.plane.normal(), [0.0, 0.0, 1.0]) < 4.0 * estimate.largest_tilt());
}

#[test]
fn a_patch_raised_by_ten_standard_errors_is_not_joined() {
    let flat = map(tenth(Params::default), &[&stated(&apart(0.0))]);
    let error: f64 = flat
        .planes
        .iter()
        .map(|plane| {
            let estimate = plane.estimate.unwrap();
            // At the middle between both.
            estimate.tilt_offset[2][2] + (1.5 * estimate.largest_tilt()).powi(2)
        })
        .sum::<f64>()
        .sqrt();
    assert!(error < SIGMA, "less than the error of a point: {error}");
    assert_eq!(map(coplanar(), &[&stated(&apart(error))]).planes.len(), 1);
    let raised = map(coplanar(), &[&stated(&apart(10.0 * error))]);
    check_sound(&raised);
    assert_eq!(raised.planes.len(), 2);
}

#[test]
fn a_plane_that_stated_errors_tell_is_found_however_large_the_place_is() {
    // A stool of 20 cells, whose top is what can be seen of it, beside a floor of 400 and of 40 000.
    let stool = patch((0.5, 1.0), (0.5, 0.9), 0.45, 3);
    for side in [2.0, 20.0] {
        let floor = patch((0.0, side), (0.0, side), 0.0, 4).into_iter().step_by(2);
        let points: Vec<[f64; 3]> = floor.chain(stool.iter().copied()).collect();
        let found = map(tenth(Params::default), &[&stated(&points)]);
        check_sound(&found);
        let top = found.planes.iter().filter(|plane| (plane.centroid[2] - 0.45).abs() < 0.01).count();
        assert_eq!((found.planes.len(), top), (2, 1), "{side} m");
    }
}

#[test]
fn planes_are_joined_without_a_covariance_being_asked_for() {
    let params = Params { estimate: None, ..coplanar() };
    let found = map(params, &[&stated(&apart(0.0))]);
    check_sound(&found);
    assert_eq!(found.planes.len(), 1);
    assert_eq!(found.planes[0].estimate, None);
}

#[test]
fn errors_that_are_found_give_nearly_the_labels_of_stated_ones() {
    for scene in [Scene::room(), Scene::corridor()] {
        let made = scans(&scene, 100_000, 7);
        let stated = map_of(Params::default(), &made);
        check_sound(&stated);
        assert_eq!(stated.noise, None);
        let bare: Vec<Scan> =
            made.iter().map(|s| s.scan.clone().with_sigma(Sigma::Unknown).unwrap()).collect();
        // The cell size follows from stated errors too: it is not what is looked at here.
        let params = Params { cell_size: Some(stated.used.cell_size), ..Params::default() };
        let found = map(params, &bare.iter().collect::<Vec<_>>());
        check_sound(&found);
        assert!(found.noise.is_some());
        let shares = [agreement(&stated, &found), agreement(&found, &stated)];
        assert!(shares.iter().all(|share| *share > 0.95), "{:?}: {shares:?}", scene.kind());
    }
}

#[test]
fn scans_inserted_one_by_one_are_those_inserted_at_once() {
    let [floor, wall] = floor_and_wall();
    for scan in [stated as fn(&[[f64; 3]]) -> Scan, unknown] {
        let at_once = map(tenth(Params::default), &[&scan(&[&floor[..], &wall].concat())]);
        let one_by_one = map(tenth(Params::default), &[&scan(&floor), &scan(&wall)]);
        assert_eq!(at_once.planes.len(), 2);
        assert_eq!(at_once.labels, one_by_one.labels);
        assert_eq!(at_once.planes, one_by_one.planes);
    }
}

#[test]
fn settings_that_make_no_plane_are_refused_by_name_and_value() {
    let refused = |name: &str, value: f64, params: Params| {
        let error = Mapper::new(params).unwrap_err();
        assert_eq!((error.name, error.value.to_bits()), (name, value.to_bits()));
        assert!(error.to_string().contains(&format!("the parameter {name} is {value}")), "{error}");
    };
    for bad in [-0.1, f64::NAN, f64::INFINITY] {
        for zero_too in [Some(0.0), None] {
            let above_zero = zero_too.unwrap_or(bad);
            refused("regions.tilt", above_zero, with_regions(|r| r.tilt = above_zero));
            refused("regions.reach", above_zero, with_regions(|r| r.reach = above_zero));
            refused("regions.turn", above_zero, with_regions(|r| r.turn = above_zero));
        }
        refused("regions.min_area", bad, with_regions(|r| r.min_area = Some(bad)));
    }
    let ends = with_regions(|r| {
        (r.tilt, r.reach, r.turn) = (f64::MIN_POSITIVE, f64::MAX, f64::MAX);
        (r.min_points, r.min_area) = (Some(0), Some(0.0));
    });
    assert_eq!(ends.validate(), Ok(()));
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let made = scans(&Scene::corridor(), 60_000, 3);
    let bare: Vec<Scan> = made.iter().map(|s| s.scan.clone().with_sigma(Sigma::Unknown).unwrap()).collect();
    let bare: Vec<&Scan> = bare.iter().collect();
    let params = Params { cell_size: None, ..coplanar() };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| [map_of(params, &made), map(params, &bare)].map(|map| bits(&map)))
    };
    assert_eq!(on(1), on(4));
}

#[test]
fn the_fewest_points_and_the_least_area_are_used_as_given() {
    let large = patch((0.0, 2.0), (0.0, 2.0), 0.0, 8);
    let small = patch((5.0, 6.0), (0.0, 1.0), 0.0, 9);
    let scan = stated(&[large, small].concat());
    let both = map(tenth(Params::default), &[&scan]);
    assert_eq!(both.planes.len(), 2);
    let grown = both.used.grown.unwrap();
    assert_eq!((grown.noise_scale, grown.min_points), (1.0, 50.0), "four in a thousand");
    let few = map(tenth(Params::default), &[&stated(&patch((0.0, 1.0), (0.0, 1.0), 0.0, 12))]);
    let many = map(tenth(Params::default), &[&stated(&patch((0.0, 6.0), (0.0, 6.0), 0.0, 13))]);
    assert_eq!([few, many].map(|map| map.used.grown.unwrap().min_points), [20.0, 250.0], "at the limits");
    assert!(grown.min_area > 0.0 && grown.min_area < 0.05);

    let points = both.planes[1].points;
    for (min_points, planes) in [(points, 2), (points + 1, 1)] {
        let found = map(with_regions(|r| r.min_points = Some(min_points)), &[&scan]);
        check_sound(&found);
        assert_eq!(found.used.grown.unwrap().min_points, min_points as f64);
        assert_eq!(found.planes.len(), planes);
    }
    // Cells at the border count in full.
    for (min_area, planes) in [(0.0, 2), (0.9, 2), (1.5, 1), (3.9, 1), (5.0, 0)] {
        let found = map(with_regions(|r| r.min_area = Some(min_area)), &[&scan]);
        check_sound(&found);
        assert_eq!(found.used.grown.unwrap().min_area, min_area);
        assert_eq!(found.planes.len(), planes, "{min_area}");
    }
    assert_eq!(map(tenth(Params::clusters), &[&scan]).used.grown, None);
}

#[test]
fn points_within_reach_of_a_plane_are_labelled() {
    let points = patch((0.0, 3.0), (0.0, 3.0), 0.0, 10);
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let around = (0..1000).map(|_| {
        let mut within = |to: f64| rng.random_range(0.0..to);
        [within(3.0), within(3.0), 6.0 * SIGMA + within(1.0)]
    });
    let scan = stated(&points.iter().copied().chain(around).collect::<Vec<_>>());
    // The share of a normal distribution within so many standard deviations.
    for (reach, share) in [(1.0, 0.683), (2.0, 0.954), (3.25, 0.999)] {
        let found = map(with_regions(|r| r.reach = reach), &[&scan]);
        check_sound(&found);
        assert_eq!(found.planes.len(), 1);
        let labelled = found.labels[..points.len()].iter().flatten().count() as f64;
        assert!((labelled / points.len() as f64 - share).abs() < 0.02, "{reach}: {labelled}");
        assert!(found.labels[points.len()..].iter().all(Option::is_none));
    }
}

#[test]
fn errors_stated_too_small_are_seen_to_be() {
    // Four times the noise, so that half of it is more than a twentieth of a cell, which is not looked into.
    let rougher = |points: Vec<[f64; 3]>, axis: usize| {
        points.into_iter().map(move |mut point| {
            point[axis] *= 4.0;
            point
        })
    };
    let [floor, wall] = floor_and_wall();
    let points: Vec<[f64; 3]> = rougher(floor, 2).chain(rougher(wall, 0)).collect();
    let with = |sigma: f64| map(tenth(Params::default), &[&cloud(points.clone(), Sigma::Uniform(sigma))]);
    let (right, small) = (with(4.0 * SIGMA), with(2.0 * SIGMA));
    assert_eq!(right.used.grown.unwrap().noise_scale, 1.0);
    let scale = small.used.grown.unwrap().noise_scale;
    assert!((3.0..5.0).contains(&scale), "{scale}");
    for found in [&right, &small] {
        check_sound(found);
        assert_eq!(found.planes.len(), 2);
    }
    assert!(agreement(&right, &small) > 0.99);
}

#[test]
fn the_floor_of_covariances_moves_no_label() {
    let scan = unknown(&floor_and_wall().concat());
    let with = |floor| map(Params { estimate: Some(Estimate { floor }), ..tenth(Params::default) }, &[&scan]);
    assert_eq!(with(0.0).labels, with(0.01).labels);
}

#[test]
fn cells_that_are_no_places_and_weighted_points_are_clustered() {
    let scan = stated(&floor_and_wall().concat());
    assert!(choose_cell_size(&scan).is_some());
    let weighted = Params { weighting: Weighting::Information, ..tenth(Params::default) };
    let by_distance = Params { assignment: Assignment::ExpectedDistance, ..tenth(Params::default) };
    for params in [weighted, by_distance] {
        let asked = map(params, &[&scan]);
        let clusters = map(Params { regions: None, ..params }, &[&scan]);
        check_sound(&asked);
        assert_eq!(asked.used.grown, None);
        assert!(asked.planes.len() >= 2);
        assert_eq!((asked.planes, asked.labels), (clusters.planes, clusters.labels));
    }
}
