//! How an evaluation is made.

use crate::{error::FollowingError, search::SearchSettings};
use serde::{Deserialize, Serialize};

/// How an evaluation is made. None of it may be chosen by looking at test rows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FollowingSettings {
    /// Root of every random number.
    pub seed: u64,
    /// How thoroughly IDM is fitted.
    pub search: SearchSettings,
    /// Ego speed that a driver must exceed in the fit rows to have a time gap, in m/s: 2 on a track, 1 in dense traffic.
    pub moving_above_mps: f64,
}

impl Default for FollowingSettings {
    fn default() -> Self {
        Self { seed: 1, search: SearchSettings::default(), moving_above_mps: 2.0 }
    }
}

impl FollowingSettings {
    pub(crate) fn check(&self) -> Result<(), FollowingError> {
        let found = self.moving_above_mps;
        if found.is_finite() && found >= 0.0 {
            return Ok(());
        }
        Err(FollowingError::BadSetting {
            name: "moving_above_mps",
            found,
            expected: "a finite number, 0 or above",
        })
    }
}
