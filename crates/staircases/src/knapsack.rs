//! A knapsack problem over floored axes.

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use terrace_crs::{Axis, Bounds, Cost, Evaluation};

use crate::cells::Cells;
use crate::draw::whole;
use crate::error::check_steps;
use crate::{ParameterError, TestCost};

/// The largest table of the dynamic programming, and the largest integer that costs may reach.
const MOST_ENTRIES: u128 = 20_000_000;
const MOST_COST: u128 = 1 << 53;

/// What may be packed, once or several times.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Item {
    /// What one piece is worth.
    pub value: u32,
    /// What one piece weighs, at least 1.
    pub weight: u32,
    /// How many pieces there are; 1 for every item is the 0-1 knapsack.
    pub most: u32,
}

/// The bounded knapsack problem as a cost: whole numbers of pieces, read off real axes, with a penalty for too much.
///
/// * Formula: f(x) = -Σ vᵢkᵢ + P · max(0, Σ wᵢkᵢ - C), with kᵢ = ⌊xᵢ⌋ pieces of value vᵢ and weight wᵢ, the capacity C
///   and the penalty P = 1 + max vᵢ.
/// * Domain: [0, uᵢ + 1] for at most uᵢ pieces, xᵢ = uᵢ + 1 counting as uᵢ; outside, the outermost steps go on.
/// * Optimum: minus the value of the best packing within the capacity, found here by dynamic programming, exactly. A
///   packing that is too heavy is never as good: taking out a piece costs less than P and gains at least P.
/// * Steps: Π (uᵢ + 1), each axis cut at the whole numbers.
/// * Source: S. Martello, P. Toth, *Knapsack Problems: Algorithms and Computer Implementations*, Wiley, 1990, chapters 2
///   and 3; the exact optimum by R. Bellman's recursion, *Dynamic Programming*, Princeton University Press, 1957. The
///   penalty is of this crate.
///
/// All numbers are whole and below 2⁵³, so costs are exact.
///
/// ```
/// use terrace_crs::Cost;
/// use terrace_staircases::{Item, Knapsack, TestCost};
///
/// let items = [Item { value: 10, weight: 5, most: 2 }, Item { value: 7, weight: 4, most: 3 }];
/// let mut cost = Knapsack::new(&items, 13)?;
/// assert_eq!((cost.minimum(), cost.step_count()), (-24.0, 12));
/// assert_eq!(cost.minimiser(), [1.0, 2.0]);
/// // Two and two weigh 18, 5 too much at 11 each.
/// assert_eq!(cost.evaluate(&[2.5, 2.5]).value, -34.0 + 55.0);
/// # Ok::<(), terrace_staircases::ParameterError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Knapsack {
    items: Vec<Item>,
    capacity: u32,
    penalty: f64,
    cells: Cells,
    bounds: Bounds,
    best: Vec<u32>,
}

impl Knapsack {
    /// The problem of packing `items` into `capacity`; finds the optimum.
    ///
    /// # Errors
    ///
    /// No items; one without weight; more than ten million pieces of one item; a table of (items) times (capacity + 1)
    /// above twenty million entries, or costs that could pass 2⁵³.
    pub fn new(items: &[Item], capacity: u32) -> Result<Self, ParameterError> {
        let mut highest = 0_u128;
        let penalty = 1 + items.iter().map(|item| u128::from(item.value)).max().unwrap_or(0);
        for (index, item) in items.iter().enumerate() {
            if item.weight == 0 {
                return Err(ParameterError::Weightless { item: index });
            }
            check_steps(usize::try_from(item.most).unwrap_or(usize::MAX).saturating_add(1))?;
            highest += u128::from(item.most) * (u128::from(item.value) + penalty * u128::from(item.weight));
        }
        check("the largest cost", highest, MOST_COST)?;
        check(
            "the table of the dynamic programming",
            items.len() as u128 * (u128::from(capacity) + 1),
            MOST_ENTRIES,
        )?;
        let bounds = Bounds::new(items.iter().map(|item| (0.0, f64::from(item.most) + 1.0)))?;
        let borders = items.iter().map(|item| (1..=item.most).map(f64::from).collect()).collect();
        let (items, best) = (items.to_vec(), pack(items, capacity));
        Ok(Self { items, capacity, penalty: penalty as f64, cells: Cells::new(borders), bounds, best })
    }

    /// A problem of `items` items with values and weights drawn from 1 to 100, up to `most` pieces each, and half the
    /// weight of all pieces as capacity.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new).
    pub fn from_seed(seed: u64, items: usize, most: u32) -> Result<Self, ParameterError> {
        check("the table of the dynamic programming", items as u128, MOST_ENTRIES)?;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let draw = |_| Item { value: whole(100, &mut rng), weight: whole(100, &mut rng), most };
        let items: Vec<Item> = (0..items).map(draw).collect();
        let weight: u128 = items.iter().map(|item| u128::from(item.weight) * u128::from(item.most)).sum();
        Self::new(&items, u32::try_from(weight / 2).unwrap_or(u32::MAX))
    }

    /// What may be packed.
    pub fn items(&self) -> &[Item] {
        &self.items
    }

    /// The weight that may be packed.
    pub fn capacity(&self) -> u32 {
        self.capacity
    }

    /// The numbers of pieces as whole numbers, 0 to uᵢ on each axis, for searches that know such axes: the same cost, the
    /// same optimum.
    ///
    /// # Errors
    ///
    /// None in effect: an item has at most ten million pieces.
    pub fn integer_bounds(&self) -> Result<Bounds, ParameterError> {
        let axis = |item: &Item| Axis::Integer { lo: 0, hi: i64::from(item.most) };
        Ok(Bounds::of(self.items.iter().map(axis))?)
    }

    /// How many pieces of each item the best packing has.
    pub fn best(&self) -> &[u32] {
        &self.best
    }

    fn value(&self, counts: impl Iterator<Item = f64>) -> f64 {
        let (mut worth, mut weight) = (0.0, 0.0);
        for (item, count) in self.items.iter().zip(counts) {
            worth += f64::from(item.value) * count;
            weight += f64::from(item.weight) * count;
        }
        self.penalty * (weight - f64::from(self.capacity)).max(0.0) - worth
    }
}

fn check(what: &'static str, count: u128, limit: u128) -> Result<(), ParameterError> {
    if count > limit { Err(ParameterError::TooLarge { what, count, limit }) } else { Ok(()) }
}

/// The best number of pieces of each item, the smallest numbers of the last items among equals.
///
/// O(items · capacity · most) time.
fn pack(items: &[Item], capacity: u32) -> Vec<u32> {
    let room = usize::try_from(capacity).unwrap_or(usize::MAX - 1);
    // best[c]: the highest value within c of the items so far; taken[i][c]: the pieces of item i in it.
    let mut best = vec![0_u64; room + 1];
    let mut taken = Vec::with_capacity(items.len());
    for item in items {
        let weight = usize::try_from(item.weight).unwrap_or(usize::MAX);
        let mut pieces = vec![0_u32; room + 1];
        for c in (0..=room).rev() {
            let mut left = c;
            for count in 1..=item.most {
                let Some(rest) = left.checked_sub(weight) else { break };
                left = rest;
                // Cells below c are not yet overwritten: they are those without this item.
                let value = best[left] + u64::from(item.value) * u64::from(count);
                if value > best[c] {
                    best[c] = value;
                    pieces[c] = count;
                }
            }
        }
        taken.push(pieces);
    }
    let mut left = room;
    let mut counts: Vec<u32> = Vec::with_capacity(items.len());
    for (item, pieces) in items.iter().zip(&taken).rev() {
        counts.push(pieces[left]);
        left -= usize::try_from(u64::from(item.weight) * u64::from(pieces[left])).unwrap_or(left);
    }
    counts.reverse();
    counts
}

impl Cost for Knapsack {
    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        self.cells.evaluate(x, |cell| self.value(cell.index.iter().map(|&k| k as f64)))
    }

    fn dimension(&self) -> Option<usize> {
        Some(self.cells.dimension())
    }
}

impl TestCost for Knapsack {
    fn name(&self) -> String {
        "knapsack".into()
    }

    fn bounds(&self) -> Bounds {
        self.bounds.clone()
    }

    fn minimum(&self) -> f64 {
        self.value(self.best.iter().copied().map(f64::from))
    }

    fn minimiser(&self) -> Vec<f64> {
        self.best.iter().copied().map(f64::from).collect()
    }

    fn step_count(&self) -> u128 {
        self.cells.count()
    }
}

#[cfg(test)]
mod tests {
    use terrace_crs::{CertifiedSearch, StopReason};

    use super::*;

    const fn item(value: u32, weight: u32, most: u32) -> Item {
        Item { value, weight, most }
    }

    #[test]
    fn nothing_fits_into_no_room() {
        let mut cost = Knapsack::new(&[item(5, 1, 3)], 0).unwrap();
        assert_eq!((cost.minimum(), cost.best()), (0.0, &[0][..]));
        assert_eq!(cost.evaluate(&[1.0]).value, -5.0 + 6.0);
    }

    #[test]
    fn a_single_item_is_taken_as_often_as_it_fits() {
        assert_eq!(Knapsack::new(&[item(5, 3, 9)], 11).unwrap().best(), [3]);
        assert_eq!(Knapsack::new(&[item(5, 3, 2)], 11).unwrap().best(), [2]);
    }

    #[test]
    fn over_whole_numbers_it_is_proven_to_be_the_same() {
        let mut cost = Knapsack::from_seed(3, 3, 6).unwrap();
        let bounds = cost.integer_bounds().unwrap();
        let proven = CertifiedSearch::default().minimise(&mut cost, &bounds).unwrap();
        assert_eq!((proven.value, proven.stop), (cost.minimum(), StopReason::Certified));
    }

    #[test]
    fn an_item_of_no_pieces_is_an_axis_of_one_step() {
        let cost = Knapsack::new(&[item(5, 3, 0), item(1, 1, 1)], 5).unwrap();
        assert_eq!((cost.step_count(), cost.minimum()), (2, -1.0));
    }

    #[test]
    fn wrong_problems_are_errors() {
        assert!(matches!(Knapsack::new(&[], 5), Err(ParameterError::Bounds(_))));
        assert_eq!(Knapsack::new(&[item(1, 0, 1)], 5), Err(ParameterError::Weightless { item: 0 }));
        for (items, capacity) in
            [([item(1, 1, 1)], u32::MAX), ([item(u32::MAX, u32::MAX, 1000)], 5), ([item(1, 1, u32::MAX)], 5)]
        {
            let error = Knapsack::new(&items, capacity);
            assert!(matches!(error, Err(ParameterError::TooLarge { .. })), "{error:?}");
        }
    }
}
