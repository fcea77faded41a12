//! The label of a point: which plane it belongs to, if any.

use std::num::NonZeroU32;

/// Identity of a plane within one result, counted from 1.
///
/// The label of a point is `Option<PlaneId>`: `None` is a point of no plane. It takes four bytes, and its number in
/// files ([`PlaneId::label`]) is the conventional one: 0 for none, 1.. for planes.
///
/// ```
/// use terrace_types::PlaneId;
///
/// let first = PlaneId::from_index(0).unwrap();
/// assert_eq!(first.get(), 1);
/// assert_eq!([Some(first), None].map(PlaneId::label), [1, 0]);
/// assert_eq!(std::mem::size_of::<Option<PlaneId>>(), 4);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PlaneId(NonZeroU32);

impl PlaneId {
    /// The plane with this number; `None` for 0 and for numbers that do not fit a signed 32-bit label file.
    pub fn new(number: u32) -> Option<Self> {
        i32::try_from(number).ok().and_then(|_| NonZeroU32::new(number)).map(Self)
    }

    /// The identity of the plane at `index` of a list, counted from 0.
    pub fn from_index(index: usize) -> Option<Self> {
        u32::try_from(index).ok()?.checked_add(1).and_then(Self::new)
    }

    /// The number, from 1.
    pub fn get(self) -> u32 {
        self.0.get()
    }

    /// The place of this plane in a list sorted by identity, from 0.
    pub fn index(self) -> usize {
        self.0.get() as usize - 1
    }

    /// The number written to label files: 0 for `None`.
    pub fn label(of: Option<Self>) -> i32 {
        of.map_or(0, |id| id.0.get().cast_signed())
    }
}

impl std::fmt::Display for PlaneId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}
