//! What a crash does, and that a consent names one that is felt.

use crate::{hindrance::Hindrance, words::Words};
use maveric_domain::design::Crash;

/// Where a consent says that a crash is heard and seen.
const PLACE: &str = "{crash}";

/// How an event of a drive says that it ended with a crash.
pub(crate) const CRASH: &str = "crash";

/// Whether a consent (none: nothing is agreed to) says of a crash what the study does.
///
/// # Errors
/// [`Hindrance::CrashNotNamed`] for one that is felt and not named, [`Hindrance::NoCrash`] for one that is named and not felt.
pub(crate) fn named(consent: Option<&str>, crash: Crash) -> Result<(), Hindrance> {
    let names = consent.is_some_and(|text| text.contains(PLACE));
    match crash {
        Crash::Felt if !names => Err(Hindrance::CrashNotNamed),
        Crash::Ends if names => Err(Hindrance::NoCrash),
        _ => Ok(()),
    }
}

/// A consent with the sentence in it that names the crash.
pub(crate) fn in_consent(text: &str, words: &Words) -> String {
    text.replace(PLACE, words.sentence("crash_sentence"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crash_that_is_felt_is_named_in_the_consent_and_no_other_is() {
        let names = Some("You drive.\n\n{crash}\n");
        assert_eq!(named(names, Crash::Felt), Ok(()));
        assert_eq!(named(Some("You drive."), Crash::Ends), Ok(()));
        assert_eq!(named(None, Crash::Ends), Ok(()));
        for consent in [None, Some("You drive.")] {
            let told = named(consent, Crash::Felt);
            assert_eq!(told, Err(Hindrance::CrashNotNamed));
        }
        assert_eq!(named(names, Crash::Ends), Err(Hindrance::NoCrash));
        let shown = in_consent("You drive.\n\n{crash}", &Words::default());
        assert!(!shown.contains('{') && shown.contains("hits another car"), "{shown}");
    }
}
