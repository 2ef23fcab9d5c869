//! Bayes factors: how much more likely the data are with an effect than without one.

mod correlation;
mod t;

pub use correlation::{BayesCorrelation, BayesCorrelationAnalysis, bayes_correlation};
pub use t::{BayesT, BayesTAnalysis, bayes_groups, bayes_one, bayes_paired};

use serde::{Deserialize, Serialize};

/// What was held likely of an effect before the data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Prior {
    /// Family of distributions.
    pub family: String,
    /// Its scale: of a Cauchy prior half its interquartile range, of a stretched beta prior the width κ.
    pub scale: f64,
    /// What it is a prior of.
    pub parameter: String,
}

impl Prior {
    fn new(family: &str, scale: f64, parameter: &str) -> Self {
        Self { family: family.to_owned(), scale, parameter: parameter.to_owned() }
    }
}

/// exp(ln) if it is a number of double precision.
fn power(ln: f64) -> Option<f64> {
    Some(libm::exp(ln)).filter(|v| v.is_finite() && *v > 0.0)
}

const TOO_LARGE: &str = "beyond the numbers of double precision; its logarithm is there";
