//! Drives of people and of the automated car, held against what they should come to.

mod automated;
mod people;

use super::*;
use crate::{
    control::{Hands, safe_distance},
    drivers::DriverParams,
    planner::{Planner, View},
    scenario::{
        ControllerSettings, FollowingRule, Integrator, ScenarioSettings, VehicleModel,
        VehiclePlacement,
    },
    session::Session,
};
use maveric_domain::{
    Drive, DriveMeta, DrivenBy, LaneActivity, LaneWish, LatentTraits, MetresPerSecond, Seconds,
    Setpoints, When, drive::Direction,
};
use proptest::prelude::*;

fn drive(rollout: &Rollout) -> Drive {
    let meta = DriveMeta::named("test", "test", "own", DrivenBy::Synthetic).unwrap();
    Drive::from_recording(meta, &rollout.recording).unwrap()
}

fn person(a: f64, b: f64, c: f64, seed: u64) -> DriverParams {
    let traits = LatentTraits { aggressiveness: a, spacing: b, pace: c };
    DriverParams::draw(&traits, seed, seed)
}

/// Asks for the same at all times, and for its lane.
fn always(speed_mps: f64, gap_m: f64) -> impl FnMut(&View<'_>) -> Setpoints {
    move |_| Setpoints { speed_mps, following_distance_m: gap_m, wish: LaneWish::Stay }
}

/// Asks for the same at all times, and for the other lane.
fn restless(speed_mps: f64, gap_m: f64, when: When) -> impl FnMut(&View<'_>) -> Setpoints {
    move |view| Setpoints {
        speed_mps,
        following_distance_m: gap_m,
        wish: if view.lane == 0 { LaneWish::MoveOut(when) } else { LaneWish::MoveBack(when) },
    }
}

/// Sways what another planner asks for.
struct Swaying<P> {
    inner: P,
    sway: (f64, f64),
    time_s: f64,
}

impl<P> Swaying<P> {
    fn phase(&self) -> f64 {
        libm::sin(std::f64::consts::TAU * self.time_s / self.sway.1)
    }
}

impl<P: Planner> Planner for Swaying<P> {
    fn plan(&mut self, view: &View<'_>) -> Setpoints {
        self.time_s = view.scene.time_s;
        let asked = self.inner.plan(view);
        Setpoints {
            speed_mps: asked.speed_mps + self.sway.0 * self.phase(),
            following_distance_m: asked.following_distance_m * libm::exp(self.phase()),
            ..asked
        }
    }
}

fn with(change: impl FnOnce(&mut ScenarioSettings)) -> Scenario {
    let mut settings = Scenario::paper().settings().clone();
    change(&mut settings);
    Scenario::try_from(settings).unwrap()
}

/// A road with nothing on it but what a test puts there.
fn empty_road(duration_s: f64, vehicles: Vec<VehiclePlacement>) -> Scenario {
    with(|s| {
        s.duration_s = duration_s;
        s.leads.factors_of_target.clear();
        s.leads.factors_of_posted.clear();
        s.off_lane.interval_s = [1e5, 1e5];
        s.vehicles = vehicles;
    })
}

fn placed(ahead_m: f64, lane: u8, speed_mps: f64) -> VehiclePlacement {
    VehiclePlacement::steady(ahead_m, lane, speed_mps)
}

fn automated(scenario: &Scenario, mut planner: impl Planner, seed: u64) -> Rollout {
    let settings = &scenario.settings().controllers;
    rollout(scenario, Driver::Automated(&mut planner, settings), seed).unwrap()
}

fn final_gap_m(rollout: &Rollout, other: usize) -> f64 {
    let ego = rollout.recording.ego();
    let track = &rollout.recording.others()[other];
    let centres = track.x_m.last().unwrap() - ego.x_m.last().unwrap();
    centres - 0.5 * (track.length_m + ego.length_m)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_person_collides_from_any_feasible_start(
        latents in prop::array::uniform3(-3.5..3.5_f64),
        ahead_m in 130.0..400.0_f64,
        lead_mps in 0.0..30.0_f64,
        seed in 0..u64::MAX,
    ) {
        let scenario = with(|s| {
            s.duration_s = 240.0;
            s.vehicles = vec![placed(ahead_m, 0, lead_mps)];
        });
        let driver = person(latents[0], latents[1], latents[2], seed);
        let driven = rollout(&scenario, Driver::Human(&driver), seed).unwrap();
        prop_assert_eq!(driven.report.collisions, 0);
    }

    #[test]
    fn no_planner_and_no_accepted_settings_make_the_car_collide(
        speed_mps in -50.0..200.0_f64,
        gap_m in -50.0..200.0_f64,
        wish in prop::sample::select(vec![None, Some(When::NotYet), Some(When::Now)]),
        start in (130.0..400.0_f64, 0.0..30.0_f64),
        gains in (0.01..2.0_f64, 0.0..0.5_f64, 0.0..0.5_f64, 0.01..2.0_f64),
        rss in (0.3..3.0_f64, 3.0..8.0_f64, 0.0..1.0_f64, 1.0..50.0_f64),
        handing in (5.0..200.0_f64, 0.0..5.0_f64, 0.5..3.5_f64, 0.1..20.0_f64),
        changing in (2.0..10.0_f64, 0.0..1.0_f64, 0.5..1.8_f64),
        following_rule in prop::sample::select(vec![FollowingRule::AskedGap, FollowingRule::Idm, FollowingRule::Paper]),
        sway in (0.0..20.0_f64, 1.0..30.0_f64),
        seed in 0..u64::MAX,
    ) {
        let controllers = ControllerSettings {
            following_rule,
            velocity_gain_per_s: gains.0,
            velocity_integral_per_s2: gains.1,
            gap_gain_per_s2: gains.2,
            speed_difference_gain_per_s: gains.3,
            reaction_s: rss.0,
            own_braking_mps2: rss.1,
            other_braking_mps2: rss.1 + rss.2 * (12.0 - rss.1),
            margin_m: rss.3,
            following_threshold_m: handing.0,
            following_threshold_factor: handing.1,
            closing_braking_mps2: handing.2,
            handover_band_m: handing.3,
            change_shortest_s: changing.0,
            change_longest_s: changing.0 + changing.1 * (15.0 - changing.0),
            change_time_factor: changing.2,
            ..ControllerSettings::default()
        };
        let scenario = with(|s| {
            s.duration_s = 240.0;
            s.vehicles = vec![placed(start.0, 0, start.1)];
            s.controllers = controllers;
        });
        let swaying = |inner: &mut dyn FnMut(&View<'_>) -> Setpoints| {
            let planner = Swaying { inner, sway, time_s: 0.0 };
            automated(&scenario, planner, seed)
        };
        let driven = match wish {
            None => swaying(&mut always(speed_mps, gap_m)),
            Some(when) => swaying(&mut restless(speed_mps, gap_m, when)),
        };
        prop_assert_eq!(driven.report.collisions, 0);
    }
}
