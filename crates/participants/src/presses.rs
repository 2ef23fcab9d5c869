//! When people press "uncomfortable" on a ride.

use crate::{
    error::{ParticipantError, within},
    response::{normal, stream},
};
use maveric_domain::{
    ParticipantId, Ride,
    press::{PRECURSORS, PressMoment},
};
use rand::RngExt as _;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Most presses a minute: one a second.
const MOST_PER_MINUTE: f64 = 59.0;

/// How often people press, and what makes them.
///
/// The odds of a press in a second are those of the person, `per_minute / 60` on average, times `exp(Σ causes · what came before)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PressModel {
    /// Presses a minute, on average over people, where nothing of the causes is there; above 0, at most 59.
    pub per_minute: f64,
    /// Standard deviation of the logarithm of a person's rate.
    pub person_sd: f64,
    /// Effects: logarithm of the odds ratio for a unit more of what came before (a column of the moments, such as `braking_mps2`).
    #[serde(default)]
    pub causes: BTreeMap<String, f64>,
}

impl PressModel {
    pub(crate) fn check(&self) -> Result<(), ParticipantError> {
        let bad = |name: &str, found, expected| ParticipantError::BadSetting {
            name: name.to_owned(),
            found,
            expected,
        };
        let rate = self.per_minute;
        if !(rate > 0.0 && rate <= MOST_PER_MINUTE) {
            return Err(bad("presses.per_minute", rate, "above 0, at most 59"));
        }
        within("presses.person_sd", self.person_sd, 0.0, 10.0, "0 to 10")?;
        for (cause, effect) in &self.causes {
            let name = format!("presses.causes.{cause}");
            if PRECURSORS.iter().all(|known| known.id != cause) {
                let expected = "a cause that is one of the columns of the moments of a press, such as braking_mps2";
                return Err(bad(&name, *effect, expected));
            }
            within(&name, *effect, -100.0, 100.0, "-100 to 100")?;
        }
        Ok(())
    }
}

/// When somebody presses on a ride whose `seconds` are these, in s since it began. What is not there at a moment has no effect in it. Each ride
/// depends on the seed, the person and the ride alone.
pub fn presses_during<'a>(
    participant: &ParticipantId,
    ride: Ride,
    seconds: impl IntoIterator<Item = &'a PressMoment>,
    model: &PressModel,
    seed: u64,
) -> Vec<f64> {
    let who = participant.as_str();
    let habit = normal(&mut stream(seed, &[who, "presses"]));
    let rate = model.per_minute / 60.0;
    // A person's rate is the mean on average.
    let odds = rate / (1.0 - rate)
        * libm::exp(model.person_sd * habit - 0.5 * model.person_sd * model.person_sd);
    let mut rng = stream(seed, &[who, "presses", &ride.to_string()]);
    let mut pressed = Vec::new();
    for moment in seconds {
        let causes = PRECURSORS.iter().filter_map(|cause| {
            let effect = model.causes.get(cause.id)?;
            Some(effect * (cause.value)(moment)?)
        });
        let odds = odds * libm::exp(causes.sum::<f64>().min(100.0));
        if rng.random_bool((odds / (1.0 + odds)).clamp(0.0, 1.0)) {
            pressed.push(moment.time_s);
        }
    }
    pressed
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::{ConditionId, DriveId};

    fn model(causes: &[(&str, f64)]) -> PressModel {
        let causes = causes.iter().map(|(id, effect)| ((*id).to_owned(), *effect));
        PressModel { per_minute: 0.6, person_sd: 0.0, causes: causes.collect() }
    }

    /// An hour, every second minute of which brakes.
    fn seconds() -> Vec<PressMoment> {
        let second = |t: u32| PressMoment {
            participant: ParticipantId::new("P1").unwrap(),
            condition: ConditionId::new("calm").unwrap(),
            drive: DriveId::new("P1-calm").unwrap(),
            minute: t / 60,
            time_s: f64::from(t) + 0.5,
            pressed: false,
            at_risk: true,
            to_press_s: None,
            least_gap_m: None,
            inverse_time_to_collision_per_s: None,
            braking_mps2: Some(f64::from((t / 60) % 2)),
            jerk_mps3: None,
            lateral_acceleration_mps2: None,
            lane_change: None,
            cut_in: None,
        };
        (0..3600).map(second).collect()
    }

    #[test]
    fn people_press_as_often_as_the_model_says_and_more_where_its_cause_is_there() {
        let (seconds, n) = (seconds(), 200);
        let pressed = |model: &PressModel, braking: u32| {
            let of = |i: u32| {
                let who = ParticipantId::new(format!("P{i}")).unwrap();
                let ride = Ride::from(ConditionId::new("calm").unwrap());
                presses_during(&who, ride, &seconds, model, 7)
            };
            let all = (0..n).flat_map(of);
            all.filter(|t| (*t as u32 / 60) % 2 == braking).count() as f64 / f64::from(n * 30)
        };
        // 200 people in 30 minutes each: the mean of 3,600 presses is off by 1.7 % once in three times.
        let plain = model(&[]);
        assert!((pressed(&plain, 0) - 0.6).abs() < 0.03);
        assert!((pressed(&plain, 1) - 0.6).abs() < 0.03);
        let caused = model(&[("braking_mps2", libm::log(2.0)), ("least_gap_m", 1.0)]);
        assert!((pressed(&caused, 0) - 0.6).abs() < 0.03);
        let odds: f64 = 2.0 * 0.01 / 0.99;
        let expected = 60.0 * odds / (1.0 + odds);
        assert!((pressed(&caused, 1) - expected).abs() < 0.05);
    }

    #[test]
    fn a_rate_that_nobody_can_have_and_a_cause_that_no_moment_has_are_named() {
        let told = |model: PressModel| model.check().unwrap_err().to_string();
        assert!(model(&[("braking_mps2", 0.5)]).check().is_ok());
        assert!(told(model(&[("breaking", 0.5)])).contains("presses.causes.breaking"));
        for per_minute in [0.0, -1.0, 60.0, f64::NAN] {
            let wrong = PressModel { per_minute, ..model(&[]) };
            assert!(told(wrong).contains("presses.per_minute"));
        }
    }
}
