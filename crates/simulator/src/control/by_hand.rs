//! A person at the wheel: what hands and feet ask of the car.

use crate::{
    scenario::{Scenario, VehicleSettings},
    vehicle::Command,
};
use maveric_domain::MetresPerSecond;

/// Engine power over mass, in W/kg: 105 kW in 1500 kg.
const POWER_W_PER_KG: f64 = 70.0;
/// Rolling resistance, in m/s²: 0.012 of the weight.
const ROLLING_MPS2: f64 = 0.12;
/// Air resistance over mass, in 1/m: 0.3 · 2.2 m² · 1.2 kg/m³ / 2 in 1500 kg.
const AIR_PER_M: f64 = 2.64e-4;
/// What the engine brakes with once the foot is off, in m/s².
const ENGINE_BRAKING_MPS2: f64 = 0.3;

/// Where a person's hands and feet are.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Hands {
    /// Share of the front wheels' largest angle, -1 to 1, positive to the left.
    pub steering: f64,
    /// Share of the accelerator's travel, 0 to 1.
    pub throttle: f64,
    /// Share of the brake's strongest braking, 0 to 1.
    pub brake: f64,
}

impl Hands {
    /// Share of the accelerator's travel that keeps the car of `scenario` at a speed.
    pub fn throttle_that_keeps(scenario: &Scenario, speed: MetresPerSecond) -> f64 {
        let pull = pull_mps2(&scenario.settings().vehicle, speed.0);
        let share = (resistance_mps2(speed.0) + ENGINE_BRAKING_MPS2) / (pull + ENGINE_BRAKING_MPS2);
        share.clamp(0.0, 1.0)
    }

    /// What the car is asked to do at `speed_mps`.
    ///
    /// # Source
    /// Ours: traction up to the car's limit or its power over its speed, resistances of a mid-size car.
    pub(crate) fn command(&self, settings: &VehicleSettings, speed_mps: f64) -> Command {
        let throttle = self.throttle.clamp(0.0, 1.0);
        let pull = pull_mps2(settings, speed_mps);
        let resistance = resistance_mps2(speed_mps) + ENGINE_BRAKING_MPS2 * (1.0 - throttle);
        let braking = self.brake.clamp(0.0, 1.0) * settings.braking_limit_mps2;
        Command {
            acceleration_mps2: throttle * pull - resistance - braking,
            steering_rad: self.steering.clamp(-1.0, 1.0) * settings.steering_limit_rad,
        }
    }
}

fn pull_mps2(settings: &VehicleSettings, speed_mps: f64) -> f64 {
    let by_power = POWER_W_PER_KG / speed_mps.max(1.0);
    settings.acceleration_limit_mps2.min(by_power)
}

fn resistance_mps2(speed_mps: f64) -> f64 {
    ROLLING_MPS2 + AIR_PER_M * speed_mps * speed_mps
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(throttle: f64, brake: f64, speed_mps: f64) -> f64 {
        let hands = Hands { throttle, brake, ..Hands::default() };
        let settings = &Scenario::paper().settings().vehicle.clone();
        hands.command(settings, speed_mps).acceleration_mps2
    }

    #[test]
    fn a_foot_off_the_pedals_lets_the_car_roll_out_and_a_foot_down_gets_it_past() {
        assert!((-1.0..-0.3).contains(&asked(0.0, 0.0, 30.0)));
        assert!((1.0..2.5).contains(&asked(1.0, 0.0, 30.0)));
        assert!((2.5..3.0).contains(&asked(1.0, 0.0, 5.0)));
        assert!(asked(0.0, 1.0, 30.0) < -8.0);
    }

    #[test]
    fn the_throttle_that_keeps_a_speed_asks_for_no_acceleration() {
        for speed_mps in [5.0, 20.0, 30.0, 40.0] {
            let keeps = Hands::throttle_that_keeps(&Scenario::paper(), MetresPerSecond(speed_mps));
            assert!(asked(keeps, 0.0, speed_mps).abs() < 1e-12, "{speed_mps}");
        }
    }

    #[test]
    fn some_speed_above_the_posted_one_is_the_fastest() {
        assert!(asked(1.0, 0.0, 45.0) > 0.0 && asked(1.0, 0.0, 65.0) < 0.0);
    }
}
