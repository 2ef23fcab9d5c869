//! Whether a text names somebody, and what it says without the names.

/// What stands in the place of a name that is not given away.
pub(crate) const HIDDEN: &str = "…";

/// Where an id stands in a text as a word of its own.
fn places(text: &str, id: &str) -> impl Iterator<Item = usize> {
    let inside = |c: Option<char>| c.is_some_and(char::is_alphanumeric);
    let alone = move |at: &usize| {
        let (before, after) = (&text[..*at], &text[*at + id.len()..]);
        !inside(before.chars().next_back()) && !inside(after.chars().next())
    };
    text.match_indices(id).map(|(at, _)| at).filter(alone)
}

/// Whether an id stands in a text as a word of its own.
pub(crate) fn names(text: &str, id: &str) -> bool {
    places(text, id).next().is_some()
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
    let standing: Vec<usize> = places(text, id).collect();
    for at in standing.into_iter().rev() {
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
        assert!(!is_about("stopped after 12 minutes", "12"));
    }
}
