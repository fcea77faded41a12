//! The part of a graph that belongs to some of its nodes.

/// The graph of the direct connections among some nodes of a larger graph: what is needed to cluster one cluster again.
///
/// ```
/// use terrace_cluster::Subgraph;
///
/// let edges: [&[u32]; 4] = [&[1, 2], &[0, 3], &[0], &[1]];
/// let part = Subgraph::induced(&[1, 3, 0], |node| edges[node]);
/// assert_eq!(part.neighbours(0), [2, 1]);
/// assert_eq!(part.neighbours(1), [0]);
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Subgraph {
    starts: Vec<usize>,
    neighbours: Vec<u32>,
}

impl Subgraph {
    /// The connections among `nodes`, each named once. Node `i` of the part is `nodes[i]`.
    pub fn induced<'g>(nodes: &[u32], neighbours: impl Fn(usize) -> &'g [u32]) -> Self {
        let mut places: Vec<(u32, u32)> = nodes.iter().copied().zip(0u32..).collect();
        places.sort_unstable();
        let place = |node: &u32| {
            let at = places.binary_search_by_key(node, |(node, _)| *node).ok()?;
            Some(places[at].1)
        };
        let mut starts = Vec::with_capacity(nodes.len() + 1);
        let mut among = Vec::new();
        starts.push(0);
        for node in nodes {
            let around = neighbours(*node as usize);
            among.extend(around.iter().filter_map(place));
            starts.push(among.len());
        }
        Self { starts, neighbours: among }
    }

    /// The nodes connected to `node`, in the order of the larger graph; none for a node that does not exist.
    #[inline]
    pub fn neighbours(&self, node: usize) -> &[u32] {
        match (self.starts.get(node), self.starts.get(node + 1)) {
            (Some(start), Some(end)) => &self.neighbours[*start..*end],
            _ => &[],
        }
    }
}
