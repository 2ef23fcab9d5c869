//! A correlation of two columns.

use maveric_stats::{Interval, apa};
use serde::{Deserialize, Serialize};

/// A correlation of two columns with its test.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Correlation {
    /// `pearson`, `spearman` or `rm_corr`.
    pub method: String,
    /// Pairs.
    pub n: usize,
    /// Degrees of freedom.
    pub df: usize,
    /// The coefficient; `None` where it does not exist.
    pub r: Option<f64>,
    /// Its p value.
    pub p: Option<f64>,
    /// Its 95 % interval.
    #[serde(flatten, with = "maveric_stats::interval::ci")]
    pub ci: Interval,
}

impl Correlation {
    /// As APA writes it; `None` where the coefficient does not exist.
    pub fn statement(&self) -> Option<apa::Statement> {
        let write = match self.method.as_str() {
            "spearman" => apa::rho,
            "rm_corr" => apa::r_rm,
            _ => apa::r,
        };
        Some(write(self.r?, self.df, self.p?))
    }
}
