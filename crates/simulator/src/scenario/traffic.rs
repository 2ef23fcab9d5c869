//! Settings of the traffic.

use super::{Range, check};
use crate::error::SimulatorError;
use serde::{Deserialize, Serialize};

fn check_all(section: &str, values: &[(&str, f64)], range: Range) -> Result<(), SimulatorError> {
    values
        .iter()
        .try_for_each(|&(key, found)| check(section, key, found, range))
}

/// The lead vehicles, one after the other.
///
/// # Source
/// Paper, Study 1, for the six speeds; calibration section 1 for when and where they appear.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LeadSettings {
    /// Speeds as factors of ego's target speed v_e.
    pub factors_of_target: Vec<f64>,
    /// Speeds as factors of the posted speed.
    pub factors_of_posted: Vec<f64>,
    /// When the first slot opens, in s; a tenth of the drive where that is sooner.
    pub first_slot_s: f64,
    /// Time between slots, in s; two fifths of the drive where that is less, so that a short drive
    /// meets at least two.
    pub slot_spacing_s: f64,
    /// Ego rows before this time do not count for v_e, in s.
    pub target_speed_from_s: f64,
    /// Gap at which a lead appears, in m.
    pub appears_ahead_m: f64,
    /// Road that must be free ahead before one appears, and beyond which the last one is over, in m.
    pub clear_ahead_m: f64,
    /// Distance behind ego in the other lane beyond which the last one is over, in m.
    pub over_behind_m: f64,
    /// Distance from ego at which a vehicle leaves the world, in m.
    pub removed_m: f64,
    /// Speed while ego approaches, at most, as a factor of v_e.
    pub approach_factor: f64,
    /// Time gap at which the lead takes its own speed, in s.
    pub approach_time_gap_s: f64,
    /// Time after which it does so in any case, in s.
    pub approach_limit_s: f64,
    /// Its acceleration, in m/s².
    pub acceleration_mps2: f64,
    /// Time after which a lead still ahead in ego's lane drives off, in s.
    pub drives_off_after_s: f64,
    /// How much faster than ego it then drives, in m/s.
    pub drives_off_faster_mps: f64,
}

impl LeadSettings {
    pub(crate) fn paper() -> Self {
        Self {
            factors_of_target: vec![0.85, 0.90, 0.97],
            factors_of_posted: vec![0.9, 1.0, 1.1],
            first_slot_s: 30.0,
            slot_spacing_s: 88.0,
            target_speed_from_s: 10.0,
            appears_ahead_m: 200.0,
            clear_ahead_m: 205.0,
            over_behind_m: 130.0,
            removed_m: 420.0,
            approach_factor: 0.85,
            approach_time_gap_s: 3.5,
            approach_limit_s: 25.0,
            acceleration_mps2: 1.0,
            drives_off_after_s: 80.0,
            drives_off_faster_mps: 6.0,
        }
    }

    pub(super) fn check(&self) -> Result<(), SimulatorError> {
        let factor = Range::Within(0.2, 2.0, "0.2 to 2");
        for &found in &self.factors_of_target {
            check("leads", "factors_of_target", found, factor)?;
        }
        for &found in &self.factors_of_posted {
            check("leads", "factors_of_posted", found, factor)?;
        }
        check("leads", "approach_factor", self.approach_factor, factor)?;
        let times = [
            ("first_slot_s", self.first_slot_s),
            ("target_speed_from_s", self.target_speed_from_s),
            ("approach_time_gap_s", self.approach_time_gap_s),
            ("approach_limit_s", self.approach_limit_s),
            ("drives_off_faster_mps", self.drives_off_faster_mps),
        ];
        check_all("leads", &times, Range::NotNegative)?;
        let positive = [
            ("slot_spacing_s", self.slot_spacing_s),
            ("over_behind_m", self.over_behind_m),
            ("acceleration_mps2", self.acceleration_mps2),
            ("drives_off_after_s", self.drives_off_after_s),
        ];
        check_all("leads", &positive, Range::Positive)?;
        let far = Range::Within(150.0, 2000.0, "150 to 2000 m");
        let distances = [
            ("appears_ahead_m", self.appears_ahead_m),
            ("clear_ahead_m", self.clear_ahead_m),
            ("removed_m", self.removed_m),
        ];
        check_all("leads", &distances, far)
    }
}

/// Encounters in which cars beside ego keep it from passing, so that it follows first.
///
/// # Source
/// Calibration section 1: without them a quarter of the drivers have under 8 s of following rows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BlockedSettings {
    /// How many of the encounters, drawn.
    pub encounters: usize,
    /// Cars side by side with ego.
    pub cars: usize,
    /// Distance between their centres, in m.
    pub spacing_m: f64,
    /// Distance behind ego at which the first appears, in m.
    pub appears_behind_m: f64,
    /// Their speed over ego's per metre that they are away from their place, in 1/s.
    pub position_gain_per_s: f64,
    /// Largest difference from ego's speed, in m/s.
    pub speed_difference_limit_mps: f64,
    /// Difference of speeds at which ego has met the lead, in m/s.
    pub met_within_mps: f64,
    /// Time from then until they leave, in s.
    pub rides_for_s: f64,
    /// Time after which they leave in any case, in s.
    pub leaves_after_s: f64,
    /// How much faster than ego they leave, in m/s.
    pub leaves_faster_mps: f64,
    /// Time from their appearance during which no other off-lane vehicle comes, in s.
    pub quiet_s: f64,
}

impl BlockedSettings {
    pub(crate) const PAPER: Self = Self {
        encounters: 2,
        cars: 3,
        spacing_m: 22.0,
        appears_behind_m: 110.0,
        position_gain_per_s: 0.25,
        speed_difference_limit_mps: 5.0,
        met_within_mps: 1.5,
        rides_for_s: 15.0,
        leaves_after_s: 70.0,
        leaves_faster_mps: 6.0,
        quiet_s: 50.0,
    };

    pub(super) fn check(&self) -> Result<(), SimulatorError> {
        check(
            "blocked",
            "cars",
            self.cars as f64,
            Range::Within(0.0, 9.0, "0 to 9"),
        )?;
        check(
            "blocked",
            "spacing_m",
            self.spacing_m,
            Range::Within(15.0, 100.0, "15 to 100 m"),
        )?;
        let behind = Range::Within(60.0, 400.0, "60 to 400 m");
        check("blocked", "appears_behind_m", self.appears_behind_m, behind)?;
        let values = [
            ("position_gain_per_s", self.position_gain_per_s),
            (
                "speed_difference_limit_mps",
                self.speed_difference_limit_mps,
            ),
            ("met_within_mps", self.met_within_mps),
            ("rides_for_s", self.rides_for_s),
            ("leaves_after_s", self.leaves_after_s),
            ("leaves_faster_mps", self.leaves_faster_mps),
            ("quiet_s", self.quiet_s),
        ];
        check_all("blocked", &values, Range::NotNegative)
    }
}

/// Single vehicles of the passing lane.
///
/// # Source
/// Calibration section 1. All are faster than ego: one in ego's lane or slower than v_e would hold up the leads.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OffLaneSettings {
    /// Shortest and longest time from one to the next, in s.
    pub interval_s: [f64; 2],
    /// Share that comes from behind; the others appear ahead.
    pub share_from_behind: f64,
    /// Distance behind ego at which one appears, in m.
    pub appears_behind_m: f64,
    /// How much faster than v_e it then is, least and most, in m/s.
    pub faster_mps: [f64; 2],
    /// Distance ahead of ego at which one appears, in m.
    pub appears_ahead_m: f64,
    /// Its speed then as a factor of v_e, least and most.
    pub ahead_factor: [f64; 2],
}

impl OffLaneSettings {
    pub(crate) const PAPER: Self = Self {
        interval_s: [45.0, 75.0],
        share_from_behind: 0.6,
        appears_behind_m: 180.0,
        faster_mps: [1.5, 5.5],
        appears_ahead_m: 190.0,
        ahead_factor: [1.06, 1.20],
    };

    pub(super) fn check(&self) -> Result<(), SimulatorError> {
        let share = Range::Within(0.0, 1.0, "0 to 1");
        check(
            "off_lane",
            "share_from_behind",
            self.share_from_behind,
            share,
        )?;
        let far = Range::Within(100.0, 400.0, "100 to 400 m");
        check("off_lane", "appears_behind_m", self.appears_behind_m, far)?;
        check("off_lane", "appears_ahead_m", self.appears_ahead_m, far)?;
        let pairs = [
            (
                "interval_s",
                self.interval_s,
                Range::Within(1.0, 1e6, "1 to 1000000 s, least first"),
            ),
            (
                "faster_mps",
                self.faster_mps,
                Range::Within(0.0, 20.0, "0 to 20 m/s, least first"),
            ),
            (
                "ahead_factor",
                self.ahead_factor,
                Range::Within(1.0, 2.0, "1 to 2, least first"),
            ),
        ];
        for (key, [low, high], range) in pairs {
            check("off_lane", key, low, range)?;
            let Range::Within(_, most, words) = range else {
                continue;
            };
            check("off_lane", key, high, Range::Within(low, most, words))?;
        }
        Ok(())
    }
}
