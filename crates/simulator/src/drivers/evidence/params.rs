//! One such person on one day.

use maveric_domain::MetresPerSecond;
use serde::Serialize;

/// How one person who acts on evidence drives on one day.
///
/// Drawn, so that every value lies in its law's range.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EvidenceParams {
    /// Speed wanted on free road, in m/s.
    pub(crate) desired_speed_mps: f64,
    /// Evidence at which a pass begins.
    pub(crate) threshold: f64,
    /// Time in which evidence is forgotten, in s.
    pub(crate) memory_s: f64,
    /// Time behind a lead in which the threshold falls to 1/e, in s.
    pub(crate) waiting_s: f64,
    /// Gap to the vehicle passed at which merging back begins, in m, whatever the speed.
    pub(crate) merge_back_gap_m: f64,
    /// Time for which that gap has to have been there, in s.
    pub(crate) merge_back_hold_s: f64,
    /// Share by which that gap shrinks with somebody close behind in the passing lane.
    pub(crate) hurry: f64,
    /// Part of the following gap that grows with speed, in s.
    pub(crate) following_time_gap_s: f64,
    /// Part of it that does not, in m.
    pub(crate) standstill_m: f64,
    /// SD of the wander of that gap, relative.
    pub(crate) gap_wander_sd: f64,
    /// SD of the wander of the desired speed, in m/s.
    pub(crate) speed_wander_sd_mps: f64,
    /// Acceleration from standstill, in m/s².
    pub(crate) acceleration_mps2: f64,
    /// Speed added while passing, in m/s.
    pub(crate) passing_speed_added_mps: f64,
    /// Least speed over the vehicle passed, in m/s.
    pub(crate) passing_speed_over_lead_mps: f64,
    /// Duration of a lane change, in s.
    pub(crate) lane_change_s: f64,
    /// Exponent on the share of a lane change that is over: above 1 the line is crossed late.
    pub(crate) lateness: f64,
    /// Where in the lane this person drives, in m to the left of its centre.
    pub(crate) lane_offset_m: f64,
    /// SD of the weave around that, in m.
    pub(crate) weave_sd_m: f64,
    /// How far this person leans out before passing, in m.
    pub(crate) peek_m: f64,
    /// Comfortable braking, in m/s².
    pub(crate) braking_mps2: f64,
    /// Reaction delay, in s.
    pub(crate) delay_s: f64,
    /// SD of the relative error of perceived gaps.
    pub(crate) gap_error_sd: f64,
}

impl EvidenceParams {
    /// Speed wanted on free road on this day.
    pub fn desired_speed(&self) -> MetresPerSecond {
        MetresPerSecond(self.desired_speed_mps)
    }
}
