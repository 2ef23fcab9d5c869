//! A word that stands by itself in the name of a column.

/// Where a word stands by itself in a name, in small or large letters.
pub(super) fn place_of(name: &str, word: &str) -> Option<usize> {
    let ends = name.len().checked_sub(word.len())?;
    (0..=ends).find(|at| {
        let part = name.get(*at..at + word.len());
        let (before, after) = (
            name.get(..*at).and_then(|r| r.chars().next_back()),
            name.get(at + word.len()..).and_then(|r| r.chars().next()),
        );
        part.is_some_and(|part| part.eq_ignore_ascii_case(word))
            && !before.is_some_and(char::is_alphanumeric)
            && !after.is_some_and(char::is_lowercase)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_counts_where_it_stands_by_itself() {
        assert_eq!(place_of("TLX_Sporty_", "sporty"), Some(4));
        assert_eq!(place_of("sportyTLX", "sporty"), Some(0));
        assert_eq!(place_of("unsporty_", "sporty"), None);
        assert_eq!(place_of("calmness_", "calm"), None);
        assert_eq!(place_of("größe_calm", "calm"), Some("größe_".len()));
    }
}
