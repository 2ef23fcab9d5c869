//! What a person makes of a drive.

use crate::{
    effects::{Effects, weighted},
    person::Participant,
    response::{normal, stream},
};
use maveric_domain::{MeasureValues, Ride};
use std::collections::{BTreeMap, BTreeSet};

/// The shift that a person would like best, in the unit of [`Perception::shift`](crate::effects::Perception::shift): the truth that an
/// estimate of preference is held against.
fn preferred_shift(participant: &Participant, effects: &Effects, seed: u64) -> f64 {
    let draw = normal(&mut stream(seed, &[participant.id.as_str(), "preference"]));
    let by_traits = weighted(participant, &effects.preference.effects);
    effects.preference.intercept + by_traits + effects.preference.own_sd * draw
}

fn homophily(participant: &Participant, effects: &Effects, seed: u64) -> f64 {
    let draw = normal(&mut stream(seed, &[participant.id.as_str(), "homophily"]));
    let by_traits = weighted(participant, &effects.homophily.effects);
    effects.homophily.mean + by_traits + effects.homophily.own_sd * draw
}

/// One person in one condition.
pub(crate) struct Trial<'a> {
    pub(crate) participant: &'a Participant,
    pub(crate) ride: Ride,
    /// What its random choices belong to: the ride's name in a study.
    pub(crate) label: &'a str,
    pub(crate) place: f64,
    pub(crate) own: &'a MeasureValues,
    pub(crate) values: &'a MeasureValues,
    pub(crate) spread: &'a BTreeMap<String, f64>,
}

/// What the person makes of it; shared by all scales.
pub(crate) struct Impression {
    pub(crate) fit: f64,
    pub(crate) likeness: f64,
    pub(crate) shift: f64,
    pub(crate) distance: f64,
    pub(crate) place: f64,
    pub(crate) halo_condition: f64,
    pub(crate) halo_person: f64,
}

/// Differences beyond this many standard deviations look alike.
const LARGEST_DIFFERENCE: f64 = 5.0;

impl Trial<'_> {
    /// Difference of a measure from the own drive, in standard deviations of the population.
    fn difference(&self, measure: &str) -> Option<f64> {
        let sd = self.spread.get(measure).filter(|s| s.is_finite() && **s > 0.0)?;
        let av = self.values.get(measure).copied().flatten()?;
        let by_hand = self.own.get(measure).copied().flatten()?;
        Some(((av - by_hand) / sd).clamp(-LARGEST_DIFFERENCE, LARGEST_DIFFERENCE))
    }

    /// Sum of weight · value over the measures that can be compared, per unit of their weight, times the whole
    /// weight; the others are added to `missing`.
    fn mean_over(
        &self,
        weights: &BTreeMap<String, f64>,
        value: impl Fn(f64) -> f64,
        missing: &mut BTreeSet<String>,
    ) -> f64 {
        let (mut sum, mut compared, mut whole) = (0.0, 0.0, 0.0);
        for (measure, weight) in weights.iter().filter(|(_, w)| **w != 0.0) {
            whole += weight.abs();
            match self.difference(measure) {
                Some(difference) => {
                    sum += weight * value(difference);
                    compared += weight.abs();
                }
                None => {
                    missing.insert(measure.clone());
                }
            }
        }
        if compared > 0.0 { sum * whole / compared } else { 0.0 }
    }

    pub(crate) fn impression(&self, effects: &Effects, seed: u64) -> (Impression, Vec<String>) {
        let id = self.participant.id.as_str();
        let mut rng = stream(seed, &[id, "impression", self.label]);
        let mut missing = BTreeSet::new();
        let perception = &effects.perception;
        let seen = self.mean_over(&perception.shift, |d| d, &mut missing);
        let shift = seen + perception.noise_sd * normal(&mut rng);
        let squares = self.mean_over(&perception.distance, |d| d * d, &mut missing);
        let distance = squares.max(0.0).sqrt();
        let preferred = preferred_shift(self.participant, effects, seed);
        let impression = Impression {
            fit: -(shift - preferred).powi(2),
            likeness: -homophily(self.participant, effects, seed) * distance,
            shift,
            distance,
            place: self.place,
            halo_condition: normal(&mut rng),
            halo_person: normal(&mut stream(seed, &[id, "halo"])),
        };
        (impression, missing.into_iter().collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        cohort::Cohort,
        effects::Perception,
        person::Trait,
        settings::CohortSettings,
        testing::{design, effects, id},
    };

    fn values<const N: usize>(of: [(&str, f64); N]) -> BTreeMap<String, f64> {
        of.map(|(name, v)| (name.to_owned(), v)).into()
    }

    fn measured<const N: usize>(of: [(&str, f64); N]) -> MeasureValues {
        of.map(|(name, v)| (name.to_owned(), Some(v))).into()
    }

    /// Effects without chance: the shift weighs speed by 2 and room by -1, the distance both alike.
    fn certain() -> Effects {
        let mut found = effects();
        found.perception = Perception {
            noise_sd: 0.0,
            shift: values([("speed", 2.0), ("room", -1.0)]),
            distance: values([("speed", 0.5), ("room", 0.5), ("nothing", 0.0)]),
        };
        found.preference.intercept = 0.25;
        found.preference.own_sd = 0.0;
        found.preference.effects = [(Trait::Openness, 0.5)].into();
        found.homophily.mean = 0.75;
        found.homophily.own_sd = 0.0;
        found.homophily.effects = [(Trait::Openness, -0.5)].into();
        found
    }

    #[test]
    fn what_is_made_of_a_drive_is_its_differences_in_spreads_and_the_persons_traits() {
        let effects = certain();
        let cohort = Cohort::draw(0, 1, 1, &CohortSettings::default(), &design()).unwrap();
        let participant = &cohort.participants[0];
        let openness = participant.latent(Trait::Openness);
        let own = measured([("speed", 25.0), ("room", 40.0)]);
        let spread = values([("speed", 2.0), ("room", 10.0)]);
        let made_of = |drive: &MeasureValues| {
            let trial = Trial {
                participant,
                ride: id("mimic").into(),
                label: "mimic",
                place: 0.0,
                own: &own,
                values: drive,
                spread: &spread,
            };
            trial.impression(&effects, 1)
        };
        let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found}");
        // One spread faster, three nearer.
        let (seen, missing) = made_of(&measured([("speed", 27.0), ("room", 10.0)]));
        assert!(missing.is_empty(), "a weight of 0 asks for nothing: {missing:?}");
        near(seen.shift, 2.0 + 3.0);
        near(seen.distance, 5.0_f64.sqrt());
        near(seen.fit, -(5.0 - 0.25 - 0.5 * openness).powi(2));
        near(seen.likeness, -(0.75 - 0.5 * openness) * 5.0_f64.sqrt());
        near(preferred_shift(participant, &effects, 1), 0.25 + 0.5 * openness);
        // What is missing is named, and the rest stands for all of the weight.
        let (seen, missing) = made_of(&measured([("speed", 23.0)]));
        assert_eq!(missing, ["room"]);
        near(seen.shift, -2.0 * 3.0 / 2.0);
        near(seen.distance, 1.0);
        // Beyond five spreads all is alike; without anything to compare nothing is seen.
        near(made_of(&measured([("speed", 99.0), ("room", 40.0)])).0.shift, 10.0);
        near(made_of(&measured([])).0.shift, 0.0);
    }
}
