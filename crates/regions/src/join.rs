//! Neighbouring regions that are one plane.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::cell::Noise;
use crate::field::{COARSE, Field};
use crate::flat::Fitted;
use crate::grow::Region;

/// Orientations may differ by this, in radians, and by so many standard errors of both.
const TURNED: f64 = 0.05;
const TURNED_ERRORS: f64 = 3.0;
/// Where they meet, one may lie so many standard errors of a point above the other.
const STEP: f64 = 1.5;
/// The mean squared distance of the smaller from the plane of both, in units of the variance of errors.
const JOINT_CHI_SQUARED: f64 = 16.0;

/// Where two regions meet: the sum over places of the vector from the second to the first, and of the weights.
#[derive(Debug, Clone, Copy, Default)]
struct Contact {
    apart: DVec3,
    weight: f64,
}

/// Pairs of regions, the first with the smaller number.
type Contacts = BTreeMap<(u32, u32), Contact>;

/// Joins regions that touch, have the same orientation, and go on without a step, the likeliest pair first. The smaller of two
/// becomes part of the larger.
pub(crate) fn join_touching(field: &Field, noise: Noise, regions: Vec<Region>) -> Vec<Region> {
    let mut contacts = contacts(field, &regions);
    let mut regions: Vec<Option<Region>> = regions.into_iter().map(Some).collect();
    let mut unlikeliness: BTreeMap<(u32, u32), f64> = BTreeMap::new();
    let judged = |pair: &(u32, u32), contact: &Contact, regions: &[Option<Region>]| {
        let of = |number: u32| regions.get(number as usize)?.as_ref();
        judge(of(pair.0)?, of(pair.1)?, contact, noise)
    };
    unlikeliness.extend(contacts.iter().filter_map(|(pair, c)| Some((*pair, judged(pair, c, &regions)?))));
    while let Some((pair, _)) = unlikeliness.iter().min_by(|a, b| a.1.total_cmp(b.1)).map(|(p, u)| (*p, *u)) {
        let points =
            |number: u32| regions[number as usize].as_ref().map_or(0.0, |region| region.fitted.points());
        let (kept, gone) = if points(pair.0) >= points(pair.1) { pair } else { (pair.1, pair.0) };
        let taken = regions[gone as usize].take();
        let joined = regions[kept as usize].take().zip(taken).and_then(|(kept, gone)| kept.with(gone, noise));
        regions[kept as usize] = joined;
        hand_over(&mut contacts, kept, gone);
        unlikeliness.retain(|(a, b), _| ![*a, *b].iter().any(|number| [kept, gone].contains(number)));
        let of_kept = contacts.iter().filter(|((a, b), _)| *a == kept || *b == kept);
        unlikeliness.extend(of_kept.filter_map(|(pair, c)| Some((*pair, judged(pair, c, &regions)?))));
    }
    regions.into_iter().flatten().collect()
}

impl Region {
    /// Both as one. That the points of two planes determine one is certain.
    fn with(mut self, other: Self, noise: Noise) -> Option<Self> {
        let mut sums = self.fitted.sums;
        sums.merge(&other.fitted.sums);
        self.cells.extend(other.cells);
        Some(Self { cells: self.cells, fitted: Fitted::of(sums, noise)? })
    }
}

/// How unlikely it is that two regions are one, up to 1; `None` beyond.
fn judge(a: &Region, b: &Region, contact: &Contact, noise: Noise) -> Option<f64> {
    let (a, b) = (&a.fitted, &b.fitted);
    let (large, small) = if a.points() >= b.points() { (a, b) } else { (b, a) };
    let turned = a.plane.angle(&b.plane) / (TURNED + TURNED_ERRORS * a.tilt.hypot(b.tilt));
    let step = large.plane.normal.dot(contact.apart / contact.weight).abs();
    let step = step / (STEP * a.variance.min(b.variance).sqrt());
    if !(turned <= 1.0 && step <= 1.0) {
        return None;
    }
    let mut sums = large.sums;
    sums.merge(&small.sums);
    let joint = small.mean_square(&Fitted::of(sums, noise)?.plane) / (JOINT_CHI_SQUARED * small.variance);
    (joint <= 1.0).then(|| turned.max(step).max(joint))
}

fn contacts(field: &Field, regions: &[Region]) -> Contacts {
    let mut region_of: Vec<Option<u32>> = vec![None; field.cells.len()];
    for (number, region) in (0..).zip(regions) {
        for cell in &region.cells {
            region_of[*cell as usize] = Some(number);
        }
    }
    let level = &field.levels[COARSE];
    let mut contacts = Contacts::new();
    let mut here: Vec<(u32, DVec3, f64)> = Vec::new();
    for group in 0..level.len() {
        here.clear();
        for cell in level.around(group) {
            let Some(region) = region_of[cell as usize] else { continue };
            let sums = &field.cells[cell as usize];
            let place = sums.mean * sums.points;
            match here.iter_mut().find(|(of, ..)| *of == region) {
                Some((_, sum, points)) => (*sum, *points) = (*sum + place, *points + sums.points),
                None => here.push((region, place, sums.points)),
            }
        }
        here.sort_unstable_by_key(|(region, ..)| *region);
        for (at, (a, of_a, points_a)) in here.iter().enumerate() {
            for (b, of_b, points_b) in &here[at + 1..] {
                let weight = points_a.min(*points_b);
                let contact = contacts.entry((*a, *b)).or_default();
                contact.apart += (of_a / *points_a - of_b / *points_b) * weight;
                contact.weight += weight;
            }
        }
    }
    contacts
}

/// The contacts of a region that became part of another are those of the other.
fn hand_over(contacts: &mut Contacts, kept: u32, gone: u32) {
    let of_gone: Vec<((u32, u32), Contact)> = contacts
        .iter()
        .filter(|((a, b), _)| *a == gone || *b == gone)
        .map(|(pair, contact)| (*pair, *contact))
        .collect();
    for (pair, contact) in of_gone {
        contacts.remove(&pair);
        let (other, from_gone) =
            if pair.0 == gone { (pair.1, contact.apart) } else { (pair.0, -contact.apart) };
        if other != kept {
            let known = contacts.entry((kept.min(other), kept.max(other))).or_default();
            known.apart += if kept < other { from_gone } else { -from_gone };
            known.weight += contact.weight;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{EDGE, NOISE, SIGMA, field, square};

    /// Cells as regions, by the number that is told for each key.
    fn regions(field: &Field, number: impl Fn([i32; 3]) -> usize) -> Vec<Region> {
        let mut cells: Vec<Vec<u32>> = Vec::new();
        for (cell, key) in (0..).zip(&field.keys) {
            let number = number(*key);
            cells.resize(cells.len().max(number + 1), Vec::new());
            cells[number].push(cell);
        }
        cells.into_iter().map(|cells| Region { fitted: field.fit(&cells, NOISE).unwrap(), cells }).collect()
    }

    fn cells_of(joined: &[Region]) -> Vec<Vec<u32>> {
        let sorted = |region: &Region| {
            let mut cells = region.cells.clone();
            cells.sort_unstable();
            cells
        };
        joined.iter().map(sorted).collect()
    }

    #[test]
    fn three_fragments_in_a_row_are_one_whichever_comes_first() {
        let field = field(&square(|x, y| [x, y, 0.05]));
        for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
            // Of different sizes: the first and the last do not touch.
            let fragments = regions(&field, |[x, ..]| order[usize::from(x > 2) + usize::from(x > 8)]);
            assert_eq!(contacts(&field, &fragments).len(), 2);
            let joined = join_touching(&field, NOISE, fragments);
            assert_eq!(cells_of(&joined), [(0..144).collect::<Vec<u32>>()]);
            assert_eq!(joined[0].fitted.sums.count(), 3600);
        }
    }

    #[test]
    fn a_step_keeps_two_apart() {
        for (step, left) in [(0.0, 1), (1.4 * SIGMA, 1), (1.6 * SIGMA, 2), (2.4 * SIGMA, 2)] {
            let height = |x: f64| if x < 0.6 { 0.015 } else { 0.015 + step };
            let field = field(&square(|x, y| [x, y, height(x)]));
            let halves = regions(&field, |[x, ..]| usize::from(x >= 6));
            let apart = &contacts(&field, &halves)[&(0, 1)];
            // From the second to the first.
            assert!((apart.apart.z / apart.weight + step).abs() < 1e-9);
            assert_eq!(join_touching(&field, NOISE, halves).len(), left, "{step}");
        }
    }

    #[test]
    fn what_does_not_touch_and_what_is_turned_stays() {
        let flat = |x: f64, y: f64| [x, y, 0.05];
        let gap = field(&square(|x, y| flat(if x < 0.6 { x } else { x + 4.0 * EDGE }, y)));
        let halves = regions(&gap, |[x, ..]| usize::from(x >= 6));
        assert_eq!(join_touching(&gap, NOISE, halves).len(), 2);
        let roof = field(&square(|x, y| [x, y, 0.02 + 0.15 * (x - 0.6).abs()]));
        let halves = regions(&roof, |[x, ..]| usize::from(x >= 6));
        assert_eq!(join_touching(&roof, NOISE, halves).len(), 2);
        assert_eq!(join_touching(&roof, NOISE, Vec::new()).len(), 0);
    }

    #[test]
    fn contacts_go_to_the_one_that_is_kept() {
        // The sum of all is that between the places of regions: those of the numbers are told apart by their axis.
        let place = [DVec3::ZERO, DVec3::X, 2.0 * DVec3::Y, 3.0 * DVec3::Z];
        let contact = |a: usize, b: usize| Contact { apart: place[a] - place[b], weight: 1.0 };
        let all = || -> Contacts {
            [(0, 1), (0, 2), (1, 2), (1, 3), (2, 3)]
                .map(|(a, b)| ((a, b), contact(a as usize, b as usize)))
                .into()
        };
        let told = |contacts: &Contacts| -> Vec<((u32, u32), DVec3, f64)> {
            contacts.iter().map(|(pair, contact)| (*pair, contact.apart, contact.weight)).collect()
        };
        let mut contacts = all();
        hand_over(&mut contacts, 2, 1);
        let with_0 = (place[0] - place[2]) + (place[0] - place[1]);
        let with_3 = (place[2] - place[3]) + (place[1] - place[3]);
        assert_eq!(told(&contacts), [((0, 2), with_0, 2.0), ((2, 3), with_3, 2.0)]);
        let mut contacts = all();
        hand_over(&mut contacts, 0, 3);
        let with_1 = (place[0] - place[1]) + (place[3] - place[1]);
        let with_2 = (place[0] - place[2]) + (place[3] - place[2]);
        let between = place[1] - place[2];
        assert_eq!(told(&contacts), [((0, 1), with_1, 2.0), ((0, 2), with_2, 2.0), ((1, 2), between, 1.0)]);
    }
}
