//! How an evaluation is made.

use super::{
    calibrate::SearchSettings, error::FollowingError, laws::keep_distance::SafetyBound,
    steering::SteeringGains,
};
use serde::{Deserialize, Serialize};

/// How an evaluation is made. None of it may be chosen by looking at test rows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FollowingSettings {
    /// Root of the searches' random numbers.
    pub seed: u64,
    /// How thoroughly laws are fitted.
    pub search: SearchSettings,
    /// Ego speed above which a row has a time gap, in m/s: 2 on a track, 1 in dense traffic.
    pub moving_above_mps: f64,
    /// Where the gains that steer by F come from.
    pub steering: SteeringGains,
    /// What bounds the steering by F.
    pub safety: SafetyBound,
}

impl Default for FollowingSettings {
    fn default() -> Self {
        Self {
            seed: 1,
            search: SearchSettings::default(),
            moving_above_mps: 2.0,
            steering: SteeringGains::default(),
            safety: SafetyBound::default(),
        }
    }
}

impl FollowingSettings {
    pub(crate) fn check(&self) -> Result<(), FollowingError> {
        let safety = &self.safety;
        for (name, found, least) in [
            ("moving_above_mps", self.moving_above_mps, 0.0),
            ("reaction_s", safety.reaction_s, f64::MIN_POSITIVE),
            ("reaction_accel_mps2", safety.reaction_accel_mps2, 0.0),
            (
                "ego_braking_mps2",
                safety.ego_braking_mps2,
                f64::MIN_POSITIVE,
            ),
            (
                "lead_braking_mps2",
                safety.lead_braking_mps2,
                f64::MIN_POSITIVE,
            ),
            ("standstill_gap_m", safety.standstill_gap_m, 0.0),
        ] {
            if !(found.is_finite() && found >= least) {
                let expected = if least > 0.0 {
                    "a finite number above 0"
                } else {
                    "a finite number, 0 or above"
                };
                return Err(FollowingError::BadSetting {
                    name,
                    found,
                    expected,
                });
            }
        }
        Ok(())
    }
}
