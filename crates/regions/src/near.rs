//! The regions near a cell, as its points see them.

use crate::ends::End;

/// A region near a cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Near {
    pub(crate) region: u32,
    /// The distance from its plane in standard errors of a point is `normal · place + offset`, places from the anchor.
    pub(crate) normal: [f32; 3],
    pub(crate) offset: f32,
    /// −2 ln of its share of the points around.
    pub(crate) prior: f32,
    /// Where its ends begin among those of the cell, and how many there are.
    pub(crate) ends: (u32, u32),
}

/// The regions near a cell where there are several, by number.
#[derive(Debug, Clone)]
pub(crate) struct Several {
    pub(crate) near: Box<[Near]>,
    pub(crate) ends: Box<[End]>,
}

/// The regions near a cell.
#[derive(Debug, Clone)]
pub(crate) enum Nearby {
    None,
    One(Near),
    Several(Several),
}

impl Near {
    /// The distance of a place in standard errors, `None` beyond the reach. A place that is not finite is near no plane.
    #[inline]
    pub(crate) fn errors(&self, [x, y, z]: [f32; 3], reach: f32) -> Option<f32> {
        let [a, b, c] = self.normal;
        let errors = a * x + b * y + c * z + self.offset;
        (errors.abs() <= reach).then_some(errors)
    }
}

/// How many of several regions a point is within the reach of.
pub(crate) enum Within {
    None,
    /// Its place among them.
    One(usize),
    Several,
}

impl Several {
    pub(crate) fn group(&self) -> Group<'_> {
        Group { near: &self.near, ends: &self.ends }
    }
}

/// Several regions near a cell, wherever they are kept.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Group<'a> {
    pub(crate) near: &'a [Near],
    /// Those of the regions, and maybe others.
    pub(crate) ends: &'a [End],
}

impl Group<'_> {
    /// Which of them a place is within the reach of: of most it is one, and then there is nothing to weigh.
    #[inline]
    pub(crate) fn within(self, place: [f32; 3], reach: f32) -> Within {
        let (mut count, mut last) = (0_u32, 0);
        for (at, near) in self.near.iter().enumerate() {
            let is_within = near.errors(place, reach).is_some();
            count += u32::from(is_within);
            last = if is_within { at } else { last };
        }
        match count {
            0 => Within::None,
            1 => Within::One(last),
            _ => Within::Several,
        }
    }

    /// How probable it is that a point is of a region, as −2 ln and but for what is the same for all; `None` beyond the reach.
    #[inline]
    pub(crate) fn score(self, near: &Near, place: [f32; 3], reach: f32) -> Option<f32> {
        let errors = near.errors(place, reach)?;
        Some(errors * errors + self.outside(near, place) + near.prior)
    }

    /// How improbable it is that a point is inside the ends of a region, as −2 ln.
    #[inline]
    pub(crate) fn outside(self, near: &Near, place: [f32; 3]) -> f32 {
        let (first, count) = (near.ends.0 as usize, near.ends.1 as usize);
        let ends = self.ends.get(first..first + count).unwrap_or(&[]);
        let inside: f32 = ends.iter().map(|end| end.ln_inside(place)).sum();
        -2.0 * inside
    }

    /// The place among the regions of that which a point is most probably of.
    #[inline]
    pub(crate) fn best(self, place: [f32; 3], reach: f32) -> Option<usize> {
        let mut best: Option<(f32, usize)> = None;
        for (at, near) in self.near.iter().enumerate() {
            if let Some(score) = self.score(near, place, reach)
                && best.is_none_or(|(least, _)| score < least)
            {
                best = Some((score, at));
            }
        }
        best.map(|(_, at)| at)
    }
}

impl Nearby {
    pub(crate) fn regions(&self) -> &[Near] {
        match self {
            Self::None => &[],
            Self::One(near) => std::slice::from_ref(near),
            Self::Several(several) => &several.near,
        }
    }
}
