//! Steering by a predicted following distance.

use maveric_laws::{Gains, Rss};

/// Steers by a predicted following distance: [`Gains`] towards max(F(v_lead), safe distance).
#[derive(Debug, Clone)]
pub struct KeepDistance<F> {
    /// F: following distance (m) from the leader's speed (m/s).
    pub distance_m: F,
    /// How hard it steers.
    pub gains: Gains,
    /// What it never asks for less than.
    pub safety: Rss,
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
    use crate::{FollowingError, settings::SAFETY, simulate, testing};

    fn keeping<F: Fn(f64) -> f64>(distance_m: F) -> KeepDistance<F> {
        KeepDistance {
            distance_m,
            gains: Gains {
                speed_per_s: 0.4,
                gap_per_s2: 0.015,
            },
            safety: SAFETY,
        }
    }

    #[test]
    fn the_predicted_distance_is_kept_where_it_is_safe() {
        let run = testing::behind("P01", 6000, 20.0, 10.0, |_| 10.0);
        let law = keeping(|lead| 5.0 + 2.0 * lead);
        let driven = simulate(&run.test(), "F", |g, v, l| law.accel_mps2(g, v, l)).unwrap();
        assert!((driven.gap_m.last().unwrap() - 25.0).abs() < 0.05);
    }

    #[test]
    fn a_distance_below_zero_at_standstill_does_not_reach_the_leader() {
        // The leader brakes to a stop at 8 m/s² within the test rows; the line asks for -25 m there.
        let stop = |t: f64| (20.0 - 8.0 * (t - 30.0).max(0.0)).max(0.0);
        let run = testing::behind("P01", 600, 40.0, 20.0, stop);
        let law = keeping(|lead| 3.4 * lead - 25.0);
        let driven = simulate(&run.fit(), "F", |g, v, l| law.accel_mps2(g, v, l)).unwrap();
        assert!(driven.gap_m.iter().all(|&gap| gap > 1.0));
        assert!(driven.speed_mps.last().unwrap().abs() < 1e-6);
    }

    #[test]
    fn a_prediction_that_is_no_number_is_not_hidden_by_the_bound() {
        let run = testing::behind("P01", 30, 40.0, 20.0, |_| 20.0);
        let law = keeping(|_| f64::NAN);
        let driven = simulate(&run.test(), "F", |g, v, l| law.accel_mps2(g, v, l));
        assert!(matches!(driven, Err(FollowingError::LawNotFinite { .. })));
    }
}
