//! The growth of one cluster.

use terrace_stats::{Moments, UncertainVector};

use crate::distance::{Centre, aligned};

/// How far the growth of a cluster has come.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Position {
    /// The member whose neighbours are looked at, and which of them comes next.
    pub(crate) member: usize,
    pub(crate) edge: usize,
    /// How many nodes are on the list of members.
    pub(crate) nodes: usize,
    /// Distances compared so far.
    pub(crate) tests: u64,
    /// Statistics of the cluster.
    pub(crate) moments: Moments,
    /// `s_x + s_y + s_z` of the members themselves, summed up.
    pub(crate) errors: f64,
}

impl Position {
    /// The founder alone, to be the last of `nodes` members.
    pub(crate) fn founded(normal: &UncertainVector, nodes: usize) -> Self {
        let mut moments = Moments::default();
        moments.push(normal);
        Self { member: nodes - 1, edge: 0, nodes, tests: 0, moments, errors: total(normal) }
    }
}

/// `s_x + s_y + s_z` of a normal.
pub(crate) fn total(normal: &UncertainVector) -> f64 {
    normal.error.iter().sum()
}

/// Who may join, and what becomes of it.
pub(crate) trait Rules {
    /// Whether the node takes part and belongs to no cluster that goes before.
    fn is_free(&self, node: u32) -> bool;
    /// Whether a node at this distance joins; told before it does. The position is that before the decision.
    fn joins(&mut self, distance: f64, before: impl FnOnce() -> Position) -> bool;
    /// The node has joined.
    fn joined(&mut self, node: u32);
}

/// Grows the cluster whose last member is at `nodes.last()`, from `position` to its end.
///
/// Members are taken in the order in which they joined; each free neighbour is compared with the cluster as it is now.
pub(crate) fn grow<'g>(
    normals: &[Option<UncertainVector>],
    neighbours: &impl Fn(usize) -> &'g [u32],
    nodes: &mut Vec<u32>,
    position: Position,
    rules: &mut impl Rules,
) -> Position {
    let Position { mut member, mut edge, mut tests, mut moments, mut errors, .. } = position;
    let mut centre = Centre::of(&moments);
    while let Some(around) = nodes.get(member).map(|node| neighbours(*node as usize)) {
        while let Some(next) = around.get(edge) {
            let normal = rules.is_free(*next).then(|| normals.get(*next as usize)).flatten();
            if let Some(Some(normal)) = normal {
                let normal = aligned(normal, &moments);
                let distance = 0.5 * centre.expected_squared_distance(&normal);
                let here = || Position { member, edge, nodes: nodes.len(), tests, moments, errors };
                let joins = rules.joins(distance, here);
                tests += 1;
                if joins {
                    moments.push(&normal);
                    errors += total(&normal);
                    centre = Centre::of(&moments);
                    nodes.push(*next);
                    rules.joined(*next);
                }
            }
            edge += 1;
        }
        member += 1;
        edge = 0;
    }
    Position { member, edge, nodes: nodes.len(), tests, moments, errors }
}
