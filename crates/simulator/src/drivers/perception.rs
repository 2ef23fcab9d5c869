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
            lead: SeenLead { gap_m: n.gap_m, closing_mps: ego_mps - n.vehicle.speed_mps },
        });
        self.seen.push_back(now);
        while self.seen.len() > self.delay_rows + 1 {
            self.seen.pop_front();
        }
        let now = now?;
        let then = self.seen.iter().flatten().find(|g| g.id == now.id);
        let lead = then.unwrap_or(&now).lead;
        Some(SeenLead { gap_m: lead.gap_m * error, closing_mps: lead.closing_mps })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::other;
    use rand::SeedableRng;
    use rand_pcg::Pcg64Mcg;

    fn wander(sd: f64) -> OrnsteinUhlenbeck {
        OrnsteinUhlenbeck::new(sd, 2.0, PLANNING_STEP_S, Pcg64Mcg::seed_from_u64(1))
    }

    #[test]
    fn a_lead_is_seen_as_it_was_and_one_that_is_new_as_it_is() {
        let mut perception = Perception::new(wander(0.0), 0.2);
        assert!((perception.next_error() - 1.0).abs() < 1e-12);
        let mut see = |id, gap_m: f64, error: f64| {
            let vehicle = other(id, gap_m, 0.0, gap_m);
            let seen = perception.see(Some(Neighbour { vehicle, gap_m }), 60.0, error);
            seen.map(|lead| (lead.gap_m, lead.closing_mps)).unwrap()
        };
        // Four rows late: until then as it was at first.
        let gaps = (0..7).map(|row| see(1, 50.0 - f64::from(row), 1.0));
        let expected = [50.0, 50.0, 50.0, 50.0, 50.0, 49.0, 48.0].map(|gap| (gap, 60.0 - gap));
        assert!(gaps.eq(expected));
        // The error is of the gap alone, and of this moment.
        assert_eq!(see(2, 20.0, 1.5), (30.0, 40.0));
        assert_eq!(see(2, 19.0, 0.5), (10.0, 40.0));
        assert!(perception.see(None, 60.0, 1.0).is_none());
    }

    #[test]
    fn no_gap_is_seen_below_half_or_above_twice_what_it_is() {
        let mut perception = Perception::new(wander(9.0), 0.0);
        let errors: Vec<f64> = (0..1000).map(|_| perception.next_error()).collect();
        let (low, high) = (
            errors.iter().copied().fold(f64::INFINITY, f64::min),
            errors.iter().copied().fold(0.0, f64::max),
        );
        assert_eq!((low, high), (0.5, 2.0));
    }
}
