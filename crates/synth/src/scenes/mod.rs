//! The buildings, one file each. Lengths in metres.

mod corridor;
mod desk;
mod room;
mod table;

pub(crate) use corridor::corridor;
pub(crate) use desk::desk;
pub(crate) use room::room;
pub(crate) use table::table;
