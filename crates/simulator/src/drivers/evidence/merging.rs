//! When such a person merges back: at a distance in metres that has been there for a moment.

use super::population::EvidenceParams;
use crate::{
    drivers::passing::{has_room_ahead, least_room_behind_m},
    neighbours::behind,
    normal::standard_normal,
    planner::PLANNING_STEP_S,
};
use maveric_domain::{Road, Scene};
use rand_pcg::Pcg64Mcg;

/// SD of the distance from one pass to the next, in m.
const PASS_SD_M: f64 = 5.0;
/// Least distance that anybody wants, in m.
const LEAST_M: f64 = 9.0;
/// Distance behind in the passing lane within which somebody presses, in m.
const PRESSED_M: f64 = 45.0;

/// What merging back takes this time.
#[derive(Debug, Clone)]
pub(super) struct Merging {
    rng: Pcg64Mcg,
    gap_m: f64,
    there_for_s: f64,
}

impl Merging {
    pub(super) fn new(params: &EvidenceParams, rng: Pcg64Mcg) -> Self {
        Self { rng, gap_m: params.merge_back_gap_m, there_for_s: 0.0 }
    }

    /// A pass begins.
    pub(super) fn begin(&mut self, params: &EvidenceParams) {
        let noise = PASS_SD_M * standard_normal(&mut self.rng);
        self.gap_m = (params.merge_back_gap_m + noise).max(LEAST_M);
        self.there_for_s = 0.0;
    }

    /// Whether to merge back into `right` now, gaps seen with the relative error `error`.
    pub(super) fn next(
        &mut self,
        params: &EvidenceParams,
        scene: &Scene,
        road: &Road,
        right: u8,
        error: f64,
    ) -> bool {
        let pressed = behind(scene, road, right + 1).is_some_and(|n| n.gap_m < PRESSED_M);
        let hurry = if pressed { 1.0 - params.hurry } else { 1.0 };
        let wanted_m = self.gap_m * hurry;
        let room = behind(scene, road, right)
            .is_none_or(|n| n.gap_m * error > wanted_m && n.gap_m > least_room_behind_m(scene, &n));
        if room && has_room_ahead(scene, road, right) {
            self.there_for_s += PLANNING_STEP_S;
        } else {
            self.there_for_s = 0.0;
        }
        self.there_for_s > params.merge_back_hold_s * hurry
    }
}
