//! What errors say of names.

/// The candidate nearest to `word`, if it is near enough to be meant.
pub(crate) fn nearest<'a>(
    word: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<String> {
    candidates
        .into_iter()
        .map(|candidate| (strsim::osa_distance(word, candidate), candidate))
        .filter(|(distance, candidate)| *distance <= 1 + candidate.chars().count() / 4)
        .min()
        .map(|(_, candidate)| candidate.to_owned())
}

pub(super) fn did_you_mean(nearest: Option<&String>) -> Option<String> {
    nearest.map(|name| format!("did you mean `{name}`?"))
}

pub(super) fn listing(names: &[String]) -> String {
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_similar_word_is_suggested() {
        assert_eq!(nearest("inptus", ["cmd", "inputs", "outputs"]).as_deref(), Some("inputs"));
        assert_eq!(nearest("banana", ["cmd", "inputs", "outputs"]), None);
    }

    #[test]
    fn a_word_may_be_one_letter_off_and_one_more_for_every_four_of_its_own() {
        let near = |word: &str, candidate: &str| nearest(word, [candidate]).is_some();
        assert!(near("see", "sed") && !near("xee", "sed"));
        assert!(near("iputz", "input") && !near("ipuxz", "input"));
        // Of two as near the first by its letters.
        assert_eq!(nearest("bat", ["cat", "bar"]).as_deref(), Some("bar"));
        assert_eq!(did_you_mean(Some(&"a".to_owned())).as_deref(), Some("did you mean `a`?"));
        assert_eq!(did_you_mean(None), None);
        assert_eq!(listing(&[]), "none");
        assert_eq!(listing(&["a".to_owned(), "b".to_owned()]), "a, b");
    }
}
