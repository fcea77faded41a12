//! A cell size from the data.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use terrace::{CellSizeChoice, CellSizeSample, Mapper, Params, Scan, Sigma, choose_cell_size};

use crate::common::{cloud, gauss, lattice, turned, unknown};

fn sheet(side: u32, spacing: f64) -> Vec<[f64; 3]> {
    lattice(side, spacing).into_iter().map(|[x, y]| turned([x, y, 0.0])).collect()
}

fn choice(points: &[[f64; 3]]) -> CellSizeChoice {
    choose_cell_size(&unknown(points)).unwrap()
}

fn close(value: f64, expected: f64, share: f64) {
    assert!((value / expected - 1.0).abs() < share, "{value} instead of {expected}");
}

#[test]
fn the_spacing_of_a_lattice_is_found() {
    for (side, spacing) in [(20, 0.01), (100, 0.02), (300, 3.0)] {
        let found = choice(&sheet(side, spacing));
        close(found.spacing, spacing, 0.2);
        close(found.cell_size, 5.0 * spacing, 0.2);
        assert!(found.sigma < 1e-6 * spacing);
    }
}

#[test]
fn a_few_points_show_a_spacing_and_no_noise() {
    // Nearly all of 25 points are at a border, where neighbours are further away.
    let found = choice(&sheet(5, 0.1));
    close(found.spacing, 0.1, 0.3);
    assert_eq!(found.sigma, 0.0);
}

#[test]
fn a_box_of_six_sheets_and_a_random_sheet_have_the_spacing_of_their_density() {
    let sheet = lattice(100, 0.02);
    let points: Vec<_> = sheet
        .iter()
        .flat_map(|[x, y]| {
            [[*x, *y, 0.0], [*x, *y, 2.0], [*x, 0.0, *y], [*x, 2.0, *y], [0.0, *x, *y], [2.0, *x, *y]]
        })
        .collect();
    close(choice(&points).spacing, 0.02, 0.2);
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let random: Vec<_> =
        (0..10_000).map(|_| [2.0 * rng.random::<f64>(), 2.0 * rng.random::<f64>(), 1.0]).collect();
    close(choice(&random).spacing, 0.02, 0.2);
}

#[test]
fn noise_wider_than_the_spacing_decides() {
    // Seen in the scatter.
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let sigma = 0.01;
    let noisy: Vec<_> =
        lattice(200, 0.005).into_iter().map(|[x, y]| [x, y, sigma * gauss(&mut rng)]).collect();
    let found = choice(&noisy);
    close(found.sigma, sigma, 0.5);
    assert_eq!(found.cell_size, 6.0 * found.sigma);
    // Stated.
    let stated = choose_cell_size(&cloud(sheet(100, 0.02), Sigma::Uniform(0.05))).unwrap();
    assert_eq!((stated.sigma, stated.cell_size), (0.05, 6.0 * 0.05));
    close(stated.spacing, 0.02, 0.2);
    let axes = choose_cell_size(&cloud(sheet(100, 0.02), Sigma::PerAxis(vec![[0.0, 0.05, 0.01]; 10_000])));
    assert_eq!(axes.unwrap().sigma, 0.05);
}

#[test]
fn outliers_change_nothing_much() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let mut points = sheet(100, 0.02);
    for k in 0..500 {
        let reach = [10.0, 1e3, 1e9][k % 3];
        points.insert(20 * k, [0; 3].map(|_| rng.random_range(-reach..reach)));
    }
    points.push([1e300; 3]);
    points.push([f64::NAN, 0.0, 0.0]);
    close(choice(&points).spacing, 0.02, 0.2);
}

#[test]
fn the_order_of_points_does_not_matter_much() {
    let mut points = sheet(100, 0.02);
    let straight = choice(&points);
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    rand::seq::SliceRandom::shuffle(points.as_mut_slice(), &mut rng);
    close(choice(&points).spacing, straight.spacing, 0.05);
}

#[test]
fn tiny_clouds_and_clouds_in_one_place_have_none() {
    let few = sheet(3, 0.1);
    for count in 0..=8 {
        assert_eq!(choose_cell_size(&unknown(&few[..count])), None, "{count} points");
    }
    assert!(choose_cell_size(&unknown(&few)).is_some());
    assert_eq!(choose_cell_size(&unknown(&[[1.0, -2.0, 1e6]; 500])), None);
    assert_eq!(choose_cell_size(&unknown(&[[f64::NAN; 3]; 500])), None);
    let mut nearly = vec![[1.0; 3]; 500];
    nearly.extend(sheet(4, 1.0));
    assert_eq!(choose_cell_size(&unknown(&nearly)), None);
}

#[test]
fn absurd_coordinates_have_none_or_a_length() {
    for scale in [1e-320, 1e-200, 1e-100, 1e100, 1e160, 1e307] {
        let points: Vec<_> = sheet(30, 1.0).iter().map(|p| p.map(|x| x * scale)).collect();
        if let Some(found) = choose_cell_size(&unknown(&points)) {
            assert!(found.cell_size.is_normal() && found.cell_size > 0.0);
        }
    }
}

#[test]
fn the_cell_size_scales_with_the_cloud() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let points: Vec<_> =
        sheet(80, 0.02).into_iter().map(|p| p.map(|x| x + 0.001 * gauss(&mut rng))).collect();
    let one = choice(&points);
    for k in [3.0, 0.001, 1e5, 1024.0] {
        let scaled: Vec<_> = points.iter().map(|p| p.map(|x| x * k)).collect();
        let other = choice(&scaled);
        close(other.cell_size, k * one.cell_size, 1e-9);
        close(other.spacing, k * one.spacing, 1e-9);
        close(other.sigma, k * one.sigma, 1e-6);
    }
}

fn sampled(scan: &Scan, size: usize) -> CellSizeChoice {
    let mut sample = CellSizeSample::new(None);
    for (points, sigma) in scan.points().chunks(size).zip(0..) {
        let range = size * sigma..size * sigma + points.len();
        let sigma = match scan.sigma() {
            Sigma::PerPoint(all) => Sigma::PerPoint(all[range].to_vec()),
            same => same.clone(),
        };
        sample.push(&Scan::new(points.to_vec(), sigma, scan.frame()).unwrap());
    }
    assert_eq!(sample.present(), scan.present());
    sample.choose().unwrap()
}

#[test]
fn chunks_show_the_cell_size_of_the_whole() {
    let mut points = sheet(100, 0.02);
    points.push([f64::NAN; 3]);
    let sigma = (0..points.len()).map(|k| if k % 3 == 0 { 0.05 } else { 0.001 }).collect();
    for scan in [unknown(&points), cloud(points, Sigma::PerPoint(sigma))] {
        for size in [1, 999, 100_000] {
            assert_eq!(Some(sampled(&scan, size)), choose_cell_size(&scan));
        }
    }
}

#[test]
fn a_share_of_many_points_shows_the_spacing_of_all() {
    // In rows of a power of two: every so-many-th would be of few columns.
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    let points: Vec<_> = (0..1 << 22)
        .map(|k: u32| {
            let (row, column) = (f64::from(k / 2048), f64::from(k % 2048));
            [0.002 * row, 0.002 * column, 2e-4 * gauss(&mut rng)]
        })
        .collect();
    let scan = cloud(points, Sigma::Uniform(1e-4));
    let share = sampled(&scan, 1 << 18);
    close(share.spacing, 0.002, 0.2);
    close(share.sigma, 2e-4, 0.3);
    for size in [1 << 20, 12_345] {
        assert_eq!(sampled(&scan, size), share);
    }
}

#[test]
fn a_choice_made_beforehand_counts_until_there_is_one() {
    let [fine, coarse] = [0.02, 0.05].map(|spacing| choice(&sheet(60, spacing)));
    let scan = unknown(&sheet(60, 0.02));
    let mut mapper = Mapper::new(Params::default()).unwrap();
    assert!(mapper.wants_cell_size());
    mapper.begin_with(coarse).unwrap();
    mapper.begin_with(fine).unwrap();
    mapper.insert(&scan).unwrap();
    assert_eq!(mapper.chosen_cell_size(), Some(coarse));
    let used = mapper.extract().unwrap().used;
    assert_eq!((used.cell_size, used.chosen), (coarse.cell_size, Some(coarse)));

    let mut given = Mapper::new(Params { cell_size: Some(0.1), ..Params::default() }).unwrap();
    given.begin_with(fine).unwrap();
    given.insert(&scan).unwrap();
    assert_eq!((given.chosen_cell_size(), given.extract().unwrap().used.cell_size), (None, 0.1));
}
