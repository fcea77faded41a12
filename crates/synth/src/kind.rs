//! The names of the scenes.

use std::str::FromStr;

/// The scenes this crate knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SceneKind {
    /// A table top and two side panels, mutually perpendicular, under white noise.
    Table,
    /// A board on two panels, aligned with the axes, under white noise.
    Desk,
    /// A narrow plane under white noise.
    Strip,
    /// A square plane whose noise grows along one side.
    Patch,
    /// A furnished room seen by a depth camera from fourteen places.
    Room,
    /// Such rooms side by side and above each other, as many as the points fill.
    Building,
    /// A corridor with a bend, scanned by a lidar that moves along it.
    Corridor,
}

impl SceneKind {
    /// All scenes, in the order of their declaration.
    pub const ALL: [Self; 7] =
        [Self::Table, Self::Desk, Self::Strip, Self::Patch, Self::Room, Self::Building, Self::Corridor];

    /// The name by which [`FromStr`] finds it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Table => "table",
            Self::Desk => "desk",
            Self::Strip => "strip",
            Self::Patch => "patch",
            Self::Room => "room",
            Self::Building => "building",
            Self::Corridor => "corridor",
        }
    }

    /// How many points are made when the caller does not say.
    pub fn default_points(self) -> usize {
        match self {
            Self::Table | Self::Desk => 30_000,
            Self::Strip => 5_000,
            Self::Patch => 10_000,
            Self::Room => 300_000,
            Self::Building => 800_000,
            Self::Corridor => 400_000,
        }
    }
}

impl std::fmt::Display for SceneKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

/// There is no scene of this name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no scene {name:?}; there are table, desk, strip, patch, room, building and corridor")]
pub struct UnknownScene {
    /// The name as given.
    pub name: String,
}

impl FromStr for SceneKind {
    type Err = UnknownScene;

    fn from_str(name: &str) -> Result<Self, UnknownScene> {
        Self::ALL
            .into_iter()
            .find(|kind| kind.name() == name)
            .ok_or_else(|| UnknownScene { name: name.to_owned() })
    }
}
