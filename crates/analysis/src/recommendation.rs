//! How far to turn the dial for a person: learned from others' ratings of their conditions.

mod learned;
mod percept;
mod scale;
#[cfg(test)]
mod tests;

pub use learned::{Learned, Preferred};
pub use scale::OnTheScale;

use crate::StudyData;
use maveric_domain::{BeyondWhy, ParticipantId, design::BeyondRule};
use maveric_stats::Belief;
use scale::{on_the_scale, settings_within};
use serde::Serialize;

/// The settings that a condition may come near to, in ADB points from the own style. On another scale they are as large a share of it.
const SETTINGS: [f64; 7] = [-15.0, -10.0, -5.0, 0.0, 5.0, 10.0, 15.0];

/// A reason: by how many points it moves the recommendation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reason {
    /// `everybody`, a trait, `own ratings`, or `own turns of the dial`.
    pub because: String,
    /// The person's value in SDs from the mean of those learned from; none where it is no trait.
    pub standardised: Option<f64>,
    /// Effect on the recommended shift, in points of the style's score.
    pub points: f64,
}

/// What to recommend to one person.
#[derive(Debug, Clone, Serialize)]
pub struct Recommendation {
    /// Who.
    pub participant: ParticipantId,
    /// Why their own drive is beyond what the model has learned from; none where it is not, or where nobody can say.
    pub beyond: Option<BeyondWhy>,
    /// By their own ratings of the conditions, where they left the dial and who they are, within the scale where it and the own style are
    /// known; none if the ratings have no top, and where the dial has no place to turn from because the drive is beyond.
    pub preferred: Option<Preferred>,
    /// The same on the scale of the score, with what the drive leaves open of the own style.
    pub on_the_scale: Option<OnTheScale>,
    /// By who they are alone, as for somebody who has not ridden yet.
    pub before_riding: Option<Preferred>,
    /// The reasons, the largest first.
    pub reasons: Vec<Reason>,
}

impl Learned {
    /// What to recommend to one person. For somebody beyond what the model has learned from the dial is not turned, unless the design
    /// lets it be.
    pub fn recommendation(&self, data: &StudyData, p: &ParticipantId) -> Recommendation {
        let embedding = data.embedding(p, true).or_else(|| data.embedding(p, false));
        let beyond = embedding.and_then(|row| row.beyond_why.clone());
        if beyond.is_some() && data.design.beyond() == BeyondRule::LeaveOut {
            return Recommendation {
                participant: p.clone(),
                beyond,
                preferred: None,
                on_the_scale: None,
                before_riding: None,
                reasons: Vec::new(),
            };
        }
        let traits = self.traits(data, p);
        let before = self.belief(data, p, false);
        let rated = self.belief(data, p, true);
        let mut after = rated.clone();
        for settled in data.settled(p) {
            self.observe_settled(&mut after, &traits, *settled);
        }
        let within = settings_within(data, embedding, self.furthest());
        let preferred = self.preferred_within(&after, &traits, within);
        Recommendation {
            participant: p.clone(),
            beyond,
            on_the_scale: preferred.as_ref().and_then(|preferred| on_the_scale(data, p, preferred)),
            preferred,
            before_riding: self.preferred_within(&before, &traits, within),
            reasons: reasons(self, [&before, &rated, &after], &traits),
        }
    }
}

/// What each part adds to the recommended shift, at the curvature that is believed.
fn reasons(learned: &Learned, [before, rated, after]: [&Belief; 3], traits: &[f64]) -> Vec<Reason> {
    let (linear, square) = learned::parabola(traits);
    let g = before.mean_of(&square).min(-0.05);
    // One unit of b in points, on the person's side of the dial.
    let side = -before.mean_of(&linear) / (2.0 * g);
    let unit = {
        let step = if side >= learned.dial.shift[1] { 0.01 } else { -0.01 };
        (learned.dial.points_at(side + step) - learned.dial.points_at(side)) / step / (-2.0 * g)
    };
    let mean = before.mean();
    let mut reasons = vec![Reason {
        because: "everybody".to_owned(),
        standardised: None,
        points: learned.dial.points_at(-mean[1] / (2.0 * g)),
    }];
    for (k, (standard, z)) in learned.traits.iter().zip(traits).enumerate() {
        reasons.push(Reason {
            because: standard.name.clone(),
            standardised: Some(*z),
            points: unit * mean[4 + k] * z,
        });
    }
    let mut add_reason = |because: &str, with: &Belief, without: &Belief| {
        let preferred = |belief| learned.preferred(belief, traits);
        if let (Some(with), Some(without)) = (preferred(with), preferred(without)) {
            reasons.push(Reason {
                because: because.to_owned(),
                standardised: None,
                points: with.points - without.points,
            });
        }
    };
    add_reason("own ratings", rated, before);
    if after != rated {
        add_reason("own turns of the dial", after, rated);
    }
    reasons.sort_by(|a, b| b.points.abs().total_cmp(&a.points.abs()));
    reasons
}
