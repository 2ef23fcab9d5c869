//! What the analyses say of style and car: the aggression line, and how the car at 0 on the dial drives.

use super::correlation::Correlation;
use crate::verdict::Verdict;
use maveric_domain::ConditionId;
use serde::{Deserialize, Serialize};

/// The position on the aggression line against measures and score.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct AggressionLine {
    /// Whether the score took part in the fit.
    pub adb_used: bool,
    /// A row a measure, the score last.
    pub rows: Vec<LineRow>,
}

/// One measure along the line.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct LineRow {
    /// Code name of the measure, or `SCALE.SUBSCALE`.
    pub measure: String,
    /// Name for people.
    pub title: String,
    /// Unit in which people read it; empty for counts and shares.
    pub unit: String,
    /// Pearson's, of the position on the line and the value.
    pub correlation: Correlation,
    /// Values of the drivers lowest and highest on the line.
    pub ends: Option<(f64, f64)>,
    /// A participant each: position, value.
    pub points: Vec<(f64, f64)>,
}

/// How well the car at 0 on the dial reproduced a measure.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Reproduction {
    /// The condition that lies at 0 on the dial.
    pub condition: ConditionId,
    /// Code name of the measure.
    pub measure: String,
    /// Name for people.
    pub title: String,
    /// Mean over drivers of 1 − |AV − driver| / driver.
    pub mean: Option<f64>,
    /// Standard deviation over drivers.
    pub sd: Option<f64>,
    /// Drivers.
    pub n: usize,
    /// Drivers left out.
    pub dropped: usize,
    /// The same if the mean of the training drivers stood in for the AV: what no personalising gives.
    pub population_mean: Option<f64>,
    /// The same of a second drive by hand, of those who drove twice: nothing can be asked to be nearer.
    pub second_drive: Option<f64>,
    /// How far the car lies from the person, on average, and whether that counts as none.
    pub bias: Option<Bias>,
}

/// Mean of AV minus driver, in the unit that people read.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Bias {
    /// Unit of all that follows; empty for counts and shares.
    pub unit: String,
    /// Drivers, those of whom the outcome is tested.
    pub n: usize,
    /// Degrees of freedom of the t tests.
    pub df: usize,
    /// Mean difference.
    pub mean: f64,
    /// Ends of its 90 % interval, which lies within ± `same_within` where both one-sided tests are below .05.
    pub interval: Option<(f64, f64)>,
    /// t of the mean against 0.
    pub t: Option<f64>,
    /// Its two-sided p.
    pub p: Option<f64>,
    /// Adjusted after Holm over all measures.
    pub p_holm: Option<f64>,
    /// A mean difference of at most this much counts as none.
    pub same_within: f64,
    /// Whether the design says so; else it is half a standard deviation between people’s baseline drives.
    pub declared: bool,
    /// The larger p of two one-sided t tests against `same_within` on either side.
    pub p_equivalent: Option<f64>,
    /// Whether the car drives as the person does, by [`crate::verdict::equivalent`].
    pub verdict: Verdict,
}

/// Whether the car at 0 on the dial is nearer to the baseline than another condition is.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Nearer {
    /// The condition that lies at 0 on the dial.
    pub condition: ConditionId,
    /// Code name of the measure.
    pub measure: String,
    /// Name for people.
    pub title: String,
    /// The other condition.
    pub than: ConditionId,
    /// Participants with all values.
    pub n: usize,
    /// For how many of them it is nearer.
    pub nearer: usize,
    /// As near: no rank of theirs counts.
    pub tied: usize,
    /// For how many of them it is farther from the baseline.
    pub farther: usize,
    /// Rank-biserial correlation of the signed ranks, above 0 where it is nearer: 1 if for everybody who is not tied.
    pub effect: Option<f64>,
    /// Ends of its 95 % interval.
    pub interval: Option<(f64, f64)>,
    /// Wilcoxon's p for |condition − baseline| against |other − baseline|, two-sided.
    pub p: Option<f64>,
    /// Adjusted after Holm over all rows.
    pub p_holm: Option<f64>,
}

/// A habit that should not follow the aggression line, and should follow the angle on the ellipse.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Kept {
    /// The condition that moves across the dial.
    pub across: ConditionId,
    /// The condition at 0 on the dial, from which it moves.
    pub from: ConditionId,
    /// Code name of the measure.
    pub measure: String,
    /// Name for people.
    pub title: String,
    /// Unit in which people read it; empty for counts and shares.
    pub unit: String,
    /// Position on the line against the measure in the baseline drive.
    pub line: Correlation,
    /// Angle (0 to 360°) against `across` minus `from`: the paper's analysis. An angle has no natural zero.
    pub angle: Correlation,
    /// Multiple R of the change on cosine and sine of the angle: the analysis that does not depend on the zero.
    pub circular_r: Option<f64>,
    /// Its p value.
    pub circular_p: Option<f64>,
    /// Adjusted after Holm over the habits.
    pub circular_p_holm: Option<f64>,
    /// A participant each: angle in rad, change.
    pub points: Vec<(f64, f64)>,
}
