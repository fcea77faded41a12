//! The values of a line.

/// The text before a `#` that starts it or follows a space; within a word, as in `-1.#IND`, it is no comment.
pub(crate) fn without_comment(text: &str) -> &str {
    let before = |(at, _)| text.get(..at).unwrap_or_default();
    let mut comments = text.match_indices('#').map(before);
    comments.find(|before| before.is_empty() || before.ends_with(char::is_whitespace)).unwrap_or(text)
}

/// The values of a line, apart by spaces, commas, or both. Between two commas there must be a value, and an empty one
/// is given where there is none; the comma at the end of a line separates nothing.
pub(crate) fn tokens(line: &str) -> impl Iterator<Item = &str> {
    line.strip_suffix(',').unwrap_or(line).split(',').flat_map(|field| {
        let mut values = field.split_whitespace();
        std::iter::once(values.next().unwrap_or_default()).chain(values)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commas_spaces_and_what_is_missing() {
        let of = |line| tokens(line).collect::<Vec<_>>();
        assert_eq!(of("1 2,3 , 4"), ["1", "2", "3", "4"]);
        assert_eq!(of("1,,2,"), ["1", "", "2"]);
        assert_eq!(without_comment("1 2 # three"), "1 2 ");
        assert_eq!(without_comment("-1.#IND"), "-1.#IND");
    }
}
