//! No nodes, one node, thresholds at their ends, normals and graphs that are not what they should be.

// A test has no caller to report to; exact values are exact.
#![allow(clippy::unwrap_used, clippy::float_cmp)]

use terrace_cluster::{ClusterError, Grower, Params, SeedOrder, Subgraph, segment};
use terrace_stats::UncertainVector;

const UP: UncertainVector = UncertainVector::exact([0.0, 0.0, 1.0]);
const SIDE: UncertainVector = UncertainVector::exact([1.0, 0.0, 0.0]);

fn with(phi: f64) -> Params {
    Params { phi, ..Params::default() }
}

fn at(degrees: f64) -> UncertainVector {
    UncertainVector::exact([degrees.to_radians().sin(), 0.0, degrees.to_radians().cos()])
}

#[test]
fn no_nodes_and_no_normals_give_no_clusters() {
    for normals in [vec![], vec![None; 4]] {
        let result = segment(&normals, |_| &[0, 1, 2, 3], &with(0.5)).unwrap();
        assert!(result.is_empty() && result.clusters().next().is_none());
        assert_eq!((result.interval().lo, result.interval().hi, result.tests()), (0.0, None, 0));
        assert_eq!((result.cluster_of(0), result.cluster(0)), (None, None));
    }
}

#[test]
fn one_node_is_one_cluster_at_every_phi() {
    let node = UncertainVector { value: UP.value, error: [0.1, 0.05, 0.0] };
    let result = segment(&[Some(node)], |_| &[], &with(0.0)).unwrap();
    let only = result.cluster(0).unwrap();
    assert_eq!((only.nodes(), only.mean_normal(), only.moments().count()), (&[0][..], node.value, 1));
    assert!((0..3).all(|i| (only.uncertainty()[i] - node.error[i]).abs() < 1e-17));
    assert!(result.interval().contains(0.0) && result.interval().contains(1e300));
}

#[test]
fn neighbours_beyond_the_slice_repeated_or_the_node_itself_are_ignored() {
    let lists: [&[u32]; 2] = [&[0, 0, 7, u32::MAX, 1, 1], &[1, 2, 0]];
    for seeds in [SeedOrder::MostCertain, SeedOrder::Random { seed: 3 }] {
        let result =
            segment(&[Some(UP), Some(UP)], |node| lists[node], &Params { seeds, ..with(0.1) }).unwrap();
        assert_eq!((result.len(), result.tests()), (1, 1));
    }
    assert_eq!(Subgraph::induced(&[1, 0], |node| lists[node]).neighbours(1), [1, 1, 0, 0]);
    assert!(Subgraph::induced(&[], |node| lists[node]).neighbours(0).is_empty());
}

#[test]
fn phi_0_joins_equal_exact_normals_and_1_joins_perpendicular_ones() {
    let normals = [UP, UP, UP.flipped(), SIDE].map(Some);
    let all: &[u32] = &[0, 1, 2, 3];
    let strict = segment(&normals, |_| all, &with(0.0)).unwrap();
    assert_eq!(strict.cluster(0).unwrap().nodes(), [0, 1, 2]);
    assert_eq!(strict.cluster(0).unwrap().mean_normal(), UP.value);
    assert_eq!((strict.len(), strict.interval().hi), (2, Some(1.0)));
    let lax = segment(&normals, |_| all, &with(1.0)).unwrap();
    assert_eq!((lax.len(), lax.interval().lo, lax.interval().hi), (1, 1.0, None));
    // With any error at all, equal is not near enough for 0.
    let unsure = [UncertainVector::isotropic(UP.value, 1e-9); 2].map(Some);
    assert_eq!(segment(&unsure, |_| all, &with(0.0)).unwrap().len(), 2);
}

#[test]
fn perpendicular_normals_join_the_same_whatever_their_signs() {
    // The second stands exactly across the first; which of its signs joins decides about the third.
    let across = UncertainVector::exact([0.0, 1.0, 0.0]);
    let diagonal = UncertainVector::exact([0.0, -(0.5f64.sqrt()), 0.5f64.sqrt()]);
    let lists: [&[u32]; 3] = [&[1], &[2], &[]];
    let mut found = Vec::new();
    for signs in 0..8 {
        let mut normals = [UP, across, diagonal];
        for (i, normal) in normals.iter_mut().enumerate() {
            *normal = if signs >> i & 1 == 1 { normal.flipped() } else { *normal };
        }
        let params = Params { seeds: SeedOrder::MostCertain, ..with(1.0) };
        let result = segment(&normals.map(Some), |node| lists[node], &params).unwrap();
        found.push((result.interval(), result.cluster(0).unwrap().uncertainty()));
    }
    assert!(found.iter().all(|one| *one == found[0]), "{found:?}");
}

#[test]
fn a_refused_neighbour_is_compared_again_when_another_member_touches_it() {
    // 2 is too far from 0 alone, and near enough once 1 has joined.
    let normals = [at(0.0), at(20.0), at(28.0)].map(Some);
    let lists: [&[u32]; 3] = [&[2, 1], &[2], &[]];
    let phi = 1.0 - 25f64.to_radians().cos();
    let result = segment(&normals, |node| lists[node], &with(phi)).unwrap();
    assert_eq!(result.cluster(0).unwrap().nodes(), [0, 1, 2]);
    assert_eq!(result.tests(), 3);
    // The refusal counts: at its distance the order of joining is another.
    assert!((result.interval().hi.unwrap() - (1.0 - 28f64.to_radians().cos())).abs() < 1e-15);
}

#[test]
fn omega_leaves_out_nodes_of_exactly_omega_and_more() {
    let unsure = UncertainVector { value: UP.value, error: [0.25, 0.125, 0.125] };
    let normals = [Some(UP), Some(unsure), Some(UP)];
    let chain: [&[u32]; 3] = [&[1], &[0, 2], &[1]];
    for (omega, clusters) in [(0.5, 2), (0.5f64.next_up(), 1), (f64::INFINITY, 1)] {
        let result = segment(&normals, |node| chain[node], &Params { omega, ..with(1.0) }).unwrap();
        assert_eq!((result.len(), result.cluster_of(1).is_some()), (clusters, clusters == 1));
    }
}

#[test]
fn most_certain_seeds_come_first_and_the_smaller_node_on_a_tie() {
    let normal = |error| Some(UncertainVector::isotropic(UP.value, error));
    let normals = [normal(0.03), normal(0.01), normal(0.02), normal(0.01)];
    let result = segment(&normals, |_| &[], &with(0.5)).unwrap();
    let seeds: Vec<u32> = result.clusters().map(|cluster| cluster.nodes()[0]).collect();
    assert_eq!(seeds, [1, 3, 2, 0]);
}

#[test]
fn the_same_seed_gives_the_same_order_and_others_another() {
    let normals = [Some(UP); 50];
    let order = |seed| {
        let params = Params { seeds: SeedOrder::Random { seed }, ..with(0.5) };
        segment(&normals, |_| &[], &params).unwrap()
    };
    assert_eq!(order(1), order(1));
    assert_ne!(order(1), order(2));
}

#[test]
fn thresholds_that_are_no_thresholds_are_refused() {
    let one = [Some(UP)];
    for phi in [-1e-300, -1.0, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(segment(&one, |_| &[], &with(phi)), Err(ClusterError::Phi { phi }));
    }
    assert!(matches!(segment(&one, |_| &[], &with(f64::NAN)), Err(ClusterError::Phi { .. })));
    for omega in [0.0, -0.0, -1.0, f64::NEG_INFINITY] {
        let params = Params { omega, ..with(0.1) };
        assert_eq!(segment(&one, |_| &[], &params), Err(ClusterError::Omega { omega }));
    }
    let nan = Grower::new(&one, |_| &[], f64::NAN, SeedOrder::MostCertain);
    assert!(matches!(nan, Err(ClusterError::Omega { .. })));
    // Minus zero is zero.
    assert!(segment(&one, |_| &[], &with(-0.0)).is_ok());
}

#[test]
fn normals_that_are_no_normals_are_refused_by_node() {
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    let values = bad.map(|x| UncertainVector::exact([0.0, x, 1.0]));
    let errors =
        bad.into_iter().chain([-1e-9]).map(|x| UncertainVector { value: UP.value, error: [0.0, 0.0, x] });
    for normal in values.into_iter().chain(errors) {
        let result = segment(&[Some(UP), None, Some(normal)], |_| &[], &with(0.1));
        assert!(matches!(result, Err(ClusterError::Normal { node: 2, .. })), "{normal:?}");
    }
    for (length, value) in [(0.0, [0.0; 3]), (2.0, [0.0, 2.0, 0.0]), (f64::INFINITY, [1e200, 0.0, 0.0])] {
        let result = segment(&[None, Some(UncertainVector::exact(value))], |_| &[], &with(0.1));
        assert_eq!(result, Err(ClusterError::Length { node: 1, length }));
    }
    // Single precision is near enough.
    let single = [0.544_639_05_f32, 0.0, 0.838_670_55].map(f64::from);
    assert!(segment(&[Some(UncertainVector::exact(single))], |_| &[], &with(0.1)).is_ok());
}

#[test]
fn errors_whose_squares_overflow_are_refused_at_every_phi() {
    let vast = UncertainVector { value: UP.value, error: [1e200, 0.0, 0.0] };
    let both: &[u32] = &[0, 1];
    let params = Params { omega: f64::INFINITY, ..with(1e300) };
    let result = segment(&[Some(UP), Some(vast)], |_| both, &params).unwrap();
    assert_eq!((result.len(), result.interval().hi), (2, None));
}
