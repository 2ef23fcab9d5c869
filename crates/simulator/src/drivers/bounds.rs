//! Between what a person's numbers may lie.

use crate::scenario::SettingRange;

/// Key, lowest, highest, and the same in words.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bounds(pub(crate) &'static str, f64, f64, &'static str);

impl Bounds {
    /// The range, or what of it lies above `low`.
    pub(crate) fn range(self, low: Option<f64>) -> SettingRange {
        SettingRange::Within(low.unwrap_or(self.1), self.2, self.3)
    }
}

pub(crate) const DESIRED_SPEED_MPS: Bounds = Bounds("desired_speed_mps", 7.0, 65.0, "7 to 65 m/s");
pub(crate) const PASSING_TIME_GAP_S: Bounds =
    Bounds("passing_time_gap_s", 0.7, 10.0, "0.7 to 10 s");
pub(crate) const PASSING_GAIN_MPS: Bounds = Bounds("passing_gain_mps", 0.0, 20.0, "0 to 20 m/s");
pub(crate) const MERGE_BACK_TIME_GAP_S: Bounds =
    Bounds("merge_back_time_gap_s", 0.5, 10.0, "0.5 to 10 s");
pub(crate) const FOLLOWING_TIME_GAP_S: Bounds =
    Bounds("following_time_gap_s", 0.7, 10.0, "0.7 to 10 s");
pub(crate) const ACCELERATION_MPS2: Bounds = Bounds("acceleration_mps2", 0.3, 3.0, "0.3 to 3 m/s²");
pub(crate) const PASSING_SPEED_ADDED_MPS: Bounds =
    Bounds("passing_speed_added_mps", -5.0, 10.0, "-5 to 10 m/s");
pub(crate) const PASSING_SPEED_OVER_LEAD_MPS: Bounds =
    Bounds("passing_speed_over_lead_mps", 0.5, 10.0, "0.5 to 10 m/s");
pub(crate) const LANE_CHANGE_S: Bounds = Bounds("lane_change_s", 3.0, 10.0, "3 to 10 s");
pub(crate) const STANDSTILL_M: Bounds = Bounds("standstill_m", 1.0, 20.0, "1 to 20 m");
pub(crate) const BRAKING_MPS2: Bounds = Bounds("braking_mps2", 0.5, 6.0, "0.5 to 6 m/s²");
pub(crate) const DESIRED_SPEED_MPH: Bounds =
    Bounds("desired_speed_mph", 20.0, 120.0, "20 to 120 mph");
pub(crate) const THRESHOLD: Bounds = Bounds("threshold", 0.1, 1000.0, "0.1 to 1000");
pub(crate) const MEMORY_S: Bounds = Bounds("memory_s", 1.0, 100.0, "1 to 100 s");
pub(crate) const WAITING_S: Bounds = Bounds("waiting_s", 1.0, 10000.0, "1 to 10000 s");
pub(crate) const MERGE_BACK_GAP_M: Bounds = Bounds("merge_back_gap_m", 8.0, 200.0, "8 to 200 m");
pub(crate) const MERGE_BACK_HOLD_S: Bounds = Bounds("merge_back_hold_s", 0.0, 20.0, "0 to 20 s");
pub(crate) const HURRY: Bounds = Bounds("hurry", 0.0, 0.9, "0 to 0.9");
pub(crate) const GAP_WANDER_SD: Bounds = Bounds("gap_wander_sd", 0.0, 0.4, "0 to 0.4");
pub(crate) const SPEED_WANDER_SD_MPS: Bounds =
    Bounds("speed_wander_sd_mps", 0.0, 2.0, "0 to 2 m/s");
pub(crate) const LATENESS: Bounds = Bounds("lateness", 0.6, 1.5, "0.6 to 1.5");
pub(crate) const LANE_OFFSET_M: Bounds = Bounds("lane_offset_m", -0.4, 0.4, "-0.4 to 0.4 m");
pub(crate) const WEAVE_SD_M: Bounds = Bounds("weave_sd_m", 0.0, 0.2, "0 to 0.2 m");
pub(crate) const PEEK_M: Bounds = Bounds("peek_m", 0.0, 0.7, "0 to 0.7 m");
pub(crate) const DELAY_S: Bounds = Bounds("delay_s", 0.0, 0.8, "0 to 0.8 s");
pub(crate) const GAP_ERROR_SD: Bounds = Bounds("gap_error_sd", 0.0, 0.15, "0 to 0.15");
