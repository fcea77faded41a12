//! What the clustering refuses.

/// Why nodes could not be clustered.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ClusterError {
    /// The orientation threshold φ must be a finite number from 0 up; 0 joins normals without
    /// error that equal the cluster's mean to the last bit, 1 nearly all.
    #[error("the orientation threshold phi = {phi} is not a finite number from 0 up")]
    Phi {
        /// The threshold as given.
        phi: f64,
    },
    /// The uncertainty threshold ω must be a number above 0; infinity lets every normal take part.
    #[error("the uncertainty threshold omega = {omega} is not a number above 0")]
    Omega {
        /// The threshold as given.
        omega: f64,
    },
    /// A normal or its error is not finite, or its error negative. Give `None` for nodes without normal.
    #[error("the normal of node {node} is ({}, {}, {}) with a standard error that is not a number", normal[0], normal[1], normal[2])]
    Normal {
        /// The node.
        node: usize,
        /// Its normal.
        normal: [f64; 3],
    },
    /// A normal is not of unit length, to a thousandth: its distances would not be those of directions. Divide it by its
    /// length, or give `None` when it has none.
    #[error("the normal of node {node} has the length {length}, not 1")]
    Length {
        /// The node.
        node: usize,
        /// Length of its normal.
        length: f64,
    },
    /// Both nodes take part, and only one of them has the other for a neighbour.
    #[error("node {to} is a neighbour of node {from}, but not the other way round")]
    OneWay {
        /// The node that has the neighbour.
        from: usize,
        /// The neighbour.
        to: usize,
    },
    /// Nodes are numbered with 32 bits.
    #[error("{nodes} nodes are more than can be numbered")]
    TooManyNodes {
        /// How many were given.
        nodes: usize,
    },
}
