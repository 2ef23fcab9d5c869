//! A rule on one answer: `misc >= 6`, `demographics.age >= 18`.

use serde::{Deserialize, Serialize};
use std::{fmt, str::FromStr};

/// How an answer is held against a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Than {
    /// The answer is the number or above it.
    #[serde(rename = ">=")]
    AtLeast,
    /// The answer is the number or below it.
    #[serde(rename = "<=")]
    AtMost,
    /// The answer is above the number.
    #[serde(rename = ">")]
    More,
    /// The answer is below the number.
    #[serde(rename = "<")]
    Less,
    /// The answer is the number.
    #[serde(rename = "==")]
    Same,
    /// Another.
    #[serde(rename = "!=")]
    Other,
}

/// Each, with its sign; the longer signs first.
const SIGNS: [(&str, Than); 6] = [
    (">=", Than::AtLeast),
    ("<=", Than::AtMost),
    ("==", Than::Same),
    ("!=", Than::Other),
    (">", Than::More),
    ("<", Than::Less),
];

impl Than {
    /// Whether `answer` is so beside `value`.
    pub fn holds(self, answer: i32, value: i32) -> bool {
        match self {
            Self::AtLeast => answer >= value,
            Self::AtMost => answer <= value,
            Self::More => answer > value,
            Self::Less => answer < value,
            Self::Same => answer == value,
            Self::Other => answer != value,
        }
    }
}

/// A rule on the answer to one item of a scale.
///
/// # Example
/// ```
/// # use maveric_domain::design::AnswerRule;
/// let rule: AnswerRule = "demographics.age >= 18".parse().unwrap();
/// assert_eq!((rule.scale.as_str(), rule.item.as_deref()), ("demographics", Some("age")));
/// assert!(rule.than.holds(18, rule.value) && !rule.than.holds(17, rule.value));
/// ```
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct AnswerRule {
    /// Id of the scale that asks.
    pub scale: String,
    /// Number of the item (from 1), or the subscale that it alone makes; none where the scale has one item.
    pub item: Option<String>,
    /// How the answer is held against the number.
    pub than: Than,
    /// The number.
    pub value: i32,
}

impl FromStr for AnswerRule {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            format!(
                "found `{text}`, expected an item, a sign (>=, <=, >, <, ==, !=) and a whole number, such as `demographics.age >= 18`"
            )
        };
        let signed = SIGNS.iter().find_map(|(sign, than)| {
            let (item, value) = text.split_once(sign)?;
            Some((item.trim(), *than, value.trim()))
        });
        let (item, than, value) = signed.ok_or_else(wrong)?;
        let (scale, item) = match item.split_once('.') {
            Some((scale, item)) => (scale, Some(item)),
            None => (item, None),
        };
        let is_word = |word: &str| {
            !word.is_empty() && word.chars().all(|c| c.is_alphanumeric() || "_-".contains(c))
        };
        if !is_word(scale) || !item.is_none_or(is_word) {
            return Err(wrong());
        }
        Ok(Self {
            scale: scale.to_owned(),
            item: item.map(str::to_owned),
            than,
            value: value.parse().map_err(|_| wrong())?,
        })
    }
}

crate::as_text::as_text!(AnswerRule);

impl fmt::Display for AnswerRule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = SIGNS.iter().find(|(_, than)| *than == self.than);
        f.write_str(&self.scale)?;
        if let Some(item) = &self.item {
            write!(f, ".{item}")?;
        }
        write!(f, " {} {}", sign.map_or("", |(sign, _)| sign), self.value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rule_survives_its_text() {
        for text in [
            "demographics.age >= 18",
            "misc >= 6",
            "health.3 != 1",
            "a.b < -2",
            "a > 4",
            "x-y.z == 0",
        ] {
            assert_eq!(text.parse::<AnswerRule>().unwrap().to_string(), text);
        }
        assert_eq!("misc>=6".parse::<AnswerRule>(), "misc >= 6".parse());
    }

    #[test]
    fn what_is_no_rule_says_what_one_is() {
        for text in [
            "",
            "misc",
            "misc >= six",
            ">= 6",
            "misc 6",
            "a.b.c >= 1",
            "misc >= 6.5",
            "misc => 6",
            "a b >= 1",
        ] {
            let told = text.parse::<AnswerRule>().unwrap_err();
            assert!(told.contains(text) && told.contains("demographics.age >= 18"), "{told}");
        }
    }

    #[test]
    fn an_answer_holds_a_rule_or_does_not() {
        for (text, holds, not) in [
            ("a >= 6", 6, 5),
            ("a <= 6", 6, 7),
            ("a > 6", 7, 6),
            ("a < 6", 5, 6),
            ("a == 6", 6, 7),
            ("a != 6", 7, 6),
        ] {
            let rule: AnswerRule = text.parse().unwrap();
            assert!(rule.than.holds(holds, rule.value), "{text}");
            assert!(!rule.than.holds(not, rule.value), "{text}");
        }
    }
}
