//! Whether a text is about somebody.

use crate::named::names;

/// Whether a text is about somebody: it has their id as a word of its own. A number is a word of many texts, and names nobody in one.
pub fn is_about(text: &str, id: &str) -> bool {
    !id.bytes().all(|b| b.is_ascii_digit()) && names(text, id)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_about_whom_it_names_and_a_number_in_it_is_nobody() {
        assert!(is_about("P001: felt sick", "P001"));
        assert!(!is_about("P0010: felt sick", "P001"));
        assert!(!is_about("stopped after 12 minutes", "12"));
    }
}
