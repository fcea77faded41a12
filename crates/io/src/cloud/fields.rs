//! Which fields of a point file are coordinates and standard errors, and the rows gathered from them.

use terrace_types::Sigma;

use super::FieldChoice;
use super::records::{ByteOrder, Column, gather};

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

    /// The indices of all fields that are read.
    pub(crate) fn indices(&self) -> impl Iterator<Item = usize> {
        let (one, axes) = match self.sigma {
            SigmaFields::None => (None, None),
            SigmaFields::One(one) => (Some(one), None),
            SigmaFields::PerAxis(axes) => (None, Some(axes)),
        };
        self.xyz.into_iter().chain(one).chain(axes.into_iter().flatten())
    }

    /// The points and errors of `count` records whose columns `of` gives.
    pub(crate) fn gather<'a>(
        &self,
        order: ByteOrder,
        count: usize,
        of: impl Fn(usize) -> Column<'a>,
    ) -> (Vec<[f64; 3]>, Sigma) {
        let sigma = match self.sigma {
            SigmaFields::None => Sigma::Unknown,
            SigmaFields::One(one) => {
                Sigma::PerPoint(gather([of(one)], order, count).into_iter().map(|[sigma]| sigma).collect())
            }
            SigmaFields::PerAxis(axes) => Sigma::PerAxis(gather(axes.map(&of), order, count)),
        };
        (gather(self.xyz.map(of), order, count), sigma)
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

/// Points and errors put together one value at a time.
#[derive(Debug)]
pub(crate) struct Rows {
    wanted: Wanted,
    row: [f64; 3],
    sigma: [f64; 3],
    points: Vec<[f64; 3]>,
    sigmas: Sigma,
}

impl Rows {
    /// With room for `capacity` points, which the caller has held against the bytes there are.
    pub(crate) fn new(wanted: Wanted, capacity: usize) -> Self {
        let sigmas = match wanted.sigma {
            SigmaFields::None => Sigma::Unknown,
            SigmaFields::One(_) => Sigma::PerPoint(Vec::with_capacity(capacity)),
            SigmaFields::PerAxis(_) => Sigma::PerAxis(Vec::with_capacity(capacity)),
        };
        Self {
            wanted,
            row: [f64::NAN; 3],
            sigma: [f64::NAN; 3],
            points: Vec::with_capacity(capacity),
            sigmas,
        }
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

    /// The points and errors.
    pub(crate) fn finish(self) -> (Vec<[f64; 3]>, Sigma) {
        (self.points, self.sigmas)
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
        let mut rows = Rows::new(wanted, 1);
        for index in 0..3 {
            assert!(rows.wants(index));
            rows.set(index, index as f64);
        }
        rows.push();
        assert_eq!(rows.finish(), (vec![[0.0, 1.0, 2.0]], Sigma::PerPoint(vec![2.0])));
    }
}
