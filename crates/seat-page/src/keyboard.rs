//! Keys and sticks as hands: what a lane can be kept with.

use crate::input::{Input, Signal};
use maveric_domain::MetresPerSecond;
use maveric_simulator::{Hands, Scenario};

/// Length of a step, in s.
const STEP_S: f64 = 0.01;
/// Sideways acceleration of a key held down, or a stick at its end, in m/s².
const SIDEWAYS_MPS2: f64 = 2.0;
/// Largest angle of the front wheels by keys or a stick, in rad: enough to turn at walking pace.
const LARGEST_RAD: f64 = 0.35;
/// Time from the middle to a key's angle, and back, in s.
const OUT_S: f64 = 0.4;
const BACK_S: f64 = 0.25;
/// Pedal travel a second while a key is held, and while it is let go.
const PRESS_PER_S: f64 = 1.5;
const BRAKE_PER_S: f64 = 1.0;
const LET_GO_PER_S: f64 = 4.0;
/// The hardest that the key of the brake brakes; with the key of the accelerator held too it is an emergency.
const KEY_BRAKE: f64 = 0.6;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[expect(clippy::struct_excessive_bools, reason = "each is a key")]
pub struct Keys {
    pub left: bool,
    pub right: bool,
    pub faster: bool,
    /// The brake, short of an emergency.
    pub slower: bool,
    /// Brake as hard as the car can.
    pub emergency: bool,
}

/// Where a stick and two triggers are.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stick {
    /// -1 to 1, positive to the left.
    pub steering: f64,
    /// 0 to 1.
    pub throttle: f64,
    /// 0 to 1.
    pub brake: f64,
}

/// The keyboard as a driver's hands: steering moves at a limited rate, comes back to the middle by itself and turns less the
/// faster the car; without a key the foot keeps the speed.
///
/// # Source
/// Ours.
#[derive(Debug, Clone, PartialEq)]
pub struct Keyboard {
    scenario: Scenario,
    wheelbase_m: f64,
    limit_rad: f64,
    steering_rad: f64,
    throttle: f64,
    brake: f64,
}

impl Keyboard {
    /// For the car of `scenario`.
    pub fn new(scenario: &Scenario) -> Self {
        let vehicle = &scenario.settings().vehicle;
        Self {
            scenario: scenario.clone(),
            wheelbase_m: vehicle.wheelbase_m,
            limit_rad: vehicle.steering_limit_rad,
            steering_rad: 0.0,
            throttle: 0.0,
            brake: 0.0,
        }
    }

    fn largest_rad(&self, speed_mps: f64) -> f64 {
        let by_speed = self.wheelbase_m * SIDEWAYS_MPS2 / (speed_mps * speed_mps).max(1.0);
        by_speed.min(LARGEST_RAD).min(self.limit_rad)
    }

    /// The keys' input at the next step, at `speed_mps`.
    pub fn input(&mut self, keys: Keys, signal: Signal, speed_mps: f64) -> Input {
        let largest = self.largest_rad(speed_mps);
        let way = f64::from(i8::from(keys.left) - i8::from(keys.right));
        let wanted = way * largest;
        // Towards the middle it goes as fast as it comes back by itself.
        let takes_s = if wanted * self.steering_rad < 0.0 || wanted.abs() < self.steering_rad.abs()
        {
            BACK_S
        } else {
            OUT_S
        };
        let most = largest * STEP_S / takes_s;
        self.steering_rad += (wanted - self.steering_rad).clamp(-most, most);
        let braking = keys.slower || keys.emergency;
        let throttle = match (keys.faster, braking) {
            (_, true) => 0.0,
            (true, false) => 1.0,
            (false, false) => {
                Hands::throttle_that_keeps(&self.scenario, MetresPerSecond(speed_mps))
            }
        };
        let rise = PRESS_PER_S * STEP_S;
        let fall = LET_GO_PER_S * STEP_S;
        self.throttle += (throttle - self.throttle).clamp(-fall, rise);
        let brake = match (keys.emergency, keys.slower) {
            (true, _) => 1.0,
            (false, true) => KEY_BRAKE,
            (false, false) => 0.0,
        };
        let press = if keys.emergency { LET_GO_PER_S } else { BRAKE_PER_S };
        self.brake += (brake - self.brake).clamp(-fall, press * STEP_S);
        let hands = Hands {
            steering: self.steering_rad / self.limit_rad,
            throttle: self.throttle,
            brake: self.brake,
        };
        Input::new(hands, signal)
    }

    /// A gamepad's input at `speed_mps`: the stick's square, so that its middle is fine, and less the faster the car.
    pub fn pad(&self, stick: Stick, signal: Signal, speed_mps: f64) -> Input {
        let steering = stick.steering.clamp(-1.0, 1.0);
        let hands = Hands {
            steering: steering * steering.abs() * 2.0 * self.largest_rad(speed_mps)
                / self.limit_rad,
            throttle: stick.throttle,
            brake: stick.brake,
        };
        Input::new(hands, signal)
    }

    /// A steering wheel's input: `turned_rad` at the wheel, over the ratio of a car's steering.
    pub fn wheel(&self, turned_rad: f64, pedals: Stick, signal: Signal) -> Input {
        const RATIO: f64 = 15.0;
        let hands = Hands {
            steering: turned_rad / RATIO / self.limit_rad,
            throttle: pedals.throttle,
            brake: pedals.brake,
        };
        Input::new(hands, signal)
    }
}
