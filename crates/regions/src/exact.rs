//! Planes by their labelled points, where all points are at hand.

use rayon::prelude::*;

use crate::labels::Points;
use crate::segment::{Found, Segmentation};
use crate::shares::Share;
use crate::{Measure, Samples};

/// Points that are labelled by a thread at once.
const AT_ONCE: usize = 1 << 14;

/// Some points of each cell, in a unit in which all places fit.
pub(crate) fn samples_of(points: Points) -> Samples {
    let finite = |place: &[f32; 3]| place.iter().all(|x| x.is_finite());
    let places = points.places.iter().filter(|place| finite(place));
    let farthest = places.flatten().fold(1e-30_f32, |farthest, x| x.abs().max(farthest));
    let mut samples = Samples::new((f64::from(farthest).log2().floor() - 14.0).exp2());
    let mut packed = Vec::with_capacity(points.places.len());
    samples.pack(points.places, &mut packed);
    samples.push_all(|at| points.cells[at].filter(|_| finite(&points.places[at])), &packed);
    samples
}

/// Labels all points, and counts and measures each plane by those it has then. Planes with fewer points than are asked for are none.
pub(crate) fn by_points(mut found: Found, points: Points) -> Segmentation {
    let labelled =
        points.cells.par_chunks(AT_ONCE).zip(points.places.par_chunks(AT_ONCE)).map(|(cells, places)| {
            let mut labels = vec![None; cells.len()];
            let points = cells.iter().zip(places).zip(&mut labels);
            let points = points.map(|((cell, place), to)| (*cell, *place, to));
            let measures = found.labeller.label_all(points, |to, label| *to = label);
            (labels, measures)
        });
    let labelled: Vec<(Vec<Option<u32>>, Vec<Measure>)> = labelled.collect();
    let mut measures = vec![Measure::default(); found.regions.len()];
    for (_, of_some) in &labelled {
        measures.iter_mut().zip(of_some).for_each(|(sum, more)| sum.add(more));
    }
    let numbers = found.by_measures(&measures);
    let labels: Vec<Option<u32>> = labelled
        .iter()
        .flat_map(|(labels, _)| labels)
        .map(|label| label.and_then(|label| numbers.get(label as usize).copied().flatten()))
        .collect();
    let mut shares: Vec<(u32, u32)> =
        points.cells.iter().zip(&labels).filter_map(|(cell, label)| Some(((*cell)?, (*label)?))).collect();
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
        regions: found.regions,
        labels,
        shares,
        noise_scale: found.noise_scale,
        min_points: found.min_points,
        min_area: found.min_area,
    }
}
