//! The clustering on random graphs: against a plain reference, and all that must not change it.

// A test has no caller to report to; equal means equal bits here.
#![allow(clippy::unwrap_used, clippy::float_cmp)]

mod graphs;

use std::collections::BTreeSet;

use graphs::{Graph, graph, length, seeds};
use proptest::prelude::*;
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use rand::seq::SliceRandom;
use terrace_cluster::{Grower, Params, SeedOrder, Segmentation, Subgraph, orientation_distance, segment};
use terrace_stats::{Moments, UncertainVector};

fn run(graph: &Graph, params: &Params) -> Segmentation {
    segment(&graph.normals, graph.neighbours(), params).unwrap()
}

fn total(normal: &UncertainVector) -> f64 {
    normal.error[0] + normal.error[1] + normal.error[2]
}

/// Half of Eq. 2 from the raw members, written out: p² + ε² + (Σp)²/n² + Σε²/n² − 2 p·Σp/n.
fn by_equation_2(normal: &UncertainVector, members: &[UncertainVector]) -> f64 {
    let n = members.len() as f64;
    let terms = (0..3).map(|i| {
        let (p, e) = (normal.value[i], normal.error[i]);
        let sum: f64 = members.iter().map(|m| m.value[i]).sum();
        let errors: f64 = members.iter().map(|m| m.error[i].powi(2)).sum();
        p * p + e * e + sum * sum / (n * n) + errors / (n * n) - 2.0 * p * sum / n
    });
    0.5 * terms.sum::<f64>()
}

/// The smaller distance of both signs: that with n · L ≥ 0.
fn either_sign(normal: &UncertainVector, members: &[UncertainVector]) -> (f64, UncertainVector) {
    let (as_is, turned) = (by_equation_2(normal, members), by_equation_2(&normal.flipped(), members));
    if turned < as_is { (turned, normal.flipped()) } else { (as_is, *normal) }
}

/// The rules from raw lists, in the plainest way: a queue, sets, and Eq. 2 over all members at each turn. Also the
/// smallest gap between a distance and φ: where it is rounding, the decision is.
fn reference(graph: &Graph, params: &Params) -> (Vec<Vec<u32>>, f64) {
    let certain = |node: &usize| graph.normals[*node].is_some_and(|n| total(&n) < params.omega);
    let mut order: Vec<usize> = (0..graph.normals.len()).filter(certain).collect();
    match params.seeds {
        SeedOrder::MostCertain => {
            let key = |node: usize| (total(&graph.normals[node].unwrap()), node);
            order.sort_by(|a, b| key(*a).partial_cmp(&key(*b)).unwrap());
        }
        SeedOrder::Random { seed } => order.shuffle(&mut ChaCha8Rng::seed_from_u64(seed)),
    }
    let mut unvisited: BTreeSet<usize> = order.iter().copied().collect();
    let (mut clusters, mut closest) = (Vec::new(), f64::INFINITY);
    for seed in order {
        if !unvisited.remove(&seed) {
            continue;
        }
        let (mut nodes, mut members) = (vec![seed], vec![graph.normals[seed].unwrap()]);
        let mut queue = std::collections::VecDeque::from([seed]);
        while let Some(node) = queue.pop_front() {
            for next in graph.edges[node].iter().map(|next| *next as usize) {
                if !unvisited.contains(&next) {
                    continue;
                }
                let (distance, turned) = either_sign(&graph.normals[next].unwrap(), &members);
                closest = closest.min((distance - params.phi).abs());
                if distance <= params.phi {
                    unvisited.remove(&next);
                    nodes.push(next);
                    members.push(turned);
                    queue.push_back(next);
                }
            }
        }
        clusters.push(nodes.into_iter().map(|node| u32::try_from(node).unwrap()).collect());
    }
    (clusters, closest)
}

fn nodes_of(result: &Segmentation) -> Vec<Vec<u32>> {
    result.clusters().map(|cluster| cluster.nodes().to_vec()).collect()
}

fn params() -> impl Strategy<Value = Params> {
    let phi = prop_oneof![4 => 0.0..1.2f64, 4 => 0.0..0.1f64, 1 => Just(0.0), 1 => Just(1.0)];
    let omega = prop_oneof![1 => 0.05..0.6f64, 1 => Just(f64::INFINITY)];
    (phi, omega, seeds()).prop_map(|(phi, omega, seeds)| Params { phi, omega, seeds })
}

/// All but φ.
fn same_result(a: &Segmentation, b: &Segmentation, nodes: usize) -> bool {
    a.interval() == b.interval()
        && a.tests() == b.tests()
        && a.clusters().eq(b.clusters())
        && (0..nodes).all(|node| a.cluster_of(node) == b.cluster_of(node))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn every_joining_is_that_of_the_plain_rules(graph in graph(40), params in params()) {
        let (clusters, closest) = reference(&graph, &params);
        prop_assume!(closest > 1e-12);
        prop_assert_eq!(nodes_of(&run(&graph, &params)), clusters);
    }

    #[test]
    fn the_result_holds_on_its_whole_interval(
        graph in graph(40),
        params in params(),
        places in prop::collection::vec(0.0..1.0f64, 4),
    ) {
        let result = run(&graph, &params);
        let interval = result.interval();
        prop_assert!(interval.contains(params.phi));
        let hi = interval.hi.unwrap_or(10.0);
        prop_assert!(interval.lo < hi);
        let inner = places.into_iter().map(|share| interval.lo + share * (hi - interval.lo));
        for phi in inner.chain([interval.lo, hi.next_down(), f64::midpoint(interval.lo, hi)]) {
            if !interval.contains(phi) {
                continue;
            }
            let again = run(&graph, &Params { phi, ..params });
            let same = same_result(&result, &again, graph.normals.len());
            prop_assert!(same, "{} {:?} {:?}", phi, result, again);
            prop_assert_eq!(again.phi(), phi);
        }
        // At hi the first decision falls otherwise, and just below lo too: the interval is not smaller than it must be.
        if let Some(hi) = interval.hi {
            let at_hi = run(&graph, &Params { phi: hi, ..params });
            prop_assert!(at_hi.interval().lo >= hi);
        }
        if interval.lo > 0.0 {
            let below = run(&graph, &Params { phi: interval.lo.next_down(), ..params });
            prop_assert!(below.interval().hi.unwrap() <= interval.lo);
        }
    }

    #[test]
    fn clusters_part_the_candidates_and_are_connected(graph in graph(40), params in params()) {
        let result = run(&graph, &params);
        let mut times = vec![0; graph.normals.len()];
        for (number, cluster) in result.clusters().enumerate() {
            prop_assert_eq!(result.cluster(number), Some(cluster));
            let members: BTreeSet<u32> = cluster.nodes().iter().copied().collect();
            let mut reached = BTreeSet::from([cluster.nodes()[0]]);
            let mut open = vec![cluster.nodes()[0]];
            while let Some(node) = open.pop() {
                for next in &graph.edges[node as usize] {
                    if members.contains(next) && reached.insert(*next) {
                        open.push(*next);
                    }
                }
            }
            prop_assert_eq!(&reached, &members);
            for node in cluster.nodes() {
                times[*node as usize] += 1;
                prop_assert_eq!(result.cluster_of(*node as usize), Some(number));
            }
        }
        prop_assert_eq!(result.clusters().len(), result.len());
        prop_assert_eq!(result.cluster(result.len()), None);
        for (node, normal) in graph.normals.iter().enumerate() {
            let candidate = normal.is_some_and(|n| total(&n) < params.omega);
            prop_assert_eq!(times[node], usize::from(candidate));
            prop_assert_eq!(result.cluster_of(node).is_some(), candidate);
        }
        prop_assert_eq!(result.cluster_of(graph.normals.len()), None);
        let grower = Grower::new(&graph.normals, graph.neighbours(), params.omega, params.seeds).unwrap();
        prop_assert_eq!(grower.candidates(), times.iter().sum::<usize>());
    }

    #[test]
    fn the_sign_of_normals_does_not_matter(
        mut graph in graph(40),
        params in params(),
        flips in prop::collection::vec(any::<bool>(), 40),
    ) {
        let result = run(&graph, &params);
        for (normal, _) in graph.normals.iter_mut().zip(flips).filter(|(_, flip)| *flip) {
            *normal = normal.map(|n| n.flipped());
        }
        let flipped = run(&graph, &params);
        prop_assert_eq!(nodes_of(&result), nodes_of(&flipped));
        prop_assert_eq!(result.interval(), flipped.interval());
        for (a, b) in result.clusters().zip(flipped.clusters()) {
            prop_assert_eq!(a.uncertainty(), b.uncertainty());
            // The mean has the sign of the seed.
            let (a, b) = (a.mean_normal(), b.mean_normal());
            prop_assert!(a == b || a == b.map(|x| -x));
        }
    }

    #[test]
    fn uncertainty_is_that_of_two_passes(graph in graph(40), params in params()) {
        for cluster in run(&graph, &params).clusters() {
            let members: Vec<UncertainVector> = cluster.nodes().iter().map(|node| {
                let n = graph.normals[*node as usize].unwrap();
                let along: f64 = (0..3).map(|i| n.value[i] * cluster.mean_normal()[i]).sum();
                if along < 0.0 { n.flipped() } else { n }
            }).collect();
            let n = members.len() as f64;
            // Signs were chosen as members joined; take only clusters whose members agree with the mean at the end.
            let mean = [0, 1, 2].map(|i| members.iter().map(|m| m.value[i]).sum::<f64>() / n);
            prop_assume!((0..3).all(|i| (mean[i] - cluster.mean_normal()[i]).abs() < 1e-12));
            prop_assert!(length(mean) <= 1.0 + 1e-12);
            for i in 0..3 {
                let spread: f64 = members.iter().map(|m| (m.value[i] - mean[i]).powi(2)).sum::<f64>() / n;
                let error: f64 = members.iter().map(|m| m.error[i].powi(2)).sum::<f64>() / n;
                prop_assert!((cluster.uncertainty()[i].powi(2) - spread - error).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn one_grower_at_many_thresholds_is_as_good_as_new(
        graph in graph(30),
        phis in prop::collection::vec(0.0..1.0f64, 1..6),
        seeds in seeds(),
    ) {
        let mut grower = Grower::new(&graph.normals, graph.neighbours(), 0.4, seeds).unwrap();
        for phi in phis {
            let fresh = run(&graph, &Params { phi, omega: 0.4, seeds });
            prop_assert_eq!(grower.grow(phi).unwrap(), &fresh);
            prop_assert!(grower.grow(f64::NAN).is_err());
        }
    }

    #[test]
    fn the_order_of_separate_parts_does_not_matter(first in graph(20), second in graph(20), phi in 0.0..1.0f64) {
        let joined = |a: &Graph, b: &Graph| {
            let offset = u32::try_from(a.normals.len()).unwrap();
            let moved = b.edges.iter().map(|list| list.iter().map(|node| node + offset).collect());
            Graph {
                normals: a.normals.iter().chain(&b.normals).copied().collect(),
                edges: a.edges.iter().cloned().chain(moved).collect(),
            }
        };
        let params = Params { phi, ..Params::default() };
        let of = |graph: &Graph, rename: &dyn Fn(u32) -> u32| -> BTreeSet<Vec<u32>> {
            nodes_of(&run(graph, &params)).into_iter()
                .map(|nodes| nodes.into_iter().map(rename).collect()).collect()
        };
        let (a, b) = (u32::try_from(first.normals.len()).unwrap(), u32::try_from(second.normals.len()).unwrap());
        let swapped = of(&joined(&second, &first), &|node| if node < b { node + a } else { node - b });
        prop_assert_eq!(of(&joined(&first, &second), &|node| node), swapped);
    }

    #[test]
    fn distance_is_that_of_equation_2(
        graph in graph(20),
        normal in graph(1).prop_filter_map("none", |graph| graph.normals[0]),
    ) {
        let mut members: Vec<UncertainVector> = Vec::new();
        let mut cluster = Moments::default();
        prop_assert_eq!(orientation_distance(&normal, &cluster), None);
        for next in graph.normals.iter().flatten() {
            members.push(*next);
            cluster.push(next);
            let distance = orientation_distance(&normal, &cluster).unwrap();
            prop_assert!((distance - either_sign(&normal, &members).0).abs() < 1e-13);
            prop_assert_eq!(orientation_distance(&normal.flipped(), &cluster), Some(distance));
            // Eq. 3, the same from the sums.
            let (d, l, e) = (cluster.weight(), cluster.sum(), cluster.error());
            let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            let eq3 = dot(normal.value, normal.value) + dot(normal.error, normal.error)
                + (dot(l, l) + e[0] + e[1] + e[2]) / (d * d)
                - 2.0 * dot(normal.value, l).abs() / d;
            prop_assert!((distance - 0.5 * eq3).abs() < 1e-13);
        }
        // Without errors and within one direction it is 1 − cos of the angle.
        let (n, m) = (normal.value, members.first().map_or([1.0, 0.0, 0.0], |m| m.value));
        let mut one = Moments::default();
        for _ in 0..3 {
            one.push(&UncertainVector::exact(m));
        }
        let cos = (n[0] * m[0] + n[1] * m[1] + n[2] * m[2]).abs();
        let exact = orientation_distance(&UncertainVector::exact(n), &one).unwrap();
        prop_assert!((exact - (1.0 - cos)).abs() < 1e-14);
    }

    #[test]
    fn subgraph_holds_the_edges_inside_and_no_other(graph in graph(20), picked in prop::collection::vec(any::<bool>(), 20), turn in 0..20usize) {
        let mut nodes: Vec<u32> =
            (0..20u32).zip(&picked).filter(|(n, p)| **p && (*n as usize) < graph.edges.len()).map(|(n, _)| n).collect();
        let turn = turn.min(nodes.len());
        nodes.rotate_left(turn);
        let part = Subgraph::induced(&nodes, graph.neighbours());
        for (i, node) in nodes.iter().enumerate() {
            let mut expected = Vec::new();
            for next in &graph.edges[*node as usize] {
                expected.extend(nodes.iter().position(|n| n == next).map(|at| u32::try_from(at).unwrap()));
            }
            prop_assert_eq!(part.neighbours(i), expected);
        }
        prop_assert!(part.neighbours(nodes.len()).is_empty() && part.neighbours(usize::MAX - 1).is_empty());
    }
}
