//! How five latents become the parameters of such a person.

use super::params::EvidenceParams;
use crate::drivers::bounds::{self, Bounds};
use crate::{
    error::SimulatorError,
    normal::standard_normal,
    scenario::{SettingRange, check_setting},
};
use maveric_domain::{LatentTraits, MetresPerSecond, stream_seed};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use serde::{Deserialize, Serialize};

/// Latents beyond this are taken as this.
const LATENT_LIMIT: f64 = 10.0;

/// How one parameter depends on the latents, by loadings that bend at the average person.
///
/// With z = `centre` + Σ loading·latent + `own`·e + `day`·n, where a latent below 0 has the first of its two loadings and one
/// above 0 the second, e ~ N(0, 1) belongs to person and parameter and n ~ N(0, 1) to the day: `lowest` + (`highest` - `lowest`) /
/// (1 + exp(-z)).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BentLaw {
    /// Value that is approached far below the average, in the parameter's unit.
    pub lowest: f64,
    /// Value that is approached far above the average.
    pub highest: f64,
    /// z of the average person.
    pub centre: f64,
    /// Loadings of aggressiveness, below and above its average.
    #[serde(default)]
    pub aggressiveness: [f64; 2],
    /// Loadings of spacing.
    #[serde(default)]
    pub spacing: [f64; 2],
    /// Loadings of pace.
    #[serde(default)]
    pub pace: [f64; 2],
    /// Loadings of patience, the fourth latent.
    #[serde(default)]
    pub patience: [f64; 2],
    /// Loadings of looseness, the fifth: how loosely a person keeps what they mean to keep.
    #[serde(default)]
    pub looseness: [f64; 2],
    /// Loading of the own part.
    pub own: f64,
    /// SD of z from day to day.
    pub day: f64,
}

/// A population of people who act on evidence.
///
/// Every key but the last three is the law of a field of [`EvidenceParams`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EvidencePopulation {
    /// In mph.
    pub desired_speed_mph: BentLaw,
    /// Without unit.
    pub threshold: BentLaw,
    /// In s.
    pub memory_s: BentLaw,
    /// In s.
    pub waiting_s: BentLaw,
    /// In m.
    pub merge_back_gap_m: BentLaw,
    /// In s.
    pub merge_back_hold_s: BentLaw,
    /// A share.
    pub hurry: BentLaw,
    /// In s.
    pub following_time_gap_s: BentLaw,
    /// In m.
    pub standstill_m: BentLaw,
    /// A share of the gap.
    pub gap_wander_sd: BentLaw,
    /// In m/s.
    pub speed_wander_sd_mps: BentLaw,
    /// In m/s².
    pub acceleration_mps2: BentLaw,
    /// In m/s.
    pub passing_speed_added_mps: BentLaw,
    /// In m/s.
    pub passing_speed_over_lead_mps: BentLaw,
    /// In s.
    pub lane_change_s: BentLaw,
    /// Without unit.
    pub lateness: BentLaw,
    /// In m.
    pub lane_offset_m: BentLaw,
    /// In m.
    pub weave_sd_m: BentLaw,
    /// In m.
    pub peek_m: BentLaw,
    /// Comfortable braking of everybody, in m/s².
    pub braking_mps2: f64,
    /// Reaction delay of everybody, in s.
    pub delay_s: f64,
    /// SD of everybody's relative error of perceived gaps.
    pub gap_error_sd: f64,
}

struct Draw {
    latents: [f64; 5],
    person_seed: u64,
    day_seed: u64,
}

fn normal(seed: u64, kind: &str, name: &str) -> f64 {
    standard_normal(&mut Pcg64Mcg::seed_from_u64(stream_seed(
        seed,
        &["evidence", kind, name],
    )))
}

impl Draw {
    fn of(&self, name: &str, law: &BentLaw) -> f64 {
        let loadings = [
            law.aggressiveness,
            law.spacing,
            law.pace,
            law.patience,
            law.looseness,
        ];
        let shared: f64 = loadings
            .iter()
            .zip(self.latents)
            .map(|([below, above], latent)| below * latent.min(0.0) + above * latent.max(0.0))
            .sum();
        let z = law.centre
            + shared
            + law.own * normal(self.person_seed, "own", name)
            + law.day * normal(self.day_seed, "day", name);
        law.lowest + (law.highest - law.lowest) / (1.0 + libm::exp(-z))
    }
}

impl EvidencePopulation {
    /// The person with these latent traits and this `person_seed`, on the day `day_seed`.
    ///
    /// Patience and looseness, which belong to no questionnaire, are drawn from `person_seed`. A latent beyond ±10 is taken as
    /// ±10, one that is not a number as 0.
    pub fn draw(&self, traits: &LatentTraits, person_seed: u64, day_seed: u64) -> EvidenceParams {
        let latents = [
            traits.aggressiveness,
            traits.spacing,
            traits.pace,
            normal(person_seed, "latent", "patience"),
            normal(person_seed, "latent", "looseness"),
        ];
        let draw = Draw {
            latents: latents.map(|z| {
                if z.is_nan() {
                    0.0
                } else {
                    z.clamp(-LATENT_LIMIT, LATENT_LIMIT)
                }
            }),
            person_seed,
            day_seed,
        };
        let mph = draw.of("desired_speed", &self.desired_speed_mph);
        EvidenceParams {
            desired_speed_mps: MetresPerSecond::from_mph(mph).0,
            threshold: draw.of("threshold", &self.threshold),
            memory_s: draw.of("memory", &self.memory_s),
            waiting_s: draw.of("waiting", &self.waiting_s),
            merge_back_gap_m: draw.of("merge_back_gap", &self.merge_back_gap_m),
            merge_back_hold_s: draw.of("merge_back_hold", &self.merge_back_hold_s),
            hurry: draw.of("hurry", &self.hurry),
            following_time_gap_s: draw.of("following_time_gap", &self.following_time_gap_s),
            standstill_m: draw.of("standstill", &self.standstill_m),
            gap_wander_sd: draw.of("gap_wander", &self.gap_wander_sd),
            speed_wander_sd_mps: draw.of("speed_wander", &self.speed_wander_sd_mps),
            acceleration_mps2: draw.of("acceleration", &self.acceleration_mps2),
            passing_speed_added_mps: draw.of("passing_speed_added", &self.passing_speed_added_mps),
            passing_speed_over_lead_mps: draw
                .of("passing_speed_over_lead", &self.passing_speed_over_lead_mps),
            lane_change_s: draw.of("lane_change", &self.lane_change_s),
            lateness: draw.of("lateness", &self.lateness),
            lane_offset_m: draw.of("lane_offset", &self.lane_offset_m),
            weave_sd_m: draw.of("weave", &self.weave_sd_m),
            peek_m: draw.of("peek", &self.peek_m),
            braking_mps2: self.braking_mps2,
            delay_s: self.delay_s,
            gap_error_sd: self.gap_error_sd,
        }
    }

    /// The laws with their keys and the range that a law may span.
    fn laws(&self) -> [(Bounds, &BentLaw); 19] {
        [
            (bounds::DESIRED_SPEED_MPH, &self.desired_speed_mph),
            (bounds::THRESHOLD, &self.threshold),
            (bounds::MEMORY_S, &self.memory_s),
            (bounds::WAITING_S, &self.waiting_s),
            (bounds::MERGE_BACK_GAP_M, &self.merge_back_gap_m),
            (bounds::MERGE_BACK_HOLD_S, &self.merge_back_hold_s),
            (bounds::HURRY, &self.hurry),
            (bounds::FOLLOWING_TIME_GAP_S, &self.following_time_gap_s),
            (bounds::STANDSTILL_M, &self.standstill_m),
            (bounds::GAP_WANDER_SD, &self.gap_wander_sd),
            (bounds::SPEED_WANDER_SD_MPS, &self.speed_wander_sd_mps),
            (bounds::ACCELERATION_MPS2, &self.acceleration_mps2),
            (
                bounds::PASSING_SPEED_ADDED_MPS,
                &self.passing_speed_added_mps,
            ),
            (
                bounds::PASSING_SPEED_OVER_LEAD_MPS,
                &self.passing_speed_over_lead_mps,
            ),
            (bounds::LANE_CHANGE_S, &self.lane_change_s),
            (bounds::LATENESS, &self.lateness),
            (bounds::LANE_OFFSET_M, &self.lane_offset_m),
            (bounds::WEAVE_SD_M, &self.weave_sd_m),
            (bounds::PEEK_M, &self.peek_m),
        ]
    }

    pub(crate) fn check(&self) -> Result<(), SimulatorError> {
        for (bounds, law) in self.laws() {
            let section = format!("evidence.{}", bounds.0);
            check_setting(&section, "lowest", law.lowest, bounds.range(None))?;
            check_setting(
                &section,
                "highest",
                law.highest,
                bounds.range(Some(law.lowest)),
            )?;
            for (key, pair) in [
                ("aggressiveness", law.aggressiveness),
                ("spacing", law.spacing),
                ("pace", law.pace),
                ("patience", law.patience),
                ("looseness", law.looseness),
                ("centre", [law.centre; 2]),
                ("own", [law.own; 2]),
            ] {
                for found in pair {
                    check_setting(&section, key, found, SettingRange::Finite)?;
                }
            }
            check_setting(&section, "day", law.day, SettingRange::NotNegative)?;
        }
        for (bounds, found) in [
            (bounds::BRAKING_MPS2, self.braking_mps2),
            (bounds::DELAY_S, self.delay_s),
            (bounds::GAP_ERROR_SD, self.gap_error_sd),
        ] {
            check_setting("evidence", bounds.0, found, bounds.range(None))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drivers::People;

    fn population() -> Box<EvidencePopulation> {
        let text = maveric_data::POPULATION_MISSPECIFIED;
        match toml::from_str(text).unwrap() {
            People::Evidence(population) => population,
            People::Drivers(_) => panic!("the file has people of the usual kind"),
        }
    }

    #[test]
    fn the_same_person_is_the_same_and_another_day_moves_a_little() {
        let (p, traits) = (population(), LatentTraits::default());
        assert_eq!(p.draw(&traits, 1, 2), p.draw(&traits, 1, 2));
        let spread = |day: fn(u64) -> u64, person: fn(u64) -> u64| {
            let gaps = |i| p.draw(&traits, person(i), day(i)).merge_back_gap_m;
            let values: Vec<f64> = (0..400).map(gaps).collect();
            let mean = values.iter().sum::<f64>() / 400.0;
            values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 399.0
        };
        let (days, people) = (spread(|i| i, |_| 1), spread(|_| 1, |i| i));
        assert!(days > 0.0 && days < 0.5 * people, "{days} {people}");
    }

    #[test]
    fn a_loading_bends_at_the_average() {
        let p = population();
        let speed = |a| {
            let traits = LatentTraits {
                aggressiveness: a,
                ..LatentTraits::default()
            };
            p.draw(&traits, 1, 1).desired_speed_mps
        };
        let (down, up) = (speed(0.0) - speed(-1.0), speed(1.0) - speed(0.0));
        assert!(down > 0.0 && up > 1.3 * down, "{down} {up}");
    }

    #[test]
    fn odd_latents_stay_within_their_laws_and_odd_laws_are_refused() {
        let p = population();
        let odd = LatentTraits {
            aggressiveness: f64::NAN,
            spacing: f64::INFINITY,
            pace: -1e300,
        };
        let driver = p.draw(&odd, 1, 1);
        let law = &p.following_time_gap_s;
        assert!((law.lowest..=law.highest).contains(&driver.following_time_gap_s));
        let mut wrong = population();
        wrong.weave_sd_m.highest = 3.0;
        let error = wrong.check().unwrap_err().to_string();
        assert!(error.contains("evidence.weave_sd_m.highest"), "{error}");
    }
}
