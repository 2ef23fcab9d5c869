//! Bayes factors: how much more likely the data are with an effect than without one.

mod correlation;
mod t;

pub use correlation::{BayesCorrelation, BayesCorrelationAnalysis, bayes_correlation};
pub use t::{BayesT, BayesTAnalysis, bayes_groups, bayes_one, bayes_paired};

/// exp(ln) if it is a number of double precision.
fn power(ln: f64) -> Option<f64> {
    Some(libm::exp(ln)).filter(|v| v.is_finite() && *v > 0.0)
}

const TOO_LARGE: &str = "beyond the numbers of double precision; its logarithm is there";
