//! When a person passes and when they merge back: MOBIL-like, with personal thresholds.

use super::params::DriverParams;
use crate::{
    neighbours::{Neighbour, ahead, behind},
    normal::standard_normal,
    planner::PLANNING_STEP_S,
};
use maveric_domain::{Road, Scene, VehicleId};
use rand_pcg::Pcg64Mcg;

/// Time gap within which a driver is behind a lead rather than approaching it, in s.
const BEHIND_TIME_GAP_S: f64 = 4.0;
/// Time gap that must be free ahead in the right lane before merging back, in s.
const FREE_AHEAD_S: f64 = 5.5;

/// One lead ahead and what this person makes of it.
#[derive(Debug, Clone, Copy)]
struct Encounter {
    lead: VehicleId,
    time_gap_s: f64,
    gain_mps: f64,
    behind_for_s: f64,
}

/// Whether a person means to pass, may pass, and merges back.
#[derive(Debug, Clone)]
pub(super) struct Passing {
    rng: Pcg64Mcg,
    encounter: Option<Encounter>,
    merge_back_time_gap_s: f64,
}

impl Passing {
    pub(super) fn new(params: &DriverParams, rng: Pcg64Mcg) -> Self {
        Self {
            rng,
            encounter: None,
            merge_back_time_gap_s: params.merge_back_time_gap_s,
        }
    }

    fn normal(&mut self) -> f64 {
        standard_normal(&mut self.rng)
    }

    /// Time gap (s) at which the pass of `lead` starts, if this person means to pass it.
    pub(super) fn wanted_at(
        &mut self,
        params: &DriverParams,
        lead: Option<Neighbour>,
        ego_mps: f64,
    ) -> Option<f64> {
        let lead = lead?;
        let id = lead.vehicle.id;
        let mut encounter = match self.encounter {
            Some(known) if known.lead == id => known,
            _ => Encounter {
                lead: id,
                time_gap_s: params.passing_time_gap_s
                    * libm::exp(params.noise.passing_time_gap_log_sd * self.normal()),
                gain_mps: params.passing_gain_mps
                    + params.noise.passing_gain_sd_mps * self.normal(),
                behind_for_s: 0.0,
            },
        };
        if lead.gap_m < BEHIND_TIME_GAP_S * ego_mps {
            encounter.behind_for_s += PLANNING_STEP_S;
        }
        self.encounter = Some(encounter);
        let needed =
            encounter.gain_mps - params.noise.passing_gain_falls_mps2 * encounter.behind_for_s;
        let gain = params.desired_speed_mps - lead.vehicle.speed_mps;
        (gain > needed).then_some(encounter.time_gap_s)
    }

    /// A pass begins: what merging back will take this time.
    pub(super) fn begin(&mut self, params: &DriverParams) {
        let factor = libm::exp(params.noise.merge_back_log_sd * self.normal());
        self.merge_back_time_gap_s = params.merge_back_time_gap_s * factor;
    }

    /// Whether to merge back into `lane` now, gaps seen with the relative error `error`.
    pub(super) fn merges_back(&self, scene: &Scene, road: &Road, lane: u8, error: f64) -> bool {
        let ego = &scene.ego;
        let room = behind(scene, road, lane).is_none_or(|n| {
            let seen_m = n.gap_m * error;
            seen_m > self.merge_back_time_gap_s * ego.speed_mps
                && n.gap_m > least_room_behind_m(scene, &n)
        });
        has_room_ahead(scene, road, lane) && room
    }
}

/// Whether `lane` is free enough ahead to merge back into.
pub(super) fn has_room_ahead(scene: &Scene, road: &Road, lane: u8) -> bool {
    ahead(scene, road, lane).is_none_or(|n| n.gap_m > FREE_AHEAD_S * scene.ego.speed_mps)
}

/// Least room behind in the lane merged back into, whatever the habit, in m.
pub(super) fn least_room_behind_m(scene: &Scene, behind: &Neighbour) -> f64 {
    let closing = (behind.vehicle.speed_mps - scene.ego.speed_mps).max(0.0);
    LEAST_BEHIND_M + BEHIND_CLOSING_S * closing
}

/// Least room behind in the lane entered, in m.
const LEAST_BEHIND_M: f64 = 8.0;
/// Room behind for each m/s by which the vehicle there is faster, in s.
const BEHIND_CLOSING_S: f64 = 3.5;
/// Room behind as a time gap of ego, in s.
const BEHIND_SPEED_S: f64 = 0.25;
/// Least room ahead in the lane entered, in m.
const LEAST_AHEAD_M: f64 = 10.0;
/// Room ahead for each m/s by which ego is faster, in s.
const AHEAD_CLOSING_S: f64 = 4.0;

/// Whether `lane` has room to move out into.
///
/// # Source
/// Calibration section 2: behind > 8 m + 3.5 s·closing + 0.25 s·v, ahead > 10 m + 4 s·closing.
pub(super) fn is_clear(scene: &Scene, road: &Road, lane: u8) -> bool {
    let ego = scene.ego.speed_mps;
    let behind_clear = behind(scene, road, lane).is_none_or(|n| {
        let closing = (n.vehicle.speed_mps - ego).max(0.0);
        n.gap_m > LEAST_BEHIND_M + BEHIND_CLOSING_S * closing + BEHIND_SPEED_S * ego
    });
    let ahead_clear = ahead(scene, road, lane).is_none_or(|n| {
        let closing = (ego - n.vehicle.speed_mps).max(0.0);
        n.gap_m > LEAST_AHEAD_M + AHEAD_CLOSING_S * closing
    });
    behind_clear && ahead_clear
}
