//! What a driver sees of the lead: late, and with an error that lingers.

use super::{idm::SeenLead, noise::OrnsteinUhlenbeck};
use crate::{neighbours::Neighbour, planner::PLANNING_STEP_S};
use maveric_domain::VehicleId;
use std::collections::VecDeque;

/// Correlation time of the error of gaps, in s, of people who have none of their own.
pub(super) const GAP_ERROR_TIME_S: f64 = 2.0;

#[derive(Debug, Clone, Copy)]
struct Glance {
    id: VehicleId,
    lead: SeenLead,
}

/// Delayed, noisy sight of the vehicle ahead.
#[derive(Debug, Clone)]
pub(super) struct Perception {
    error: OrnsteinUhlenbeck,
    delay_rows: usize,
    seen: VecDeque<Option<Glance>>,
}

impl Perception {
    /// `error` is the relative error of gaps, sampled at every planning step.
    pub(super) fn new(error: OrnsteinUhlenbeck, delay_s: f64) -> Self {
        Self {
            error,
            delay_rows: (delay_s / PLANNING_STEP_S).round() as usize,
            seen: VecDeque::new(),
        }
    }

    /// Takes the next moment and gives the relative error of gaps in it.
    pub(super) fn next_error(&mut self) -> f64 {
        // No gap is ever seen below half or above twice what it is.
        (1.0 + self.error.next()).clamp(0.5, 2.0)
    }

    /// The vehicle ahead as seen now: as it was a delay ago, or as it is if it came into view since.
    pub(super) fn see(
        &mut self,
        ahead: Option<Neighbour>,
        ego_mps: f64,
        error: f64,
    ) -> Option<SeenLead> {
        let now = ahead.map(|n| Glance {
            id: n.vehicle.id,
            lead: SeenLead {
                gap_m: n.gap_m,
                closing_mps: ego_mps - n.vehicle.speed_mps,
            },
        });
        self.seen.push_back(now);
        while self.seen.len() > self.delay_rows + 1 {
            self.seen.pop_front();
        }
        let now = now?;
        let then = self.seen.iter().flatten().find(|g| g.id == now.id);
        let lead = then.unwrap_or(&now).lead;
        Some(SeenLead {
            gap_m: lead.gap_m * error,
            closing_mps: lead.closing_mps,
        })
    }
}
