//! When a person passes and when they merge back: MOBIL-like, with personal thresholds.

use super::population::DriverParams;
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
        Self { rng, encounter: None, merge_back_time_gap_s: params.merge_back_time_gap_s }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{other, scene};
    use maveric_domain::LatentTraits;
    use rand::SeedableRng;

    const LEFT_M: f64 = 3.66;

    /// Somebody who passes at 2 s for 3 m/s, half a m/s less for each second behind, merges back at 1.5 s, and is always the same.
    fn person() -> (DriverParams, Passing) {
        let traits = LatentTraits { aggressiveness: 0.0, spacing: 0.0, pace: 0.0 };
        let mut params = DriverParams::draw(&traits, 1, 1);
        params.desired_speed_mps = 30.0;
        params.passing_time_gap_s = 2.0;
        params.passing_gain_mps = 3.0;
        params.merge_back_time_gap_s = 1.5;
        params.noise.passing_time_gap_log_sd = 0.0;
        params.noise.passing_gain_sd_mps = 0.0;
        params.noise.merge_back_log_sd = 0.0;
        params.noise.passing_gain_falls_mps2 = 0.5;
        let passing = Passing::new(&params, Pcg64Mcg::seed_from_u64(1));
        (params, passing)
    }

    #[test]
    fn a_lead_is_passed_for_a_gain_that_falls_while_waiting_behind_it() {
        let (params, mut passing) = person();
        let mut wanted = |id, gap_m, lead_mps| {
            let vehicle = other(id, gap_m, 0.0, lead_mps);
            passing.wanted_at(&params, Some(Neighbour { vehicle, gap_m }), 20.0)
        };
        assert_eq!(wanted(1, 100.0, 26.9), Some(2.0));
        // 2.5 m/s will do from above 1 s behind it, which is within 4 s at 20 m/s.
        assert!((0..100).all(|_| wanted(2, 80.0, 27.5).is_none()));
        let mut waits = |id| (1..100).find(|_| wanted(id, 79.9, 27.5).is_some());
        assert_eq!(waits(2), Some(21));
        assert_eq!(waits(3), Some(21), "another one is waited behind anew");
        assert_eq!(passing.wanted_at(&params, None, 20.0), None);
    }

    #[test]
    fn merging_back_needs_room_behind_as_it_is_seen_and_room_ahead() {
        let (params, mut passing) = person();
        passing.begin(&params);
        let merges = |gap_m: f64, speed_mps: f64, error: f64| {
            let scene = scene(LEFT_M, 20.0, &[other(1, gap_m, 0.0, speed_mps)]);
            passing.merges_back(&scene, &Road::PAPER, 0, error)
        };
        // 1.5 s at 20 m/s; one who is 10 m/s faster needs 8 m and 3.5 s of that; ahead 5.5 s.
        for (least_m, speed_mps, error) in [
            (-30.0, 20.0, 1.0),
            (-30.0 / 0.9, 20.0, 0.9),
            (-43.0, 30.0, 1.0),
            (-43.0, 30.0, 1.5),
            (110.0, 20.0, 1.0),
        ] {
            assert!(merges(1.001 * least_m, speed_mps, error), "{least_m}");
            assert!(!merges(0.999 * least_m, speed_mps, error), "{least_m}");
        }
    }

    #[test]
    fn moving_out_needs_room_for_who_comes_and_for_who_is_slow() {
        let clear = |gap_m: f64, speed_mps: f64| {
            let scene = scene(0.0, 20.0, &[other(1, gap_m, LEFT_M, speed_mps)]);
            is_clear(&scene, &Road::PAPER, 1)
        };
        for (least_m, speed_mps) in [
            // 8 m, 3.5 s of 6 m/s and a quarter of a second of 20; the same for one who is slower, without the closing.
            (-34.0, 26.0),
            (-13.0, 15.0),
            // 10 m and 4 s of 5 m/s.
            (30.0, 15.0),
            (10.0, 25.0),
        ] {
            assert!(clear(1.001 * least_m, speed_mps), "{least_m}");
            assert!(!clear(0.999 * least_m, speed_mps), "{least_m}");
        }
    }
}
