//! How strongly things hang together: one file.

use crate::{
    error::{ParticipantError, within},
    person::{Participant, Trait},
    presses::PressModel,
};
use maveric_domain::{Design, Scale};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Loadings on latent traits, by name.
pub type Loadings = BTreeMap<Trait, f64>;

pub(crate) fn weighted(participant: &Participant, loadings: &Loadings) -> f64 {
    let terms = loadings.iter();
    terms.map(|(name, loading)| loading * participant.latent(*name)).sum()
}

/// Sizes of everything that synthetic people answer and rate by; `study_data/effects.toml`.
///
/// Some numbers are *effects*: they tie answers or ratings to a person's traits or to what the car did.
/// The others are means and noise. [`Effects::without_effects`] sets the former to zero.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Effects {
    /// Share of items left out, 0 to below 1.
    pub missing_rate: f64,
    pub adb: AdbModel,
    /// The other scales answered before the drives: scale → subscale → model.
    pub answers: BTreeMap<String, BTreeMap<String, FactorModel>>,
    /// How people perceive what the car does.
    pub perception: Perception,
    pub preference: Preference,
    /// How much people mind that the car drives unlike themselves.
    pub homophily: Homophily,
    /// The scales answered after each condition: scale → subscale → model.
    pub ratings: BTreeMap<String, BTreeMap<String, RatingModel>>,
    /// When people press "uncomfortable" on a ride; nobody does without.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub presses: Option<PressModel>,
}

/// The ADB total: `mean + sd · (loading · a + √(1 − loading²) · noise)`, rounded and clamped to the scale.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AdbModel {
    pub mean_points: f64,
    /// Standard deviation of the total, in points.
    pub sd_points: f64,
    /// Effect: correlation of the total with aggressiveness, −1 to 1.
    pub aggressiveness: f64,
    /// Scatter of the items around their mean, in points.
    pub item_sd: f64,
}

/// A subscale answered before the drives; how its answers are spread is in the scale's norms.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FactorModel {
    /// Effects: loadings of the factor on traits; their squares add up to at most 1.
    #[serde(default)]
    pub loadings: Loadings,
}

/// How what the car does becomes two numbers for the person in it.
///
/// Differences from the person's own drive count in standard deviations of the population. The *shift* says how much more
/// aggressive the drive is, the *distance* how different (root of the weighted squares). Both are sums with the weights given here,
/// by the code name of the measure; a measure without a value in either drive is left out and the other weights rescaled.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Perception {
    /// Standard deviation of what people misperceive of the shift.
    pub noise_sd: f64,
    /// Effects: weights of the shift; negative where less is more aggressive.
    pub shift: BTreeMap<String, f64>,
    /// Effects: weights of the squared differences in the distance, not negative.
    pub distance: BTreeMap<String, f64>,
}

/// The shift that a person would like best, in the unit of [`Perception::shift`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Preference {
    pub intercept: f64,
    /// Standard deviation of what no trait explains.
    pub own_sd: f64,
    /// Effects: change per standard deviation of a trait.
    #[serde(default)]
    pub effects: Loadings,
}

/// How much a person minds distance from their own style, per standard deviation of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Homophily {
    pub mean: f64,
    /// Standard deviation of what no trait explains.
    pub own_sd: f64,
    /// Effects: change per standard deviation of a trait.
    #[serde(default)]
    pub effects: Loadings,
}

/// A subscale answered after each condition; every number is in points of its scale.
///
/// The latent rating of a person in a condition is `mean + preference · fit + homophily · likeness + shift · A + distance · D + order · place + liking · H
/// + halo_condition · H + halo_person · P + carry_over · (preference · fit + … + distance · D of the drive before) + noise`, with A and D as perceived (see [`Perception`]), `fit = −(A − preferred shift)²`, `likeness = −h · D`, h as in
/// [`Homophily`], place −1.5 to 1.5 in the order of the trials, and H, P drawn once a person and condition, and once a person.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RatingModel {
    pub mean: f64,
    /// Effect of the fit to the preferred style.
    #[serde(default)]
    pub preference: f64,
    /// Effect of likeness to the own style.
    #[serde(default)]
    pub homophily: f64,
    /// Effect of the perceived shift itself.
    #[serde(default)]
    pub shift: f64,
    /// Effect of the perceived distance itself.
    #[serde(default)]
    pub distance: f64,
    /// Effect of the place in the order of the trials.
    #[serde(default)]
    pub order: f64,
    /// Effect: the share of what the drive before did to its rating that is left in this one.
    #[serde(default)]
    pub carry_over: f64,
    /// Effect of the condition's halo on a scale that is not about regard: what people like they call similar.
    #[serde(default)]
    pub liking: f64,
    /// Halo shared by all ratings of a person.
    #[serde(default)]
    pub halo_person: f64,
    /// Halo shared by the ratings of a person in a condition.
    #[serde(default)]
    pub halo_condition: f64,
    /// Standard deviation of a person's own habit with this scale.
    pub person_sd: f64,
    /// Standard deviation of what is left in a person and condition.
    pub noise_sd: f64,
    pub item_sd: f64,
}

impl Effects {
    /// The same people without any effect: ratings know nothing of condition, order or person, questionnaires nothing of traits, and
    /// no halo ties ratings together. Means and noise stay, a person's habit with a scale among it.
    ///
    /// # Source
    /// Method section 7: with all effects zero, no more significant results than chance.
    #[must_use]
    pub fn without_effects(&self) -> Self {
        let mut null = self.clone();
        null.adb.aggressiveness = 0.0;
        for model in null.answers.values_mut().flat_map(BTreeMap::values_mut) {
            model.loadings.clear();
        }
        null.perception.shift.values_mut().for_each(|w| *w = 0.0);
        null.perception.distance.values_mut().for_each(|w| *w = 0.0);
        null.preference.intercept = 0.0;
        null.preference.effects.clear();
        null.homophily.mean = 0.0;
        null.homophily.effects.clear();
        for model in null.ratings.values_mut().flat_map(BTreeMap::values_mut) {
            (model.preference, model.homophily) = (0.0, 0.0);
            (model.shift, model.distance) = (0.0, 0.0);
            (model.order, model.liking) = (0.0, 0.0);
            model.carry_over = 0.0;
            (model.halo_person, model.halo_condition) = (0.0, 0.0);
        }
        if let Some(presses) = &mut null.presses {
            presses.causes.clear();
        }
        null
    }

    /// The same people, whose ratings follow what the car did `factor` times as strongly: every effect of a drive on a rating is
    /// multiplied. Order, halo, noise and what questionnaires know of traits stay.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let mut scaled = self.clone();
        for model in scaled.ratings.values_mut().flat_map(BTreeMap::values_mut) {
            for effect in [
                &mut model.preference,
                &mut model.homophily,
                &mut model.shift,
                &mut model.distance,
                &mut model.liking,
            ] {
                *effect *= factor;
            }
        }
        let causes = scaled.presses.iter_mut().flat_map(|p| p.causes.values_mut());
        causes.for_each(|effect| *effect *= factor);
        scaled
    }

    /// The scales that a design asks after a ride and of which no effect is known: they are answered at random.
    pub fn unknown_of<'a>(
        &'a self,
        design: &'a Design,
        scales: &'a [Scale],
    ) -> impl Iterator<Item = &'a Scale> {
        let after = &design.protocol().after;
        let unknown = move |scale: &&Scale| !self.ratings.contains_key(&scale.id);
        let scales = scales.iter().filter(move |scale| after.contains(&scale.id));
        scales.filter(unknown)
    }

    /// Says whether the numbers make sense.
    ///
    /// # Errors
    /// [`ParticipantError::BadSetting`] naming the first key that does not.
    pub fn check(&self) -> Result<(), ParticipantError> {
        within("missing_rate", self.missing_rate, 0.0, 0.99, "0 to 0.99")?;
        finite("adb.mean_points", self.adb.mean_points)?;
        not_negative("adb.sd_points", self.adb.sd_points)?;
        not_negative("adb.item_sd", self.adb.item_sd)?;
        let r = self.adb.aggressiveness;
        within("adb.aggressiveness", r, -1.0, 1.0, "-1 to 1")?;
        for (scale, models) in &self.answers {
            for (subscale, model) in models {
                let explained: f64 = model.loadings.values().map(|l| l * l).sum();
                let key = format!("answers.{scale}.{subscale}.loadings");
                let expected = "squares that add up to at most 1";
                within(&key, explained, 0.0, 1.0 + 1e-9, expected)?;
            }
        }
        not_negative("perception.noise_sd", self.perception.noise_sd)?;
        for (measure, weight) in &self.perception.shift {
            finite(&format!("perception.shift.{measure}"), *weight)?;
        }
        for (measure, weight) in &self.perception.distance {
            not_negative(&format!("perception.distance.{measure}"), *weight)?;
        }
        finite("preference.intercept", self.preference.intercept)?;
        not_negative("preference.own_sd", self.preference.own_sd)?;
        finite("homophily.mean", self.homophily.mean)?;
        not_negative("homophily.own_sd", self.homophily.own_sd)?;
        for (table, effects) in
            [("preference", &self.preference.effects), ("homophily", &self.homophily.effects)]
        {
            for (name, effect) in effects {
                finite(&format!("{table}.effects.{}", name.as_str()), *effect)?;
            }
        }
        for (scale, models) in &self.ratings {
            for (subscale, model) in models {
                model.check(&format!("ratings.{scale}.{subscale}"))?;
            }
        }
        self.presses.as_ref().map_or(Ok(()), PressModel::check)
    }
}

impl RatingModel {
    fn check(&self, table: &str) -> Result<(), ParticipantError> {
        for (field, found) in [
            ("mean", self.mean),
            ("preference", self.preference),
            ("homophily", self.homophily),
            ("shift", self.shift),
            ("distance", self.distance),
            ("order", self.order),
            ("carry_over", self.carry_over),
            ("liking", self.liking),
            ("halo_person", self.halo_person),
            ("halo_condition", self.halo_condition),
        ] {
            finite(&format!("{table}.{field}"), found)?;
        }
        for (field, found) in
            [("person_sd", self.person_sd), ("noise_sd", self.noise_sd), ("item_sd", self.item_sd)]
        {
            not_negative(&format!("{table}.{field}"), found)?;
        }
        Ok(())
    }
}

/// Beyond this a number in the file is a slip of the keyboard, and sums could overflow.
const LARGEST: f64 = 1e6;

fn finite(name: &str, found: f64) -> Result<(), ParticipantError> {
    within(name, found, -LARGEST, LARGEST, "a number of ordinary size")
}

fn not_negative(name: &str, found: f64) -> Result<(), ParticipantError> {
    let expected = "a number of ordinary size, not negative";
    within(name, found, 0.0, LARGEST, expected)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::effects;

    const FILE: &str = maveric_data::EFFECTS;

    #[test]
    fn the_shipped_file_is_valid_and_so_is_its_null() {
        effects().check().unwrap();
        let null = effects().without_effects();
        null.check().unwrap();
        assert_eq!(null.without_effects(), null);
        assert!((null.adb.mean_points - 28.0).abs() < 1e-12);
    }

    #[test]
    fn scaling_multiplies_the_effects_of_a_drive_alone() {
        let (full, half) = (effects(), effects().scaled(0.5));
        let of = |e: &Effects| e.ratings["rosas"]["competence"];
        assert!((of(&half).homophily - 0.5 * of(&full).homophily).abs() < 1e-12);
        assert!((of(&half).halo_person - of(&full).halo_person).abs() < 1e-12);
        assert_eq!(half.answers, full.answers);
        assert_eq!(full.scaled(1.0), full);
    }

    #[test]
    fn a_misspelt_key_or_trait_is_named() {
        for (right, wrong) in [("noise_sd", "noize_sd"), ("openness = 0.2 ", "opennes = 0.2 ")] {
            assert!(FILE.contains(right), "{right}");
            let error = toml::from_str::<Effects>(&FILE.replace(right, wrong)).unwrap_err();
            assert!(error.to_string().contains(wrong.trim_end_matches(" = 0.2 ")), "{error}");
        }
    }

    #[test]
    fn impossible_numbers_are_named_by_their_key() {
        let named = |change: &dyn Fn(&mut Effects), key: &str| {
            let mut effects = effects();
            change(&mut effects);
            let error = effects.check().unwrap_err().to_string();
            assert!(error.contains(key), "{error}");
        };
        named(&|e| e.missing_rate = 1.5, "`missing_rate` is 1.5");
        named(&|e| e.adb.aggressiveness = f64::NAN, "adb.aggressiveness");
        named(&|e| e.homophily.own_sd = -1.0, "homophily.own_sd");
        named(
            &|e| {
                let risky = e.answers.get_mut("mdsi").and_then(|m| m.get_mut("risky"));
                risky.unwrap().loadings.insert(Trait::Pace, 0.95);
            },
            "answers.mdsi.risky.loadings",
        );
        named(
            &|e| {
                let competence = e.ratings.get_mut("rosas").and_then(|m| m.get_mut("competence"));
                competence.unwrap().preference = f64::INFINITY;
            },
            "ratings.rosas.competence.preference",
        );
    }
}
