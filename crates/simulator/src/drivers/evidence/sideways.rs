//! Where in the lane such a person drives.

use super::population::EvidenceParams;
use crate::{drivers::noise::OrnsteinUhlenbeck, planner::PLANNING_STEP_S};
use rand_pcg::Pcg64Mcg;

/// Correlation time of the weave, in s.
const WEAVE_TIME_S: f64 = 8.0;
/// Time in which a person moves to where they mean to be in the lane, in s.
const MOVES_OVER_S: f64 = 2.0;
/// Weave beyond this many SDs is held back.
const MOST_SDS: f64 = 2.5;

/// Place within the lane, in m to the left of its centre.
#[derive(Debug, Clone)]
pub(super) struct Sideways {
    weave: OrnsteinUhlenbeck,
    offset_m: f64,
}

impl Sideways {
    pub(super) fn new(params: &EvidenceParams, rng: Pcg64Mcg) -> Self {
        Self {
            weave: OrnsteinUhlenbeck::new(params.weave_sd_m, WEAVE_TIME_S, PLANNING_STEP_S, rng),
            offset_m: 0.0,
        }
    }

    /// The next place, leaning out by `lean` (0 to 1) of what this person leans before passing.
    pub(super) fn next(&mut self, params: &EvidenceParams, lean: f64) -> f64 {
        let most_m = MOST_SDS * params.weave_sd_m;
        let weave_m = self.weave.next().clamp(-most_m, most_m);
        let meant_m = params.lane_offset_m + weave_m + lean * params.peek_m;
        self.offset_m += PLANNING_STEP_S / MOVES_OVER_S * (meant_m - self.offset_m);
        self.offset_m
    }
}
