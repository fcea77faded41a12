//! The buildings. Lengths in metres.

mod corridor;
mod desk;
mod flat;
mod room;
mod table;

pub(crate) use corridor::corridor;
pub(crate) use desk::desk;
pub(crate) use flat::{patch, strip};
pub(crate) use room::room;
pub(crate) use table::table;
