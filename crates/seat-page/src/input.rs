//! What hands and feet do at one step, in whole numbers, so that a record holds exactly what the car was given.

use maveric_simulator::Hands;
use serde::{Deserialize, Serialize};

/// The whole way of the steering, to either side.
const FULL_STEERING: f64 = 30_000.0;
/// The whole way of a pedal.
const FULL_PEDAL: f64 = 10_000.0;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(try_from = "i8", into = "i8")]
pub enum Signal {
    #[default]
    Off,
    /// The left turn signal blinks.
    Left,
    /// The right turn signal blinks.
    Right,
}

impl TryFrom<i8> for Signal {
    type Error = String;
    fn try_from(number: i8) -> Result<Self, String> {
        match number {
            0 => Ok(Self::Off),
            1 => Ok(Self::Left),
            -1 => Ok(Self::Right),
            _ => Err(format!("turn signal {number}, expected -1, 0 or 1")),
        }
    }
}

impl From<Signal> for i8 {
    fn from(signal: Signal) -> Self {
        match signal {
            Signal::Off => 0,
            Signal::Left => 1,
            Signal::Right => -1,
        }
    }
}

/// What hands and feet do at one step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Input {
    /// -30000 to 30000: share of the front wheels' largest angle, positive to the left.
    pub steering: i16,
    /// 0 to 10000.
    pub throttle: u16,
    /// 0 to 10000.
    pub brake: u16,
    pub signal: Signal,
}

impl Input {
    /// The nearest whole numbers to where the hands are; what is no number counts as 0.
    pub fn new(hands: Hands, signal: Signal) -> Self {
        let pedal = |share: f64| (share.clamp(0.0, 1.0) * FULL_PEDAL).round() as u16;
        Self {
            steering: (hands.steering.clamp(-1.0, 1.0) * FULL_STEERING).round() as i16,
            throttle: pedal(hands.throttle),
            brake: pedal(hands.brake),
            signal,
        }
    }

    /// What the car is given.
    pub fn hands(self) -> Hands {
        Hands {
            steering: f64::from(self.steering) / FULL_STEERING,
            throttle: f64::from(self.throttle) / FULL_PEDAL,
            brake: f64::from(self.brake) / FULL_PEDAL,
        }
    }

    /// Whether every number is in its range.
    pub fn possible(self) -> bool {
        f64::from(self.steering).abs() <= FULL_STEERING
            && f64::from(self.throttle.max(self.brake)) <= FULL_PEDAL
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hands_are_kept_to_a_part_in_ten_thousand_and_within_their_ways() {
        let hands = Hands { steering: -0.012_34, throttle: 0.567_8, brake: 2.0 };
        let kept = Input::new(hands, Signal::Left).hands();
        assert!((kept.steering - hands.steering).abs() < 2e-5);
        assert!((kept.throttle - hands.throttle).abs() < 1e-4);
        assert!((kept.brake - 1.0).abs() < 1e-12);
        let nothing = Hands { steering: f64::NAN, ..Hands::default() };
        assert_eq!(Input::new(nothing, Signal::Off), Input::default());
    }
}
