//! One such person on one day.

use crate::{
    error::SimulatorError,
    scenario::{SettingRange, check_setting},
};
use maveric_domain::MetresPerSecond;
use serde::{Deserialize, Serialize};

/// How one person who acts on evidence drives on one day.
///
/// Drawn from an [`EvidencePopulation`](super::EvidencePopulation), or written by hand and checked before the drive.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EvidenceParams {
    /// Speed wanted on free road, in m/s.
    pub desired_speed_mps: f64,
    /// Evidence at which a pass begins.
    pub threshold: f64,
    /// Time in which evidence is forgotten, in s.
    pub memory_s: f64,
    /// Time behind a lead in which the threshold falls to 1/e, in s.
    pub waiting_s: f64,
    /// Gap to the vehicle passed at which merging back begins, in m, whatever the speed.
    pub merge_back_gap_m: f64,
    /// Time for which that gap has to have been there, in s.
    pub merge_back_hold_s: f64,
    /// Share by which that gap shrinks with somebody close behind in the passing lane.
    pub hurry: f64,
    /// Part of the following gap that grows with speed, in s.
    pub following_time_gap_s: f64,
    /// Part of it that does not, in m.
    pub standstill_m: f64,
    /// SD of the wander of that gap, relative.
    pub gap_wander_sd: f64,
    /// SD of the wander of the desired speed, in m/s.
    pub speed_wander_sd_mps: f64,
    /// Acceleration from standstill, in m/s².
    pub acceleration_mps2: f64,
    /// Speed added while passing, in m/s.
    pub passing_speed_added_mps: f64,
    /// Least speed over the vehicle passed, in m/s.
    pub passing_speed_over_lead_mps: f64,
    /// Duration of a lane change, in s.
    pub lane_change_s: f64,
    /// Exponent on the share of a lane change that is over: above 1 the line is crossed late.
    pub lateness: f64,
    /// Where in the lane this person drives, in m to the left of its centre.
    pub lane_offset_m: f64,
    /// SD of the weave around that, in m.
    pub weave_sd_m: f64,
    /// How far this person leans out before passing, in m.
    pub peek_m: f64,
    /// Comfortable braking, in m/s².
    pub braking_mps2: f64,
    /// Reaction delay, in s.
    pub delay_s: f64,
    /// SD of the relative error of perceived gaps.
    pub gap_error_sd: f64,
}

impl EvidenceParams {
    /// Whether every value lies where a person's may.
    ///
    /// # Errors
    /// [`SimulatorError::Setting`] for the first that does not.
    pub fn check(&self) -> Result<(), SimulatorError> {
        for (key, found, low, high, words) in [
            (
                "desired_speed_mps",
                self.desired_speed_mps,
                7.0,
                65.0,
                "7 to 65 m/s",
            ),
            ("threshold", self.threshold, 0.1, 1000.0, "0.1 to 1000"),
            ("memory_s", self.memory_s, 1.0, 100.0, "1 to 100 s"),
            ("waiting_s", self.waiting_s, 1.0, 10000.0, "1 to 10000 s"),
            (
                "merge_back_gap_m",
                self.merge_back_gap_m,
                8.0,
                200.0,
                "8 to 200 m",
            ),
            (
                "merge_back_hold_s",
                self.merge_back_hold_s,
                0.0,
                20.0,
                "0 to 20 s",
            ),
            ("hurry", self.hurry, 0.0, 0.9, "0 to 0.9"),
            (
                "following_time_gap_s",
                self.following_time_gap_s,
                0.7,
                10.0,
                "0.7 to 10 s",
            ),
            ("standstill_m", self.standstill_m, 1.0, 20.0, "1 to 20 m"),
            ("gap_wander_sd", self.gap_wander_sd, 0.0, 0.4, "0 to 0.4"),
            (
                "speed_wander_sd_mps",
                self.speed_wander_sd_mps,
                0.0,
                2.0,
                "0 to 2 m/s",
            ),
            (
                "acceleration_mps2",
                self.acceleration_mps2,
                0.3,
                3.0,
                "0.3 to 3 m/s²",
            ),
            (
                "passing_speed_added_mps",
                self.passing_speed_added_mps,
                -5.0,
                10.0,
                "-5 to 10 m/s",
            ),
            (
                "passing_speed_over_lead_mps",
                self.passing_speed_over_lead_mps,
                0.5,
                10.0,
                "0.5 to 10 m/s",
            ),
            ("lane_change_s", self.lane_change_s, 3.0, 10.0, "3 to 10 s"),
            ("lateness", self.lateness, 0.6, 1.5, "0.6 to 1.5"),
            (
                "lane_offset_m",
                self.lane_offset_m,
                -0.4,
                0.4,
                "-0.4 to 0.4 m",
            ),
            ("weave_sd_m", self.weave_sd_m, 0.0, 0.2, "0 to 0.2 m"),
            ("peek_m", self.peek_m, 0.0, 0.7, "0 to 0.7 m"),
            ("braking_mps2", self.braking_mps2, 0.5, 6.0, "0.5 to 6 m/s²"),
            ("delay_s", self.delay_s, 0.0, 0.8, "0 to 0.8 s"),
            ("gap_error_sd", self.gap_error_sd, 0.0, 0.15, "0 to 0.15"),
        ] {
            let range = SettingRange::Within(low, high, words);
            check_setting("driver", key, found, range)?;
        }
        Ok(())
    }

    /// Speed wanted on free road on this day.
    pub fn desired_speed(&self) -> MetresPerSecond {
        MetresPerSecond(self.desired_speed_mps)
    }
}
