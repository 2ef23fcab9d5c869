//! One synthetic person on one day.

use super::{
    bounds,
    population::{EncounterNoise, Law, Population},
};
use crate::{error::SimulatorError, normal::standard_normal, scenario::check_setting};
use maveric_domain::{LatentTraits, MetresPerSecond, stream_seed};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use serde::{Deserialize, Serialize};

/// How one synthetic person drives on one day: drawn from a [`Population`], or written by hand and checked before the drive.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriverParams {
    /// Speed wanted on free road, in m/s.
    pub desired_speed_mps: f64,
    /// Time gap at which a pass starts, in s.
    pub passing_time_gap_s: f64,
    /// Speed gain needed to pass, in m/s.
    pub passing_gain_mps: f64,
    /// Time gap to the vehicle passed at which merging back starts, in s.
    pub merge_back_time_gap_s: f64,
    /// Time gap kept while following, in s.
    pub following_time_gap_s: f64,
    /// IDM acceleration, in m/s².
    pub acceleration_mps2: f64,
    /// Speed added while passing, in m/s.
    pub passing_speed_added_mps: f64,
    /// Least speed over the vehicle passed, in m/s.
    pub passing_speed_over_lead_mps: f64,
    /// Duration of a lane change, in s.
    pub lane_change_s: f64,
    /// IDM gap at standstill, in m.
    pub standstill_m: f64,
    /// IDM comfortable braking, in m/s².
    pub braking_mps2: f64,
    /// What changes from encounter to encounter.
    pub noise: EncounterNoise,
}

/// Latents beyond this are taken as this, so that no parameter leaves the finite numbers.
const LATENT_LIMIT: f64 = 10.0;

struct Draw<'a> {
    traits: &'a LatentTraits,
    person_seed: u64,
    day_seed: u64,
}

impl Draw<'_> {
    fn normal(seed: u64, kind: &str, name: &str) -> f64 {
        standard_normal(&mut Pcg64Mcg::seed_from_u64(stream_seed(
            seed,
            &[kind, name],
        )))
    }

    fn z(&self, name: &str, law: &Law) -> f64 {
        let latent = |value: f64| {
            if value.is_nan() {
                0.0
            } else {
                value.clamp(-LATENT_LIMIT, LATENT_LIMIT)
            }
        };
        law.a * latent(self.traits.aggressiveness)
            + law.b * latent(self.traits.spacing)
            + law.c * latent(self.traits.pace)
            + law.own * Self::normal(self.person_seed, "own", name)
    }

    fn day(&self, name: &str, law: &Law) -> f64 {
        law.day * Self::normal(self.day_seed, "day", name)
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
        Population::PAPER.draw(traits, person_seed, day_seed)
    }

    /// Whether every value lies where a person's may.
    ///
    /// # Errors
    /// [`SimulatorError::Setting`] for the first that does not.
    pub fn check(&self) -> Result<(), SimulatorError> {
        for (bounds, found) in [
            (bounds::DESIRED_SPEED_MPS, self.desired_speed_mps),
            (bounds::PASSING_TIME_GAP_S, self.passing_time_gap_s),
            (bounds::PASSING_GAIN_MPS, self.passing_gain_mps),
            (bounds::MERGE_BACK_TIME_GAP_S, self.merge_back_time_gap_s),
            (bounds::FOLLOWING_TIME_GAP_S, self.following_time_gap_s),
            (bounds::ACCELERATION_MPS2, self.acceleration_mps2),
            (
                bounds::PASSING_SPEED_ADDED_MPS,
                self.passing_speed_added_mps,
            ),
            (
                bounds::PASSING_SPEED_OVER_LEAD_MPS,
                self.passing_speed_over_lead_mps,
            ),
            (bounds::LANE_CHANGE_S, self.lane_change_s),
            (bounds::STANDSTILL_M, self.standstill_m),
            (bounds::BRAKING_MPS2, self.braking_mps2),
        ] {
            check_setting("driver", bounds.0, found, bounds.range(None))?;
        }
        self.noise.check("driver.noise")
    }

    /// Speed wanted on free road on this day.
    pub fn desired_speed(&self) -> MetresPerSecond {
        MetresPerSecond(self.desired_speed_mps)
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
        let draw = Draw {
            traits,
            person_seed,
            day_seed,
        };
        DriverParams {
            desired_speed_mps: draw.desired_speed_mps(&self.desired_speed_mph),
            passing_time_gap_s: draw.exponential("passing_time_gap", &self.passing_time_gap_s),
            passing_gain_mps: draw.additive("passing_gain", &self.passing_gain_mps),
            merge_back_time_gap_s: draw
                .exponential("merge_back_time_gap", &self.merge_back_time_gap_s),
            following_time_gap_s: draw
                .exponential("following_time_gap", &self.following_time_gap_s),
            acceleration_mps2: draw.exponential("acceleration", &self.acceleration_mps2),
            passing_speed_added_mps: draw
                .additive("passing_speed_added", &self.passing_speed_added_mps),
            passing_speed_over_lead_mps: draw
                .additive("passing_speed_over_lead", &self.passing_speed_over_lead_mps),
            lane_change_s: draw.exponential("lane_change", &self.lane_change_s),
            standstill_m: self.standstill_m,
            braking_mps2: self.braking_mps2,
            noise: self.noise,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CALM: LatentTraits = LatentTraits {
        aggressiveness: -1.9,
        spacing: 0.3,
        pace: 0.2,
    };

    #[test]
    fn the_same_person_on_the_same_day_is_the_same() {
        assert_eq!(
            DriverParams::draw(&CALM, 1, 2),
            DriverParams::draw(&CALM, 1, 2)
        );
        assert_ne!(
            DriverParams::draw(&CALM, 1, 2),
            DriverParams::draw(&CALM, 1, 3)
        );
        assert_ne!(
            DriverParams::draw(&CALM, 1, 2),
            DriverParams::draw(&CALM, 2, 2)
        );
    }

    #[test]
    fn the_same_person_in_an_aggressive_role_is_faster_and_closer() {
        let wild = LatentTraits {
            aggressiveness: 1.9,
            ..CALM
        };
        let (calm, wild) = (
            DriverParams::draw(&CALM, 1, 2),
            DriverParams::draw(&wild, 1, 2),
        );
        assert!(wild.desired_speed_mps > calm.desired_speed_mps + 4.0);
        assert!(wild.passing_time_gap_s < calm.passing_time_gap_s);
        assert!(wild.merge_back_time_gap_s < calm.merge_back_time_gap_s);
    }

    #[test]
    fn the_table_of_calibration_holds_over_a_thousand_people() {
        let speeds: Vec<f64> = (0..1000)
            .map(|seed| {
                let normal = |name| Draw::normal(seed, "test", name);
                let traits = LatentTraits {
                    aggressiveness: normal("a"),
                    spacing: normal("b"),
                    pace: normal("c"),
                };
                DriverParams::draw(&traits, seed, seed)
                    .desired_speed()
                    .mph()
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
        assert!(driver.check().is_ok());
        driver.noise.delay_s = 3.0;
        let error = driver.check().unwrap_err().to_string();
        assert!(error.contains("driver.noise.delay_s"), "{error}");
        driver.lane_change_s = f64::NAN;
        let error = driver.check().unwrap_err().to_string();
        assert!(error.contains("driver.lane_change_s"), "{error}");
    }

    #[test]
    fn latents_that_are_no_numbers_give_a_driver_all_the_same() {
        let odd = LatentTraits {
            aggressiveness: f64::NAN,
            spacing: f64::INFINITY,
            pace: -1e300,
        };
        let driver = DriverParams::draw(&odd, 1, 1);
        assert!(driver.desired_speed_mps.is_finite() && driver.merge_back_time_gap_s >= 0.55);
    }
}
