//! `key=value` pairs and lists of numbers.

use crate::ParseNoiseError;

/// The values of the keys of one model, as they stand.
pub(crate) struct Values<'a, const N: usize> {
    model: &'static str,
    keys: [&'static str; N],
    found: [Option<&'a str>; N],
}

/// Reads `key=value,key=value`.
pub(crate) fn values<'a, const N: usize>(
    model: &'static str,
    keys: [&'static str; N],
    text: &'a str,
) -> Result<Values<'a, N>, ParseNoiseError> {
    let mut found = [None; N];
    for pair in text.split(',').map(str::trim).filter(|_| !text.is_empty()) {
        let (name, value) =
            pair.split_once('=').map_or((pair, ""), |(name, value)| (name.trim(), value.trim()));
        let Some((slot, key)) = found.iter_mut().zip(keys).find(|(_, key)| *key == name) else {
            let (found, allowed) = (name.to_owned(), keys.join(", "));
            return Err(ParseNoiseError::UnknownKey { model, found, allowed });
        };
        if slot.replace(value).is_some() {
            return Err(ParseNoiseError::RepeatedKey { model, key, value: value.to_owned() });
        }
    }
    Ok(Values { model, keys, found })
}

impl<'a, const N: usize> Values<'a, N> {
    /// The value of a key, if it was there.
    pub(crate) fn get(&self, key: &str) -> Option<&'a str> {
        self.keys.iter().zip(self.found).find(|(name, _)| **name == key).and_then(|(_, value)| value)
    }

    /// The value of a key that has no default.
    pub(crate) fn required(&self, key: &'static str) -> Result<&'a str, ParseNoiseError> {
        self.get(key).ok_or_else(|| ParseNoiseError::MissingKey {
            model: self.model,
            key,
            allowed: self.keys.join(", "),
        })
    }
}

/// A number. That it is finite and in its bounds is looked at by the model that takes it.
pub(crate) fn number(name: &'static str, text: &str) -> Result<f64, ParseNoiseError> {
    text.parse().map_err(|_| ParseNoiseError::NotANumber {
        name,
        found: text.to_owned(),
        allowed: "a number such as 0.02",
    })
}

/// Exactly `N` numbers, separated by commas.
pub(crate) fn numbers<const N: usize>(model: &'static str, text: &str) -> Result<[f64; N], ParseNoiseError> {
    let mut found = [0.0; N];
    let mut parts = text.split(',').map(str::trim).filter(|_| !text.is_empty());
    let wrong = || ParseNoiseError::WrongCount { model, needed: N, found: text.to_owned() };
    for value in &mut found {
        *value = number(model, parts.next().ok_or_else(wrong)?)?;
    }
    if parts.next().is_some() { Err(wrong()) } else { Ok(found) }
}
