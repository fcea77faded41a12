//! What the clustering refuses.

/// Why nodes could not be clustered.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ClusterError {
    /// The orientation threshold φ must be a finite number from 0 up; 0 joins equal, exact normals only, 1 nearly all.
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
    /// Nodes are numbered with 32 bits.
    #[error("{nodes} nodes are more than can be numbered")]
    TooManyNodes {
        /// How many were given.
        nodes: usize,
    },
}
