//! The model: a person's rating of a drive from how it is shifted, how far it is from their own, and who they are.

use super::{
    SETTINGS,
    percept::{Dial, Percept},
};
use crate::{
    StudyData,
    error::AnalysisError,
    homophily::{ratings, scale_and_factor},
    turned::Settled,
};
use maveric_domain::{
    ParticipantId,
    design::{Condition, ScoreName},
};
use maveric_stats::{Belief, Hierarchical, PersonRows, hierarchical};
use serde::Serialize;

/// A column of numbers about people, standardised over those learned from.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Standard {
    /// What it is: `openness`, `adb`, `line_position`, …
    pub(super) name: String,
    /// Mean of the values learned from.
    pub(super) mean: f64,
    /// Standard deviation.
    pub(super) sd: f64,
}

/// Everything learned from the people of a study.
///
/// rating = α + A (b + Σ θₖ xₖ + u) + g A² + D (d + Σ φₖ xₖ + v) + ε: A the perceived shift, D the perceived distance from the own drive, x the
/// person's standardised traits; α, u, v differ between people. θ and φ are shrunk, each group by a variance of its own.
/// The preferred shift is where b A + g A² is highest; D, the dislike of a car unlike oneself, is kept apart from it.
#[derive(Debug, Clone)]
pub struct Learned {
    /// [`StudyData::adb_point`] of the study.
    pub(super) adb_point: f64,
    /// How a drive is perceived.
    pub(super) percept: Percept,
    /// Where the dial is.
    pub(super) dial: Dial,
    /// The traits.
    pub(super) traits: Vec<Standard>,
    /// The ratings, each with 1, or -1 where less is better; they are averaged in SDs.
    pub(super) ratings: Vec<(ScoreName, f64, Standard)>,
    /// The fit; its coefficients are of 1, A, A² and D, then of A by each trait, then of D by each.
    pub(super) fit: Hierarchical,
}

/// Where a person would like the dial, in points of the style's score.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Preferred {
    /// The middle of what is believed.
    pub points: f64,
    /// Low end of the 95 % interval.
    pub low: f64,
    /// High end.
    pub high: f64,
    /// How sure that it is within 5 ADB points of `points`, or as large a share of another scale, 0 to 1.
    pub within_5: f64,
}

/// Columns before the traits: 1, A, A², D.
const PLAIN: usize = 4;
/// Settings further from the own style than this are not recommended, in ADB points or as large a share of another scale: nobody has
/// driven them.
const FURTHEST_POINTS: f64 = 30.0;

/// Names and values of what is known of a person before any ride.
fn traits_of(data: &StudyData, p: &ParticipantId) -> Vec<(String, Option<f64>)> {
    let mut traits = Vec::new();
    let family = data.design.homophily();
    for word in family.map_or(&[][..], |f| &f.factors) {
        let (scale, only) = scale_and_factor(word);
        for name in data.pre_subscales(scale) {
            if only.is_none_or(|factor| factor == name.subscale) {
                let value = data.pre(p, &name);
                traits.push((name.subscale, value));
            }
        }
    }
    if let Some(style) = data.design.style() {
        traits.push((style.score.scale.clone(), data.pre(p, &style.score)));
    }
    let position = data.embedding(p, false).and_then(|e| e.line_position);
    traits.push(("line_position".to_owned(), position));
    let velocity = data.baseline(p, "mean_velocity_mps");
    traits.push(("own_mean_velocity".to_owned(), velocity));
    traits
}

fn standard(name: String, values: &[f64]) -> Option<Standard> {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let sd = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
    (sd.is_finite() && sd > 1e-9).then_some(Standard { name, mean, sd })
}

/// Which setting a condition of the study showed that moved by so many ADB points, or as large a share of another scale.
pub(super) fn setting_of(condition: &Condition, moved_points: Option<f64>) -> Option<usize> {
    condition.dial()?;
    let moved = moved_points?;
    SETTINGS.iter().position(|s| (s - moved).abs() <= 2.5)
}

impl Learned {
    /// Learns from some of a study's people, and how they perceive a drive too.
    ///
    /// # Errors
    /// [`AnalysisError::NoRatings`] where the design declares none; [`AnalysisError::NothingToLearn`] for fewer than five people, ratings
    /// that nobody gave or all gave alike, or a dial that nobody perceives to turn.
    pub fn from(data: &StudyData, people: &[ParticipantId]) -> Result<Self, AnalysisError> {
        let not_possible = |problem: String| AnalysisError::NothingToLearn { problem };
        if people.len() < 5 {
            return Err(not_possible(format!(
                "{} people to learn from, expected at least 5",
                people.len()
            )));
        }
        let declared = ratings(data);
        if declared.is_empty() {
            return Err(AnalysisError::NoRatings);
        }
        let percept = Percept::learn(data, people)?;
        let dial = percept.dial(data, people).ok_or_else(|| {
            not_possible("the two ends of the dial and its middle are not perceived in this order, or were not all driven: the dial has no direction".to_owned())
        })?;
        let known: Vec<Vec<(String, Option<f64>)>> =
            people.iter().map(|p| traits_of(data, p)).collect();
        let traits = known[0]
            .iter()
            .enumerate()
            .filter_map(|(k, (name, _))| {
                let values: Vec<f64> = known.iter().filter_map(|t| t[k].1).collect();
                standard(name.clone(), &values)
            })
            .collect();
        let conditions = data.design.conditions();
        let better = |name: &ScoreName| data.better(name).factor();
        let ratings: Vec<(ScoreName, f64, Standard)> = declared
            .iter()
            .filter_map(|name| {
                let answers = people
                    .iter()
                    .flat_map(|p| conditions.iter().map(|c| data.rated(p, c.id, name)));
                let scaling = standard(name.to_string(), &answers.flatten().collect::<Vec<f64>>())?;
                Some((name.clone(), better(name), scaling))
            })
            .collect();
        if ratings.is_empty() {
            let names: Vec<String> = declared.iter().map(ToString::to_string).collect();
            return Err(not_possible(format!(
                "nobody answered {} after a condition, or all answered the same",
                names.join(", ")
            )));
        }
        let mut learned = Self {
            adb_point: data.adb_point(),
            percept,
            dial,
            traits,
            ratings,
            fit: Hierarchical {
                coefficients: Belief::new(Vec::new(), Vec::new())?,
                shrunken_sd: Vec::new(),
                random_sd: Vec::new(),
                residual_sd: 0.0,
                ln_evidence: 0.0,
            },
        };
        let rows: Vec<PersonRows> = people.iter().map(|p| learned.rows(data, p)).collect();
        let count = learned.traits.len();
        let groups = [vec![None; PLAIN], vec![Some(0); count], vec![Some(1); count]].concat();
        learned.fit = hierarchical(&rows, &groups)?;
        Ok(learned)
    }

    /// A person's standardised traits; 0, the mean, where one is missing.
    pub(super) fn traits(&self, data: &StudyData, p: &ParticipantId) -> Vec<f64> {
        let known = traits_of(data, p);
        let z_of = |s: &Standard| {
            let value = known.iter().find(|(name, _)| *name == s.name).and_then(|(_, v)| *v);
            value.map_or(0.0, |v| (v - s.mean) / s.sd)
        };
        self.traits.iter().map(z_of).collect()
    }

    /// The mean rating behind scores, in SDs.
    pub(super) fn rating(&self, score: impl Fn(&ScoreName) -> Option<f64>) -> Option<f64> {
        let z_of = |(name, sign, s): &(ScoreName, f64, Standard)| {
            Some(sign * (score(name)? - s.mean) / s.sd)
        };
        let values: Vec<f64> = self.ratings.iter().filter_map(z_of).collect();
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    }

    /// The columns of x for a drive perceived as (shift, distance).
    fn columns(traits: &[f64], (shift, distance): (f64, f64)) -> Vec<f64> {
        let mut x = vec![1.0, shift, shift * shift, distance];
        x.extend(traits.iter().map(|t| t * shift));
        x.extend(traits.iter().map(|t| t * distance));
        x
    }

    /// The whole row of a drive for a belief about somebody: x, z, and which of [`SETTINGS`] it showed, if one.
    pub(super) fn row(traits: &[f64], perceived: (f64, f64), setting: Option<usize>) -> Vec<f64> {
        let mut row = Self::columns(traits, perceived);
        row.extend([1.0, perceived.0, perceived.1]);
        row.extend((0..SETTINGS.len()).map(|i| if setting == Some(i) { 1.0 } else { 0.0 }));
        row
    }

    fn rows(&self, data: &StudyData, p: &ParticipantId) -> PersonRows {
        let traits = self.traits(data, p);
        let mut rows = PersonRows::default();
        for c in data.design.conditions() {
            let rating = self.rating(|name| data.rated(p, c.id, name));
            if let (Some(y), Some(perceived)) = (rating, self.percept.of_condition(data, p, c.id)) {
                rows.y.push(y);
                rows.x.push(Self::columns(&traits, perceived));
                rows.z.push(vec![1.0, perceived.0, perceived.1]);
            }
        }
        rows
    }

    /// What is believed of a person: by their traits alone, or by their ratings of the study's conditions too.
    ///
    /// Behind β and u stands an error of each setting that its repetitions share, as large as that of a single rating: what the model gets
    /// wrong about a setting it gets wrong each time, so that showing it again tells less than showing another.
    pub(super) fn belief(&self, data: &StudyData, p: &ParticipantId, with_ratings: bool) -> Belief {
        let mut belief = self.fit.somebody().extended(&[self.fit.residual_sd; SETTINGS.len()]);
        if with_ratings {
            let traits = self.traits(data, p);
            for c in data.design.conditions() {
                let rating = self.rating(|name| data.rated(p, c.id, name));
                if let (Some(y), Some(perceived)) =
                    (rating, self.percept.of_condition(data, p, c.id))
                {
                    let moved = data.condition(p, c.id).and_then(|row| row.moved_points);
                    let moved = moved.map(|points| points / self.adb_point);
                    let row = Self::row(&traits, perceived, setting_of(c, moved));
                    self.observe(&mut belief, &row, y);
                }
            }
        }
        belief
    }

    /// Takes in one rating.
    fn observe(&self, belief: &mut Belief, row: &[f64], rating: f64) {
        belief.observe(row, rating, self.fit.residual_sd.powi(2));
    }

    /// Takes in where somebody left the dial: what they like neither rises nor falls there.
    ///
    /// # Source
    /// Ours: the slope b + 2 g A of the preference is 0 at the perceived shift A of the place, with the error that the SD of the place
    /// makes of it at the curvature that is believed.
    pub(super) fn observe_settled(&self, belief: &mut Belief, traits: &[f64], settled: Settled) {
        let (linear, square) = parabola(traits);
        let shift = |points: f64| self.dial.expected(points).0;
        let settled_shift = shift(settled.points);
        let half = 0.5 * self.adb_point;
        let apart = shift(settled.points + half) - shift(settled.points - half);
        let a_point = apart.abs() / self.adb_point;
        let mut slope: Vec<f64> =
            linear.iter().zip(&square).map(|(l, s)| l + 2.0 * settled_shift * s).collect();
        slope.resize(belief.len(), 0.0);
        let curvature = belief.mean_of(&square).min(-0.05);
        let sd = 2.0 * curvature * a_point * settled.sd;
        belief.observe(&slope, 0.0, sd * sd);
    }

    /// Where the person would like the dial; `None` if the ratings do not fall to both sides of anything.
    pub(super) fn preferred(&self, belief: &Belief, traits: &[f64]) -> Option<Preferred> {
        self.preferred_within(belief, traits, self.furthest())
    }

    /// Between which settings one may be recommended to anybody.
    pub(super) fn furthest(&self) -> [f64; 2] {
        let furthest = FURTHEST_POINTS * self.adb_point;
        [-furthest, furthest]
    }

    /// As [`Learned::preferred`], between these settings.
    pub(super) fn preferred_within(
        &self,
        belief: &Belief,
        traits: &[f64],
        [low, high]: [f64; 2],
    ) -> Option<Preferred> {
        let (linear, square) = parabola(traits);
        let tops = belief.top_of_parabola(&linear, &square)?;
        let points: Vec<f64> =
            tops.into_iter().map(|shift| self.dial.points_at(shift).clamp(low, high)).collect();
        let quantile = |share: f64| points[((points.len() - 1) as f64 * share).round() as usize];
        let middle = quantile(0.5);
        let within = 5.0 * self.adb_point;
        let near = points.iter().filter(|v| (*v - middle).abs() <= within);
        Some(Preferred {
            points: middle,
            low: quantile(0.025),
            high: quantile(0.975),
            within_5: near.count() as f64 / points.len() as f64,
        })
    }
}

/// Weights of b and of g in a belief about somebody with these traits.
pub(crate) fn parabola(traits: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let size = PLAIN + 2 * traits.len() + 3;
    let (mut linear, mut square) = (vec![0.0; size], vec![0.0; size]);
    linear[1] = 1.0;
    linear[PLAIN..PLAIN + traits.len()].copy_from_slice(traits);
    linear[PLAIN + 2 * traits.len() + 1] = 1.0;
    square[2] = 1.0;
    (linear, square)
}
