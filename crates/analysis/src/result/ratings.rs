//! What people rated: by who they are, by how near the car is to their own style, and which style they preferred.

use super::correlation::Correlation;
use maveric_domain::{ConditionId, design::ScoreName};
use maveric_stats::{Congruence, MixedModel, Proportion};
use serde::{Deserialize, Serialize};

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
        format!("homophily.{}.{}-{}.{}", self.factor, self.own, self.versus, self.rating)
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
    pub less_is_better: bool,
    /// By what score people perceived how far the car lies, which decides nothing; none where that is as driven.
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
