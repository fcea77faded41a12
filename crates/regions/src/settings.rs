//! What may be set.

use crate::RegionsError;

/// What makes a region a plane, and a point one of its points. All have defaults that follow from the data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// The largest standard error of a plane's orientation, in radians.
    pub tilt: f64,
    /// The largest distance of a point from its plane, in standard errors.
    pub reach: f64,
    /// The normal of a plane turns over its surface by less than this, rms, in radians. What turns further, significantly, is curved.
    pub turn: f64,
    /// Whether the errors of the sums are stated, and so all there is while planes are as flat as they say. Errors that were found
    /// from how points scatter say nothing of what neighbouring points share: a sensor's steps, a bent table.
    pub errors_are_stated: bool,
    /// The fewest points of a plane. `None`: four in a thousand of all points, at least 20, and 250 are always enough.
    pub min_points: Option<u64>,
    /// The least area of a plane, in m². `None`: a quarter of a per cent of the area of all planes, but no more than that of fifty
    /// cells of the coarser resolution, of twelve where errors are stated.
    pub min_area: Option<f64>,
    /// A step that is left out, to find what it is worth.
    pub leave_out: Option<Step>,
}

/// A step of the method that can be left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// Regions begin at every resolution; without, at that of a coarser cell alone.
    Resolutions,
    /// A region grows over cells whose points lie on its plane; without, over cells whose surface is not turned against it.
    Offsets,
    /// And whose surface is not turned against it; without, wherever points lie on its plane.
    Normals,
    /// Planes are fitted to their sums as they grow; without, that of the seed stays.
    Refit,
    /// Errors may be larger than stated, and surfaces bent by as much; without, they are as stated.
    Bent,
    /// Slices through clutter are no planes, where cells may scatter.
    Slices,
    /// Labels know how many points around are of each plane.
    Shares,
    /// Labels know where planes end at each other.
    Ends,
    /// Curved surfaces are no planes.
    Curved,
    /// Planes are as certain and as wide as is asked for.
    Certain,
    /// Planes that fall into parts are taken apart.
    Parts,
    /// Planes have the least size.
    Size,
}

impl Step {
    /// All, in the order in which they come.
    pub const ALL: [Self; 12] = [
        Self::Resolutions,
        Self::Offsets,
        Self::Normals,
        Self::Refit,
        Self::Bent,
        Self::Slices,
        Self::Shares,
        Self::Ends,
        Self::Curved,
        Self::Certain,
        Self::Parts,
        Self::Size,
    ];
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            tilt: 0.01,
            reach: 3.1,
            turn: 0.1,
            errors_are_stated: true,
            min_points: None,
            leave_out: None,
            min_area: None,
        }
    }
}

impl Settings {
    /// Whether a step is taken.
    pub(crate) fn takes(&self, step: Step) -> bool {
        self.leave_out != Some(step)
    }

    /// # Errors
    /// [`RegionsError::Setting`] for the first setting out of its range.
    pub fn validate(&self) -> Result<(), RegionsError> {
        let above_zero = [("tilt", self.tilt), ("reach", self.reach), ("turn", self.turn)];
        for (name, value) in above_zero {
            if !(value > 0.0 && value.is_finite()) {
                return Err(RegionsError::Setting { name, value, expected: "above zero and finite" });
            }
        }
        match self.min_area {
            Some(value) if !(value >= 0.0 && value.is_finite()) => {
                Err(RegionsError::Setting { name: "min_area", value, expected: "at least zero and finite" })
            }
            _ => Ok(()),
        }
    }
}
