//! What the analyses of the paper give: everything that a figure, a table or a claim is made from.

use crate::family::Family;
use maveric_domain::ConditionId;
use maveric_stats::{Comparison, MixedModel, Proportion};
use serde::{Deserialize, Serialize};

/// Every analysis of the paper over one study (method section 9).
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Analysis {
    /// Whether the people are made up.
    pub synthetic: bool,
    /// Those who are tested.
    pub participants: usize,
    /// 9.1, with the ADB score in the fit of the embedding: as the paper does it.
    pub line: AggressionLine,
    /// 9.1, fitted without the ADB score: what driving alone tells.
    pub line_without_adb: AggressionLine,
    /// 9.2, a row a measure.
    pub accuracy: Vec<MimicAccuracy>,
    /// 9.3, six panels.
    pub panels: Vec<Panel>,
    /// 9.3, is Mimic nearer to the own drive than Aggressive and Cautious are?
    pub nearer: Vec<Nearer>,
    /// 9.4, a row a measure.
    pub kept: Vec<Kept>,
    /// 9.5, the family of tests as declared, such as `mini_ipip,mdsi`.
    #[serde(default)]
    pub family: Family,
    /// 9.5, a row a pair of factor and rating difference.
    pub homophily: Vec<HomophilyRow>,
    /// 9.5, perceived similarity against the ratings, over all answers.
    pub similarity: Vec<SimilarityRow>,
    /// 9.5, each rating on the shift of the dial, with people as random effects.
    #[serde(default)]
    pub mixed: Vec<MixedRow>,
    /// 9.5, who preferred another style to their own.
    pub preferences: Vec<Preference>,
    /// Share of Aggressive and Cautious embeddings that lie further out than any training driver's.
    pub beyond_training: Option<f64>,
    /// Who or what was left out of an analysis, and why.
    pub exclusions: Vec<Exclusion>,
}

/// One correlation.
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
    /// Lower end of its 95 % interval.
    pub ci_low: Option<f64>,
    /// Upper end.
    pub ci_high: Option<f64>,
}

/// The position on the aggression line against measures and score.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct AggressionLine {
    /// Whether the ADB score took part in the fit.
    pub adb_used: bool,
    /// A row a measure, the ADB score last.
    pub rows: Vec<LineRow>,
    /// Mean velocity of the drivers lowest and highest on the line, in mph.
    pub velocity_ends_mph: Option<(f64, f64)>,
}

/// One measure along the line.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct LineRow {
    /// Code name of the measure, or `adb`.
    pub measure: String,
    /// Name for people.
    pub title: String,
    /// The correlation.
    pub correlation: Correlation,
    /// A participant each: position, value in the measure's unit.
    pub points: Vec<(f64, f64)>,
}

/// How well Mimic reproduced a measure.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct MimicAccuracy {
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
}

/// One panel: differences from the own drive in the four conditions.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Panel {
    /// Code name of the measure, or `aggressiveness`.
    pub measure: String,
    /// Name for people.
    pub title: String,
    /// Unit of the differences.
    pub unit: String,
    /// Value that means "the same as my own".
    pub same: f64,
    /// A participant each.
    pub participants: Vec<String>,
    /// A row a participant, a column a condition in the order of [`ConditionId::AV`].
    pub rows: Vec<Vec<Option<f64>>>,
    /// Participants in the test.
    pub n: usize,
    /// Participants left out for a missing value.
    pub dropped: Vec<String>,
    /// The pairs, Holm-adjusted over this panel's six.
    pub pairs: Vec<PanelPair>,
    /// The test over the conditions, with every check that was made; `None` with fewer than two participants in it.
    pub comparison: Option<Comparison>,
}

/// One pair of conditions within a panel.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct PanelPair {
    /// First condition.
    pub first: ConditionId,
    /// Second condition; the difference is first minus second.
    pub second: ConditionId,
    /// Mean difference.
    pub mean_difference: Option<f64>,
    /// p value.
    pub p: Option<f64>,
    /// Adjusted.
    pub p_holm: Option<f64>,
}

/// Whether Mimic is nearer to the own drive than another condition is.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Nearer {
    /// Code name of the measure.
    pub measure: String,
    /// Name for people.
    pub title: String,
    /// Aggressive or Cautious.
    pub than: ConditionId,
    /// Participants with all values.
    pub n: usize,
    /// Share of them for whom Mimic is nearer.
    pub share: Option<f64>,
    /// Wilcoxon's p for |Mimic − own| against |other − own|, two-sided.
    pub p: Option<f64>,
    /// Adjusted after Holm over all rows.
    pub p_holm: Option<f64>,
}

/// A habit that should not follow the aggression line, and should follow the angle on the ellipse.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Kept {
    /// Code name of the measure.
    pub measure: String,
    /// Name for people.
    pub title: String,
    /// Unit.
    pub unit: String,
    /// Position on the line against the measure in the own drive.
    pub line: Correlation,
    /// Angle (0 to 360°) against Perpendicular minus Mimic: the paper's analysis. An angle has no natural zero.
    pub angle: Correlation,
    /// Multiple R of the change on cosine and sine of the angle: the analysis that does not depend on the zero.
    pub circular_r: Option<f64>,
    /// Its p value.
    pub circular_p: Option<f64>,
    /// A participant each: angle in rad, change.
    pub points: Vec<(f64, f64)>,
}

/// A factor of a person against how differently they rated two conditions.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct HomophilyRow {
    /// Code name of the factor, such as `conscientiousness`.
    pub factor: String,
    /// Mimic minus this condition.
    pub versus: ConditionId,
    /// `competence`, `intelligence`, `discomfort` or `trust`.
    pub rating: String,
    /// The correlation, its method chosen by assumption.
    pub correlation: Correlation,
    /// p adjusted after Holm over the family.
    pub p_holm: Option<f64>,
    /// p adjusted after Benjamini and Hochberg over the family.
    pub p_bh: Option<f64>,
}

/// Perceived similarity against a rating.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SimilarityRow {
    /// `competence`, `intelligence` or `trust`.
    pub rating: String,
    /// As the paper did it: every answer a pair of its own (df 94 for 24 people).
    pub pooled: Correlation,
    /// Within people: the analysis that knows that four answers come from one person.
    pub within: Correlation,
}

/// A rating on the shift of the dial: the linear mixed model with random intercept and slope a participant.
///
/// Keys of `model.fixed`: `intercept` (the rating at Mimic), `shift` (change a unit towards aggressive) and `shift_squared` (negative:
/// away from the own style on either side it falls, which is homophily). Unit: `unit_points` points of the ADB scale.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct MixedRow {
    /// `competence`, `intelligence`, `discomfort` or `trust`.
    pub rating: String,
    /// ADB points in one unit of the shift.
    pub unit_points: f64,
    /// The fit (REML; tests by Satterthwaite's degrees of freedom).
    pub model: Option<MixedModel>,
    /// Why there is none.
    pub why_not: Option<String>,
}

/// How many rated another style above their own.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Preference {
    /// The rating.
    pub rating: String,
    /// Participants with all three scores.
    pub n: usize,
    /// Rated Aggressive better than Mimic (less discomfort is better).
    pub aggressive_above: usize,
    /// Rated Cautious better than Mimic.
    pub cautious_above: usize,
    /// Rated Mimic no better than Cautious.
    pub mimic_not_above_cautious: usize,
    /// Share of `aggressive_above` in `n`, with Wilson's 95 % interval.
    #[serde(default)]
    pub aggressive_share: Option<Proportion>,
    /// Share of `cautious_above`.
    #[serde(default)]
    pub cautious_share: Option<Proportion>,
    /// Share of `mimic_not_above_cautious`.
    #[serde(default)]
    pub mimic_not_above_cautious_share: Option<Proportion>,
}

/// Who or what was left out.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Exclusion {
    /// The participant or drive.
    pub who: String,
    /// The analysis.
    pub what: String,
    /// The reason.
    pub why: String,
}
