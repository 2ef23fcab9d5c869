//! One such person on one day.

use crate::drivers::bounds;
use crate::{error::SimulatorError, scenario::check_setting};
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
        for (bounds, found) in [
            (bounds::DESIRED_SPEED_MPS, self.desired_speed_mps),
            (bounds::THRESHOLD, self.threshold),
            (bounds::MEMORY_S, self.memory_s),
            (bounds::WAITING_S, self.waiting_s),
            (bounds::MERGE_BACK_GAP_M, self.merge_back_gap_m),
            (bounds::MERGE_BACK_HOLD_S, self.merge_back_hold_s),
            (bounds::HURRY, self.hurry),
            (bounds::FOLLOWING_TIME_GAP_S, self.following_time_gap_s),
            (bounds::STANDSTILL_M, self.standstill_m),
            (bounds::GAP_WANDER_SD, self.gap_wander_sd),
            (bounds::SPEED_WANDER_SD_MPS, self.speed_wander_sd_mps),
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
            (bounds::LATENESS, self.lateness),
            (bounds::LANE_OFFSET_M, self.lane_offset_m),
            (bounds::WEAVE_SD_M, self.weave_sd_m),
            (bounds::PEEK_M, self.peek_m),
            (bounds::BRAKING_MPS2, self.braking_mps2),
            (bounds::DELAY_S, self.delay_s),
            (bounds::GAP_ERROR_SD, self.gap_error_sd),
        ] {
            check_setting("driver", bounds.0, found, bounds.range(None))?;
        }
        Ok(())
    }

    /// Speed wanted on free road on this day.
    pub fn desired_speed(&self) -> MetresPerSecond {
        MetresPerSecond(self.desired_speed_mps)
    }
}
