//! Coordinate and pattern moves on mixed axes.

use rand::Rng;

use crate::ledger::{Ledger, check_starts};
use crate::{Axis, Bounds, Cost, Minimum, SearchError, Step, Steps, StopReason, Stopping, draw};

/// Pattern search: from each start place, moves along one axis at a time; the moves that led to a lower cost are then
/// made once more, all together; it ends when no move leads lower. For settings of several kinds: real, whole numbers
/// and lists at once.
///
/// # Based on
///
/// * R. Hooke, T. A. Jeeves, *"Direct search" solution of numerical and statistical problems*, Journal of the ACM 8
///   (2), 212-229, 1961, [doi:10.1145/321062.321069](https://doi.org/10.1145/321062.321069).
///
/// # Algorithm
///
/// The *mesh* is the length of a move, as a share of each axis; a quarter at first. From each start in turn:
///
/// 1. *Explore*: along each axis try a move to a higher coordinate, and if the cost is not strictly lower there, one
///    to a lower coordinate; keep what has a lower cost.
/// 2. If that led to a lower cost, go the whole way from where the exploration began to where it ended once more (the
///    *pattern move*) and explore from there. As long as this gives a strictly lower cost, do it again from there;
///    then go to 1.
/// 3. If not, halve the mesh and go to 1. The start has *converged* when the mesh is below [`finest`](Self::finest),
///    or when halving would change no move.
///
/// A move along a real axis is the mesh times its width. Along whole numbers and lists it goes on by the mesh times
/// the number of values, rounded down, and at least to the next value.
///
/// *Steps*: a move goes at least to the border of the known step it stands on, since the cost is the same anywhere
/// inside. So a start that has converged stands on a step of which no neighbour along an axis is lower, unless the
/// steps are narrower than the finest mesh. A move that would leave the bounds ends at them.
///
/// *Ties*: the earlier found wins.
///
/// # When it ends
///
/// With [`StopReason::Converged`] when all starts have, or before as [`Stopping`] says: a round is one exploration,
/// and there is no limit to them unless it is set. It does not look at [`Stopping::spread`].
///
/// # Complexity
///
/// Per round at most 2 *d* questions for *d* axes, and one for the start place or the pattern move before it.
///
/// # Limits
///
/// It finds a low place near each start, not the lowest of all, and may stick in a narrow valley that runs slantwise
/// to the axes. Several starts help, as does giving it the result of another method.
///
/// # Examples
///
/// ```
/// use rand::{SeedableRng, rngs::ChaCha8Rng};
/// use terrace_crs::{Axis, Bounds, PatternSearch, StopReason, from_fn};
///
/// // A threshold, a number of repeats, and the wells of a laboratory plate, which are 6, 24 or 96.
/// let bounds = Bounds::of([
///     Axis::Real { lo: 0.0, hi: 1.0 },
///     Axis::Integer { lo: 1, hi: 30 },
///     Axis::List(vec![6.0, 24.0, 96.0]),
/// ])?;
/// let mut cost = from_fn(|x| ((20.0 * x[0]).floor() - 7.0).abs() + (x[1] - 12.0).abs() + (x[2] - 24.0).abs());
/// let mut rng = ChaCha8Rng::seed_from_u64(1);
/// let minimum = PatternSearch::default().minimise(&mut cost, &bounds, &mut rng)?;
/// assert_eq!((minimum.value, minimum.stop), (0.0, StopReason::Converged));
/// assert_eq!(minimum.x[1..], [12.0, 24.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct PatternSearch {
    /// Places to start from, in this order: a setting in use, or the results of other methods.
    pub start: Vec<Vec<f64>>,
    /// The number of starts, those given included; the others are drawn uniformly (each place as likely as any other).
    /// `None`: 5, or those given if they are more.
    pub starts: Option<usize>,
    /// The mesh below which a start has converged, as a share of each axis. `None`: 2⁻²⁰, about a millionth.
    pub finest: Option<f64>,
    /// When to stop before all starts have converged.
    pub stopping: Stopping,
}

/// The mesh at first.
const COARSEST: f64 = 0.25;

impl PatternSearch {
    /// The lowest cost found within the bounds.
    ///
    /// The same cost, bounds, parameters and generator state give the same result and the same trace.
    ///
    /// # Errors
    ///
    /// A [`SearchError`]: parameters that do not fit each other or the bounds, reported before the cost is asked; or
    /// a cost that breaks its [contract](Cost#contract), as with a NaN.
    pub fn minimise(
        &self,
        cost: &mut (impl Cost + ?Sized),
        bounds: &Bounds,
        rng: &mut (impl Rng + ?Sized),
    ) -> Result<Minimum, SearchError> {
        self.minimise_with(cost, bounds, &mut Steps::new(bounds), rng)
    }

    /// As [`minimise`](Self::minimise), with the steps known from earlier searches of the same cost; adds to them.
    ///
    /// # Errors
    ///
    /// As [`minimise`](Self::minimise); `steps` then keeps what was learnt before the error.
    pub fn minimise_with(
        &self,
        cost: &mut (impl Cost + ?Sized),
        bounds: &Bounds,
        steps: &mut Steps,
        rng: &mut (impl Rng + ?Sized),
    ) -> Result<Minimum, SearchError> {
        let ledger = Ledger::open(cost, bounds, steps, &self.stopping)?;
        check_starts(&self.start, bounds)?;
        let starts = self.starts.unwrap_or(self.start.len().max(5));
        if starts == 0 {
            return Err(SearchError::EmptyPopulation);
        }
        if self.start.len() > starts {
            return Err(SearchError::TooManyStarts { starts: self.start.len(), population: starts });
        }
        let finest = self.finest.unwrap_or(0.5_f64.powi(20));
        if finest.is_nan() || finest <= 0.0 {
            return Err(SearchError::Mesh { finest });
        }
        let mut walk = Walk { ledger, bounds, most: self.stopping.rounds, rounds: 0 };
        let given = self.start.iter().cloned();
        let places = given.chain(std::iter::repeat_with(|| draw::place(bounds, rng))).take(starts);
        for x in places {
            match walk.descend(x, finest) {
                Ok(()) => {}
                Err(End::Stop(stop)) => return walk.ledger.finish(walk.rounds, stop),
                Err(End::Error(error)) => return Err(error),
            }
        }
        walk.ledger.finish(walk.rounds, StopReason::Converged)
    }
}

/// Why a descent did not come to its end.
enum End {
    Stop(StopReason),
    Error(SearchError),
}

#[derive(Clone)]
struct Base {
    x: Vec<f64>,
    value: f64,
}

struct Walk<'a, C: ?Sized> {
    ledger: Ledger<'a, C>,
    bounds: &'a Bounds,
    most: Option<usize>,
    rounds: usize,
}

impl<C: Cost + ?Sized> Walk<'_, C> {
    fn ask(&mut self, x: &[f64]) -> Result<f64, End> {
        match self.ledger.halt() {
            Some(stop) => Err(End::Stop(stop)),
            None => self.ledger.ask(x, self.rounds).map_err(End::Error),
        }
    }

    fn descend(&mut self, x: Vec<f64>, finest: f64) -> Result<(), End> {
        let value = self.ask(&x)?;
        self.ledger.accept(1);
        let mut base = Base { x, value };
        let mut mesh = COARSEST;
        loop {
            let (mut here, coarse) = self.explore(&base, mesh)?;
            if here.value >= base.value {
                mesh /= 2.0;
                if mesh < finest || !coarse {
                    return Ok(());
                }
                continue;
            }
            // The pattern move, as long as it leads down.
            loop {
                let further = here.x.iter().zip(&base.x).map(|(here, before)| here + (here - before));
                let mut further: Vec<f64> = further.collect();
                self.bounds.snap(&mut further);
                let value = self.ask(&further)?;
                let (there, _) = self.explore(&Base { x: further, value }, mesh)?;
                base = std::mem::replace(&mut here, there);
                if here.value >= base.value {
                    break;
                }
            }
        }
    }

    /// The lowest place that moves along the axes lead to, and whether a finer mesh would make other moves.
    fn explore(&mut self, from: &Base, mesh: f64) -> Result<(Base, bool), End> {
        if self.most.is_some_and(|most| self.rounds >= most) {
            return Err(End::Stop(StopReason::Rounds));
        }
        self.rounds += 1;
        let mut here = from.clone();
        let mut coarse = false;
        for (number, axis) in self.bounds.axes().iter().enumerate() {
            for up in [true, false] {
                let old = here.x[number];
                let (least, most) = self.border(&here.x, number);
                let moved = if up { above(axis, old, most, mesh) } else { below(axis, old, least, mesh) };
                let Some(Move { to, by_mesh }) = moved else { continue };
                coarse |= by_mesh;
                here.x[number] = to;
                let value = self.ask(&here.x)?;
                if value < here.value {
                    self.ledger.accept(1);
                    here.value = value;
                    break;
                }
                here.x[number] = old;
            }
        }
        Ok((here, coarse))
    }

    /// The interval around `x` along an axis on which the cost is known to be the same.
    fn border(&self, x: &[f64], axis: usize) -> (f64, f64) {
        match self.ledger.steps().step_at(x).map(|known| known.step) {
            Some(Step::Box { lo, hi }) if axis < lo.len() && axis < hi.len() => (lo[axis], hi[axis]),
            _ => (x[axis], x[axis].next_up()),
        }
    }
}

struct Move {
    to: f64,
    /// Whether the mesh and not the border of the step set its length.
    by_mesh: bool,
}

/// The value a mesh above `x`, at least `border`, the first value beyond the step.
fn above(axis: &Axis, x: f64, border: f64, mesh: f64) -> Option<Move> {
    let nearest = axis.at_or_above(border)?;
    let far = match axis.count() {
        None => (x + mesh * (axis.hi() - axis.lo())).min(axis.hi()),
        Some(count) => axis.nth(axis.rank(x).saturating_add(ranks(count, mesh))),
    };
    Some(Move { to: far.max(nearest), by_mesh: far > nearest })
}

/// The value a mesh below `x`, outside of the step that begins at `border`.
fn below(axis: &Axis, x: f64, border: f64, mesh: f64) -> Option<Move> {
    let (nearest, far) = match axis.count() {
        None => (border.next_down(), (x - mesh * (axis.hi() - axis.lo())).max(axis.lo())),
        Some(count) => {
            let nearest = axis.nth(axis.rank(border).checked_sub(1)?);
            (nearest, axis.nth(axis.rank(x).saturating_sub(ranks(count, mesh))))
        }
    };
    (nearest >= axis.lo()).then(|| Move { to: far.min(nearest), by_mesh: far < nearest })
}

/// The mesh of an axis that is moved along by rank.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a count")]
fn ranks(count: u64, mesh: f64) -> u64 {
    ((mesh * count as f64) as u64).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn to(moved: Option<Move>) -> Option<(f64, bool)> {
        moved.map(|moved| (moved.to, moved.by_mesh))
    }

    #[test]
    fn a_move_goes_at_least_to_the_border_and_at_most_to_the_bounds() {
        let axis = Axis::Real { lo: 0.0, hi: 8.0 };
        assert_eq!(to(above(&axis, 1.0, 1.5, 0.25)), Some((3.0, true)));
        assert_eq!(to(above(&axis, 1.0, 5.0, 0.25)), Some((5.0, false)));
        assert_eq!(to(above(&axis, 7.0, 7.5, 0.25)), Some((8.0, true)));
        assert_eq!(to(above(&axis, 7.0, 8.5, 0.25)), None);
        assert_eq!(to(below(&axis, 4.0, 3.0, 0.25)), Some((2.0, true)));
        assert_eq!(to(below(&axis, 4.0, 1.0, 0.25)), Some((1.0_f64.next_down(), false)));
        assert_eq!(to(below(&axis, 4.0, f64::NEG_INFINITY, 0.25)), None);
        assert_eq!(to(below(&axis, 0.0, 0.0, 0.25)), None);
    }

    #[test]
    fn counted_axes_are_moved_along_by_rank_and_by_one_at_least() {
        let axis = Axis::List(vec![0.0, 1.0, 10.0, 11.0, 50.0, 60.0, 70.0, 80.0]);
        assert_eq!(to(above(&axis, 1.0, 1.0_f64.next_up(), 0.25)), Some((11.0, true)));
        assert_eq!(to(above(&axis, 1.0, 1.0_f64.next_up(), 1e-9)), Some((10.0, false)));
        assert_eq!(to(above(&axis, 1.0, 20.0, 0.25)), Some((50.0, false)));
        assert_eq!(to(below(&axis, 60.0, 60.0, 0.25)), Some((11.0, true)));
        assert_eq!(to(below(&axis, 60.0, 11.0, 0.25)), Some((10.0, false)));
        assert_eq!(to(below(&axis, 0.0, 0.0, 0.25)), None);
        assert_eq!(to(above(&axis, 80.0, 80.0_f64.next_up(), 0.25)), None);
    }
}
