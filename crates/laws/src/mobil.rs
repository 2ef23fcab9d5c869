//! MOBIL: whether a lane change is worth it, and safe.

use serde::{Deserialize, Serialize};

/// What a driver weighs before a lane change.
///
/// # Source
/// Kesting, Treiber and Helbing 2007, "General lane-changing model MOBIL for car-following models".
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Mobil {
    /// p: weight of what others gain or lose beside the own gain.
    pub politeness: f64,
    /// Gain that a change has to bring, in m/s².
    pub threshold_mps2: f64,
    /// Extra gain that a change to the left has to bring, and that one to the right need not, in m/s².
    pub keep_right_mps2: f64,
    /// Hardest braking that a change may ask of anybody, in m/s², positive.
    pub safe_braking_mps2: f64,
}

/// Accelerations before and after a lane change, in m/s²; `None` where there is nobody.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sides {
    /// The driver's own.
    pub own: (f64, f64),
    /// The new follower's.
    pub new_follower: Option<(f64, f64)>,
    /// The old follower's.
    pub old_follower: Option<(f64, f64)>,
}

impl Mobil {
    /// Whether the driver changes; `to_the_left` says which way.
    pub fn wants(&self, sides: &Sides, to_the_left: bool) -> bool {
        let safe = |after: f64| after >= -self.safe_braking_mps2;
        if !safe(sides.own.1) || sides.new_follower.is_some_and(|(_, after)| !safe(after)) {
            return false;
        }
        let gain = |(before, after): (f64, f64)| after - before;
        let others = sides.new_follower.map_or(0.0, gain) + sides.old_follower.map_or(0.0, gain);
        let bias = if to_the_left { 1.0 } else { -1.0 } * self.keep_right_mps2;
        gain(sides.own) + self.politeness * others > self.threshold_mps2 + bias
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOBIL: Mobil = Mobil {
        politeness: 0.5,
        threshold_mps2: 0.1,
        keep_right_mps2: 0.3,
        safe_braking_mps2: 4.0,
    };
    const GAIN: Sides = Sides { own: (-0.5, 0.0), new_follower: None, old_follower: None };

    #[test]
    fn a_gain_above_threshold_and_bias_is_taken() {
        assert!(MOBIL.wants(&GAIN, true), ".5 > .1 + .3");
        let less = Sides { own: (-0.3, 0.0), ..GAIN };
        assert!(!MOBIL.wants(&less, true) && MOBIL.wants(&less, false));
    }

    #[test]
    fn what_the_others_lose_counts_by_politeness() {
        let cost = |loss: f64| Sides { new_follower: Some((0.0, -loss)), ..GAIN };
        assert!(MOBIL.wants(&cost(0.1), true), ".5 - .05 > .4");
        assert!(!MOBIL.wants(&cost(0.3), true), ".5 - .15 < .4");
        let freed = Sides { old_follower: Some((-1.0, 0.0)), ..cost(0.3) };
        assert!(MOBIL.wants(&freed, true));
    }

    #[test]
    fn nobody_is_made_to_brake_harder_than_is_safe() {
        let hard = Sides { own: (-9.0, 1.0), new_follower: Some((0.0, -4.1)), old_follower: None };
        assert!(!MOBIL.wants(&hard, false));
        assert!(!MOBIL.wants(&Sides { own: (-9.0, -4.1), ..GAIN }, false));
    }
}
