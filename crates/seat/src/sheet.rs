//! What is answered on one page.

use crate::{steps::Step, token};
use serde::{Deserialize, Serialize};

/// Answers to one scale, or agreeing to a text.
#[derive(Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Sheet {
    /// One an item; null where it was left out.
    #[serde(default)]
    pub(crate) answers: Vec<Option<i32>>,
    /// Whether the text was agreed to.
    #[serde(default)]
    pub(crate) agreed: bool,
    /// Time on the page, in s.
    pub(crate) seconds: f64,
    /// Which rule held somebody back, of those of a screening; its answers stay in the page.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) refused: Option<usize>,
    /// When each probe of a ride was asked (s) and what was answered; taken from the ride's record, whatever is sent.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) probes: Vec<(f64, Option<i32>)>,
    /// SHA-256 of the text that was agreed to; set here, whatever is sent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) text_sha256: Option<String>,
}

impl Sheet {
    /// The sheet as it is kept, if it is what the step asks: what is wrong with it otherwise.
    pub(crate) fn checked(mut self, found: &Step) -> Result<String, String> {
        (self.text_sha256, self.probes) = (None, Vec::new());
        if !(0.0..1e6).contains(&self.seconds) {
            return Err(format!("seconds {}", self.seconds));
        }
        if self.refused.is_some() && !matches!(found, Step::Screen { .. }) {
            return Err("nobody is judged here".to_owned());
        }
        match found {
            Step::Scale {
                items, min, max, ..
            } => {
                let range = *min..=*max;
                let all = self.answers.len() == items.len();
                if !all || self.answers.iter().flatten().any(|a| !range.contains(a)) {
                    let (n, low, high) = (items.len(), range.start(), range.end());
                    return Err(format!(
                        "expected {n} answers, each {low} to {high} or left out"
                    ));
                }
            }
            Step::Text {
                agree: true, text, ..
            } if self.agreed && self.answers.is_empty() => {
                self.text_sha256 = Some(token::sha256(text));
            }
            Step::Screen { rules, .. }
                if self.answers.is_empty()
                    && !self.agreed
                    && self.refused.is_none_or(|at| at < rules.len()) => {}
            _ => return Err("nothing is asked here".to_owned()),
        }
        serde_json::to_string(&self).map_err(|e| e.to_string())
    }
}
