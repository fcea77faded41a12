//! The buildings. Lengths in metres.

mod building;
mod corridor;
mod desk;
mod flat;
mod room;
mod table;

pub use building::POINTS_PER_ROOM;
pub(crate) use building::{building, rooms_for};
pub(crate) use corridor::corridor;
pub(crate) use desk::desk;
pub(crate) use flat::{patch, strip};
pub(crate) use room::room;
pub(crate) use table::table;
