//! The repaired clustering against fresh runs, on random graphs.

// A test has no caller to report to; equal means equal bits where it says so.
#![allow(clippy::unwrap_used, clippy::float_cmp, clippy::panic)]

mod graphs;

use graphs::{Graph, graph, seeds};
use proptest::prelude::*;
use terrace_cluster::{ClusterError, Grower, Interval, Outcome, SeedOrder, Stair, Staircase};
use terrace_stats::UncertainVector;

const UP: UncertainVector = UncertainVector::exact([0.0, 0.0, 1.0]);

/// A graph, which of its nodes take part, and where clusters begin.
#[derive(Debug, Clone)]
struct Case {
    graph: Graph,
    omega: f64,
    seeds: SeedOrder,
}

impl Case {
    fn nodes(&self) -> usize {
        self.fresh().candidates()
    }

    fn fresh<'g>(&'g self) -> Grower<'g, impl Fn(usize) -> &'g [u32] + Clone> {
        Grower::new(&self.graph.normals, self.graph.neighbours(), self.omega, self.seeds).unwrap()
    }

    fn staircase<'g>(&'g self) -> Staircase<'g, impl Fn(usize) -> &'g [u32] + Clone> {
        Staircase::new(&self.graph.normals, self.graph.neighbours(), self.omega, self.seeds).unwrap()
    }

    /// What a fresh run adds up to.
    fn run(&self, phi: f64) -> Stair {
        let mut grower = self.fresh();
        let result = grower.grow(phi).unwrap();
        let mut stair = Stair {
            clusters: result.len(),
            uncertainty: 0.0,
            weighted_uncertainty: 0.0,
            interval: result.interval(),
        };
        for cluster in result.clusters() {
            let own: f64 = cluster.uncertainty().iter().sum();
            stair.uncertainty += own;
            stair.weighted_uncertainty += own * cluster.nodes().len() as f64;
        }
        stair
    }

    /// All steps, each by a fresh run.
    fn walk(&self) -> Vec<Stair> {
        let mut steps = vec![self.run(0.0)];
        while let Some(hi) = steps.last().and_then(|step: &Stair| step.interval.hi) {
            steps.push(self.run(hi));
        }
        steps
    }
}

fn case(most: usize) -> impl Strategy<Value = Case> {
    let omega = prop_oneof![1 => 0.05..0.6f64, 2 => Just(f64::INFINITY)];
    // As they come, all exact, or all of about the same error, so that many are alone at low thresholds.
    (graph(most), 0..4u32, omega, seeds()).prop_map(|(mut graph, errors, omega, seeds)| {
        for (i, normal) in graph.normals.iter_mut().enumerate() {
            let error = |_: UncertainVector| match errors {
                0 => [0.0; 3],
                _ => [0.1 + 1e-3 * (i % 7) as f64; 3],
            };
            if errors < 2 {
                *normal = normal.map(|n| UncertainVector { error: error(n), ..n });
            }
        }
        Case { graph, omega, seeds }
    })
}

/// Small and larger graphs.
fn cases() -> impl Strategy<Value = Case> {
    prop_oneof![case(40).boxed(), case(150).boxed()]
}

/// Which threshold comes next.
#[derive(Debug, Clone, Copy)]
enum Next {
    At(f64),
    Again,
    Lo(i8),
    Hi(i8),
    /// At or near half the squared error of a node.
    Own(prop::sample::Index, i8),
}

impl Next {
    fn phi(self, case: &Case, last: f64, interval: Interval) -> f64 {
        let beside = |x: f64, side: i8| match side {
            -1 => x.next_down().max(0.0),
            0 => x,
            _ => x.next_up(),
        };
        match self {
            Self::At(phi) => phi,
            Self::Again => last,
            Self::Lo(side) => beside(interval.lo, side),
            Self::Hi(side) => interval.hi.map_or(last, |hi| beside(hi, side)),
            Self::Own(index, side) => {
                let normal = index.get(&case.graph.normals);
                let own = normal.map_or(0.0, |n| 0.5 * n.error.iter().map(|e| e * e).sum::<f64>());
                beside(own, side)
            }
        }
    }
}

fn next() -> impl Strategy<Value = Next> {
    prop_oneof![
        4 => (0.0..0.1f64).prop_map(Next::At),
        4 => (0.0..1.1f64).prop_map(Next::At),
        1 => prop::sample::select(vec![0.0, -0.0, 1.0, 2.0, 1e300]).prop_map(Next::At),
        1 => Just(Next::Again),
        3 => (-1..2i8).prop_map(Next::Lo),
        6 => (-1..2i8).prop_map(Next::Hi),
        1 => (any::<prop::sample::Index>(), -1..2i8).prop_map(|(index, side)| Next::Own(index, side)),
    ]
}

fn sums(stair: &Stair) -> [f64; 3] {
    [stair.clusters as f64, stair.uncertainty, stair.weighted_uncertainty]
}

fn near(a: f64, b: f64, relative: f64) -> bool {
    a == b || (a - b).abs() <= relative * a.abs().max(b.abs())
}

/// The same clusters; sums are taken in another order.
fn same(repaired: &Stair, fresh: &Stair) -> Result<(), TestCaseError> {
    prop_assert_eq!(repaired.clusters, fresh.clusters);
    prop_assert_eq!(repaired.interval, fresh.interval);
    prop_assert_eq!(repaired.interval.lo.to_bits(), fresh.interval.lo.to_bits());
    for (a, b) in sums(repaired).into_iter().zip(sums(fresh)) {
        prop_assert!(near(a, b, 1e-12), "{repaired:?} {fresh:?}");
    }
    Ok(())
}

/// What a search wants less of.
#[derive(Debug, Clone, Copy)]
enum Cost {
    Clusters,
    Uncertainty,
    Weighted,
    Both(f64),
}

impl Cost {
    fn of(self, stair: &Stair, nodes: usize) -> f64 {
        let mean = stair.weighted_uncertainty / nodes.max(1) as f64;
        match self {
            Self::Clusters => stair.clusters as f64,
            Self::Uncertainty => stair.uncertainty,
            Self::Weighted => stair.weighted_uncertainty,
            Self::Both(weight) => mean + weight * stair.clusters as f64,
        }
    }
}

fn cost() -> impl Strategy<Value = Cost> {
    prop_oneof![
        Just(Cost::Clusters),
        Just(Cost::Uncertainty),
        Just(Cost::Weighted),
        (-6.0..0.0f64).prop_map(|power| Cost::Both(10f64.powf(power))),
    ]
}

/// Thresholds of the interval: its ends, some inside, and some near `phi`.
fn inside(interval: Interval, phi: f64, places: &[f64]) -> Vec<f64> {
    let top = interval.hi.map_or(interval.lo.max(phi) + 0.5, f64::next_down);
    let mut all = vec![phi, interval.lo, top];
    for place in places {
        all.push(interval.lo + place * (top - interval.lo));
        all.push(phi + place * (top - phi));
    }
    all.retain(|phi| interval.contains(*phi));
    all
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn each_repair_is_a_run_from_the_beginning(case in cases(), nexts in prop::collection::vec(next(), 1..40)) {
        let mut staircase = case.staircase();
        prop_assert_eq!(staircase.candidates(), case.nodes());
        let (mut last, mut interval) = (0.0, Interval::ALL);
        for next in nexts {
            let phi = next.phi(&case, last, interval);
            let stair = staircase.at(phi).unwrap();
            same(&stair, &case.run(phi))?;
            prop_assert!(stair.interval.contains(phi));
            // What came before must not show in any bit.
            let mut other = case.staircase();
            prop_assert_eq!(other.at(phi).unwrap(), stair);
            prop_assert_eq!(other.tests(), case.fresh().grow(phi).unwrap().tests());
            let tests = staircase.tests();
            prop_assert_eq!(staircase.at(phi).unwrap(), stair);
            prop_assert_eq!(staircase.tests(), tests, "nothing is compared on the same step");
            (last, interval) = (phi, stair.interval);
        }
    }

    #[test]
    fn giving_up_tells_no_lie_and_leaves_all_in_order(
        case in cases(),
        asked in prop::collection::vec((next(), cost(), prop_oneof![3 => 0.05..1.1f64, 1 => Just(f64::INFINITY)]), 1..40),
        places in prop::collection::vec(0.0..1.0f64, 2),
        end in 0.0..1.1f64,
    ) {
        let nodes = case.nodes();
        let mut staircase = case.staircase();
        let (mut last, mut interval) = (0.0, Interval::ALL);
        for (next, cost, share) in asked {
            let phi = next.phi(&case, last, interval);
            let fresh = case.run(phi);
            let ceiling = if share.is_finite() { share * cost.of(&fresh, nodes) } else { f64::INFINITY };
            let keep = |stair: &Stair| cost.of(stair, nodes) <= ceiling;
            let outcome = staircase.at_while(phi, keep).unwrap();
            prop_assert_eq!(case.staircase().at_while(phi, keep).unwrap(), outcome, "history shows");
            (last, interval) = (phi, match outcome {
                Outcome::Complete(stair) => {
                    prop_assert!(keep(&stair) || nodes == 0);
                    same(&stair, &fresh)?;
                    stair.interval
                }
                Outcome::GivenUp(least) => {
                    prop_assert!(!keep(&least));
                    prop_assert!(least.interval.contains(phi), "{phi} {least:?}");
                    for other in inside(least.interval, phi, &places) {
                        let there = case.run(other);
                        for (sum, least) in sums(&there).into_iter().zip(sums(&least)) {
                            prop_assert!(sum >= least * (1.0 - 1e-9), "{other} {there:?} {least:?}");
                        }
                        // No threshold of the interval gets further; higher ones know no more of nodes that are alone.
                        let again = case.staircase().at_while(other, keep).unwrap();
                        prop_assert!(matches!(again, Outcome::GivenUp(_)));
                        prop_assert!(other < phi || again == outcome, "{other} {again:?} {outcome:?}");
                    }
                    least.interval
                }
            });
        }
        same(&staircase.at(end).unwrap(), &case.run(end))?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn the_whole_walk_is_that_of_fresh_runs(case in cases()) {
        let walk = case.walk();
        let mut staircase = case.staircase();
        let mut phi = Some(0.0);
        for fresh in &walk {
            let stair = staircase.at(phi.unwrap()).unwrap();
            same(&stair, fresh)?;
            phi = stair.interval.hi;
        }
        prop_assert_eq!(phi, None);
        // And down again.
        for fresh in walk.iter().rev() {
            same(&staircase.at(fresh.interval.lo).unwrap(), fresh)?;
        }
    }

    #[test]
    fn a_search_that_gives_up_finds_the_same_minimum(case in cases(), cost in cost()) {
        let nodes = case.nodes();
        let of = |stair: &Stair| cost.of(stair, nodes);
        let walk = case.walk();
        let naive = walk.iter().map(of).fold(f64::INFINITY, f64::min);
        let mut staircase = case.staircase();
        let (mut best, mut phi, mut steps) = (f64::INFINITY, Some(0.0), 0);
        while let Some(at) = phi {
            phi = match staircase.at_while(at, |stair| of(stair) < best).unwrap() {
                Outcome::Complete(stair) => {
                    best = best.min(of(&stair));
                    stair.interval.hi
                }
                Outcome::GivenUp(least) => least.interval.hi,
            };
            steps += 1;
            // Where nodes known to be alone were enough to give up, the interval may end inside a step.
            prop_assert!(steps <= walk.len() + nodes);
        }
        prop_assert!(near(best, naive, 1e-9), "{best} {naive}");
    }
}

fn exact(normals: &[[f64; 3]]) -> Vec<Option<UncertainVector>> {
    normals.iter().map(|value| Some(UncertainVector::exact(*value))).collect()
}

#[test]
fn one_way_edges_are_refused_among_nodes_that_take_part_alone() {
    let lists: [&[u32]; 3] = [&[1], &[0, 2], &[]];
    let new = |normals: &[Option<UncertainVector>]| {
        Staircase::new(normals, |node| lists[node], 0.4, SeedOrder::MostCertain).map(|s| s.candidates()).err()
    };
    assert_eq!(new(&[Some(UP); 3]), Some(ClusterError::OneWay { from: 1, to: 2 }));
    // Nothing is asked of nodes without a normal, or with one that is too uncertain, from either side.
    let unsure = UncertainVector::isotropic(UP.value, 0.3);
    for out in [None, Some(unsure)] {
        assert_eq!(new(&[Some(UP), Some(UP), out]), None);
        assert_eq!(new(&[Some(UP), out, Some(UP)]), None);
    }
}

#[test]
fn neighbours_beyond_the_slice_repeated_or_the_node_itself_are_ignored() {
    let lists: [&[u32]; 3] = [&[0, 7, 0, 1, u32::MAX, 1, 2], &[1, 2, 0, 3], &[2, 2, 1, 0, 0]];
    let normals = exact(&[[0.0, 0.0, 1.0], [0.0, 0.6, 0.8], [0.0, 1.0, 0.0]]);
    for seeds in [SeedOrder::MostCertain, SeedOrder::Random { seed: 3 }] {
        let mut staircase = Staircase::new(&normals, |node| lists[node], 0.4, seeds).unwrap();
        let mut grower = Grower::new(&normals, |node| lists[node], 0.4, seeds).unwrap();
        for phi in [0.0, 0.3, 0.1, 1.0, 0.2, 0.5, 0.0] {
            let (stair, fresh) = (staircase.at(phi).unwrap(), grower.grow(phi).unwrap());
            assert_eq!((stair.clusters, stair.interval), (fresh.len(), fresh.interval()));
        }
    }
}

#[test]
fn thresholds_that_are_no_thresholds_are_refused_and_change_nothing() {
    let normals = exact(&[[0.0, 0.0, 1.0], [0.0, 0.6, 0.8]]);
    let lists: [&[u32]; 2] = [&[1], &[0]];
    let mut staircase = Staircase::new(&normals, |node| lists[node], 0.4, SeedOrder::MostCertain).unwrap();
    let before = staircase.at(0.1).unwrap();
    for phi in [-1e-300, -1.0, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(staircase.at(phi), Err(ClusterError::Phi { phi }));
        assert_eq!(staircase.at_while(phi, |_| false), Err(ClusterError::Phi { phi }));
    }
    assert!(matches!(staircase.at(f64::NAN), Err(ClusterError::Phi { .. })));
    assert_eq!((staircase.at(0.1).unwrap(), staircase.tests()), (before, 1));
    for omega in [0.0, -1.0, f64::NAN] {
        let new = Staircase::new(&normals, |node| lists[node], omega, SeedOrder::MostCertain);
        assert!(matches!(new.err(), Some(ClusterError::Omega { .. })));
    }
    let long = exact(&[[0.0, 0.0, 2.0]]);
    let new = Staircase::new(&long, |_| &[], 0.4, SeedOrder::MostCertain);
    assert_eq!(new.err(), Some(ClusterError::Length { node: 0, length: 2.0 }));
}

#[test]
fn without_nodes_that_take_part_there_is_nothing_to_add_up() {
    let unsure = Some(UncertainVector::isotropic(UP.value, 1.0));
    for normals in [vec![], vec![None; 3], vec![unsure; 5]] {
        let mut staircase = Staircase::new(&normals, |_| &[0, 1, 2], 0.4, SeedOrder::MostCertain).unwrap();
        let nothing =
            Stair { clusters: 0, uncertainty: 0.0, weighted_uncertainty: 0.0, interval: Interval::ALL };
        for phi in [0.0, 0.5, 2.0] {
            assert_eq!(staircase.at(phi).unwrap(), nothing);
            assert_eq!(staircase.at_while(phi, |_| false).unwrap(), Outcome::Complete(nothing));
        }
        assert_eq!((staircase.candidates(), staircase.tests()), (0, 0));
    }
}

#[test]
fn one_node_is_one_cluster_at_every_phi() {
    let normals = [Some(UncertainVector { value: UP.value, error: [0.125, 0.0625, 0.0] })];
    let mut staircase = Staircase::new(&normals, |_| &[0], 0.4, SeedOrder::MostCertain).unwrap();
    for phi in [0.0, 1.0, 1e300] {
        let stair = staircase.at(phi).unwrap();
        assert_eq!((stair.clusters, stair.interval), (1, Interval::ALL));
        assert!(
            (stair.uncertainty - 0.1875).abs() < 1e-15 && stair.uncertainty == stair.weighted_uncertainty
        );
    }
}

#[test]
fn duplicates_are_one_cluster_from_0_on() {
    let normals = [Some(UP), Some(UP.flipped()), Some(UP), Some(UP)];
    let all: &[u32] = &[0, 1, 2, 3];
    let mut staircase = Staircase::new(&normals, |_| all, 0.4, SeedOrder::Random { seed: 5 }).unwrap();
    for phi in [0.0, 1.0, 0.0] {
        let stair = staircase.at(phi).unwrap();
        assert_eq!((stair.clusters, stair.weighted_uncertainty, stair.interval), (1, 0.0, Interval::ALL));
    }
}

#[test]
fn a_node_may_join_at_just_half_its_squared_error() {
    let normals = [Some(UP), Some(UncertainVector { value: UP.value, error: [0.25, 0.0, 0.0] })];
    let lists: [&[u32]; 2] = [&[1], &[0]];
    let own = 0.5 * 0.25 * 0.25;
    let mut staircase = Staircase::new(&normals, |node| lists[node], 0.4, SeedOrder::MostCertain).unwrap();
    let outcome = staircase.at_while(own, |least| least.clusters < 2).unwrap();
    assert!(matches!(outcome, Outcome::Complete(Stair { clusters: 1, .. })), "{outcome:?}");
    // Just below it is alone, and nothing need be compared to know.
    let tests = staircase.tests();
    let outcome = staircase.at_while(own.next_down(), |least| least.clusters < 2).unwrap();
    let Outcome::GivenUp(least) = outcome else { panic!("{outcome:?}") };
    assert_eq!((least.clusters, least.interval), (2, Interval { lo: 0.0, hi: Some(own) }));
    assert_eq!(staircase.tests(), tests);
}

#[test]
fn errors_whose_squares_overflow_leave_the_node_alone_at_every_phi() {
    let vast = UncertainVector { value: UP.value, error: [1e200, 0.0, 0.0] };
    let (normals, both): (_, &[u32]) = ([Some(UP), Some(vast)], &[0, 1]);
    let mut staircase = Staircase::new(&normals, |_| both, f64::INFINITY, SeedOrder::MostCertain).unwrap();
    for phi in [0.0, 1e300] {
        let stair = staircase.at(phi).unwrap();
        assert_eq!((stair.clusters, stair.interval), (2, Interval::ALL));
        let outcome = staircase.at_while(phi, |least| least.clusters < 2).unwrap();
        assert!(matches!(outcome, Outcome::GivenUp(Stair { interval: Interval::ALL, .. })), "{outcome:?}");
    }
}
