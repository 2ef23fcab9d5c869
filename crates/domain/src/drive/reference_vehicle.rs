//! Which vehicle ego drives by: the reference vehicle.

use crate::{
    ids::VehicleId,
    scene::{Reference, Road, Scene, VehicleState, bumper_distance_m},
};

/// Follows the reference vehicle from row to row, in a log and in the simulated car alike.
///
/// The nearest vehicle ahead in ego's lane within 200 m. When ego moves out to pass it, it stays the
/// reference until ego merges back in front of it, it is more than 200 m away, or a vehicle ahead in ego's own
/// lane comes within 100 m.
///
/// # Source
/// Method section 2, and calibration section 4 for two remedies: in a passing lane without a reference the nearest vehicle
/// behind in the lane to the right becomes it (else the planner sees free road and stays left for ever), and a car
/// ahead in the passing lane replaces a passed one only if it is slower than ego + 0.5 m/s.
#[derive(Debug, Clone)]
pub struct ReferenceTracker {
    road: Road,
    current: Option<Tracked>,
}

#[derive(Debug, Clone, Copy)]
struct Tracked {
    id: VehicleId,
    /// Ego has moved out of this vehicle's lane, to pass it.
    passing: bool,
}

/// Distance within which a vehicle ahead in ego's new lane takes over from the one being passed, in m.
const TAKE_OVER_M: f64 = 100.0;
/// How much faster than ego such a vehicle may be, in m/s.
const TAKE_OVER_FASTER_MPS: f64 = 0.5;

impl ReferenceTracker {
    /// A tracker that has seen nothing yet.
    pub fn new(road: Road) -> Self {
        Self { road, current: None }
    }

    /// Takes the next scene and gives the signals about the reference vehicle in it.
    pub fn observe(&mut self, scene: &Scene) -> Reference {
        let road = self.road;
        let ego = &scene.ego;
        let lane = road.nearest_lane(ego.y_m);
        let distance = |v: &VehicleState| bumper_distance_m(ego, v);
        let near = |v: &&VehicleState| distance(v).abs() <= Reference::FREE_ROAD_DX_M;
        let by_distance =
            |a: &&VehicleState, b: &&VehicleState| distance(a).abs().total_cmp(&distance(b).abs());
        let ahead = scene
            .vehicles
            .iter()
            .filter(near)
            .filter(|v| road.is_in_lane_of(ego, v.y_m) && v.x_m > ego.x_m)
            .min_by(by_distance);
        let behind_right = || {
            let right = lane.checked_sub(1)?;
            scene
                .vehicles
                .iter()
                .filter(near)
                .filter(|v| road.lane_at(v.y_m) == Some(right) && v.x_m < ego.x_m)
                .min_by(by_distance)
        };

        let current = self.current.and_then(|tracked| {
            let vehicle = scene.vehicles.iter().filter(near).find(|v| v.id == tracked.id)?;
            Some((vehicle, tracked.passing))
        });
        let passed = current.filter(|(vehicle, passing)| {
            // Ego left its lane just now, or is beside or ahead of it already; who left the road is passed by nobody.
            let out = road
                .lane_at(vehicle.y_m)
                .is_some_and(|its| its < lane || (its != lane && *passing));
            let taken_over = ahead.is_some_and(|a| {
                a.id != vehicle.id
                    && distance(a) < TAKE_OVER_M
                    && a.speed_mps < ego.speed_mps + TAKE_OVER_FASTER_MPS
            });
            out && !taken_over
        });
        let passing_lane_ahead = |a: &&VehicleState| {
            lane == 0
                || (distance(a) < TAKE_OVER_M && a.speed_mps < ego.speed_mps + TAKE_OVER_FASTER_MPS)
        };
        let chosen = match passed {
            Some((vehicle, _)) => Some((vehicle, true)),
            None => ahead
                .filter(passing_lane_ahead)
                .map(|v| (v, false))
                .or_else(|| behind_right().map(|v| (v, true)))
                .or_else(|| ahead.map(|v| (v, false))),
        };
        self.current = chosen.map(|(vehicle, passing)| Tracked { id: vehicle.id, passing });
        match chosen {
            Some((vehicle, _)) => Reference {
                vehicle: Some(vehicle.id),
                dx_m: distance(vehicle),
                dy_m: vehicle.y_m - ego.y_m,
                speed_mps: vehicle.speed_mps,
            },
            None => Reference::free_road(&road),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::EgoState;

    fn scene(ego: (f64, f64), others: &[(u32, f64, f64, f64)]) -> Scene {
        Scene {
            time_s: 0.0,
            ego: EgoState { x_m: ego.0, y_m: ego.1, speed_mps: 30.0, length_m: 5.0 },
            vehicles: others
                .iter()
                .map(|&(id, x_m, y_m, speed_mps)| VehicleState {
                    id: VehicleId(id),
                    x_m,
                    y_m,
                    speed_mps,
                    length_m: 5.0,
                })
                .collect(),
        }
    }

    fn lead(reference: &Reference) -> Option<u32> {
        reference.vehicle.map(|v| v.0)
    }

    #[test]
    fn the_nearest_ahead_in_the_own_lane_is_the_reference() {
        let mut tracker = ReferenceTracker::new(Road::PAPER);
        let seen = tracker.observe(&scene(
            (0.0, 0.0),
            &[(1, 90.0, 0.0, 25.0), (2, 50.0, 0.0, 25.0), (3, 20.0, 3.66, 25.0)],
        ));
        assert_eq!(lead(&seen), Some(2));
        assert!((seen.dx_m - 45.0).abs() < 1e-12);
    }

    #[test]
    fn a_car_beside_a_road_of_one_lane_has_the_car_ahead_of_it_as_reference() {
        let width = Road::PAPER.lane_width_m;
        let road = Road { lanes: 1, ..Road::PAPER };
        for y in [-width, 0.0, width] {
            let others = [(1, 50.0, y, 25.0), (2, 30.0, y + 2.0 * width, 25.0)];
            let seen = ReferenceTracker::new(road).observe(&scene((0.0, y), &others));
            assert_eq!(lead(&seen), Some(1), "{y}");
        }
        // Of several lanes it is known where they are.
        let two = ReferenceTracker::new(Road::PAPER)
            .observe(&scene((0.0, -width), &[(1, 50.0, -width, 25.0)]));
        assert_eq!(lead(&two), None);
    }

    #[test]
    fn an_empty_road_gives_the_free_road_values() {
        let seen = ReferenceTracker::new(Road::PAPER)
            .observe(&scene((0.0, 0.0), &[(1, 300.0, 0.0, 25.0)]));
        assert_eq!(seen, Reference::free_road(&Road::PAPER));
    }

    #[test]
    fn a_passed_vehicle_stays_the_reference_until_ego_merges_back() {
        let mut tracker = ReferenceTracker::new(Road::PAPER);
        assert_eq!(lead(&tracker.observe(&scene((0.0, 0.0), &[(1, 50.0, 0.0, 25.0)]))), Some(1));
        for (x, y) in [(10.0, 2.0), (30.0, 3.66), (60.0, 3.66), (90.0, 3.66)] {
            assert_eq!(lead(&tracker.observe(&scene((x, y), &[(1, 50.0, 0.0, 25.0)]))), Some(1));
        }
        assert_eq!(lead(&tracker.observe(&scene((95.0, 1.0), &[(1, 50.0, 0.0, 25.0)]))), None);
    }

    #[test]
    fn a_slower_car_ahead_in_the_passing_lane_takes_over_and_a_faster_one_does_not() {
        for (speed, expected) in [(25.0, 2), (35.0, 1)] {
            let mut tracker = ReferenceTracker::new(Road::PAPER);
            tracker.observe(&scene((0.0, 0.0), &[(1, 50.0, 0.0, 25.0)]));
            let seen = tracker
                .observe(&scene((10.0, 3.0), &[(1, 50.0, 0.0, 25.0), (2, 80.0, 3.66, speed)]));
            assert_eq!(lead(&seen), Some(expected));
        }
    }

    #[test]
    fn in_the_passing_lane_the_nearest_behind_in_the_slow_lane_is_found_again() {
        let mut tracker = ReferenceTracker::new(Road::PAPER);
        let seen = tracker.observe(&scene((100.0, 3.66), &[(1, 50.0, 0.0, 25.0)]));
        assert_eq!(lead(&seen), Some(1));
        assert!(seen.dx_m < 0.0);
    }
}
