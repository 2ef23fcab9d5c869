//! What is around ego at one instant.

use crate::ids::VehicleId;
use serde::{Deserialize, Serialize};

/// Places across the road that differ by less are one, in m: sums of lanes are rounded.
const SAME_PLACE_M: f64 = 1e-6;

/// The road: parallel lanes, counted from the right (slow) lane 0.
///
/// x runs forward, y to the left; the centre of lane 0 is at y = 0 and of lane i at i·width.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Road {
    /// Number of lanes, at least 1.
    pub lanes: u8,
    /// From line to line, in m, the same for all lanes.
    pub lane_width_m: f64,
    /// Posted speed, in m/s.
    pub posted_speed_mps: f64,
}

impl Road {
    /// The paper's road: two lanes of 12 ft (3.66 m), posted 55 mph (24.5872 m/s).
    pub const PAPER: Self = Self { lanes: 2, lane_width_m: 3.66, posted_speed_mps: 24.5872 };

    /// Largest distance from a lane's centre that a place in that lane has, in lane widths.
    ///
    /// Readers cut off places beyond it, where a log says the lane and the place in it.
    pub const WITHIN_LANE: f64 = 0.49;

    /// Returns whether a place, in m from the centre of its lane, is where readers cut off places beyond the lane.
    pub fn is_cut_off(&self, place_m: f64) -> bool {
        (place_m.abs() - Self::WITHIN_LANE * self.lane_width_m).abs() < SAME_PLACE_M
    }

    /// The lane in which a vehicle at lateral position `y_m` drives; none where its centre is half a lane or more beside the
    /// road: it is parked there, comes towards ego, or drives on another road. The centre of a lane that the road does not have is in none.
    pub fn lane_at(&self, y_m: f64) -> Option<u8> {
        let (right, left) = (-self.lane_width_m, self.lane_centre_m(self.lanes));
        let is_on_road = y_m > right + SAME_PLACE_M && y_m < left - SAME_PLACE_M;
        is_on_road.then(|| self.nearest_lane(y_m))
    }

    /// Whether a vehicle at lateral position `y_m` drives in ego's lane. Of a road of one lane so does whoever is within half a lane of ego
    /// where both are beside it: the lane may have another number there, or both are in a lane that is not known.
    pub fn is_in_lane_of(&self, ego: &EgoState, y_m: f64) -> bool {
        let aside_m = (y_m - ego.y_m).abs();
        self.lane_at(y_m) == Some(self.nearest_lane(ego.y_m))
            || (self.lanes == 1 && aside_m <= 0.5 * self.lane_width_m)
    }

    /// The lane whose centre is nearest to lateral position `y_m`: ego has one even where it leaves the road.
    pub fn nearest_lane(&self, y_m: f64) -> u8 {
        // `as` saturates, so far-off positions end in the outermost lanes.
        ((y_m / self.lane_width_m).round().max(0.0) as u8).min(self.lanes.saturating_sub(1))
    }

    /// Lateral position of the centre of `lane`, in m.
    pub fn lane_centre_m(&self, lane: u8) -> f64 {
        f64::from(lane) * self.lane_width_m
    }
}

/// Ego at one instant; positions are of the vehicle's centre.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct EgoState {
    /// Position along the road, in m.
    pub x_m: f64,
    /// Lateral position, in m.
    pub y_m: f64,
    /// Speed, in m/s.
    pub speed_mps: f64,
    /// Bumper to bumper, in m.
    pub length_m: f64,
}

/// Another vehicle at one instant; positions are of the vehicle's centre.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct VehicleState {
    /// Which vehicle.
    pub id: VehicleId,
    /// Position along the road, in m.
    pub x_m: f64,
    /// Lateral position, in m.
    pub y_m: f64,
    /// Speed, in m/s.
    pub speed_mps: f64,
    /// Bumper to bumper, in m.
    pub length_m: f64,
}

/// Everything visible at one instant.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// Time since the start of the drive, in s.
    pub time_s: f64,
    /// The car whose drive it is.
    pub ego: EgoState,
    /// The others, in any order.
    pub vehicles: Vec<VehicleState>,
}

/// Bumper-to-bumper distance from ego to another vehicle, in m.
///
/// Positive when it is ahead (its rear bumper minus ego's front bumper), negative when it is
/// behind (ego's rear bumper to its front bumper, negated), 0 while the two overlap along x.
pub fn bumper_distance_m(ego: &EgoState, other: &VehicleState) -> f64 {
    let centres = other.x_m - ego.x_m;
    let bumpers = centres.abs() - 0.5 * (ego.length_m + other.length_m);
    bumpers.max(0.0).copysign(centres)
}

/// The signals about the reference vehicle at one instant.
///
/// # Source
/// Method section 2. Without a reference vehicle the signals hold the free-road values.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// The vehicle, if there is one (`lead_present`).
    pub vehicle: Option<VehicleId>,
    /// `lead_dx_m`: signed bumper-to-bumper distance, in m; see [`bumper_distance_m`].
    pub dx_m: f64,
    /// `lead_dy_m`: its lateral position minus ego's, in m.
    pub dy_m: f64,
    /// `lead_speed_mps`: its speed, in m/s.
    pub speed_mps: f64,
}

impl Reference {
    /// Distance reported where there is no reference vehicle, and beyond which there is none, in m.
    pub const FREE_ROAD_DX_M: f64 = 200.0;

    /// The free-road values: 200 m, 0 m and the posted speed.
    pub fn free_road(road: &Road) -> Self {
        Self {
            vehicle: None,
            dx_m: Self::FREE_ROAD_DX_M,
            dy_m: 0.0,
            speed_mps: road.posted_speed_mps,
        }
    }
}

/// What a planner is told at one instant: the paper's state information.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Situation {
    /// Time since the start of the drive, in s.
    pub time_s: f64,
    /// Ego's speed, in m/s.
    pub ego_speed_mps: f64,
    /// The reference vehicle.
    pub reference: Reference,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_falls_through_zero_while_passing() {
        let ego = EgoState { x_m: 0.0, y_m: 0.0, speed_mps: 30.0, length_m: 4.0 };
        let at = |x_m| {
            let id = VehicleId(1);
            bumper_distance_m(
                &ego,
                &VehicleState { id, x_m, y_m: 0.0, speed_mps: 20.0, length_m: 6.0 },
            )
        };
        assert!((at(25.0) - 20.0).abs() < 1e-12);
        assert!(at(3.0).abs() < 1e-12);
        assert!((at(-25.0) + 20.0).abs() < 1e-12);
    }

    #[test]
    fn lanes_are_counted_from_the_right() {
        assert_eq!(Road::PAPER.nearest_lane(-1.0), 0);
        assert_eq!(Road::PAPER.nearest_lane(1.84), 1);
        assert_eq!(Road::PAPER.nearest_lane(99.0), 1);
    }

    #[test]
    fn a_lane_ends_half_a_lane_beside_the_road() {
        let next = Road::PAPER.lane_centre_m(2);
        for (y_m, lane) in [
            (-3.67, None),
            // The centre of a lane more, as it is and as a sum that is rounded.
            (-3.66, None),
            (-3.66 + 1e-12, None),
            (-3.659, Some(0)),
            (-3.65, Some(0)),
            (1.84, Some(1)),
            (7.31, Some(1)),
            (next - 0.001, Some(1)),
            (next - 1e-12, None),
            (next, None),
            (7.33, None),
            (f64::NAN, None),
        ] {
            assert_eq!(Road::PAPER.lane_at(y_m), lane, "{y_m} m");
        }
    }

    #[test]
    fn beside_an_only_lane_whoever_is_within_half_a_lane_of_ego_is_in_its_lane() {
        let width = Road::PAPER.lane_width_m;
        let together = |lanes: u8, ego_y_m: f64, y_m: f64| {
            let ego = EgoState { x_m: 0.0, y_m: ego_y_m, speed_mps: 30.0, length_m: 4.0 };
            let road = Road { lanes, ..Road::PAPER };
            road.is_in_lane_of(&ego, y_m)
        };
        for beside in [-width, width, 2.0 * width] {
            assert!(together(1, beside, beside), "{beside}");
            assert!(together(1, beside, beside + 0.4 * width), "{beside}");
            assert!(!together(1, 0.0, beside), "{beside}");
        }
        // Of several lanes it is known where they are.
        assert!(together(2, width, width) && together(2, 0.0, 0.0));
        assert!(!together(2, 0.0, width) && !together(2, width, 0.0));
        assert!(!together(2, 2.0 * width, 2.0 * width));
    }
}
