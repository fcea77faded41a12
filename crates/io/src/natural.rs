//! Natural order of file names: `scan2` before `scan10`.

use std::cmp::Ordering;

/// Compares names so that runs of digits count by their value. A total order: names that differ only in leading zeros
/// are told apart by their bytes.
///
/// ```
/// let mut names = ["scan10.ply", "scan2.ply", "scan1.ply"];
/// names.sort_by(|a, b| terrace_io::natural_order(a, b));
/// assert_eq!(names, ["scan1.ply", "scan2.ply", "scan10.ply"]);
/// ```
pub fn natural_order(a: &str, b: &str) -> Ordering {
    let (mut x, mut y) = (a.as_bytes(), b.as_bytes());
    loop {
        let order = match (x.first(), y.first()) {
            (None, None) => return a.cmp(b),
            (Some(c), Some(d)) if c.is_ascii_digit() && d.is_ascii_digit() => {
                let (number, other) = (take_number(&mut x), take_number(&mut y));
                number.len().cmp(&other.len()).then_with(|| number.cmp(other))
            }
            (c, d) => {
                x = x.get(1..).unwrap_or_default();
                y = y.get(1..).unwrap_or_default();
                c.cmp(&d)
            }
        };
        if order.is_ne() {
            return order;
        }
    }
}

/// The last run of digits in a name; `None` when there is none or it does not fit.
pub(crate) fn last_number(name: &str) -> Option<u64> {
    name.split(|c: char| !c.is_ascii_digit()).rfind(|run| !run.is_empty())?.parse().ok()
}

/// Takes the digits at the front, and returns them without leading zeros.
fn take_number<'a>(text: &mut &'a [u8]) -> &'a [u8] {
    let digits = text.iter().take_while(|c| c.is_ascii_digit()).count();
    let (number, rest) = text.split_at(digits);
    *text = rest;
    let zeros = number.iter().take_while(|c| **c == b'0').count();
    number.get(zeros..).unwrap_or_default()
}
