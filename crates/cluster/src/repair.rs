//! Clusters that are grown again where something changed.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::Range;

use terrace_stats::UncertainVector;

use crate::Interval;
use crate::growth::{Position, Rules, grow};
use crate::marks::Marks;

/// The owner of a node that was of the cluster which is grown again.
const FREE: u32 = u32::MAX;
/// The owner of a node that takes no part: no cluster goes before it, so that it is free for none.
const NOBODY: u32 = 0;

/// All clusters, each known by its rank: the place of its founder among the candidates.
#[derive(Debug, Clone)]
pub(crate) struct Clusters {
    /// The nodes that may found a cluster, in this order.
    candidates: Vec<u32>,
    /// The place of each node in `candidates`.
    rank: Vec<u32>,
    /// The rank of the cluster each node belongs to; its own when it was lost, to found one if no earlier cluster takes it.
    owner: Vec<u32>,
    by_rank: Vec<Option<Grown>>,
    /// Clusters that are no more, for their memory.
    spare: Vec<Grown>,
    /// Ranks to look at again, since nodes around them were gained or lost by an earlier one; at first all.
    queue: BinaryHeap<Reverse<u32>>,
    /// Which of them are in the queue.
    waits: Vec<bool>,
    /// Members from before, and members gained with the rank whose they were: kept for their memory.
    before: Vec<u32>,
    gained: Vec<(u32, u32)>,
}

#[derive(Debug, Clone, Default)]
struct Grown {
    nodes: Vec<u32>,
    marks: Marks,
}

/// A cluster that was grown again.
pub(crate) struct Regrown {
    /// Where its growth ended.
    pub(crate) end: Position,
    /// The thresholds with the same decisions.
    pub(crate) interval: Interval,
    /// How many distances were compared.
    pub(crate) tests: u64,
}

impl Clusters {
    pub(crate) fn new(nodes: usize, candidates: Vec<u32>) -> Self {
        let mut rank = vec![NOBODY; nodes];
        for (place, node) in (0..).zip(&candidates) {
            rank[*node as usize] = place;
        }
        Self {
            owner: rank.clone(),
            rank,
            by_rank: vec![None; candidates.len()],
            spare: Vec::new(),
            queue: (0..).take(candidates.len()).map(Reverse).collect(),
            waits: vec![true; candidates.len()],
            before: Vec::new(),
            gained: Vec::new(),
            candidates,
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.candidates.len()
    }

    /// The first rank that waits.
    pub(crate) fn first_waiting(&self) -> Option<usize> {
        self.queue.peek().map(|Reverse(rank)| *rank as usize)
    }

    /// Makes the cluster of this rank what it is at `phi`; `None` when its founder belongs to an earlier one. All earlier
    /// ones must be what they are.
    pub(crate) fn repair<'g>(
        &mut self,
        place: usize,
        phi: f64,
        normals: &[Option<UncertainVector>],
        neighbours: &impl Fn(usize) -> &'g [u32],
    ) -> Option<Regrown> {
        let disturbed = self.first_waiting() == Some(place);
        if disturbed {
            self.queue.pop();
            self.waits[place] = false;
        }
        // Fewer candidates than nodes, which fit 32 bits.
        #[allow(clippy::cast_possible_truncation)]
        let rank = place as u32;
        let founder = self.candidates[place];
        let cluster = self.by_rank[place].take();
        let normal = normals.get(founder as usize).and_then(Option::as_ref);
        let (Some(normal), false) = (normal, self.owner[founder as usize] < rank) else {
            if let Some(cluster) = cluster {
                self.dissolve(cluster, rank, neighbours);
            }
            return None;
        };

        let mut cluster = cluster.or_else(|| self.spare.pop()).unwrap_or_default();
        // Where nodes around it changed, nothing of what it was is certain.
        let same = if disturbed { None } else { cluster.marks.back_to_the_first_other(phi) };
        let start = same.unwrap_or_else(|| {
            cluster.marks.clear();
            Position::founded(normal, 1)
        });
        let mut before = std::mem::take(&mut self.before);
        let mut gained = std::mem::take(&mut self.gained);
        before.extend(cluster.nodes.drain(start.nodes.min(cluster.nodes.len())..));
        for node in &before {
            let owner = &mut self.owner[*node as usize];
            if *owner == rank {
                *owner = FREE;
            }
        }
        if cluster.nodes.is_empty() {
            cluster.nodes.push(founder);
        }

        let Grown { nodes, marks } = &mut cluster;
        let mut rules = Repair { phi, rank, marks, owner: &mut self.owner, gained: &mut gained };
        let end = grow(normals, neighbours, nodes, start, &mut rules);
        let interval = marks.interval();
        self.by_rank[place] = Some(cluster);

        for (node, owner) in gained.drain(..) {
            if owner != FREE {
                self.look_again(owner);
                self.tell_around(node, rank..owner, neighbours);
            }
        }
        for node in before.drain(..) {
            if self.owner[node as usize] == FREE {
                self.lost(node, rank, neighbours);
            }
        }
        (self.before, self.gained) = (before, gained);
        Some(Regrown { end, interval, tests: end.tests - start.tests })
    }

    fn dissolve<'g>(&mut self, mut cluster: Grown, rank: u32, neighbours: &impl Fn(usize) -> &'g [u32]) {
        for node in cluster.nodes.drain(..) {
            if self.owner[node as usize] == rank {
                self.lost(node, rank, neighbours);
            }
        }
        cluster.marks.clear();
        self.spare.push(cluster);
    }

    /// A node left the cluster of this rank: it may found one, or join a later one.
    fn lost<'g>(&mut self, node: u32, rank: u32, neighbours: &impl Fn(usize) -> &'g [u32]) {
        let own = self.rank[node as usize];
        self.owner[node as usize] = own;
        self.look_again(own);
        self.tell_around(node, rank..own, neighbours);
    }

    /// Clusters that touch a node are grown again where it is free for them now and was not before, or the other way
    /// round: those between its owner and the one before.
    fn tell_around<'g>(&mut self, node: u32, owners: Range<u32>, neighbours: &impl Fn(usize) -> &'g [u32]) {
        for near in neighbours(node as usize) {
            let Some(owner) = self.owner.get(*near as usize).copied() else { continue };
            if owners.start < owner && owner < owners.end {
                self.look_again(owner);
            }
        }
    }

    fn look_again(&mut self, rank: u32) {
        if !std::mem::replace(&mut self.waits[rank as usize], true) {
            self.queue.push(Reverse(rank));
        }
    }
}

struct Repair<'r> {
    phi: f64,
    rank: u32,
    marks: &'r mut Marks,
    owner: &'r mut [u32],
    gained: &'r mut Vec<(u32, u32)>,
}

impl Rules for Repair<'_> {
    #[inline]
    fn is_free(&self, node: u32) -> bool {
        self.owner.get(node as usize).is_some_and(|owner| *owner > self.rank)
    }

    #[inline]
    fn joins(&mut self, distance: f64, before: impl FnOnce() -> Position) -> bool {
        self.marks.decide(distance, self.phi, before)
    }

    #[inline]
    fn joined(&mut self, node: u32) {
        let owner = std::mem::replace(&mut self.owner[node as usize], self.rank);
        self.gained.push((node, owner));
    }
}
