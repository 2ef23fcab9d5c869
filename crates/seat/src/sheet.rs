//! What is answered on one page.

use crate::{steps::Step, token};
use serde::{Deserialize, Serialize};

/// Answers to one scale, or agreeing to a text.
#[derive(Deserialize, Serialize)]
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
    /// SHA-256 of the text that was agreed to; set here, whatever is sent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) text_sha256: Option<String>,
}

impl Sheet {
    /// The sheet as it is kept, if it is what the step asks: what is wrong with it otherwise.
    pub(crate) fn checked(mut self, found: &Step) -> Result<String, String> {
        self.text_sha256 = None;
        if !(0.0..1e6).contains(&self.seconds) {
            return Err(format!("seconds {}", self.seconds));
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
            _ => return Err("nothing is asked here".to_owned()),
        }
        serde_json::to_string(&self).map_err(|e| e.to_string())
    }
}
