//! Who acts on evidence, and how five latents become the parameters of such a person.

use crate::{
    drivers::{
        bounds,
        habit::{check_bounds, latent, people},
    },
    error::SimulatorError,
    normal::normal_of,
    scenario::setting::{Range, Value, check},
};
use maveric_domain::{LatentTraits, MetresPerSecond};
use serde::{Deserialize, Serialize};

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

impl Value for BentLaw {
    fn check(&self, name: &str, range: Range) -> Result<(), SimulatorError> {
        check_bounds(name, [self.lowest, self.highest], range)?;
        for (key, pair) in [
            ("aggressiveness", self.aggressiveness),
            ("spacing", self.spacing),
            ("pace", self.pace),
            ("patience", self.patience),
            ("looseness", self.looseness),
            ("centre", [self.centre; 2]),
            ("own", [self.own; 2]),
        ] {
            for number in pair {
                check(&format!("{name}.{key}"), number, Range::Finite)?;
            }
        }
        check(&format!("{name}.day"), self.day, Range::NotNegative)
    }
}

people! {
    /// How one person who acts on evidence drives on one day: drawn from an [`EvidencePopulation`], or written by hand and checked
    /// before the drive.
    pub struct EvidenceParams;

    /// A population of people who act on evidence.
    pub struct EvidencePopulation of BentLaw;

    desired_speed;
    habits {
        /// Evidence at which a pass begins.
        threshold, 0.1..=1000.0, bent("threshold");
        /// Time in which evidence is forgotten.
        memory_s, 1.0..=100.0, bent("memory");
        /// Time behind a lead in which the threshold falls to 1/e.
        waiting_s, 1.0..=10_000.0, bent("waiting");
        /// Gap to the vehicle passed at which merging back begins, whatever the speed.
        merge_back_gap_m, 8.0..=200.0, bent("merge_back_gap");
        /// Time for which that gap has to have been there.
        merge_back_hold_s, 0.0..=20.0, bent("merge_back_hold");
        /// Share by which that gap shrinks with somebody close behind in the passing lane.
        hurry, 0.0..=0.9, bent("hurry");
        /// Part of the following gap that grows with speed.
        following_time_gap_s, bounds::FOLLOWING_TIME_GAP_S, bent("following_time_gap");
        /// Part of it that does not.
        standstill_m, bounds::STANDSTILL_M, bent("standstill");
        /// SD of the wander of that gap, relative.
        gap_wander_sd, 0.0..=0.4, bent("gap_wander");
        /// SD of the wander of the desired speed.
        speed_wander_sd_mps, 0.0..=2.0, bent("speed_wander");
        /// Acceleration from standstill.
        acceleration_mps2, bounds::ACCELERATION_MPS2, bent("acceleration");
        /// Speed added while passing.
        passing_speed_added_mps, bounds::PASSING_SPEED_ADDED_MPS, bent("passing_speed_added");
        /// Least speed over the vehicle passed.
        passing_speed_over_lead_mps, bounds::PASSING_SPEED_OVER_LEAD_MPS, bent("passing_speed_over_lead");
        /// Duration of a lane change.
        lane_change_s, bounds::LANE_CHANGE_S, bent("lane_change");
        /// Exponent on the share of a lane change that is over: above 1 the line is crossed late.
        lateness, 0.6..=1.5, bent("lateness");
        /// Where in the lane this person drives, to the left of its centre.
        lane_offset_m, -0.4..=0.4, bent("lane_offset");
        /// SD of the weave around that.
        weave_sd_m, 0.0..=0.2, bent("weave");
        /// How far this person leans out before passing.
        peek_m, 0.0..=0.7, bent("peek");
    }
    everybody {
        /// Comfortable braking.
        braking_mps2: f64, bounds::BRAKING_MPS2;
        /// Reaction delay.
        delay_s: f64, bounds::DELAY_S;
        /// SD of the relative error of perceived gaps.
        gap_error_sd: f64, bounds::GAP_ERROR_SD;
    }
}

struct Draw {
    latents: [f64; 5],
    person_seed: u64,
    day_seed: u64,
}

fn normal(seed: u64, kind: &str, name: &str) -> f64 {
    normal_of(seed, &["evidence", kind, name])
}

impl Draw {
    fn desired_speed_mps(&self, law: &BentLaw) -> f64 {
        MetresPerSecond::from_mph(self.bent("desired_speed", law)).0
    }

    fn bent(&self, name: &str, law: &BentLaw) -> f64 {
        let loadings = [law.aggressiveness, law.spacing, law.pace, law.patience, law.looseness];
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
        self.person(&Draw { latents: latents.map(latent), person_seed, day_seed })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{drivers::People, scenario::setting::check_section};

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
            let traits = LatentTraits { aggressiveness: a, ..LatentTraits::default() };
            p.draw(&traits, 1, 1).desired_speed_mps
        };
        let (down, up) = (speed(0.0) - speed(-1.0), speed(1.0) - speed(0.0));
        assert!(down > 0.0 && up > 1.3 * down, "{down} {up}");
    }

    #[test]
    fn odd_latents_stay_within_their_laws_and_odd_laws_are_refused() {
        let p = population();
        let odd = LatentTraits { aggressiveness: f64::NAN, spacing: f64::INFINITY, pace: -1e300 };
        let driver = p.draw(&odd, 1, 1);
        let law = &p.following_time_gap_s;
        assert!((law.lowest..=law.highest).contains(&driver.following_time_gap_s));
        let mut wrong = population();
        wrong.weave_sd_m.highest = 3.0;
        let error = check_section("evidence", wrong.as_ref()).unwrap_err().to_string();
        assert!(error.contains("evidence.weave_sd_m.highest"), "{error}");
    }
}
