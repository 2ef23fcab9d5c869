//! When such a person moves out: evidence that leaks, against a threshold that falls.

use super::population::EvidenceParams;
use crate::{drivers::idm::SeenLead, normal::standard_normal, planner::PLANNING_STEP_S};
use maveric_domain::VehicleId;
use rand_pcg::Pcg64Mcg;

/// Speed that a lead costs, in m/s, and time gap behind it, in s, at which evidence grows by 1 a second.
const UNIT_GAIN_MPS: f64 = 3.0;
/// See above.
const UNIT_TIME_GAP_S: f64 = 2.0;
/// Shortest time gap that counts, in s.
const SHORTEST_TIME_GAP_S: f64 = 0.4;
/// Time gap within which a person is behind a lead rather than approaching it, in s.
const BEHIND_TIME_GAP_S: f64 = 4.0;
/// Spread of the evidence at rest, as a share of the threshold.
const RESTLESSNESS: f64 = 0.1;
/// Evidence never exceeds this many thresholds, so that a lane that opens late does not find years of it.
const MOST_THRESHOLDS: f64 = 2.0;

/// Evidence for passing the present lead.
#[derive(Debug, Clone)]
pub(super) struct Urge {
    rng: Pcg64Mcg,
    lead: Option<VehicleId>,
    evidence: f64,
    behind_for_s: f64,
}

impl Urge {
    pub(super) fn new(rng: Pcg64Mcg) -> Self {
        Self { rng, lead: None, evidence: 0.0, behind_for_s: 0.0 }
    }

    /// How near the evidence is to its threshold after this moment: 1 or above, the person wants to pass now.
    pub(super) fn next(
        &mut self,
        params: &EvidenceParams,
        lead: Option<(VehicleId, SeenLead)>,
        ego_mps: f64,
    ) -> f64 {
        // One draw a moment, whatever is ahead: another lead changes no later draw.
        let noise = standard_normal(&mut self.rng);
        let id = lead.map(|(id, _)| id);
        if id != self.lead {
            (self.lead, self.evidence, self.behind_for_s) = (id, 0.0, 0.0);
        }
        let Some((_, seen)) = lead else {
            return 0.0;
        };
        let time_gap_s = (seen.gap_m / ego_mps.max(1.0)).max(SHORTEST_TIME_GAP_S);
        if time_gap_s < BEHIND_TIME_GAP_S {
            self.behind_for_s += PLANNING_STEP_S;
        }
        let lead_mps = ego_mps - seen.closing_mps;
        let gain_mps = (params.desired_speed_mps - lead_mps).max(0.0);
        let nearness = UNIT_TIME_GAP_S / time_gap_s;
        let grows = gain_mps / UNIT_GAIN_MPS * nearness * nearness;
        let kick = RESTLESSNESS * params.threshold * (2.0 / params.memory_s).sqrt();
        self.evidence += PLANNING_STEP_S * (grows - self.evidence / params.memory_s)
            + kick * PLANNING_STEP_S.sqrt() * noise;
        self.evidence = self.evidence.clamp(0.0, MOST_THRESHOLDS * params.threshold);
        if gain_mps <= 0.0 {
            return 0.0;
        }
        let threshold = params.threshold * libm::exp(-self.behind_for_s / params.waiting_s);
        self.evidence / threshold
    }
}
