//! Cars that ride beside ego and keep it behind its lead for a while.

use super::{Arrival, Car, EgoView, Role, distance_m, find};
use crate::scenario::BlockedSettings;
use maveric_domain::VehicleId;

/// The cars of one blocked encounter, from their arrival until they leave.
///
/// # Source
/// Calibration section 1.
#[derive(Debug, Clone)]
pub(crate) struct Blockade {
    lead: VehicleId,
    since_s: f64,
    met_s: Option<f64>,
}

impl Blockade {
    /// The cars that come up in the lane beside ego, and what watches over them.
    ///
    /// An off-lane vehicle that is where they would appear becomes one of them (ours): nobody appears inside another.
    pub(crate) fn raise(
        s: &BlockedSettings,
        cars: &mut [Car],
        ego: &EgoView,
        lead: VehicleId,
        time_s: f64,
    ) -> (Self, Vec<Arrival>) {
        let lane = ego.lane + 1;
        let middle = 0.5 * (s.cars as f64 - 1.0);
        let usual_x_m = |i: usize| ego.x_m - s.appears_behind_m - s.spacing_m * i as f64;
        let place_m = |i: usize| s.spacing_m * (middle - i as f64);
        let mut shift_m = 0.0;
        let mut taken = None;
        for car in cars.iter_mut().filter(|car| car.lane == lane) {
            let passing_by = matches!(
                car.role,
                Role::Steady {
                    passing_by: true,
                    ..
                }
            );
            let off_m = |i: usize| car.state.x_m - usual_x_m(i);
            let nearest = (0..s.cars).min_by(|&i, &j| off_m(i).abs().total_cmp(&off_m(j).abs()));
            let near = nearest.filter(|&i| passing_by && off_m(i).abs() <= s.spacing_m);
            if let Some(i) = near {
                (shift_m, taken) = (off_m(i), Some(i));
                car.role = Role::Blocker {
                    place_m: place_m(i),
                    leaving: false,
                };
                break;
            }
        }
        let arrivals = (0..s.cars).filter(|&i| Some(i) != taken).map(|i| Arrival {
            x_m: usual_x_m(i) + shift_m,
            lane,
            speed_mps: ego.speed_mps + s.speed_difference_limit_mps,
            role: Role::Blocker {
                place_m: place_m(i),
                leaving: false,
            },
        });
        let blockade = Self {
            lead,
            since_s: time_s,
            met_s: None,
        };
        (blockade, arrivals.collect())
    }

    /// Whether the cars leave now: ego has followed long enough, or there is nothing left to block.
    pub(crate) fn ends(
        &mut self,
        s: &BlockedSettings,
        cars: &[Car],
        ego: &EgoView,
        time_s: f64,
    ) -> bool {
        let lead = find(cars, Some(self.lead))
            .filter(|car| car.lane == ego.lane && distance_m(ego, &car.state) > 0.0);
        let Some(lead) = lead else {
            return true;
        };
        if (lead.state.speed_mps - ego.speed_mps).abs() < s.met_within_mps {
            self.met_s.get_or_insert(time_s);
        }
        self.met_s.is_some_and(|met| time_s - met > s.rides_for_s)
            || time_s - self.since_s > s.leaves_after_s
    }
}

/// Speed of a blocker, in m/s.
pub(crate) fn wanted_mps(
    s: &BlockedSettings,
    ego: &EgoView,
    x_m: f64,
    place_m: f64,
    leaving: bool,
) -> f64 {
    if leaving {
        return ego.speed_mps + s.leaves_faster_mps;
    }
    let error = ego.x_m + place_m - x_m;
    let limit = s.speed_difference_limit_mps;
    (ego.speed_mps + (s.position_gain_per_s * error).clamp(-limit, limit)).max(0.0)
}
