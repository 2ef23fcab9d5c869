//! Steering by a predicted following distance.

use super::helly::Gains;
use serde::{Deserialize, Serialize};

/// The distance that is never to be undercut, and the braking that keeps it.
///
/// # Source
/// The responsibility-sensitive-safety rule of Shalev-Shwartz, Shammah and Shashua 2017, plus a gap at standstill.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SafetyBound {
    /// Time before ego brakes, in s.
    pub reaction_s: f64,
    /// Ego's acceleration until then, in m/s².
    pub reaction_accel_mps2: f64,
    /// Braking of ego after that, in m/s².
    pub ego_braking_mps2: f64,
    /// Hardest braking of the leader, in m/s².
    pub lead_braking_mps2: f64,
    /// Gap kept at standstill, in m.
    pub standstill_gap_m: f64,
}

impl Default for SafetyBound {
    /// Reaction 0.3 s at 1 m/s², ego braking at 7 m/s² and its leader at 8 m/s², and 2 m.
    ///
    /// The usual numbers (1 s, 4 against 8 m/s²) ask for 94 m at 30 m/s: more than anybody keeps.
    fn default() -> Self {
        Self {
            reaction_s: 0.3,
            reaction_accel_mps2: 1.0,
            ego_braking_mps2: 7.0,
            lead_braking_mps2: 8.0,
            standstill_gap_m: 2.0,
        }
    }
}

impl SafetyBound {
    /// The least safe gap at these speeds, in m.
    pub fn distance_m(&self, ego_speed_mps: f64, lead_speed_mps: f64) -> f64 {
        let after = ego_speed_mps + self.reaction_s * self.reaction_accel_mps2;
        let reacting = 0.5 * (ego_speed_mps + after) * self.reaction_s;
        let stopping = after * after / (2.0 * self.ego_braking_mps2);
        let lead_stops = lead_speed_mps * lead_speed_mps / (2.0 * self.lead_braking_mps2);
        self.standstill_gap_m + (reacting + stopping - lead_stops).max(0.0)
    }

    /// The speed at which `gap_m` is the least safe gap, in m/s; 0 where no speed is safe.
    pub fn safe_speed_mps(&self, gap_m: f64, lead_speed_mps: f64) -> f64 {
        // [`SafetyBound::distance_m`], a parabola in the speed after the reaction, solved for that speed.
        let gained = self.reaction_s * self.reaction_accel_mps2;
        let lead_stops = lead_speed_mps * lead_speed_mps / (2.0 * self.lead_braking_mps2);
        let room = gap_m - self.standstill_gap_m + lead_stops + 0.5 * gained * self.reaction_s;
        let reacting = self.ego_braking_mps2 * self.reaction_s;
        let square = reacting * reacting + 2.0 * self.ego_braking_mps2 * room;
        (square.max(0.0).sqrt() - reacting - gained).max(0.0)
    }

    /// How much [`SafetyBound::safe_speed_mps`] grows with the gap, in 1/s; 0 where no speed is safe.
    pub(crate) fn safe_speed_slope_per_s(&self, gap_m: f64, lead_speed_mps: f64) -> f64 {
        let safe = self.safe_speed_mps(gap_m, lead_speed_mps);
        if safe > 0.0 {
            let gained = self.reaction_s * self.reaction_accel_mps2;
            self.ego_braking_mps2 / (safe + gained + self.ego_braking_mps2 * self.reaction_s)
        } else {
            0.0
        }
    }

    /// The most that ego may accelerate, in m/s²: to the safe speed within the reaction time, so a braking where the
    /// gap is not safe.
    pub fn most_accel_mps2(&self, gap_m: f64, ego_speed_mps: f64, lead_speed_mps: f64) -> f64 {
        (self.safe_speed_mps(gap_m, lead_speed_mps) - ego_speed_mps) / self.reaction_s
    }
}

/// Steers by a predicted following distance: [`Gains`] towards max(F(v_lead), safe distance).
#[derive(Debug, Clone)]
pub struct KeepDistance<F> {
    /// F: following distance (m) from the leader's speed (m/s).
    pub distance_m: F,
    /// How hard it steers.
    pub gains: Gains,
    /// What it never asks for less than.
    pub safety: SafetyBound,
}

impl<F: Fn(f64) -> f64> KeepDistance<F> {
    /// Acceleration, in m/s²; not finite if F is not.
    pub fn accel_mps2(&self, gap_m: f64, ego_speed_mps: f64, lead_speed_mps: f64) -> f64 {
        let safe = self.safety.distance_m(ego_speed_mps, lead_speed_mps);
        let predicted = (self.distance_m)(lead_speed_mps);
        // `f64::max` would hide a prediction that is no number.
        let wanted = if predicted < safe { safe } else { predicted };
        let steering = self
            .gains
            .accel_mps2(gap_m, wanted, ego_speed_mps, lead_speed_mps);
        let most = self
            .safety
            .most_accel_mps2(gap_m, ego_speed_mps, lead_speed_mps);
        if steering > most { most } else { steering }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FollowingError, made_up, simulate};

    const GAINS: Gains = Gains {
        speed_per_s: 0.4,
        gap_per_s2: 0.015,
    };

    fn keeping<F: Fn(f64) -> f64>(distance_m: F) -> KeepDistance<F> {
        KeepDistance {
            distance_m,
            gains: GAINS,
            safety: SafetyBound::default(),
        }
    }

    #[test]
    fn at_standstill_the_safe_distance_is_two_metres_and_at_speed_about_twenty() {
        let safety = SafetyBound::default();
        assert!(safety.distance_m(0.0, 0.0) < 2.1);
        assert!((safety.distance_m(30.0, 30.0) - 20.4).abs() < 0.1);
    }

    #[test]
    fn the_safe_speed_is_the_one_whose_safe_distance_is_the_gap() {
        let safety = SafetyBound::default();
        for (speed, lead) in [(5.0, 3.0), (20.0, 18.0), (30.0, 29.0)] {
            let gap = safety.distance_m(speed, lead);
            assert!((safety.safe_speed_mps(gap, lead) - speed).abs() < 1e-9);
        }
        assert!(safety.safe_speed_mps(1.0, 0.0).abs() < 1e-12);
    }

    #[test]
    fn the_predicted_distance_is_kept_where_it_is_safe() {
        let run = made_up::behind("P01", 6000, 20.0, 10.0, |_| 10.0);
        let law = keeping(|lead| 5.0 + 2.0 * lead);
        let driven = simulate(&run.test(), "F", |g, v, l| law.accel_mps2(g, v, l)).unwrap();
        assert!((driven.gap_m.last().unwrap() - 25.0).abs() < 0.05);
    }

    #[test]
    fn a_distance_below_zero_at_standstill_does_not_reach_the_leader() {
        // The leader brakes to a stop at 8 m/s² within the test rows; the line asks for -25 m there.
        let stop = |t: f64| (20.0 - 8.0 * (t - 30.0).max(0.0)).max(0.0);
        let run = made_up::behind("P01", 600, 40.0, 20.0, stop);
        let law = keeping(|lead| 3.4 * lead - 25.0);
        let driven = simulate(&run.fit(), "F", |g, v, l| law.accel_mps2(g, v, l)).unwrap();
        assert!(driven.gap_m.iter().all(|&gap| gap > 1.0));
        assert!(driven.speed_mps.last().unwrap().abs() < 1e-6);
    }

    #[test]
    fn a_prediction_that_is_no_number_is_not_hidden_by_the_bound() {
        let run = made_up::behind("P01", 30, 40.0, 20.0, |_| 20.0);
        let law = keeping(|_| f64::NAN);
        let driven = simulate(&run.test(), "F", |g, v, l| law.accel_mps2(g, v, l));
        assert!(matches!(driven, Err(FollowingError::LawNotFinite { .. })));
    }
}
