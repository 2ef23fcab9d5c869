//! Whether a text names somebody.

/// Whether an id stands in a text as a word of its own.
pub(crate) fn names(text: &str, id: &str) -> bool {
    let inside = |c: Option<char>| c.is_some_and(char::is_alphanumeric);
    text.match_indices(id).any(|(at, _)| {
        let (before, after) = (&text[..at], &text[at + id.len()..]);
        !inside(before.chars().next_back()) && !inside(after.chars().next())
    })
}
