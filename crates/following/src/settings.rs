//! How an evaluation is made.

use crate::{
    closed_loop_network::{ClosedLoopSettings, check},
    error::FollowingError,
    search::SearchSettings,
};
use maveric_laws::Rss;
use serde::{Deserialize, Serialize};

/// What bounds whatever is learned: reaction 0.3 s at 1 m/s², ego braking at 7 m/s² and its leader at 8 m/s², and 2 m at
/// standstill. The usual numbers (1 s, 4 against 8 m/s²) ask for 94 m at 30 m/s: more than anybody keeps.
pub const SAFETY: Rss = Rss {
    reaction_s: 0.3,
    reaction_accel_mps2: 1.0,
    ego_braking_mps2: 7.0,
    lead_braking_mps2: 8.0,
    standstill_gap_m: 2.0,
};

/// How an evaluation is made. None of it may be chosen by looking at test rows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FollowingSettings {
    /// Root of every random number.
    pub seed: u64,
    /// How thoroughly laws are fitted.
    pub search: SearchSettings,
    /// Ego speed above which a row has a time gap, in m/s: 2 on a track, 1 in dense traffic.
    pub moving_above_mps: f64,
    /// What bounds the network and the steering by F.
    pub safety: Rss,
    /// From how many seeds the network is trained through its own simulated following; 0 leaves it out.
    pub closed_loop_seeds: usize,
    /// How it is trained.
    pub closed_loop: ClosedLoopSettings,
}

impl Default for FollowingSettings {
    fn default() -> Self {
        Self {
            seed: 1,
            search: SearchSettings::default(),
            moving_above_mps: 2.0,
            safety: SAFETY,
            closed_loop_seeds: 5,
            closed_loop: ClosedLoopSettings::default(),
        }
    }
}

impl FollowingSettings {
    pub(crate) fn check(&self) -> Result<(), FollowingError> {
        let (safety, above) = (&self.safety, f64::MIN_POSITIVE);
        check(&[
            ("moving_above_mps", self.moving_above_mps, 0.0),
            ("reaction_s", safety.reaction_s, above),
            ("reaction_accel_mps2", safety.reaction_accel_mps2, 0.0),
            ("ego_braking_mps2", safety.ego_braking_mps2, above),
            ("lead_braking_mps2", safety.lead_braking_mps2, above),
            ("standstill_gap_m", safety.standstill_gap_m, 0.0),
        ])
    }
}
