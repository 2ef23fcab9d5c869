//! One synthetic person on one day.

use super::population::{EncounterNoise, Law, Population};
use maveric_domain::{LatentTraits, MetresPerSecond, stream_seed};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

/// How one synthetic person drives on one day.
///
/// Drawn, not made by hand, so that every value lies in its law's range.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DriverParams {
    pub(crate) desired_speed_mps: f64,
    pub(crate) passing_time_gap_s: f64,
    pub(crate) passing_gain_mps: f64,
    pub(crate) merge_back_time_gap_s: f64,
    pub(crate) following_time_gap_s: f64,
    pub(crate) acceleration_mps2: f64,
    pub(crate) passing_speed_added_mps: f64,
    pub(crate) passing_speed_over_lead_mps: f64,
    pub(crate) lane_change_s: f64,
    pub(crate) standstill_m: f64,
    pub(crate) braking_mps2: f64,
    pub(crate) noise: EncounterNoise,
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
        StandardNormal.sample(&mut Pcg64Mcg::seed_from_u64(stream_seed(
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
        let value = law.centre * (law.scale * self.z(name, law) + self.day(name, law)).exp();
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
