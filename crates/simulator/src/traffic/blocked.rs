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
            let passing_by = matches!(car.role, Role::Steady { passing_by: true, .. });
            let off_m = |i: usize| car.state.x_m - usual_x_m(i);
            let nearest = (0..s.cars).min_by(|&i, &j| off_m(i).abs().total_cmp(&off_m(j).abs()));
            let near = nearest.filter(|&i| passing_by && off_m(i).abs() <= s.spacing_m);
            if let Some(i) = near {
                (shift_m, taken) = (off_m(i), Some(i));
                car.role = Role::Blocker { place_m: place_m(i), leaving: false };
                break;
            }
        }
        let arrivals = (0..s.cars).filter(|&i| Some(i) != taken).map(|i| Arrival {
            x_m: usual_x_m(i) + shift_m,
            lane,
            speed_mps: ego.speed_mps + s.speed_difference_limit_mps,
            role: Role::Blocker { place_m: place_m(i), leaving: false },
        });
        let blockade = Self { lead, since_s: time_s, met_s: None };
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{car, seen_ego};
    use std::sync::LazyLock;

    static S: LazyLock<BlockedSettings> = LazyLock::new(BlockedSettings::default);

    #[test]
    fn a_blocker_makes_for_its_place_beside_ego_and_leaves_faster() {
        let ego = seen_ego();
        let wanted = |x_m: f64, leaving| wanted_mps(&S, &ego, x_m, 22.0, leaving);
        // A quarter of what is missing a second, 5 m/s at most.
        for (x_m, expected) in
            [(22.0, 20.0), (14.0, 22.0), (30.0, 18.0), (-60.0, 25.0), (90.0, 15.0)]
        {
            assert!((wanted(x_m, false) - expected).abs() < 1e-12, "{x_m}");
        }
        assert!((wanted(22.0, true) - 26.0).abs() < 1e-12);
    }

    #[test]
    fn the_cars_come_up_behind_in_a_row_and_one_that_passes_by_becomes_one_of_them() {
        let ego = seen_ego();
        let places = |cars: &mut [Car]| {
            let (_, arrivals) = Blockade::raise(&S, cars, &ego, VehicleId(1), 0.0);
            let place = |role: &Role| match role {
                Role::Blocker { place_m, leaving: false } => *place_m,
                _ => f64::NAN,
            };
            let found = arrivals.iter().map(|a| (a.x_m, place(&a.role)));
            assert!(arrivals.iter().all(|a| a.lane == 1 && (a.speed_mps - 25.0).abs() < 1e-12));
            found.collect::<Vec<_>>()
        };
        assert_eq!(places(&mut []), [(-110.0, 22.0), (-132.0, 0.0), (-154.0, -22.0)]);
        let passing = |x_m: f64, lane, passing_by| {
            let role = Role::Steady { speed_mps: 24.0, passing_by };
            let mut car = car(7, -1.0, lane, 24.0, role);
            car.state.x_m = x_m;
            [car]
        };
        // Two metres ahead of the middle one's place: it is the middle one, and the others keep their distance to it.
        let mut near = passing(-130.0, 1, true);
        assert_eq!(places(&mut near), [(-108.0, 22.0), (-152.0, -22.0)]);
        assert!(matches!(near[0].role, Role::Blocker { place_m, .. } if place_m.abs() < 1e-12));
        for mut other in
            [passing(-130.0, 0, true), passing(-130.0, 1, false), passing(-80.0, 1, true)]
        {
            assert_eq!(places(&mut other).len(), 3);
        }
    }

    #[test]
    fn they_leave_once_ego_has_followed_for_a_while_or_has_no_lead() {
        let ego = seen_ego();
        let role = Role::Steady { speed_mps: 20.0, passing_by: false };
        let lead = |gap_m: f64, lane, speed_mps| [car(1, gap_m, lane, speed_mps, role)];
        let after = |cars: &[Car]| {
            let (mut blockade, _) = Blockade::raise(&S, &mut [], &ego, VehicleId(1), 100.0);
            (0..1000).find(|s| blockade.ends(&S, cars, &ego, 100.0 + f64::from(*s)))
        };
        // 15 s after the speeds have met; 70 s where they do not.
        assert_eq!(after(&lead(40.0, 0, 21.4)), Some(16));
        assert_eq!(after(&lead(40.0, 0, 18.6)), Some(16));
        assert_eq!(after(&lead(40.0, 0, 21.6)), Some(71));
        for gone in [&lead(40.0, 1, 20.0)[..], &lead(-40.0, 0, 20.0), &[]] {
            assert_eq!(after(gone), Some(0));
        }
    }
}
