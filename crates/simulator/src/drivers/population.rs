//! How latent traits become driving parameters: the table of calibration section 2.

use super::bounds::{self, Bounds};
use crate::{
    error::SimulatorError,
    scenario::{SettingRange, check_setting},
};
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

/// How a driver differs from one encounter to the next, and from moment to moment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EncounterNoise {
    /// SD of the logarithm of the time gap at which a pass starts, per encounter.
    pub passing_time_gap_log_sd: f64,
    /// SD of the speed gain needed, per encounter, in m/s.
    pub passing_gain_sd_mps: f64,
    /// How fast the gain needed falls while behind the lead, in m/s per s.
    pub passing_gain_falls_mps2: f64,
    /// SD of the logarithm of the merge-back time gap, per pass.
    pub merge_back_log_sd: f64,
    /// Reaction delay, in s.
    pub delay_s: f64,
    /// SD of the relative error of perceived gaps.
    pub gap_error_sd: f64,
    /// Correlation time of that error, in s.
    pub gap_error_time_s: f64,
    /// SD of the wander of the desired speed, in m/s.
    pub speed_wander_sd_mps: f64,
    /// Correlation time of that wander, in s.
    pub speed_wander_time_s: f64,
}

impl EncounterNoise {
    /// Refuses the first value out of range, naming it within `section`.
    pub(super) fn check(&self, section: &str) -> Result<(), SimulatorError> {
        let short = SettingRange::Within(0.0, 0.8, "0 to 0.8 s");
        check_setting(section, "delay_s", self.delay_s, short)?;
        let error = SettingRange::Within(0.0, 0.15, "0 to 0.15");
        check_setting(section, "gap_error_sd", self.gap_error_sd, error)?;
        for (key, found) in [
            ("gap_error_time_s", self.gap_error_time_s),
            ("speed_wander_time_s", self.speed_wander_time_s),
        ] {
            check_setting(section, key, found, SettingRange::Positive)?;
        }
        for (key, found) in [
            ("passing_time_gap_log_sd", self.passing_time_gap_log_sd),
            ("passing_gain_sd_mps", self.passing_gain_sd_mps),
            ("passing_gain_falls_mps2", self.passing_gain_falls_mps2),
            ("merge_back_log_sd", self.merge_back_log_sd),
            ("speed_wander_sd_mps", self.speed_wander_sd_mps),
        ] {
            let range = SettingRange::Within(0.0, 2.0, "0 to 2");
            check_setting(section, key, found, range)?;
        }
        Ok(())
    }
}

/// The population of synthetic drivers.
///
/// # Source
/// Method section 7 (ours); every number from calibration section 2.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Population {
    /// Speed wanted on free road, additive, in mph; its `day` is relative and applied last.
    pub desired_speed_mph: Law,
    /// Time gap at which a pass starts, exponential, in s.
    pub passing_time_gap_s: Law,
    /// Speed gain needed to pass, additive, in m/s.
    pub passing_gain_mps: Law,
    /// Merge-back time gap, exponential, in s.
    pub merge_back_time_gap_s: Law,
    /// Following time gap, exponential, in s.
    pub following_time_gap_s: Law,
    /// IDM acceleration, exponential, in m/s².
    pub acceleration_mps2: Law,
    /// Speed added while passing, additive, in m/s.
    pub passing_speed_added_mps: Law,
    /// Least speed over the vehicle passed, additive, in m/s.
    pub passing_speed_over_lead_mps: Law,
    /// Duration of a lane change, exponential, in s.
    pub lane_change_s: Law,
    /// IDM gap at standstill, in m.
    pub standstill_m: f64,
    /// IDM comfortable braking, in m/s².
    pub braking_mps2: f64,
    /// What changes from encounter to encounter.
    pub noise: EncounterNoise,
}

const fn law(centre: f64, scale: f64, loadings: [f64; 4], day: f64, range: [f64; 2]) -> Law {
    let [a, b, c, own] = loadings;
    let [lowest, highest] = range;
    Law {
        centre,
        scale,
        a,
        b,
        c,
        own,
        day,
        lowest,
        highest,
    }
}

impl Population {
    pub(crate) const PAPER: Self = Self {
        desired_speed_mph: law(66.5, 6.3, [0.58, 0.15, 0.70, 0.38], 0.012, [53.0, 84.0]),
        passing_time_gap_s: law(2.05, 0.32, [-0.70, 0.62, 0.20, 0.28], 0.05, [0.8, 3.6]),
        passing_gain_mps: law(2.2, 1.2, [-0.62, 0.0, -0.65, 0.43], 0.1, [0.3, 3.2]),
        merge_back_time_gap_s: law(1.38, 0.33, [-0.67, 0.25, 0.60, 0.36], 0.05, [0.55, 3.4]),
        following_time_gap_s: law(1.1, 0.28, [0.0, 0.90, 0.0, 0.43], 0.05, [0.7, 3.0]),
        acceleration_mps2: law(1.4, 0.12, [0.0, 0.0, 0.0, 1.0], 0.0, [0.8, 2.5]),
        passing_speed_added_mps: law(0.5, 1.0, [0.0, 0.0, -0.8, 0.2], 0.0, [-0.6, 6.0]),
        passing_speed_over_lead_mps: law(2.3, 1.0, [0.0, 0.0, -0.6, 0.15], 0.0, [1.2, 6.0]),
        lane_change_s: law(4.8, 0.1, [0.0, 0.0, 0.0, 1.0], 0.0, [3.3, 7.0]),
        standstill_m: 2.0,
        braking_mps2: 2.5,
        noise: EncounterNoise {
            passing_time_gap_log_sd: 0.16,
            passing_gain_sd_mps: 0.2,
            passing_gain_falls_mps2: 0.015,
            merge_back_log_sd: 0.16,
            delay_s: 0.5,
            gap_error_sd: 0.06,
            gap_error_time_s: 2.0,
            speed_wander_sd_mps: 0.4,
            speed_wander_time_s: 20.0,
        },
    };

    /// The laws with their keys and the widest range a law may be clipped to.
    fn laws(&self) -> [(Bounds, &Law); 9] {
        [
            (bounds::DESIRED_SPEED_MPH, &self.desired_speed_mph),
            (bounds::PASSING_TIME_GAP_S, &self.passing_time_gap_s),
            (bounds::PASSING_GAIN_MPS, &self.passing_gain_mps),
            (bounds::MERGE_BACK_TIME_GAP_S, &self.merge_back_time_gap_s),
            (bounds::FOLLOWING_TIME_GAP_S, &self.following_time_gap_s),
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
        ]
    }

    pub(crate) fn check(&self) -> Result<(), SimulatorError> {
        for (bounds, law) in self.laws() {
            let section = format!("drivers.{}", bounds.0);
            check_setting(&section, "lowest", law.lowest, bounds.range(None))?;
            check_setting(
                &section,
                "highest",
                law.highest,
                bounds.range(Some(law.lowest)),
            )?;
            for (key, found) in [
                ("centre", law.centre),
                ("scale", law.scale),
                ("a", law.a),
                ("b", law.b),
                ("c", law.c),
                ("own", law.own),
            ] {
                check_setting(&section, key, found, SettingRange::Finite)?;
            }
            check_setting(&section, "day", law.day, SettingRange::NotNegative)?;
        }
        for (bounds, found) in [
            (bounds::STANDSTILL_M, self.standstill_m),
            (bounds::BRAKING_MPS2, self.braking_mps2),
        ] {
            check_setting("drivers", bounds.0, found, bounds.range(None))?;
        }
        self.noise.check("drivers.noise")
    }
}
