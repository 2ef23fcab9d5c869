//! Which versions of the consent there were, how many people agreed to each, and how many did not.

use maveric_domain::ParticipantId;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A text that somebody agreed to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ConsentRow {
    /// Who agreed.
    pub participant: ParticipantId,
    /// The number of the page, from 1.
    pub step: usize,
    /// SHA-256 of the text as it was shown, in hexadecimal digits.
    pub text_sha256: String,
    /// When, in UTC (`2026-11-27T13:26:32Z`); none where it was given away without.
    pub at: Option<String>,
    /// Whether their style may be lent to others; none where nobody was asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub style_lent: Option<bool>,
}

/// How many people left where they were asked to agree to a text.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct NotAgreed {
    /// SHA-256 of the text as it was shown, in hexadecimal digits.
    pub text_sha256: String,
    /// How many.
    pub people: usize,
}

/// A version of the consent: a text, word for word.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ConsentVersion {
    /// SHA-256 of the text as it was shown, in hexadecimal digits.
    pub text_sha256: String,
    /// The first day on which somebody agreed to it, in UTC (`2026-11-27`), where it is known and [`FEWEST_AGREED`] did.
    pub first_day: Option<String>,
    /// The last such day.
    pub last_day: Option<String>,
    /// How many people agreed to it.
    pub agreed: usize,
    /// How many left where they were asked to.
    pub not_agreed: usize,
    /// How many of those who agreed let their style be lent to others; none where none of them was asked, or fewer than [`FEWEST_AGREED`]
    /// agreed.
    pub style_lent: Option<usize>,
}

/// Of a version that fewer people agreed to neither days nor lenders are told: who took part when is known in a laboratory.
pub const FEWEST_AGREED: usize = 5;

/// Digits of a day in a moment.
const DAY_LEN: usize = 10;

/// Every version that somebody agreed to or did not, in the order of their first days.
pub(crate) fn versions(agreed: &[ConsentRow], not_agreed: &[NotAgreed]) -> Vec<ConsentVersion> {
    let mut by_text: BTreeMap<&str, ConsentVersion> = BTreeMap::new();
    let none_yet = |text: &str| ConsentVersion {
        text_sha256: text.to_owned(),
        first_day: None,
        last_day: None,
        agreed: 0,
        not_agreed: 0,
        style_lent: None,
    };
    for row in agreed {
        let text = row.text_sha256.as_str();
        let version = by_text.entry(text).or_insert_with(|| none_yet(text));
        version.agreed += 1;
        if let Some(lent) = row.style_lent {
            version.style_lent = Some(version.style_lent.unwrap_or(0) + usize::from(lent));
        }
        // Days written so stand in the order of time.
        let day = row.at.as_deref().and_then(|at| at.get(..DAY_LEN));
        if let Some(day) = day {
            if version.first_day.as_deref().is_none_or(|first| day < first) {
                version.first_day = Some(day.to_owned());
            }
            if version.last_day.as_deref().is_none_or(|last| day > last) {
                version.last_day = Some(day.to_owned());
            }
        }
    }
    for row in not_agreed {
        let text = row.text_sha256.as_str();
        let version = by_text.entry(text).or_insert_with(|| none_yet(text));
        version.not_agreed += row.people;
    }
    let mut versions: Vec<ConsentVersion> = by_text.into_values().collect();
    // Whose days nobody knows come last.
    versions.sort_by_key(|version| (version.first_day.is_none(), version.first_day.clone()));
    for few in versions.iter_mut().filter(|v| v.agreed < FEWEST_AGREED) {
        (few.first_day, few.last_day, few.style_lent) = (None, None, None);
    }
    versions
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(who: &str, text: &str, at: Option<&str>, style_lent: Option<bool>) -> ConsentRow {
        ConsentRow {
            participant: ParticipantId::new(who).unwrap(),
            step: 1,
            text_sha256: text.to_owned(),
            at: at.map(str::to_owned),
            style_lent,
        }
    }

    fn refused(text: &str, people: usize) -> NotAgreed {
        NotAgreed { text_sha256: text.to_owned(), people }
    }

    #[test]
    fn each_version_has_its_days_and_how_many_agreed_and_did_not_and_one_of_few_people_its_counts_alone()
     {
        let of_first = |who| row(who, "bb", Some("2026-11-02T10:00:00Z"), None);
        let of_second = |who, lent| row(who, "aa", Some("2026-11-20T09:00:00Z"), lent);
        let agreed = [
            row("P8", "aa", Some("2026-11-20T08:00:00Z"), Some(true)),
            row("P2", "bb", Some("2026-11-03T23:59:59Z"), None),
            row("P1", "bb", Some("2026-11-01T10:00:00Z"), None),
            of_first("P3"),
            of_first("P4"),
            of_first("P5"),
            of_second("P6", Some(false)),
            of_second("P7", Some(true)),
            // The page of this one showed no box.
            of_second("P9", None),
            of_second("P10", Some(false)),
            // Four agreed to a third.
            row("P11", "cc", Some("2026-11-10T09:00:00Z"), Some(true)),
            row("P12", "cc", Some("2026-11-10T09:00:00Z"), Some(true)),
            row("P13", "cc", Some("2026-11-11T09:00:00Z"), Some(false)),
            row("P14", "cc", Some("2026-11-11T09:00:00Z"), Some(false)),
        ];
        let version = |text: &str, days: Option<[&str; 2]>, counts: [usize; 2], style_lent| {
            let [first_day, last_day] = match days {
                Some(days) => days.map(|day| Some(day.to_owned())),
                None => [None, None],
            };
            ConsentVersion {
                text_sha256: text.to_owned(),
                first_day,
                last_day,
                agreed: counts[0],
                not_agreed: counts[1],
                style_lent,
            }
        };
        let days = Some(["2026-11-01", "2026-11-03"]);
        let day = Some(["2026-11-20", "2026-11-20"]);
        assert_eq!(
            versions(&agreed, &[refused("00", 1), refused("bb", 2)]),
            [
                version("bb", days, [5, 2], None),
                version("cc", None, [4, 0], None),
                version("aa", day, [5, 0], Some(2)),
                // Nobody agreed to it.
                version("00", None, [0, 1], None),
            ]
        );
        assert!(versions(&[], &[]).is_empty());
        // Where it was given away without times, nobody knows the days.
        let without: Vec<_> =
            (1..=FEWEST_AGREED).map(|i| row(&format!("P{i}"), "aa", None, Some(false))).collect();
        let without = versions(&without, &[]);
        assert_eq!(without, [version("aa", None, [5, 0], Some(0))]);
    }
}
