//! What the analyses of a study give: everything that a figure, a table or a claim is made from.

use crate::{
    balance::{Balance, OrderBalance},
    finding::Finding,
    flow::Flow,
    lent::BesideLent,
    other_choice::Sensitivity,
    presses::Presses,
    retest::Repeats,
    verdict::Verdict,
    which::WhichRide,
};
use maveric_domain::{
    ConditionId,
    design::{DeclaredTest, ScoreName, Sign},
};
use maveric_stats::{
    ByDesign, CarryOver, Congruence, Effect, LevelChoice, LevelContrast, MixedModel, Named,
    Proportion, SimpleTest, apa,
};
use serde::{Deserialize, Serialize};

/// Every analysis of one study, as its design asks for it (method section 9).
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Analysis {
    /// Whether the people are made up.
    pub synthetic: bool,
    /// Whether a script drove in place of a person.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub scripted: bool,
    /// People analysed.
    pub participants: usize,
    /// How many there were at each step, and who was left out.
    pub flow: Flow,
    /// How evenly the conditions stand in the orders in which people met them; none where no order is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub orders: Option<OrderBalance>,
    /// The primary outcomes in the order written, each tested if all before it were below .05.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub primary: Vec<PrimaryOutcome>,
    /// Outcomes by another choice than the one that decides.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sensitivity: Vec<Sensitivity>,
    /// The hypotheses of the design, judged by their rules.
    pub hypotheses: Vec<Judged>,
    /// What became of each question that the study asks, in the order in which a reader asks; a page words them.
    pub findings: Vec<Finding>,
    /// 9.1, with the score in the fit of the embedding, as the paper does it; none without a style.
    pub line: Option<AggressionLine>,
    /// 9.1, fitted without the score: what driving alone tells.
    pub line_without_adb: Option<AggressionLine>,
    /// 9.2, a row a measure; empty without a condition at 0 on the dial, or without a baseline.
    pub reproduction: Vec<Reproduction>,
    /// Every outcome, every rating and what the drives met on their road, by condition, the baseline first.
    pub descriptives: Vec<Described>,
    /// 9.3, a panel an outcome, then one a group of people where the design divides them.
    pub panels: Vec<Panel>,
    /// 9.3, is the car at 0 on the dial nearer to the baseline than the others are?
    pub nearer: Vec<Nearer>,
    /// 9.4, a row a measure that aggression does not move; empty where no car moves across the dial.
    pub kept: Vec<Kept>,
    /// Each rating over the distance from the own style; empty with fewer than three places on the dial.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub congruence: Vec<CongruenceRow>,
    /// 9.5, a row a pair of factor and rating difference; empty where none was declared.
    pub homophily: Vec<HomophilyRow>,
    /// 9.5, perceived similarity against the ratings, over all answers.
    pub similarity: Vec<SimilarityRow>,
    /// 9.5, each rating on the shift of the dial, with people as random effects.
    pub mixed: Vec<MixedRow>,
    /// 9.5, who preferred another style to their own.
    pub preferences: Vec<Preference>,
    /// What people pressed during the rides; none where nothing could be pressed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub presses: Option<Presses>,
    /// Several sessions and rides; none where the design has one of each.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repeats: Option<Repeats>,
    /// The own style beside somebody else's of the same score, a condition with such a style a row.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lent: Vec<BesideLent>,
    /// Whether people tell which of two rides was in their own style; none where they are not asked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub which: Option<WhichRide>,
    /// Share of embeddings away from 0 on the dial that lie further out than any training driver's.
    pub beyond_training: Option<f64>,
    /// What the design asks for and this analysis does in another way, or not at all, in sentences.
    pub notes: Vec<String>,
    /// Who or what was left out of an analysis, and why.
    pub exclusions: Vec<Exclusion>,
}

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
    /// Lower end of its 95 % interval.
    pub ci_low: Option<f64>,
    /// Upper end.
    pub ci_high: Option<f64>,
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

/// An outcome or a rating in one condition, or in the baseline drive.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Described {
    /// Code name of the measure, or `SCALE.SUBSCALE`.
    pub outcome: String,
    /// Name for people.
    pub title: String,
    /// Unit of the values; empty for counts and shares.
    pub unit: String,
    /// The condition, or the baseline, in which the values were taken.
    pub condition: ConditionId,
    /// People with a value.
    pub n: usize,
    /// Arithmetic mean.
    pub mean: Option<f64>,
    /// Standard deviation over people, over n − 1.
    pub sd: Option<f64>,
    /// Median over people; none without values.
    pub median: Option<f64>,
}

/// A group of people, as the design's factors divide them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Group {
    /// The factor, or several joined by ×.
    pub factor: String,
    /// The level of this group.
    pub level: String,
    /// What pages call it.
    #[serde(default)]
    pub label: String,
}

/// One outcome over the conditions.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Panel {
    /// Code name of the measure, or `SCALE.SUBSCALE`.
    pub outcome: String,
    /// Name for people.
    pub title: String,
    /// Unit of the values; empty for counts and shares.
    pub unit: String,
    /// Whether it was measured; else people were asked.
    pub measured: bool,
    /// Value that means "the same as my own", where there is one.
    pub same: Option<f64>,
    /// Lowest and highest value that there can be, of a score.
    pub range: Option<(f64, f64)>,
    /// The values are differences from this drive; none where they are what was measured or answered.
    pub differences_from: Option<ConditionId>,
    /// Whose they are; none where they are everybody's. Where the design divides people, a panel of each group follows that of everybody.
    pub group: Option<Group>,
    /// The columns of `rows`.
    pub conditions: Vec<ConditionId>,
    /// A participant each.
    pub participants: Vec<String>,
    /// A row a participant, a column a condition.
    pub rows: Vec<Vec<Option<f64>>>,
    /// Participants in the test.
    pub n: usize,
    /// Participants left out for a missing value, or for an order that is not known.
    pub dropped: Vec<String>,
    /// Those of them whose order is not known, where the test takes the period.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub without_order: Vec<String>,
    /// The test of the contrasts; none where nothing could be tested.
    pub test: Option<ContrastTest>,
    /// Why this test, a sentence a step.
    pub reasons: Vec<String>,
    /// The test that the design calls for, with every check that was made: over the conditions, and between people where it divides
    /// them and this panel is of everybody.
    pub comparison: Option<ByDesign>,
    /// How even the orders of those in the test are, where it takes the period.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub balance: Option<Balance>,
    /// The model with first-order carry-over, where the test takes the period: a look at how much rests on there being none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub carry_over: Option<CarryOver>,
    /// The declared contrasts: one family over everybody, and one over all groups of this outcome.
    pub contrasts: Vec<Contrast>,
    /// Means, simple effects and declared contrasts of the factors' levels, where everybody was tested by several factors.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub by_factor: Option<ByFactor>,
}

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
    /// Ends of its 95 % interval, which compares people with others.
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

/// The test of a panel's contrasts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ContrastTest {
    /// Paired t tests.
    T,
    /// Wilcoxon's signed ranks.
    Wilcoxon,
    /// Differences of a mixed model's means, each over its own error where everybody has every condition, by Satterthwaite's degrees of freedom.
    Mixed,
    /// Differences of an ordinal model's coefficients, by t.
    Ordinal,
}

/// Degrees of freedom: whole numbers but of a model.
#[expect(clippy::ref_option, reason = "as serde calls it")]
fn degrees<S: serde::Serializer>(df: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    match *df {
        Some(df) if df.fract().abs() > 0.0 => serializer.serialize_f64(df),
        Some(df) => serializer.serialize_u64(df as u64),
        None => serializer.serialize_none(),
    }
}

/// Two conditions of a panel held against each other.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Contrast {
    /// First condition.
    pub first: ConditionId,
    /// Second condition; the difference is first minus second.
    pub second: ConditionId,
    /// Which way the difference is expected to lie.
    pub expected: Option<Sign>,
    /// People whose first value lies above the second, at it, and below it.
    pub people: [usize; 3],
    /// Mean of first minus second, in the unit of the panel.
    pub mean_difference: Option<f64>,
    /// t or W+ of the test.
    pub statistic: Option<f64>,
    /// Degrees of freedom of a t.
    #[serde(serialize_with = "degrees")]
    pub df: Option<f64>,
    /// Standard error of the mean difference, of a mixed model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub se: Option<f64>,
    /// Ends of the 95 % interval of the mean difference, of a mixed model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interval: Option<(f64, f64)>,
    /// Effect size with its interval.
    pub effect: Option<Effect>,
    /// p value, two-sided.
    pub p: Option<f64>,
    /// Adjusted after Holm over the contrasts of the outcome.
    pub p_holm: Option<f64>,
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

/// A factor of a person against how differently they rated two conditions.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct HomophilyRow {
    /// The factor, such as `mini_ipip.conscientiousness`.
    pub factor: ScoreName,
    /// Name for people.
    pub title: String,
    /// The condition at 0 on the dial.
    pub own: ConditionId,
    /// `own` minus this condition.
    pub versus: ConditionId,
    /// The rating whose difference between the two is correlated.
    pub rating: ScoreName,
    /// Name for people.
    pub rating_title: String,
    /// The correlation, its method chosen by assumption.
    pub correlation: Correlation,
    /// p adjusted after Holm over the family.
    pub p_holm: Option<f64>,
    /// p adjusted after Benjamini and Hochberg over the family.
    pub p_bh: Option<f64>,
    /// Interval of the coefficient that holds with 95 % for the whole family at once (Šidák).
    pub simultaneous: Option<(f64, f64)>,
}

impl HomophilyRow {
    /// The name of this test in a ledger of claims, before `.r`.
    pub fn key(&self) -> String {
        format!(
            "homophily.{}.{}-{}.{}",
            self.factor, self.own, self.versus, self.rating
        )
    }
}

/// Perceived similarity against a rating.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SimilarityRow {
    /// What the perceived similarity is correlated with.
    pub rating: ScoreName,
    /// Name for people.
    pub title: String,
    /// As the paper did it: every answer a pair of its own (df 94 for 24 people).
    pub pooled: Correlation,
    /// Within people: the analysis that knows that several answers come from one person.
    pub within: Correlation,
}

/// The score by which people rated the style of a car after each ride.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PerceivedStyle {
    /// The style's own, or one that compares the car with oneself.
    pub score: ScoreName,
    /// Name for people.
    pub title: String,
    /// The answer that means "as I do", which a comparing score is counted from, up along the dial; none for the style's own.
    pub same: Option<f64>,
}

/// How a rating depends on the distance of the car from the person's own style.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct CongruenceRow {
    /// The rating that is explained, higher always better in the model.
    pub rating: ScoreName,
    /// Name for people.
    pub title: String,
    /// Whether less of it is better: the model has it turned.
    #[serde(default)]
    pub less_is_better: bool,
    /// By what score people perceived how far the car lies, which decides nothing; none where that is as driven.
    #[serde(default)]
    pub perceived: Option<PerceivedStyle>,
    /// People in the model; without one, those with the rating and both places.
    pub n: usize,
    /// Places that the curvature rests on: on the dial, or different distances that people perceived.
    pub places: usize,
    /// Distance that counts as near, in points of the style's score, or of that by which it was perceived.
    pub near_points: f64,
    /// Middle of the scale, which people's own style is counted from; 0 where the range is not known.
    pub middle: f64,
    /// Whether the model takes the period; not where no order is known, or the orders do not tell it from the places.
    pub period: bool,
    /// The fit: higher is better, whichever way the rating is keyed; as driven with its surface.
    pub model: Option<Congruence>,
    /// The rating as predicted over the distance, for people of the mean own style and one standard deviation to either side; as driven
    /// alone.
    #[serde(default)]
    pub curves: Vec<CongruenceCurve>,
    /// Why there is no fit.
    pub why_not: Option<String>,
}

impl CongruenceRow {
    /// Whether it is judged: somebody rated what was driven.
    pub fn is_judged(&self) -> bool {
        self.n > 0 && self.perceived.is_none()
    }
}

/// What people of one own style are predicted to answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CongruenceCurve {
    /// Standard deviations of their own style from the mean: -1, 0 or 1.
    pub sds: i8,
    /// Their own style, in points.
    pub own: f64,
    /// People whose own style lies nearest to this one of the three.
    pub n: usize,
    /// Least and greatest distance from their own style that these people met, with its sign, within the scale.
    pub met: (f64, f64),
    /// The rating as it is keyed, at a distance of 0, by the distance and by its square; averaged over the periods.
    pub rating: [f64; 3],
}

/// A rating on the shift of the dial: the linear mixed model with random intercept and slope a participant.
///
/// Keys of `model.fixed`: `intercept` (the rating at 0 on the dial), `shift` (change a unit upwards) and `shift_squared` (negative:
/// away from the own style on either side it falls, which is homophily). Unit: `unit_points` points of the style's score.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct MixedRow {
    /// The rating that the model explains.
    pub rating: ScoreName,
    /// Name for people.
    pub title: String,
    /// Points in one unit of the shift.
    pub unit_points: f64,
    /// The fit (REML; tests by Satterthwaite's degrees of freedom).
    pub model: Option<MixedModel>,
    /// Why there is none.
    pub why_not: Option<String>,
}

/// How many rated another style above their own.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Preference {
    /// What the conditions are compared by.
    pub rating: ScoreName,
    /// Name for people.
    pub title: String,
    /// Whether less of it counts as better.
    pub less_is_better: bool,
    /// The condition at 0 on the dial.
    pub own: ConditionId,
    /// Participants with all scores.
    pub n: usize,
    /// The conditions elsewhere on the dial.
    pub others: Vec<Above>,
}

/// How many rated one condition above their own style.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Above {
    /// The condition held against the own style.
    pub condition: ConditionId,
    /// Rated it better.
    pub above: usize,
    /// Their share, with Wilson's 95 % interval.
    pub share: Option<Proportion>,
    /// Rated it at least as good.
    pub not_below: usize,
    /// Share of those who rated it at least as good, with Wilson's 95 % interval.
    pub not_below_share: Option<Proportion>,
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

/// What became of a primary outcome.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PrimaryOutcome {
    /// Id of the outcome.
    pub outcome: String,
    /// Name for people.
    pub title: String,
    /// Unit of the difference; empty for counts and shares.
    pub unit: String,
    /// First condition of the contrast that decides.
    pub first: ConditionId,
    /// Second; the difference is first minus second.
    pub second: ConditionId,
    /// The declared test.
    pub test: DeclaredTest,
    /// People in it.
    pub n: usize,
    /// The outcome before it at which the gate closed: then there is neither p nor verdict.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub closed_by: Option<String>,
    /// Mean difference, of a mixed model with the period taken out.
    pub mean_difference: Option<f64>,
    /// Ends of its 95 % interval, of a mixed model.
    pub interval: Option<(f64, f64)>,
    /// p of the contrast, two-sided, not adjusted: it is the only one that decides.
    pub p: Option<f64>,
    /// Whether p is below α.
    pub verdict: Verdict,
}

/// A hypothesis of the design, judged.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Judged {
    /// In words, as declared.
    pub says: String,
    /// Id of the outcome.
    pub outcome: String,
    /// First condition of the contrast.
    pub first: ConditionId,
    /// Second; the difference is first minus second.
    pub second: ConditionId,
    /// The rule, in words.
    pub rule: String,
    /// What became of it.
    pub verdict: Verdict,
    /// People whom the tests of the outcome are of: those with a value of every condition.
    pub n: usize,
    /// Mean of first minus second, in the unit of the panel.
    pub mean_difference: Option<f64>,
    /// Ends of the interval of that mean: 95 %; of a claim that the two are the same 90 %, which lies within the bounds where both one-sided
    /// tests are below .05.
    pub interval: Option<(f64, f64)>,
    /// Which way the difference is claimed to lie; none of a claim that the two are the same.
    pub expected: Option<Sign>,
    /// Bounds within which the two count as the same, of a claim that they are.
    pub bounds: Option<(f64, f64)>,
    /// The p that decides: Holm's within the outcome, or the larger of the two one-sided tests.
    pub p: Option<f64>,
}
