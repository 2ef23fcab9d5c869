//! Settings of the background traffic.

use super::{
    ScenarioSettings,
    setting::{Range, check, settings},
};
use crate::{
    error::SimulatorError,
    flow::{FlowSettings, Mobil, Shape, TrafficMix},
    planner::PLANNING_STEP_S,
};
use maveric_domain::MetresPerSecond;

settings! {
    /// Background traffic: every lane filled to a density, following by IDM and changing lane by MOBIL.
    ///
    /// It takes the place of the lead vehicles, which must be none, and of the off-lane vehicles. Ego drives as one of the
    /// vehicles of a ring that moves with it: who falls half a ring behind comes up again half a ring ahead, so that the
    /// density stays what it is. Background vehicles move along the road's centre line and do not slow down in bends.
    #[derive(Copy)]
    pub struct BackgroundSettings {
        /// Density, ego included: at least two vehicles a lane, and standing nobody nearer than 1 m.
        vehicles_per_km_and_lane: f64, 2.0..=100.0;
        /// Length of the ring.
        ring_m: f64, 1000.0..=50_000.0;
        /// Distance from ego within which a vehicle is seen and recorded. A vehicle comes and goes 300 m from ego or further.
        seen_within_m: f64, 200.0..=300.0;
        /// Who drives.
        #[serde(default)]
        mix: TrafficMix;
        /// How they change lane.
        #[serde(default)]
        mobil: Mobil;
        /// A section of slow traffic at the start.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        wave: Option<WaveSettings>;
    }
}

settings! {
    /// Slow traffic at the start: speeds fall along the section to `speed_mps` at its far end.
    #[derive(Copy)]
    pub struct WaveSettings {
        /// Where it begins ahead of ego; on the ring, as its far end.
        ahead_m: f64, 50.0..=50_000.0;
        /// Its length.
        length_m: f64, Range::Positive;
        /// Speed at its far end.
        speed_mps: f64, 0.0..=60.0;
    }
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

    /// Refuses what does not go with the rest of the scenario.
    pub(super) fn check_beside(&self, scenario: &ScenarioSettings) -> Result<(), SimulatorError> {
        if let Some(wave) = &self.wave {
            let ends_m = wave.ahead_m + wave.length_m;
            let on_ring = Range::Because(0.0, self.ring_m, "at most the length of the ring");
            check("background.wave.ahead_m + length_m", ends_m, on_ring)?;
        }
        let leads = scenario.leads.factors_of_target.len() + scenario.leads.factors_of_posted.len();
        let words = "none ([]) beside [background], which takes the place of the leads";
        let name = "leads.factors_of_target and factors_of_posted";
        check(name, leads as f64, Range::Because(0.0, 0.0, words))?;
        let none = Range::Because(0.0, 0.0, "none ([]) beside [background]");
        check("vehicles", scenario.vehicles.len() as f64, none)?;
        self.check_start(scenario)
    }

    /// Ego must be able to slow down to the speed of the traffic that it starts in.
    fn check_start(&self, scenario: &ScenarioSettings) -> Result<(), SimulatorError> {
        let gap_m = 1000.0 / self.vehicles_per_km_and_lane - self.mix.car.length_m;
        let traffic_mps = self.mix.car.equilibrium_speed_mps(gap_m);
        let most = traffic_mps + (2.0 * START_BRAKING_MPS2 * gap_m.max(0.0)).sqrt();
        let words = "a speed at which ego can stay behind the vehicle ahead at this density";
        let range = Range::Because(0.0, MetresPerSecond(most).mph(), words);
        check("start.speed_mph", scenario.start.speed_mph, range)
    }
}
