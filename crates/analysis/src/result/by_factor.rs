//! What the factors of a design did to an outcome.

use maveric_stats::{LevelChoice, LevelContrast, Named, SimpleTest};
use serde::{Deserialize, Serialize};

/// What the factors of a design did to an outcome, level by level.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ByFactor {
    /// The factors, those between people first.
    pub factors: Vec<TestedFactor>,
    /// The mean of each level and of each cell.
    pub means: Vec<LevelMean>,
    /// Each interaction of two factors: the effect of one at each level of the other.
    pub simple: Vec<SimpleTest>,
    /// The declared contrasts: one family.
    pub contrasts: Vec<FactorContrast>,
}

/// A factor of a test.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TestedFactor {
    /// Its name: of a column, or of what the conditions cross.
    pub name: String,
    /// Whether it changes within people.
    pub within: bool,
    /// Its levels, in order.
    pub levels: Vec<String>,
}

/// The mean of a level of a factor, or of a cell of several, over the levels of all others with equal weight.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct LevelMean {
    /// The factors joined by `:`.
    pub effect: String,
    /// A level a factor.
    pub levels: Vec<String>,
    /// People.
    pub n: usize,
    /// The mean, in the unit of the panel.
    pub mean: f64,
    /// Ends of its 95 % interval, which compares people with others, by the variance of each group on its own.
    pub interval: Option<(f64, f64)>,
    /// Ends of the 95 % interval that compares the levels within people (Cousineau and Morey, each group on its own); of a cell of all
    /// factors where one of them is within people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub within: Option<(f64, f64)>,
}

/// A declared contrast of levels with its test.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct FactorContrast {
    /// Factor → its two levels, the first less the second, or the one at which it is held.
    pub levels: Named<LevelChoice>,
    /// The estimate and its test.
    #[serde(flatten)]
    pub test: LevelContrast,
    /// Adjusted after Holm over the declared contrasts of the outcome.
    pub p_holm: Option<f64>,
}
