//! Which fields of a point file are coordinates and standard errors, and the rows gathered from them.

use terrace_types::Sigma;

use super::FieldChoice;
use super::records::{ByteOrder, Column, Scalar, fill, gather};
use crate::bytes::{Bytes, PIECE};

/// The fields that are read, as indices into the fields of the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Wanted {
    pub xyz: [usize; 3],
    pub sigma: SigmaFields,
}

/// Where the standard errors stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SigmaFields {
    None,
    One(usize),
    PerAxis([usize; 3]),
}

/// A field that is needed and not there.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Missing {
    pub name: String,
    /// The fields there are, for people.
    pub fields: String,
}

impl Wanted {
    /// Finds `x`, `y`, `z` and the errors by name. Case does not matter, but a name that is equal in case goes first;
    /// of fields with one name the first counts.
    pub(crate) fn find(names: &[&str], errors_from: &FieldChoice) -> Result<Self, Missing> {
        let exactly = |name: &str| names.iter().position(|field| *field == name);
        let position =
            |name: &str| exactly(name).or_else(|| names.iter().position(|f| f.eq_ignore_ascii_case(name)));
        let missing = |name: &str| Missing { name: name.to_owned(), fields: listed(names) };
        let needed = |name: &str| position(name).ok_or_else(|| missing(name));

        let xyz = [needed("x")?, needed("y")?, needed("z")?];
        let sigma = match errors_from {
            FieldChoice::Ignore => SigmaFields::None,
            FieldChoice::Named(name) => SigmaFields::One(exactly(name).ok_or_else(|| missing(name))?),
            FieldChoice::Automatic => {
                let axes = (position("sigma_x"), position("sigma_y"), position("sigma_z"));
                match (position("sigma"), axes) {
                    (Some(one), _) => SigmaFields::One(one),
                    (None, (Some(x), Some(y), Some(z))) => SigmaFields::PerAxis([x, y, z]),
                    _ => SigmaFields::None,
                }
            }
        };
        Ok(Self { xyz, sigma })
    }

    /// Errors of no points yet, of the kind that the fields hold.
    fn no_errors(&self) -> Sigma {
        match self.sigma {
            SigmaFields::None => Sigma::Unknown,
            SigmaFields::One(_) => Sigma::PerPoint(Vec::new()),
            SigmaFields::PerAxis(_) => Sigma::PerAxis(Vec::new()),
        }
    }

    /// The indices of all fields that are read.
    pub(crate) fn indices(&self) -> impl Iterator<Item = usize> {
        let (one, axes) = match self.sigma {
            SigmaFields::None => (None, None),
            SigmaFields::One(one) => (Some(one), None),
            SigmaFields::PerAxis(axes) => (None, Some(axes)),
        };
        self.xyz.into_iter().chain(one).chain(axes.into_iter().flatten())
    }
}

/// The names, comma-separated, and not more than fit a message.
fn listed(names: &[&str]) -> String {
    const MOST: usize = 20;
    let mut list =
        names.iter().take(MOST).map(|name| super::lines::shown(name.as_bytes())).collect::<Vec<_>>();
    if names.len() > MOST {
        list.push(format!("and {} more", names.len() - MOST));
    }
    if list.is_empty() { "none".to_owned() } else { list.join(", ") }
}

/// Points and errors put together, one value or many records at a time, and taken away piece by piece.
#[derive(Debug)]
pub(crate) struct Rows {
    wanted: Wanted,
    row: [f64; 3],
    sigma: [f64; 3],
    points: Vec<[f64; 3]>,
    sigmas: Sigma,
}

impl Rows {
    /// No rows yet.
    pub(crate) fn new(wanted: Wanted) -> Self {
        let sigmas = wanted.no_errors();
        Self { wanted, row: [f64::NAN; 3], sigma: [f64::NAN; 3], points: Vec::new(), sigmas }
    }

    /// Makes room for `more` points, which the caller has held against the bytes there are.
    pub(crate) fn reserve(&mut self, more: usize) {
        self.points.reserve(more);
        match &mut self.sigmas {
            Sigma::PerPoint(sigmas) => sigmas.reserve(more),
            Sigma::PerAxis(sigmas) => sigmas.reserve(more),
            Sigma::Unknown | Sigma::Uniform(_) | Sigma::Covariance(_) => {}
        }
    }

    /// Number of rows.
    pub(crate) fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether the field at `index` is read.
    pub(crate) fn wants(&self, index: usize) -> bool {
        self.wanted.indices().any(|wanted| wanted == index)
    }

    /// Sets the field at `index` of the current row.
    pub(crate) fn set(&mut self, index: usize, value: f64) {
        let sigma = match self.wanted.sigma {
            SigmaFields::None => None,
            SigmaFields::One(one) => Some([one; 3]),
            SigmaFields::PerAxis(axes) => Some(axes),
        };
        for axis in 0..3 {
            if self.wanted.xyz[axis] == index {
                self.row[axis] = value;
            }
            if sigma.is_some_and(|fields| fields[axis] == index) {
                self.sigma[axis] = value;
            }
        }
    }

    /// Ends the current row.
    pub(crate) fn push(&mut self) {
        self.points.push(self.row);
        match &mut self.sigmas {
            Sigma::PerPoint(sigmas) => sigmas.push(self.sigma[0]),
            Sigma::PerAxis(sigmas) => sigmas.push(self.sigma),
            // No field holds one error for all points, or a covariance.
            Sigma::Unknown | Sigma::Uniform(_) | Sigma::Covariance(_) => {}
        }
    }

    /// Adds the points and errors of `count` records whose columns `of` gives.
    pub(crate) fn gather<'a>(&mut self, order: ByteOrder, count: usize, of: impl Fn(usize) -> Column<'a>) {
        match (&mut self.sigmas, self.wanted.sigma) {
            (Sigma::PerPoint(sigmas), SigmaFields::One(one)) => {
                let start = sigmas.len();
                sigmas.resize(start + count, f64::NAN);
                let new = sigmas.get_mut(start..).unwrap_or_default();
                fill(new.as_chunks_mut::<1>().0, 0, of(one), order);
            }
            (Sigma::PerAxis(sigmas), SigmaFields::PerAxis(axes)) => {
                gather(axes.map(&of), order, count, sigmas);
            }
            _ => {}
        }
        gather(self.wanted.xyz.map(of), order, count, &mut self.points);
    }

    /// Adds the points and errors of `count` records of `stride` bytes from byte `at` on; `field` tells where in a record
    /// a field starts, and its type. The caller has checked that the file has as many bytes.
    pub(crate) fn gather_records<B: Bytes>(
        &mut self,
        bytes: &mut B,
        mut at: u64,
        stride: usize,
        mut count: usize,
        order: ByteOrder,
        field: impl Fn(usize) -> (usize, Scalar),
    ) -> Result<(), B::Error> {
        self.reserve(count);
        let piece = (PIECE / stride.max(1)).max(1);
        while count > 0 {
            let records = count.min(piece);
            let window = bytes.window(at, records * stride)?;
            self.gather(order, records, |index| {
                let (offset, scalar) = field(index);
                Column { bytes: window, stride, offset, scalar }
            });
            at += (records * stride) as u64;
            count -= records;
        }
        Ok(())
    }

    /// Adds `count` points whose coordinates are set axis by axis.
    pub(crate) fn add_absent(&mut self, count: usize) -> &mut [[f64; 3]] {
        let start = self.points.len();
        self.points.resize(start + count, [f64::NAN; 3]);
        self.points.get_mut(start..).unwrap_or_default()
    }

    /// Takes the points and errors away.
    pub(crate) fn take(&mut self) -> (Vec<[f64; 3]>, Sigma) {
        let sigmas = std::mem::replace(&mut self.sigmas, self.wanted.no_errors());
        (std::mem::take(&mut self.points), sigmas)
    }

    /// Takes over the memory of points and errors that are no longer needed, when there are no rows.
    pub(crate) fn reuse(&mut self, mut points: Vec<[f64; 3]>, sigmas: Sigma) {
        if !self.points.is_empty() {
            return;
        }
        points.clear();
        self.points = points;
        match (&mut self.sigmas, sigmas) {
            (Sigma::PerPoint(own), Sigma::PerPoint(mut spent)) => {
                spent.clear();
                *own = spent;
            }
            (Sigma::PerAxis(own), Sigma::PerAxis(mut spent)) => {
                spent.clear();
                *own = spent;
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn find(names: &[&str], choice: &FieldChoice) -> Result<([usize; 3], SigmaFields), String> {
        Wanted::find(names, choice)
            .map(|w| (w.xyz, w.sigma))
            .map_err(|m| format!("{} of {}", m.name, m.fields))
    }

    #[test]
    fn names_in_any_case_and_order() {
        let automatic = FieldChoice::Automatic;
        assert_eq!(find(&["Z", "i", "Y", "X"], &automatic), Ok(([3, 2, 0], SigmaFields::None)));
        assert_eq!(find(&["X", "x", "y", "z"], &automatic), Ok(([1, 2, 3], SigmaFields::None)));
        assert_eq!(find(&["x", "y", "z", "Sigma"], &automatic), Ok(([0, 1, 2], SigmaFields::One(3))));
        assert_eq!(
            find(&["sigma_z", "sigma_y", "SIGMA_X", "x", "y", "z"], &automatic),
            Ok(([3, 4, 5], SigmaFields::PerAxis([2, 1, 0])))
        );
        assert_eq!(find(&["sigma_z", "x", "y", "z"], &automatic), Ok(([1, 2, 3], SigmaFields::None)));
    }

    #[test]
    fn a_missing_field_is_told_with_those_there_are() {
        assert_eq!(find(&["x", "z"], &FieldChoice::Automatic), Err("y of x, z".into()));
        assert_eq!(find(&[], &FieldChoice::Automatic), Err("x of none".into()));
        let named = FieldChoice::Named("err".into());
        assert_eq!(find(&["x", "y", "z", "ERR"], &named), Err("err of x, y, z, ERR".into()));
        assert_eq!(find(&["x", "y", "z", "err"], &named), Ok(([0, 1, 2], SigmaFields::One(3))));
        assert_eq!(find(&["x", "y", "z", "sigma"], &FieldChoice::Ignore), Ok(([0, 1, 2], SigmaFields::None)));
    }

    #[test]
    fn one_field_may_serve_twice() {
        let wanted = Wanted::find(&["x", "y", "z"], &FieldChoice::Named("z".into())).unwrap();
        let mut rows = Rows::new(wanted);
        for index in 0..3 {
            assert!(rows.wants(index));
            rows.set(index, index as f64);
        }
        rows.push();
        assert_eq!(rows.take(), (vec![[0.0, 1.0, 2.0]], Sigma::PerPoint(vec![2.0])));
    }
}
