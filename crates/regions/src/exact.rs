//! Planes by their labelled points, where all points are at hand.

use glam::DVec3;

use crate::labels::Points;
use crate::segment::{Found, Segmentation, Share};
use crate::{Cell, Samples};

/// Some points of each cell, in the order of their cells.
pub(crate) fn samples_of(points: Points) -> Samples {
    let mut samples = Samples::default();
    for (cell, place) in points.cells.iter().zip(points.places) {
        if let Some(cell) = cell.filter(|_| place.iter().all(|x| x.is_finite())) {
            samples.push(cell, *place);
        }
    }
    samples
}

/// Labels all points, and counts and measures each plane by those it has then. Planes with fewer points than are asked for are none.
pub(crate) fn by_points(found: Found, cells: &[Cell], points: Points) -> Segmentation {
    let mut labels = found.labeller.label_all(points);
    let mut regions = found.regions;
    let mut counts = vec![0_u64; regions.len()];
    labels.iter().flatten().for_each(|label| counts[*label as usize] += 1);
    let mut order: Vec<usize> =
        (0..regions.len()).filter(|at| counts[*at] > 0 && counts[*at] as f64 >= found.min_points).collect();
    order.sort_by_key(|at| std::cmp::Reverse(counts[*at]));
    let mut rank: Vec<Option<u32>> = vec![None; regions.len()];
    for (new, old) in (0..).zip(&order) {
        rank[*old] = Some(new);
    }
    labels.iter_mut().for_each(|label| *label = label.and_then(|label| rank[label as usize]));
    regions = order.iter().map(|old| regions[*old]).collect();

    let mut sums = vec![(DVec3::ZERO, 0.0); regions.len()];
    let mut shares: Vec<(u32, u32)> = Vec::new();
    for ((label, cell), place) in labels.iter().zip(points.cells).zip(points.places) {
        let (Some(label), Some(cell)) = (label, cell) else { continue };
        let region = &regions[*label as usize];
        let anchor = DVec3::from(cells[*cell as usize].stats.anchor()) - DVec3::from(region.point);
        let from = anchor + DVec3::from(place.map(f64::from));
        let (sum, squares) = &mut sums[*label as usize];
        *sum += from;
        *squares += from.dot(region.normal.into()).powi(2);
        shares.push((*cell, *label));
    }
    for ((region, old), (sum, squares)) in regions.iter_mut().zip(&order).zip(sums) {
        region.points = counts[*old];
        let points = region.points as f64;
        region.centroid = (DVec3::from(region.point) + sum / points).to_array();
        region.rms = (squares / points).sqrt();
    }
    shares.sort_unstable();
    let shares = shares
        .chunk_by(|a, b| a == b)
        .map(|of| Share {
            cell: of[0].0,
            region: of[0].1,
            points: u32::try_from(of.len()).unwrap_or(u32::MAX),
        })
        .collect();
    Segmentation {
        regions,
        labels,
        shares,
        noise_scale: found.noise_scale,
        min_points: found.min_points,
        min_area: found.min_area,
    }
}
