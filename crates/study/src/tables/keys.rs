//! Texts as keys: ids, labels, words and names of columns, compared without blanks around them and in one Unicode form.

use crate::error::StudyError;
use maveric_domain::ParticipantId;
use std::{borrow::Cow, collections::BTreeMap};
use unicode_normalization::{UnicodeNormalization as _, is_nfc};

/// The text without blanks around it, its letters composed (NFC).
///
/// `f ` and `f` are one key, and so are `ü` as one character and as `u` with a mark.
pub(crate) fn key(text: &str) -> Cow<'_, str> {
    composed(text.trim())
}

/// The text with its letters composed (NFC).
pub(crate) fn composed(text: &str) -> Cow<'_, str> {
    if is_nfc(text) { Cow::Borrowed(text) } else { Cow::Owned(text.nfc().collect()) }
}

/// The first two keys that differ only in capitals.
pub(crate) fn differing_in_case<'a>(
    keys: impl IntoIterator<Item = &'a str>,
) -> Option<(&'a str, &'a str)> {
    let mut known: BTreeMap<String, &str> = BTreeMap::new();
    keys.into_iter().find_map(|key| {
        let first = *known.entry(key.to_lowercase()).or_insert(key);
        (first != key).then_some((first, key))
    })
}

/// Refuses ids that differ only in capitals.
///
/// # Errors
/// The two ids, and what to do.
pub(crate) fn one_case_of<'a>(
    ids: impl IntoIterator<Item = &'a ParticipantId>,
) -> Result<(), StudyError> {
    let Some((first, second)) = differing_in_case(ids.into_iter().map(ParticipantId::as_str))
    else {
        return Ok(());
    };
    let problem = format!("the participants `{first}` and `{second}` differ only in capitals");
    let help =
        "write the id of one person alike everywhere, and give two people ids that differ in more";
    Err(StudyError::not_possible(problem).with_help(help))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_trimmed_and_composed() {
        assert_eq!(key(" Mu\u{308}nchen\u{a0}"), "M\u{fc}nchen");
        assert!(matches!(key("plain"), Cow::Borrowed("plain")));
    }

    #[test]
    fn keys_that_differ_in_case_are_found() {
        assert_eq!(differing_in_case(["a", "b", "a", "B"]), Some(("b", "B")));
        assert_eq!(differing_in_case(["a", "b", "a"]), None);
    }
}
