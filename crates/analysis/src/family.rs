//! Which factors are held against rating differences: the family of tests, declared before looking.

use crate::{AnalysisError, data::StudyData};
use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// The factors of the homophily tests; each is held against every rating, for Mimic − Cautious and Mimic − Aggressive. One family:
/// Holm's and Benjamini and Hochberg's corrections count all of these tests and no others.
///
/// As text: scales and factors separated by commas, such as `mini_ipip,mdsi.high_velocity`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Family(Vec<Member>);

#[derive(Debug, Clone, PartialEq, Eq)]
struct Member {
    scale: String,
    /// All factors of the scale without.
    factor: Option<String>,
}

impl Default for Family {
    /// The Big Five and the eight factors of the MDSI: all that the paper correlates.
    fn default() -> Self {
        let whole = |scale: &str| Member {
            scale: scale.to_owned(),
            factor: None,
        };
        Self(vec![whole("mini_ipip"), whole("mdsi")])
    }
}

impl FromStr for Family {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let mut members = Vec::new();
        for word in text.split(',').map(str::trim) {
            let (scale, factor) = match word.split_once('.') {
                Some((scale, factor)) => (scale, Some(factor)),
                None => (word, None),
            };
            if scale.is_empty() || factor.is_some_and(str::is_empty) {
                return Err(format!(
                    "`{word}` in the family `{text}` names no scale, expected scales and factors such as `mini_ipip,mdsi.high_velocity`"
                ));
            }
            let member = Member {
                scale: scale.to_owned(),
                factor: factor.map(str::to_owned),
            };
            if members.contains(&member) {
                return Err(format!("`{word}` stands twice in the family `{text}`"));
            }
            members.push(member);
        }
        Ok(Self(members))
    }
}

impl TryFrom<String> for Family {
    type Error = String;
    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<Family> for String {
    fn from(family: Family) -> Self {
        family.to_string()
    }
}

impl std::fmt::Display for Family {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let words: Vec<String> = self
            .0
            .iter()
            .map(|m| match &m.factor {
                Some(factor) => format!("{}.{factor}", m.scale),
                None => m.scale.clone(),
            })
            .collect();
        f.write_str(&words.join(","))
    }
}

impl Family {
    /// Scale and factor of each member, once each, in the order declared.
    pub(crate) fn factors(&self, data: &StudyData) -> Result<Vec<(String, String)>, AnalysisError> {
        let mut found: Vec<(String, String)> = Vec::new();
        for Member { scale, factor } in &self.0 {
            let known = data.pre_subscales(scale);
            if known.is_empty() {
                return Err(AnalysisError::UnansweredScale {
                    scale: scale.clone(),
                });
            }
            let wanted = match factor {
                None => known,
                Some(factor) if known.contains(factor) => vec![factor.clone()],
                Some(factor) => {
                    return Err(AnalysisError::UnknownFactor {
                        scale: scale.clone(),
                        factor: factor.clone(),
                        known,
                    });
                }
            };
            for factor in wanted {
                let pair = (scale.clone(), factor);
                if !found.contains(&pair) {
                    found.push(pair);
                }
            }
        }
        Ok(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_family_survives_its_text() {
        for text in ["mini_ipip,mdsi", "mdsi.high_velocity"] {
            assert_eq!(text.parse::<Family>().unwrap().to_string(), text);
        }
        assert_eq!(Family::default().to_string(), "mini_ipip,mdsi");
    }

    #[test]
    fn a_slip_in_a_family_is_named() {
        for (text, said) in [
            ("", "names no scale"),
            ("mdsi.", "names no scale"),
            ("a,a", "twice"),
        ] {
            let error = text.parse::<Family>().unwrap_err();
            assert!(error.contains(said), "{error}");
        }
    }
}
