//! What is scored of a questionnaire, and what samples score.

use serde::{Deserialize, Serialize};

/// A group of items that are scored together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Subscale {
    /// Code name, such as `high_velocity`.
    pub id: String,
    /// Name for people.
    pub title: String,
    /// Its items, numbered from 1; none where it is a sum of others.
    #[serde(default)]
    pub items: Vec<u32>,
    /// The subscales whose scores it adds up, before their weights; an item of two of them counts twice.
    #[serde(default)]
    pub sum_of: Vec<String>,
    /// What sum or mean is multiplied by.
    #[serde(default = "one")]
    pub weight: f64,
    /// Items reversed in this subscale only, beside those of the scale.
    #[serde(default)]
    pub reversed: Vec<u32>,
    /// Whether less of it is better, as of discomfort.
    #[serde(default)]
    pub lower_is_better: bool,
    /// The score that means "as I do", where items compare with oneself.
    #[serde(default)]
    pub same: Option<f64>,
    /// What a sample usually scores; made-up people are made to.
    #[serde(default)]
    pub norms: Option<Norms>,
}

impl Subscale {
    /// The same without some of its items, as a subscale of its own: `discomfort_without_4`, "Discomfort without item 4".
    #[must_use]
    pub fn without_items(&self, items: &[u32]) -> Self {
        let numbers: Vec<String> = items.iter().map(ToString::to_string).collect();
        let noun = if items.len() == 1 { "item" } else { "items" };
        Self {
            id: without_items(&self.id, items),
            title: format!("{} without {noun} {}", self.title, numbers.join(", ")),
            items: self.items.iter().copied().filter(|item| !items.contains(item)).collect(),
            norms: None,
            ..self.clone()
        }
    }
}

/// The id of a subscale without some of its items.
pub(crate) fn without_items(subscale: &str, items: &[u32]) -> String {
    let numbers: Vec<String> = items.iter().map(ToString::to_string).collect();
    format!("{subscale}_without_{}", numbers.join("_"))
}

fn one() -> f64 {
    1.0
}

/// What samples score on a subscale, in the unit of its score.
///
/// A number that was looked up names its publication; one that was not says `chosen`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Norms {
    /// Mean score.
    pub mean: f64,
    /// Standard deviation of the score.
    pub sd: f64,
    /// Cronbach's alpha.
    pub alpha: f64,
    /// Where mean and standard deviation are from: a publication, or `chosen`.
    pub source: String,
    /// Where alpha is from, if from elsewhere.
    #[serde(default)]
    pub alpha_source: Option<String>,
}

/// The usual correlation of two subscales' scores.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NormCorrelation {
    /// The two subscales.
    pub of: [String; 2],
    /// Pearson's r.
    pub r: f64,
    /// A publication, or `chosen`.
    pub source: String,
}

/// How the answers of a subscale become one score.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scoring {
    /// The sum over its items (a missing item counts as the mean of the answered ones).
    Sum,
    /// The mean of the answered items.
    Mean,
}

impl Norms {
    /// The source of a number that no publication has.
    pub const CHOSEN: &str = "chosen";

    /// Whether mean and standard deviation are a publication's.
    pub fn is_published(&self) -> bool {
        self.source != Self::CHOSEN
    }

    /// Whether alpha is a publication's.
    pub fn is_alpha_published(&self) -> bool {
        self.alpha_source.as_ref().unwrap_or(&self.source) != Self::CHOSEN
    }

    /// Whether a score between `low` and `high` can have them; otherwise the key and what is wrong with it.
    pub(super) fn check(&self, (low, high): (f64, f64)) -> Result<(), String> {
        let widest = (high - low) / 2.0;
        let (mean, sd, alpha) = (self.mean, self.sd, self.alpha);
        if !(mean > low && mean < high) {
            return Err(format!("norms.mean is {mean}, expected between {low} and {high}"));
        }
        if !(sd > 0.0 && sd < widest) {
            return Err(format!("norms.sd is {sd}, expected above 0 and below {widest}"));
        }
        if !(alpha > 0.0 && alpha < 1.0) {
            return Err(format!("norms.alpha is {alpha}, expected between 0 and 1"));
        }
        if self.source.trim().is_empty() {
            return Err("norms.source is empty, expected a publication or `chosen`".to_owned());
        }
        Ok(())
    }
}
