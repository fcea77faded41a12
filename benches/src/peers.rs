//! What other programs reach on the same scenes, each with the setting that is best for the scene.

/// The best of another program on a scene, measured for this project.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peer {
    /// The scene, or the group of scenes it is the mean of.
    pub scene: &'static str,
    /// The program.
    pub program: &'static str,
    /// F1 of planes with an IoU above 0.8.
    pub f1_80: f64,
    /// The weighted cover, where it was measured.
    pub weighted_cover: Option<f64>,
}

/// By scene the one of greatest F1, then of greatest cover. All but PEAC, which needs the grid of a depth image, are of
/// `benches/peers`; its single images are four, of which the scenes here are two.
const PEERS: [Peer; 8] = [
    Peer { scene: "table", program: "CGAL RANSAC", f1_80: 1.0, weighted_cover: Some(0.969) },
    Peer { scene: "room300k", program: "CGAL region growing", f1_80: 0.833, weighted_cover: Some(0.904) },
    Peer { scene: "roomframe", program: "PEAC", f1_80: 0.836, weighted_cover: Some(0.948) },
    Peer { scene: "evops_icl", program: "PEAC", f1_80: 0.632, weighted_cover: None },
    Peer { scene: "synpeb", program: "CGAL region growing", f1_80: 0.909, weighted_cover: Some(0.973) },
    Peer { scene: "balm_sim", program: "Open3D patches", f1_80: 1.0, weighted_cover: Some(0.986) },
    Peer { scene: "mosd-boxes", program: "CGAL region growing", f1_80: 0.847, weighted_cover: Some(0.981) },
    Peer { scene: "nyuv2_planes", program: "CGAL RANSAC", f1_80: 0.439, weighted_cover: Some(0.734) },
];

/// The best of the others on a scene or a group; `None` where that was not measured.
pub fn of(scene: &str) -> Option<Peer> {
    PEERS.into_iter().find(|peer| peer.scene == scene)
}
