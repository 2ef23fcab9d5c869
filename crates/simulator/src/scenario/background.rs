//! Settings of the background traffic.

use super::{Range, ScenarioSettings, check};
use crate::{
    error::SimulatorError,
    flow::{FlowSettings, Mobil, Shape, TrafficMix},
    planner::PLANNING_STEP_S,
};
use maveric_domain::MetresPerSecond;
use serde::{Deserialize, Serialize};

/// Background traffic: every lane filled to a density, following by IDM and changing lane by MOBIL.
///
/// It takes the place of the lead vehicles, which must be none, and of the off-lane vehicles. Ego drives as one of the
/// vehicles of a ring that moves with it: who falls half a ring behind comes up again half a ring ahead, so that the
/// density stays what it is. Background vehicles move along the road's centre line and do not slow down in bends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BackgroundSettings {
    /// Density, ego included, in vehicles per km and lane.
    pub vehicles_per_km_and_lane: f64,
    /// Length of the ring, in m.
    pub ring_m: f64,
    /// Distance from ego within which a vehicle is seen and recorded, in m.
    pub seen_within_m: f64,
    /// Who drives.
    #[serde(default)]
    pub mix: TrafficMix,
    /// How they change lane.
    #[serde(default = "published")]
    pub mobil: Mobil,
    /// A section of slow traffic at the start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wave: Option<WaveSettings>,
}

fn published() -> Mobil {
    Mobil::PUBLISHED
}

/// Slow traffic at the start: speeds fall along the section to `speed_mps` at its far end.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WaveSettings {
    /// Where it begins, in m ahead of ego.
    pub ahead_m: f64,
    /// Its length, in m.
    pub length_m: f64,
    /// Speed at its far end, in m/s.
    pub speed_mps: f64,
}

/// Braking that ego's start may need behind the vehicle ahead, in m/s².
const START_BRAKING_MPS2: f64 = 2.0;

impl BackgroundSettings {
    /// The ring around ego.
    pub(crate) fn flow(&self, lanes: u8) -> FlowSettings {
        FlowSettings {
            lanes,
            length_m: self.ring_m,
            shape: Shape::Ring,
            step_s: PLANNING_STEP_S,
            mobil: Some(self.mobil),
        }
    }

    /// Number of vehicles on the ring, ego included.
    pub(crate) fn count(&self, lanes: u8) -> usize {
        let per_lane = (self.vehicles_per_km_and_lane * self.ring_m / 1000.0).round();
        per_lane as usize * usize::from(lanes)
    }

    pub(super) fn check(&self, scenario: &ScenarioSettings) -> Result<(), SimulatorError> {
        let section = "background";
        let ring = Range::Within(1000.0, 50_000.0, "1000 to 50000 m");
        check(section, "ring_m", self.ring_m, ring)?;
        // At least two vehicles a lane; and standing, nobody nearer than 1 m.
        let density = Range::Within(2.0, 100.0, "2 to 100 vehicles per km and lane");
        let per_km = self.vehicles_per_km_and_lane;
        check(section, "vehicles_per_km_and_lane", per_km, density)?;
        // A vehicle comes and goes 300 m from ego or further, and half a ring away at most.
        let seen = Range::Within(200.0, 300.0, "200 to 300 m");
        check(section, "seen_within_m", self.seen_within_m, seen)?;
        self.mix.check("background.mix")?;
        self.mobil.check("background.mobil")?;
        if let Some(wave) = &self.wave {
            let on_ring = Range::Within(50.0, self.ring_m, "50 m to the length of the ring");
            check("background.wave", "ahead_m", wave.ahead_m, on_ring)?;
            let far_end = wave.ahead_m + wave.length_m;
            check(
                "background.wave",
                "length_m",
                wave.length_m,
                Range::Positive,
            )?;
            check("background.wave", "ahead_m + length_m", far_end, on_ring)?;
            let speed = Range::Within(0.0, 60.0, "0 to 60 m/s");
            check("background.wave", "speed_mps", wave.speed_mps, speed)?;
        }
        let none = |words| Range::Within(0.0, 0.0, words);
        let leads = scenario.leads.factors_of_target.len() + scenario.leads.factors_of_posted.len();
        let words = "none ([]) beside [background], which takes the place of the leads";
        check(
            "leads",
            "factors_of_target and factors_of_posted",
            leads as f64,
            none(words),
        )?;
        let placed = scenario.vehicles.len() as f64;
        check(
            "",
            "vehicles",
            placed,
            none("none ([]) beside [background]"),
        )?;
        self.check_start(scenario)
    }

    /// Ego must be able to slow down to the speed of the traffic that it starts in.
    fn check_start(&self, scenario: &ScenarioSettings) -> Result<(), SimulatorError> {
        let gap_m = 1000.0 / self.vehicles_per_km_and_lane - self.mix.car.length_m;
        let traffic_mps = self.mix.car.equilibrium_speed_mps(gap_m);
        let most = traffic_mps + (2.0 * START_BRAKING_MPS2 * gap_m.max(0.0)).sqrt();
        let words = "a speed at which ego can stay behind the vehicle ahead at this density";
        let most_mph = MetresPerSecond(most).mph();
        let range = Range::Within(0.0, most_mph, words);
        check("start", "speed_mph", scenario.start.speed_mph, range)
    }
}
