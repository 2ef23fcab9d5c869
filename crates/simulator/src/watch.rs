//! What goes wrong around ego, counted by episode.

use crate::{
    control::safe_distance_m, neighbours::ahead, planner::PLANNING_STEP_S,
    scenario::ControllerSettings,
};
use maveric_domain::{Road, Scene, VehicleId, scene::bumper_distance_m};

/// Collisions, and moments inside the safe distance.
#[derive(Debug)]
pub(crate) struct Watch {
    touching: Vec<VehicleId>,
    too_near: bool,
    /// Row and vehicle of each collision's first moment.
    pub(crate) collisions: Vec<(usize, VehicleId)>,
    /// Episodes inside the safe distance.
    pub(crate) violations: u32,
    /// Time inside it, in s.
    pub(crate) inside_s: f64,
    /// Least share of it that was left; 1 without such a moment.
    pub(crate) least_share: f64,
}

impl Default for Watch {
    fn default() -> Self {
        Self {
            touching: Vec::new(),
            too_near: false,
            collisions: Vec::new(),
            violations: 0,
            inside_s: 0.0,
            least_share: 1.0,
        }
    }
}

impl Watch {
    /// Takes the next row.
    pub(crate) fn look(
        &mut self,
        row: usize,
        scene: &Scene,
        road: &Road,
        rule: &ControllerSettings,
        width_m: f64,
    ) {
        let ego = &scene.ego;
        let touching: Vec<VehicleId> = scene
            .vehicles
            .iter()
            .filter(|v| bumper_distance_m(ego, v).abs() <= 0.0 && (v.y_m - ego.y_m).abs() < width_m)
            .map(|v| v.id)
            .collect();
        let fresh = touching.iter().filter(|id| !self.touching.contains(id));
        self.collisions.extend(fresh.map(|&id| (row, id)));
        self.touching = touching;
        let share = ahead(scene, road, road.nearest_lane(ego.y_m)).map_or(1.0, |n| {
            let safe_m = safe_distance_m(rule, ego.speed_mps, n.vehicle.speed_mps);
            if n.gap_m < safe_m { n.gap_m / safe_m } else { 1.0 }
        });
        let too_near = share < 1.0;
        self.violations += u32::from(too_near && !self.too_near);
        self.inside_s += f64::from(u8::from(too_near)) * PLANNING_STEP_S;
        self.least_share = self.least_share.min(share);
        self.too_near = too_near;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{AT_ONCE, other, scene};

    #[test]
    fn collisions_and_moments_inside_the_safe_distance_are_counted_by_episode() {
        let mut watch = Watch::default();
        let mut look = |row: usize, gap_m: f64, y_m: f64| {
            // 25 m are safe behind who stands.
            let scene = scene(0.0, 20.0, &[other(7, gap_m, y_m, 0.0)]);
            watch.look(row, &scene, &Road::PAPER, &AT_ONCE, 1.9);
        };
        for (row, gap_m) in [30.0, 25.0, 20.0, 10.0, 30.0, 24.0].into_iter().enumerate() {
            look(row, gap_m, 0.0);
        }
        // Overlapping along the road: beside each other first, then within a width, and once more after a row apart.
        for (row, y_m) in [1.9, 1.8, 1.7, 1.9, 1.5].into_iter().enumerate() {
            look(6 + row, 0.0, y_m);
        }
        let rows: Vec<usize> = watch.collisions.iter().map(|c| c.0).collect();
        assert_eq!(rows, [7, 10]);
        // Inside: rows 2 and 3, row 5; then whoever is within half a lane and overlaps, rows 7, 8 and 10.
        assert_eq!(watch.violations, 4);
        assert!((watch.inside_s - 6.0 * PLANNING_STEP_S).abs() < 1e-12);
        assert!(watch.least_share.abs() < 1e-12);
    }
}
