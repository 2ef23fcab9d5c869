//! Until when somebody can take back what they gave, and how they are told.

use crate::{books::now, hindrance::Hindrance, words::Words};
use chrono::{DateTime, NaiveDate};
use serde::Serialize;

/// Where a consent names the day.
const PLACE: &str = "{withdraw_until}";

/// What a page is told of taking back.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(crate) struct Withdrawal {
    /// The last day on which it can be done after the end; none where it always can.
    pub(crate) until: Option<String>,
    /// Whether it can be done today.
    pub(crate) open: bool,
}

impl Withdrawal {
    /// Of a study with this last day, which is looked at today.
    pub(crate) fn new(until: Option<&str>) -> Self {
        Self::on(&today().to_string(), until)
    }

    fn on(day: &str, until: Option<&str>) -> Self {
        Self {
            // Days written so stand in the order of time.
            open: until.is_none_or(|until| day <= until),
            until: until.map(str::to_owned),
        }
    }

    /// What somebody is told who comes too late; none while they do not.
    pub(crate) fn too_late(&self) -> Option<String> {
        let until = self.until.as_ref().filter(|_| !self.open)?;
        Some(format!(
            "what was given in this study could be taken back until {until}; ask whoever runs the study"
        ))
    }
}

pub(crate) fn today() -> NaiveDate {
    let now = DateTime::from_timestamp(now(), 0).unwrap_or_default();
    now.date_naive()
}

/// A consent with the last day in it: where it says so, or in a sentence of its own.
///
/// # Errors
/// [`Hindrance::NoLastDay`] for a consent that names a day where the study has none.
pub(crate) fn in_consent(
    text: &str,
    until: Option<&str>,
    words: &Words,
) -> Result<String, Hindrance> {
    match until {
        Some(until) if text.contains(PLACE) => Ok(text.replace(PLACE, until)),
        Some(until) => Ok(format!(
            "{}\n\n{}\n",
            text.trim_end(),
            words.say("withdraw_sentence", &[("until", until)])
        )),
        None if text.contains(PLACE) => Err(Hindrance::NoLastDay),
        None => Ok(text.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_day_counts_and_the_day_after_is_too_late() {
        let on = |day: &str| Withdrawal::on(day, Some("2026-12-31"));
        assert!(on("2026-12-31").open && on("2026-12-31").too_late().is_none());
        assert!(!on("2027-01-01").open);
        assert!(on("2027-01-01").too_late().unwrap().contains("2026-12-31"));
        assert!(Withdrawal::on("2999-01-01", None).open);
        assert_eq!(today().to_string().len(), 10);
    }

    #[test]
    fn a_consent_names_the_day_once_and_never_a_day_that_there_is_not() {
        let in_consent = |text, day| super::in_consent(text, day, &Words::default());
        let day = Some("2026-12-31");
        let named = in_consent("Until {withdraw_until} only.", day).unwrap();
        assert_eq!(named, "Until 2026-12-31 only.");
        let added = in_consent("Welcome.\n", day).unwrap();
        assert_eq!(added.matches("2026-12-31").count(), 1, "{added}");
        assert_eq!(in_consent("Welcome.\n", None).unwrap(), "Welcome.\n");
        assert!(in_consent("Until {withdraw_until}.", None).is_err());
    }
}
