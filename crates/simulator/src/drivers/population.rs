//! How latent traits become driving parameters: the table of calibration section 2.

use super::{
    bounds,
    habit::{check_bounds, latent, people},
};
use crate::{
    error::SimulatorError,
    normal::normal_of,
    scenario::setting::{Range, Value, check, settings},
};
use maveric_domain::{LatentTraits, MetresPerSecond};
use serde::{Deserialize, Serialize};

/// How one parameter depends on the latents, a person's own part and the day.
///
/// With z = `a`·aggressiveness + `b`·spacing + `c`·pace + `own`·e, where e ~ N(0, 1) belongs to this person
/// and this parameter alone, and n ~ N(0, 1) to the day: `centre` + `scale`·z + `day`·n where the parameter
/// is additive, `centre`·exp(`scale`·z + `day`·n) where it is exponential; [`Population`] says which is which.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Law {
    /// Value of the average person, in the parameter's unit.
    pub centre: f64,
    /// Spread: in the parameter's unit if additive, of its logarithm if exponential.
    pub scale: f64,
    /// Loading of aggressiveness.
    pub a: f64,
    /// Loading of spacing.
    pub b: f64,
    /// Loading of pace.
    pub c: f64,
    /// Loading of the own part.
    pub own: f64,
    /// SD from day to day.
    pub day: f64,
    /// Lowest value.
    pub lowest: f64,
    /// Highest value.
    pub highest: f64,
}

impl Value for Law {
    fn check(&self, name: &str, range: Range) -> Result<(), SimulatorError> {
        check_bounds(name, [self.lowest, self.highest], range)?;
        for (key, number, range) in [
            ("centre", self.centre, Range::Finite),
            ("scale", self.scale, Range::Finite),
            ("a", self.a, Range::Finite),
            ("b", self.b, Range::Finite),
            ("c", self.c, Range::Finite),
            ("own", self.own, Range::Finite),
            ("day", self.day, Range::NotNegative),
        ] {
            check(&format!("{name}.{key}"), number, range)?;
        }
        Ok(())
    }
}

settings! {
    /// How a driver differs from one encounter to the next, and from moment to moment.
    #[derive(Copy)]
    pub struct EncounterNoise {
        /// SD of the logarithm of the time gap at which a pass starts, per encounter.
        passing_time_gap_log_sd: f64 = 0.16, 0.0..=2.0;
        /// SD of the speed gain needed, per encounter.
        passing_gain_sd_mps: f64 = 0.2, 0.0..=2.0;
        /// How fast the gain needed falls while behind the lead.
        passing_gain_falls_mps2: f64 = 0.015, 0.0..=2.0;
        /// SD of the logarithm of the merge-back time gap, per pass.
        merge_back_log_sd: f64 = 0.16, 0.0..=2.0;
        /// Reaction delay.
        delay_s: f64 = 0.5, bounds::DELAY_S;
        /// SD of the relative error of perceived gaps.
        gap_error_sd: f64 = 0.06, bounds::GAP_ERROR_SD;
        /// Correlation time of that error.
        gap_error_time_s: f64 = 2.0, Range::Positive;
        /// SD of the wander of the desired speed.
        speed_wander_sd_mps: f64 = 0.4, 0.0..=2.0;
        /// Correlation time of that wander.
        speed_wander_time_s: f64 = 20.0, Range::Positive;
    }
}

fn law(centre: f64, scale: f64, loadings: [f64; 4], day: f64, range: [f64; 2]) -> Law {
    let [a, b, c, own] = loadings;
    let [lowest, highest] = range;
    Law { centre, scale, a, b, c, own, day, lowest, highest }
}

people! {
    /// How one synthetic person drives on one day: drawn from a [`Population`], or written by hand and checked before the drive.
    pub struct DriverParams;

    /// The population of synthetic drivers.
    ///
    /// The law of the speed wanted is additive; its `day` is relative and applied last.
    ///
    /// # Source
    /// Method section 7 (ours); every number from calibration section 2.
    pub struct Population of Law;

    desired_speed = law(66.5, 6.3, [0.58, 0.15, 0.70, 0.38], 0.012, [53.0, 84.0]);
    habits {
        /// Time gap at which a pass starts.
        passing_time_gap_s = law(2.05, 0.32, [-0.70, 0.62, 0.20, 0.28], 0.05, [0.8, 3.6]), 0.7..=10.0, exponential("passing_time_gap");
        /// Speed gain needed to pass.
        passing_gain_mps = law(2.2, 1.2, [-0.62, 0.0, -0.65, 0.43], 0.1, [0.3, 3.2]), 0.0..=20.0, additive("passing_gain");
        /// Time gap to the vehicle passed at which merging back starts.
        merge_back_time_gap_s = law(1.38, 0.33, [-0.67, 0.25, 0.60, 0.36], 0.05, [0.55, 3.4]), 0.5..=10.0, exponential("merge_back_time_gap");
        /// Time gap kept while following.
        following_time_gap_s = law(1.1, 0.28, [0.0, 0.90, 0.0, 0.43], 0.05, [0.7, 3.0]), bounds::FOLLOWING_TIME_GAP_S, exponential("following_time_gap");
        /// IDM acceleration.
        acceleration_mps2 = law(1.4, 0.12, [0.0, 0.0, 0.0, 1.0], 0.0, [0.8, 2.5]), bounds::ACCELERATION_MPS2, exponential("acceleration");
        /// Speed added while passing.
        passing_speed_added_mps = law(0.5, 1.0, [0.0, 0.0, -0.8, 0.2], 0.0, [-0.6, 6.0]), bounds::PASSING_SPEED_ADDED_MPS, additive("passing_speed_added");
        /// Least speed over the vehicle passed.
        passing_speed_over_lead_mps = law(2.3, 1.0, [0.0, 0.0, -0.6, 0.15], 0.0, [1.2, 6.0]), bounds::PASSING_SPEED_OVER_LEAD_MPS, additive("passing_speed_over_lead");
        /// Duration of a lane change.
        lane_change_s = law(4.8, 0.1, [0.0, 0.0, 0.0, 1.0], 0.0, [3.3, 7.0]), bounds::LANE_CHANGE_S, exponential("lane_change");
    }
    everybody {
        /// IDM gap at standstill.
        standstill_m: f64 = 2.0, bounds::STANDSTILL_M;
        /// IDM comfortable braking.
        braking_mps2: f64 = 2.5, bounds::BRAKING_MPS2;
        /// What changes from encounter to encounter.
        noise: EncounterNoise = EncounterNoise::default();
    }
}

struct Draw {
    traits: LatentTraits,
    person_seed: u64,
    day_seed: u64,
}

impl Draw {
    fn z(&self, name: &str, law: &Law) -> f64 {
        law.a * latent(self.traits.aggressiveness)
            + law.b * latent(self.traits.spacing)
            + law.c * latent(self.traits.pace)
            + law.own * normal_of(self.person_seed, &["own", name])
    }

    fn day(&self, name: &str, law: &Law) -> f64 {
        law.day * normal_of(self.day_seed, &["day", name])
    }

    fn additive(&self, name: &str, law: &Law) -> f64 {
        let value = law.centre + law.scale * self.z(name, law) + self.day(name, law);
        value.clamp(law.lowest, law.highest)
    }

    fn exponential(&self, name: &str, law: &Law) -> f64 {
        let value = law.centre * libm::exp(law.scale * self.z(name, law) + self.day(name, law));
        value.clamp(law.lowest, law.highest)
    }

    fn desired_speed_mps(&self, law: &Law) -> f64 {
        let name = "desired_speed";
        let usual = (law.centre + law.scale * self.z(name, law)).clamp(law.lowest, law.highest);
        let today = (1.0 + self.day(name, law)).clamp(0.8, 1.2);
        MetresPerSecond::from_mph(usual * today).0
    }
}

impl DriverParams {
    /// Draws a person of the calibrated population; see [`Population::draw`].
    pub fn draw(traits: &LatentTraits, person_seed: u64, day_seed: u64) -> Self {
        Population::default().draw(traits, person_seed, day_seed)
    }
}

impl Population {
    /// The person with these latent traits and this `person_seed`, on the day `day_seed`.
    ///
    /// The same person on two days differs by the day's noise only. Each parameter has a stream of its own, so a
    /// further parameter changes no other. A latent beyond ±10 is taken as ±10, one that is not a number as 0.
    ///
    /// # Source
    /// Calibration section 2.
    pub fn draw(&self, traits: &LatentTraits, person_seed: u64, day_seed: u64) -> DriverParams {
        self.person(&Draw { traits: *traits, person_seed, day_seed })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::setting::check_section;

    const CALM: LatentTraits = LatentTraits { aggressiveness: -1.9, spacing: 0.3, pace: 0.2 };

    #[test]
    fn the_same_person_on_the_same_day_is_the_same() {
        assert_eq!(DriverParams::draw(&CALM, 1, 2), DriverParams::draw(&CALM, 1, 2));
        assert_ne!(DriverParams::draw(&CALM, 1, 2), DriverParams::draw(&CALM, 1, 3));
        assert_ne!(DriverParams::draw(&CALM, 1, 2), DriverParams::draw(&CALM, 2, 2));
    }

    #[test]
    fn the_same_person_in_an_aggressive_role_is_faster_and_closer() {
        let wild = LatentTraits { aggressiveness: 1.9, ..CALM };
        let (calm, wild) = (DriverParams::draw(&CALM, 1, 2), DriverParams::draw(&wild, 1, 2));
        assert!(wild.desired_speed_mps > calm.desired_speed_mps + 4.0);
        assert!(wild.passing_time_gap_s < calm.passing_time_gap_s);
        assert!(wild.merge_back_time_gap_s < calm.merge_back_time_gap_s);
    }

    #[test]
    fn the_table_of_calibration_holds_over_a_thousand_people() {
        let speeds: Vec<f64> = (0..1000)
            .map(|seed| {
                let normal = |name| normal_of(seed, &["test", name]);
                let traits = LatentTraits {
                    aggressiveness: normal("a"),
                    spacing: normal("b"),
                    pace: normal("c"),
                };
                DriverParams::draw(&traits, seed, seed).desired_speed().mph()
            })
            .collect();
        let mean = speeds.iter().sum::<f64>() / 1000.0;
        let sd = (speeds.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / 999.0).sqrt();
        assert!((mean - 66.5).abs() < 0.7, "{mean}");
        assert!((sd - 6.3).abs() < 0.5, "{sd}");
    }

    #[test]
    fn a_driver_written_by_hand_is_checked_by_key() {
        let mut driver = DriverParams::draw(&CALM, 1, 2);
        assert!(check_section("driver", &driver).is_ok());
        driver.noise.delay_s = 3.0;
        let error = check_section("driver", &driver).unwrap_err().to_string();
        assert!(error.contains("driver.noise.delay_s"), "{error}");
        driver.lane_change_s = f64::NAN;
        let error = check_section("driver", &driver).unwrap_err().to_string();
        assert!(error.contains("driver.lane_change_s"), "{error}");
    }

    #[test]
    fn latents_that_are_no_numbers_give_a_driver_all_the_same() {
        let odd = LatentTraits { aggressiveness: f64::NAN, spacing: f64::INFINITY, pace: -1e300 };
        let driver = DriverParams::draw(&odd, 1, 1);
        assert!(driver.desired_speed_mps.is_finite() && driver.merge_back_time_gap_s >= 0.55);
    }
}
