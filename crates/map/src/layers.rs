//! Clusters of several layers, taken apart.

use terrace_stats::{Moments, UncertainVector};
use terrace_types::PlaneId;

use crate::ExtractedPlane;
use crate::nodes::Nodes;
use crate::optimise::Part;

/// Layers are taken apart so many times at most, less one.
pub(crate) const LAYERS: usize = 4;

/// The planes as parts, with each of their other layers of at least `min_cells` cells as a part of its own; `None` when there is
/// no such layer.
pub(crate) fn layers_apart(
    planes: &[ExtractedPlane],
    plane_of_node: &[Option<PlaneId>],
    layers: &[Vec<Vec<u32>>],
    nodes: &Nodes,
    min_cells: usize,
) -> Option<Vec<Part>> {
    let mut parts: Vec<Part> = planes
        .iter()
        .map(|plane| Part {
            nodes: Vec::new(),
            uncertainty: plane.normal_uncertainty,
            phi: plane.phi,
            interval: plane.phi_interval,
        })
        .collect();
    let mut apart = Vec::new();
    let mut moved = vec![false; nodes.dense.len()];
    for (part, layer) in parts.iter().zip(layers) {
        for layer in layer.iter().filter(|layer| layer.len() >= min_cells) {
            for node in layer {
                moved[*node as usize] = true;
            }
            apart.push(Part { nodes: layer.clone(), ..part.clone() });
        }
    }
    if apart.is_empty() {
        return None;
    }
    for ((node, plane), moved) in (0..).zip(plane_of_node).zip(moved) {
        if let Some(part) = plane.filter(|_| !moved).and_then(|plane| parts.get_mut(plane.index())) {
            part.nodes.push(node);
        }
    }
    parts.extend(apart);
    for part in &mut parts {
        let mut normals = Moments::EMPTY;
        let of = part.nodes.iter().filter_map(|node| nodes.normals.get(*node as usize)?.as_ref().ok());
        let mut first: Option<[f64; 3]> = None;
        for normal in of {
            let vector = normal.as_vector();
            let towards = *first.get_or_insert(vector.value);
            let turned = (0..3).map(|i| vector.value[i] * towards[i]).sum::<f64>() < 0.0;
            normals.push(&if turned {
                UncertainVector { value: vector.value.map(|x| -x), ..vector }
            } else {
                vector
            });
        }
        if let Some(variance) = normals.variance_with_error() {
            part.uncertainty = variance.map(|v| v.max(0.0).sqrt());
        }
    }
    Some(parts)
}
