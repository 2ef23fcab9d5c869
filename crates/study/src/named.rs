//! Whether a text names somebody, and what it says without the names.

use std::borrow::Cow;

/// What stands in the place of a name that is not given away.
pub(crate) const HIDDEN: &str = "…";

/// Where an id stands in a text as a word of its own, in any capitals if it has a digit: without one it may be a word of a sentence.
fn places(text: &str, id: &str) -> Vec<usize> {
    let inside = |c: Option<char>| c.is_some_and(char::is_alphanumeric);
    let alone = |at: &usize| {
        let (before, after) = (&text[..*at], &text[*at + id.len()..]);
        !inside(before.chars().next_back()) && !inside(after.chars().next())
    };
    // Letters of ASCII keep their length, so places are those of the text.
    let (searched, wanted) = if id.bytes().any(|b| b.is_ascii_digit()) {
        (Cow::Owned(text.to_ascii_lowercase()), Cow::Owned(id.to_ascii_lowercase()))
    } else {
        (Cow::Borrowed(text), Cow::Borrowed(id))
    };
    searched.match_indices(&*wanted).map(|(at, _)| at).filter(alone).collect()
}

/// Whether an id stands in a text as a word of its own.
pub(crate) fn names(text: &str, id: &str) -> bool {
    !places(text, id).is_empty()
}

/// An id that texts have as a number.
pub(crate) fn is_number(id: &str) -> bool {
    id.bytes().all(|b| b.is_ascii_digit())
}

/// Whether a text is about somebody: it has their id as a word of its own. A number is a word of many texts, and names nobody in one.
pub fn is_about(text: &str, id: &str) -> bool {
    !is_number(id) && names(text, id)
}

/// The text with `…` for each of these ids.
pub(crate) fn without<'a>(text: &str, ids: impl IntoIterator<Item = &'a str>) -> String {
    let hide = |text: String, id| with(&text, id, HIDDEN);
    ids.into_iter().fold(text.to_owned(), hide)
}

/// The text with a name for an id.
pub(crate) fn with(text: &str, id: &str, name: &str) -> String {
    let mut renamed = text.to_owned();
    for at in places(text, id).into_iter().rev() {
        renamed.replace_range(at..at + id.len(), name);
    }
    renamed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_is_found_as_a_word_and_not_inside_another() {
        assert!(names("logs/P1-own.mcap", "P1") && names("P1", "P1"));
        assert!(!names("logs/P12.mcap", "P1") && !names("xP1", "P1"));
        let text = "people = { P1 = \"gone\" } # P12, P1-own, P1";
        assert_eq!(without(text, ["P1-own", "P1"]), "people = { … = \"gone\" } # P12, …, …");
    }

    #[test]
    fn a_text_is_about_whom_it_names_and_a_number_in_it_is_nobody() {
        assert!(is_about("P001: felt sick", "P001"));
        assert!(!is_about("P0010: felt sick", "P001"));
        assert!(is_about("p001 felt sick", "P001") && is_about("like P001", "p001"));
        assert!(!is_about("a person felt sick", "A"));
        assert_eq!(without("p1 and P1", ["P1"]), "… and …");
        assert!(!is_about("stopped after 12 minutes", "12"));
    }
}
