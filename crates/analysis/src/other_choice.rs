//! What came of an outcome by another choice than the one that decides.

use crate::verdict::Verdict;
use maveric_domain::ConditionId;
use serde::{Deserialize, Serialize};

/// An outcome by another choice than the one that decides.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sensitivity {
    /// `SCALE.SUBSCALE` of the outcome.
    pub outcome: String,
    /// Name of the outcome for people.
    pub title: String,
    /// The other choice.
    #[serde(flatten)]
    pub choice: OtherChoice,
    /// People in the test that decides, and in the other.
    pub n: [usize; 2],
    /// A row a declared contrast.
    pub rows: Vec<SensitivityRow>,
}

/// What is chosen otherwise.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "choice", rename_all = "kebab-case")]
pub enum OtherChoice {
    /// The score without items that name what the conditions turn.
    WithoutItems {
        /// Numbers of the items.
        items: Vec<u32>,
    },
    /// With what was said of rides that people stopped.
    WithStopped {
        /// Stopped rides that somebody rated.
        rides: usize,
    },
}

/// A contrast as it is decided, and by the other choice.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SensitivityRow {
    /// First condition.
    pub first: ConditionId,
    /// Second; differences are first minus second.
    pub second: ConditionId,
    /// Mean difference in the unit of the score.
    pub mean_difference: Option<f64>,
    /// p of what decides, two-sided.
    pub p: Option<f64>,
    /// Whether what decides is below .05.
    pub differs: Verdict,
    /// Mean difference by the other choice.
    pub other_mean_difference: Option<f64>,
    /// p of that difference, two-sided.
    pub other_p: Option<f64>,
    /// Whether both p are after Holm over the contrasts of the outcome; of its primary contrast they are as they are.
    pub holm: bool,
    /// Of a difference, whether it is there with the same sign by the other choice; else whether one is there by that alone.
    pub other_differs: Verdict,
}

impl Sensitivity {
    /// Contrasts that differ by the other choice alone.
    pub fn only_there(&self) -> usize {
        let rows = self.rows.iter();
        let only = |row: &&SensitivityRow| {
            row.differs != Verdict::Shown && row.other_differs == Verdict::Shown
        };
        rows.filter(only).count()
    }
}
