//! What people think of the car in each condition.

use crate::{
    coverage::{covered, subscale_of},
    effects::{Effects, RatingModel},
    error::ParticipantError,
    impression::{Impression, Trial},
    person::Participant,
    response::{as_given, grade, maybe_left_out, normal, stream},
};
use maveric_domain::{Answer, ConditionId, MeasureValues, Moment, ParticipantId, Ride, Scale};
use std::{
    collections::{BTreeMap, BTreeSet},
    fmt,
};

/// Measures that one of the two drives lacks, or that do not vary: the person judged by the others.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct RatingWarning {
    pub participant: ParticipantId,
    /// The one that they rated.
    pub condition: ConditionId,
    /// Code names of the measures.
    pub measures: Vec<String>,
}

impl fmt::Display for RatingWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (participant, condition) = (&self.participant, self.condition);
        let measures = self.measures.join(", ");
        write!(f, "participant {participant} ({condition}) was rated without {measures}")
    }
}

/// Answers after the conditions, and what was left out of them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Rated {
    /// Ordered by condition as given, scale as given and item.
    pub answers: Vec<Answer>,
    /// One a condition at most.
    pub warnings: Vec<RatingWarning>,
}

/// Lets one participant rate the conditions that they sat through.
///
/// `own` and `trials` hold objective measures by code name, `spread` their standard deviations in the population (see [`maveric_domain::spread`]).
/// Only the scales that [`Effects::ratings`] knows are asked. Each answer depends on the seed, the person, the condition (and session and
/// trial, where there are several) and the subscale alone.
///
/// # Errors
/// [`ParticipantError::BadTrial`] for a ride given twice or one driven by hand; [`ParticipantError::BadMeasure`];
/// [`ParticipantError::BadSetting`], [`ParticipantError::UnknownSubscale`], [`ParticipantError::ItemTwice`],
/// [`ParticipantError::ItemWithoutModel`] or [`ParticipantError::Domain`] where effects or scales do not fit.
///
/// # Source
/// Method section 7; the formula is at [`RatingModel`].
pub fn rate<R: Into<Ride> + Copy>(
    participant: &Participant,
    own: &MeasureValues,
    trials: &[(R, MeasureValues)],
    spread: &BTreeMap<String, f64>,
    scales: &[Scale],
    effects: &Effects,
    seed: u64,
) -> Result<Rated, ParticipantError> {
    effects.check()?;
    covered(scales, &effects.ratings)?;
    check_measures(participant, own)?;
    let mut seen = BTreeSet::new();
    let mut sat_through = Vec::new();
    let rides = trials.iter().map(|(ride, values)| {
        let ride: Ride = (*ride).into();
        (ride, ride.to_string(), values)
    });
    let rides: Vec<(Ride, String, &MeasureValues)> = rides.collect();
    for (ride, label, values) in &rides {
        check_measures(participant, values)?;
        let ride = *ride;
        let condition = ride.condition;
        let bad = |problem| {
            Err(ParticipantError::BadTrial {
                participant: participant.id.clone(),
                condition,
                problem,
            })
        };
        let Some(place) = participant.order.iter().position(|c| *c == condition) else {
            return bad("is none that they sat through");
        };
        if !seen.insert(ride) {
            return bad("is given twice");
        }
        let trial = Trial {
            participant,
            ride,
            label,
            place: place as f64 - (participant.order.len() as f64 - 1.0) / 2.0,
            own,
            values,
            spread,
        };
        let judged = trial.impression(effects, seed);
        sat_through.push((place, trial, judged));
    }
    let mut rated = Rated::default();
    for (place, trial, (impression, missing)) in &sat_through {
        let before = |(p, before, _): &&(usize, Trial<'_>, _)| {
            p + 1 == *place && before.ride.occasion == trial.ride.occasion
        };
        let before = sat_through.iter().find(before);
        let left = before.map(|(_, _, (impression, _))| impression);
        let judged = (impression, left, missing.as_slice());
        trial.rate(scales, effects, seed, judged, &mut rated);
    }
    Ok(rated)
}

fn check_measures(
    participant: &Participant,
    values: &MeasureValues,
) -> Result<(), ParticipantError> {
    for (measure, value) in values {
        if let Some(found) = value.filter(|v| !v.is_finite()) {
            return Err(ParticipantError::BadMeasure {
                participant: participant.id.clone(),
                measure: measure.clone(),
                found,
            });
        }
    }
    Ok(())
}

impl Trial<'_> {
    /// Adds the answers to every scale that is rated, by what the person made of this trial and of the one before it.
    fn rate(
        &self,
        scales: &[Scale],
        effects: &Effects,
        seed: u64,
        (impression, before, missing): (&Impression, Option<&Impression>, &[String]),
        rated: &mut Rated,
    ) {
        if !missing.is_empty() {
            rated.warnings.push(RatingWarning {
                participant: self.participant.id.clone(),
                condition: self.ride.condition,
                measures: missing.to_vec(),
            });
        }
        for scale in scales {
            if let Some(models) = effects.ratings.get(&scale.id) {
                let answers = self.answers(scale, models, (impression, before), effects, seed);
                rated.answers.extend(answers);
            }
        }
    }

    fn answers(
        &self,
        scale: &Scale,
        models: &BTreeMap<String, RatingModel>,
        (impression, before): (&Impression, Option<&Impression>),
        effects: &Effects,
        seed: u64,
    ) -> Vec<Answer> {
        let id = self.participant.id.as_str();
        let mut answers = Vec::new();
        for (name, model) in models {
            let Ok(subscale) = subscale_of(scale, name) else {
                continue; // checked before any trial
            };
            let labels = [id, "rating", scale.id.as_str(), name.as_str()];
            let habit = normal(&mut stream(seed, &labels));
            let mut rng = stream(seed, &[id, "rating", &scale.id, name, self.label]);
            let left = before.map_or(0.0, |before| model.with_drive(0.0, before));
            let latent = model.latent(impression)
                + model.carry_over * left
                + model.person_sd * habit
                + model.noise_sd * normal(&mut rng);
            for &item in &subscale.items {
                let Some(asked) = scale.item(item) else {
                    continue; // checked when the scale was read
                };
                let scored = grade(asked, latent + model.item_sd * normal(&mut rng));
                let given = as_given(scale, subscale, item, scored);
                answers.push(Answer {
                    participant: self.participant.id.clone(),
                    moment: Moment::After(self.ride),
                    scale: scale.id.clone(),
                    item,
                    answer: maybe_left_out(&mut rng, effects.missing_rate, given),
                });
            }
        }
        answers.sort_by_key(|a| a.item);
        answers
    }
}

impl RatingModel {
    /// A rating, and what the car did to it.
    fn with_drive(&self, rating: f64, i: &Impression) -> f64 {
        rating
            + self.preference * i.fit
            + self.homophily * i.likeness
            + self.shift * i.shift
            + self.distance * i.distance
    }

    fn latent(&self, i: &Impression) -> f64 {
        self.with_drive(self.mean, i)
            + self.order * i.place
            + (self.liking + self.halo_condition) * i.halo_condition
            + self.halo_person * i.halo_person
    }
}

#[cfg(test)]
mod tests;
