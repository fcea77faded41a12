//! Graphs of normals at random.

// Each test file uses the part it needs.
#![allow(dead_code)]

use proptest::prelude::*;
use terrace_cluster::SeedOrder;
use terrace_stats::UncertainVector;

#[derive(Debug, Clone)]
pub struct Graph {
    pub normals: Vec<Option<UncertainVector>>,
    pub edges: Vec<Vec<u32>>,
}

impl Graph {
    pub fn neighbours<'g>(&'g self) -> impl Fn(usize) -> &'g [u32] + Clone {
        |node| &self.edges[node]
    }
}

fn unit() -> impl Strategy<Value = [f64; 3]> {
    let anywhere = prop::array::uniform3(-1.0..1.0f64).prop_filter("too short", |v| length(*v) > 0.1);
    // Often near one of few directions, so that clusters grow, and either sign.
    let near =
        (0..3usize, any::<bool>(), prop::array::uniform3(-0.2..0.2f64)).prop_map(|(axis, flip, mut v)| {
            v[axis] += if flip { -1.0 } else { 1.0 };
            v
        });
    prop_oneof![1 => anywhere, 4 => near].prop_map(|v| v.map(|x| x / length(v)))
}

pub fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn normal() -> impl Strategy<Value = Option<UncertainVector>> {
    let normal =
        (unit(), prop::array::uniform3(0.0..0.2f64), any::<bool>()).prop_map(|(value, error, exact)| {
            if exact { UncertainVector::exact(value) } else { UncertainVector { value, error } }
        });
    prop::option::weighted(0.9, normal)
}

/// Up to `most` nodes, with neighbours on both sides.
pub fn graph(most: usize) -> impl Strategy<Value = Graph> {
    (1..=most).prop_flat_map(|nodes| {
        let pairs = prop::collection::vec((0..nodes, 0..nodes), 0..4 * nodes);
        (prop::collection::vec(normal(), nodes), pairs).prop_map(|(normals, pairs)| {
            let mut edges = vec![Vec::new(); normals.len()];
            for (a, b) in pairs {
                edges[a].push(u32::try_from(b).unwrap());
                edges[b].push(u32::try_from(a).unwrap());
            }
            Graph { normals, edges }
        })
    })
}

pub fn seeds() -> impl Strategy<Value = SeedOrder> {
    prop_oneof![Just(SeedOrder::MostCertain), any::<u64>().prop_map(|seed| SeedOrder::Random { seed })]
}
