//! What the tests of charts share.

use proptest::prelude::*;

/// A number that may be as large or small as numbers get, or none.
pub fn any_value() -> impl Strategy<Value = f64> {
    prop_oneof![4 => -2.0..2.0_f64, 1 => Just(1.0), 1 => Just(1e-300), 1 => Just(1e300), 1 => Just(-1e300), 1 => Just(f64::NAN), 1 => Just(f64::INFINITY), 1 => any::<f64>()]
}

/// Checks that every tag is closed and returns the elements as name and attributes.
pub fn elements(svg: &str) -> Vec<(String, Vec<(String, String)>)> {
    let (mut open, mut found) = (Vec::new(), Vec::new());
    let mut rest = svg;
    while let Some(start) = rest.find('<') {
        assert!(!rest[..start].contains('>'), "a bare > in {rest}");
        let end = start + rest[start..].find('>').expect("a tag ends");
        let tag = &rest[start + 1..end];
        rest = &rest[end + 1..];
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop().as_deref(), Some(name));
            continue;
        }
        let (inner, closed) = tag.strip_suffix('/').map_or((tag, false), |inner| (inner, true));
        let (name, attributes) = inner.split_once(' ').unwrap_or((inner, ""));
        let mut pairs = Vec::new();
        for (k, part) in attributes.split('"').collect::<Vec<_>>().chunks_exact(2).enumerate() {
            let key = part[0].trim().strip_suffix('=').unwrap_or_else(|| panic!("attribute {k} of {tag}"));
            pairs.push((key.to_owned(), part[1].to_owned()));
        }
        if !closed {
            open.push(name.to_owned());
        }
        found.push((name.to_owned(), pairs));
    }
    assert!(open.is_empty(), "{open:?} left open");
    found
}

pub fn attribute(pairs: &[(String, String)], key: &str) -> Option<f64> {
    pairs.iter().find(|(k, _)| k == key).map(|(_, v)| v.parse().expect("a number"))
}
