//! What tells points of planes, laid out cell by cell.

use glam::DVec3;
use rayon::prelude::*;

use super::tally::{Total, Units};
use super::{Labeller, NONE, Place};
use crate::cube::Cube;
use crate::ends::End;
use crate::field::Field;
use crate::flat::Flat;
use crate::level::number;
use crate::near::{Near, Nearby, Several};
use crate::of_cells::{OfCells, Parts};

/// What is the same for all cells.
struct Laying<'a> {
    field: &'a Field,
    anchors: &'a [DVec3],
    reach: f32,
    origin: DVec3,
    planes: &'a [Flat],
    units: Units,
}

/// Of some cells on end what is not the same for each.
struct Laid {
    mixed: Vec<Near>,
    ends: Vec<End>,
    whole: Vec<Total>,
}

impl Labeller {
    /// `numbers` tells, from a cell on, of which plane the points of a region are in a cell, if of any: cells are asked for in their order,
    /// each for several regions. `anchors` are those of the field.
    pub(crate) fn of<N: FnMut(u32, u32) -> Option<u32>>(
        field: &Field,
        anchors: Vec<DVec3>,
        of_cells: OfCells,
        reach: f64,
        numbers: impl Fn(u32) -> N + Sync,
        planes: Vec<Flat>,
    ) -> Self {
        // As places are.
        #[allow(clippy::cast_possible_truncation)]
        let reach = reach as f32;
        let (units, origin) = (Units::of(field.edge), anchors.first().copied().unwrap_or(DVec3::ZERO));
        let laying = Laying { field, anchors: &anchors, reach, origin, planes: &planes, units };
        let OfCells { mut nearby, mut parts } = of_cells;
        let mut cells: Vec<Place> = vec![Place::UNKNOWN; parts.len()];
        let threads = rayon::current_num_threads();
        // On one thread each cell is put where it stays, without a list on the way.
        let laid = if threads == 1 {
            let put = |place: Place| cells[field.order[place.rank as usize] as usize] = place;
            laying.lay(0, &mut nearby, &mut parts, numbers(0), put)
        } else {
            let at_once = parts.len().div_ceil(threads).max(1);
            let some = nearby.par_chunks_mut(at_once).zip(parts.par_chunks_mut(at_once)).enumerate();
            let lay = |(part, (nearby, parts)): (usize, (&mut [Nearby], &mut [Parts]))| {
                let first = number(part * at_once);
                let mut places = Vec::with_capacity(parts.len());
                let laid = laying.lay(first, nearby, parts, numbers(first), |place| places.push(place));
                (places, laid)
            };
            let mut all = Laid::of(planes.len(), (0, 0));
            for (places, laid) in some.map(lay).collect::<Vec<_>>() {
                let begin = place_of(&all.mixed);
                for place in places {
                    let mixed = (place.mixed.0.saturating_add(begin), place.mixed.1);
                    cells[field.order[place.rank as usize] as usize] = Place { mixed, ..place };
                }
                all.append(laid);
            }
            all
        };
        let Laid { mixed, ends, whole } = laid;
        Self { reach, cells, anchors, mixed, ends, origin, planes, whole, units }
    }
}

impl Laying<'_> {
    /// Lays out some cells, of which this is the first: `put` takes one after the other. What was near them is not kept.
    fn lay(
        &self,
        first: u32,
        nearby: &mut [Nearby],
        parts: &mut [Parts],
        mut number: impl FnMut(u32, u32) -> Option<u32>,
        mut put: impl FnMut(Place),
    ) -> Laid {
        let sums = &self.field.cells[first as usize..];
        // Counted first: lists that grow are copied into new memory again and again.
        let mut most = (0, 0);
        for ((nearby, parts), sums) in nearby.iter().zip(&*parts).zip(sums) {
            match nearby {
                Nearby::One(_) => most.0 += usize::from(parts.whole(sums.points).is_none()),
                Nearby::Several(Several { near, ends }) => {
                    most = (most.0 + near.len(), most.1 + ends.len());
                }
                Nearby::None => {}
            }
        }
        let mut laid = Laid::of(self.planes.len(), most);
        let of_cells = nearby.iter_mut().zip(parts);
        for ((rank, (nearby, parts)), sums) in (first..).zip(of_cells).zip(sums) {
            let nearby = std::mem::replace(nearby, Nearby::None);
            let parts = std::mem::replace(parts, Parts::None);
            let mut number = |region: u32| number(rank, region).unwrap_or(NONE);
            let mut place = Place { rank, ..Place::UNKNOWN };
            let plane = parts.whole(sums.points).map_or(NONE, |part| number(part.region));
            let at = plane as usize;
            if let (Some(flat), Some(whole)) = (self.planes.get(at), laid.whole.get_mut(at)) {
                place.plane = plane;
                whole.add(&Total::of(sums, self.origin, flat, self.units));
            }
            self.see(&mut place, &nearby, number, &mut laid);
            put(place);
        }
        laid
    }

    /// Tells a cell what is near it.
    fn see(&self, place: &mut Place, nearby: &Nearby, mut number: impl FnMut(u32) -> u32, laid: &mut Laid) {
        let Laid { mixed, ends, .. } = laid;
        if let Nearby::One(near) = nearby
            && place.plane != NONE
        {
            (place.normal, place.offset) = (near.normal, near.offset);
            return;
        }
        let first = mixed.len();
        let rank = place.rank as usize;
        let cube = Cube::of(self.field, rank, self.anchors[rank]);
        for near in nearby.regions().iter().filter(|near| !cube.is_beyond(near, self.reach)) {
            let at = near.ends.0.saturating_add(place_of(ends));
            mixed.push(Near { region: number(near.region), ends: (at, near.ends.1), ..*near });
        }
        match mixed[first..] {
            [near] if near.region == place.plane && place.plane != NONE => {
                (place.normal, place.offset) = (near.normal, near.offset);
                mixed.truncate(first);
                return;
            }
            ref left if left.iter().all(|near| near.region == NONE) => {
                mixed.truncate(first);
                return;
            }
            _ => {}
        }
        place.mixed = (place_of(&mixed[..first]), place_of(&mixed[first..]));
        if let Nearby::Several(several) = nearby {
            ends.extend(&several.ends);
        }
    }
}

impl Laid {
    /// Of no cells, with room for so much near them and so many ends.
    fn of(planes: usize, (near, ends): (usize, usize)) -> Self {
        let whole = vec![Total::default(); planes];
        Self { mixed: Vec::with_capacity(near), ends: Vec::with_capacity(ends), whole }
    }

    /// Adds that of the cells that follow.
    fn append(&mut self, mut later: Self) {
        let begin = place_of(&self.ends);
        for near in &mut later.mixed {
            near.ends.0 = near.ends.0.saturating_add(begin);
        }
        self.mixed.append(&mut later.mixed);
        self.ends.append(&mut later.ends);
        for (all, whole) in self.whole.iter_mut().zip(&later.whole) {
            all.add(whole);
        }
    }
}

/// The place after the last of a list.
fn place_of<T>(list: &[T]) -> u32 {
    // Of each of the cells, which are numbered with 32 bits, some few: memory would be at its end before.
    u32::try_from(list.len()).unwrap_or(NONE)
}
