//! All measures of one pair of labelings.

use terrace_types::PlaneId;

use crate::contingency::Best;
use crate::{Contingency, Matches, SegComp};

/// All measures of a labeling against the truth; the definitions are on the page of the crate.
///
/// ```
/// use terrace_eval::{Contingency, Evaluation};
///
/// // Of the first plane one point of four was missed, the second was found to the point.
/// let both = Contingency::of_numbers(&[1, 1, 1, 1, 2, 2, 0], &[7, 7, 7, 0, 3, 3, 3])?;
/// let all = Evaluation::of(&both);
/// assert_eq!((all.half.matched, all.strict.matched), (2, 0));
/// assert_eq!(all.cover, Some((0.75 + 2.0 / 3.0) / 2.0));
/// assert_eq!(all.point_accuracy, Some(5.0 / 6.0));
/// assert_eq!(all.non_planar_claimed, Some(1.0));
/// # Ok::<(), terrace_eval::EvalError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Evaluation {
    /// Number of points compared.
    pub points: u64,
    /// The planes that match above [`Evaluation::HALF`].
    pub half: Matches,
    /// The planes that match above [`Evaluation::STRICT`].
    pub strict: Matches,
    /// Mean IoU of the pairs that match above one half; `None` without any.
    pub mean_iou: Option<f64>,
    /// Mean over all true planes of the IoU of their match, 0 for those without; `None` without true planes.
    pub mean_iou_all: Option<f64>,
    /// Mean Dice coefficient of the pairs that match above one half; `None` without any.
    pub mean_dice: Option<f64>,
    /// Mean of the best IoU of each true plane; `None` without true planes.
    pub cover: Option<f64>,
    /// The same weighted by points, see [`Contingency::weighted_cover`].
    pub weighted_cover: Option<f64>,
    /// What became of each plane, at [`Evaluation::SHARE`].
    pub segcomp: SegComp,
    /// The share of the points of true planes that lie in the found plane which matches theirs above one half; `None`
    /// without true planes.
    pub point_accuracy: Option<f64>,
    /// See [`Contingency::non_planar_claimed`].
    pub non_planar_claimed: Option<f64>,
    /// Each true plane, by number.
    pub planes: Vec<TruePlaneScore>,
}

/// How well one true plane was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TruePlaneScore {
    /// The true plane.
    pub truth: PlaneId,
    /// Number of its points.
    pub points: u64,
    /// Its greatest IoU with a found plane, 0 when none shares a point.
    pub best_iou: f64,
    /// The found plane that matches it above one half, if any.
    pub found: Option<PlaneId>,
}

impl Evaluation {
    /// The IoU above which planes match in [`Evaluation::half`], in the means and in the point accuracy.
    pub const HALF: f64 = 0.5;
    /// The IoU above which planes match in [`Evaluation::strict`].
    pub const STRICT: f64 = 0.8;
    /// The share of [`Evaluation::segcomp`].
    pub const SHARE: f64 = 0.8;

    /// Computes all measures.
    pub fn of(both: &Contingency) -> Self {
        let best = both.best();
        let matched = |best: &&Best| best.iou > Self::HALF;
        let matched_iou = || best.iter().filter(matched).map(|best| best.iou);
        let true_points: u64 = best.iter().map(|best| best.points).sum();
        let (mut right, mut dice) = (0, Vec::new());
        for pair in both.pairs().filter(|pair| pair.iou() > Self::HALF) {
            right += pair.shared;
            dice.push(2.0 * pair.shared as f64 / (pair.of_truth + pair.of_found) as f64);
        }
        Self {
            points: both.points(),
            half: both.matches_above(Self::HALF),
            strict: both.matches_above(Self::STRICT),
            mean_iou: mean(matched_iou()),
            mean_iou_all: share(matched_iou().sum(), best.len() as f64),
            mean_dice: mean(dice.into_iter()),
            cover: mean(best.iter().map(|best| best.iou)),
            weighted_cover: both.weighted_cover(),
            segcomp: both.sorted_at(Self::SHARE),
            point_accuracy: share(right as f64, true_points as f64),
            non_planar_claimed: both.non_planar_claimed(),
            planes: best.iter().map(TruePlaneScore::of).collect(),
        }
    }
}

impl TruePlaneScore {
    fn of(best: &Best) -> Self {
        let found = best.found.filter(|_| best.iou > Evaluation::HALF);
        Self { truth: best.truth, points: best.points, best_iou: best.iou, found }
    }
}

fn share(of: f64, all: f64) -> Option<f64> {
    (all > 0.0).then(|| of / all)
}

/// The arithmetic mean; `None` of nothing.
pub(crate) fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0_u64, 0.0), |(count, sum), value| (count + 1, sum + value));
    share(sum, count as f64)
}
