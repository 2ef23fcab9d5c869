//! Who drives ahead of and behind ego, lane by lane.

use maveric_domain::{Road, Scene, VehicleState, scene::bumper_distance_m};

/// A vehicle near ego.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Neighbour {
    pub(crate) vehicle: VehicleState,
    /// Bumper to bumper, in m; 0 while the two overlap along x.
    pub(crate) gap_m: f64,
}

/// The nearest vehicle ahead in `lane`.
pub(crate) fn ahead(scene: &Scene, road: &Road, lane: u8) -> Option<Neighbour> {
    nearest(scene, |v| road.lane_at(v.y_m) == Some(lane) && v.x_m > scene.ego.x_m)
}

/// The nearest vehicle behind, or beside with its centre behind, in `lane`.
pub(crate) fn behind(scene: &Scene, road: &Road, lane: u8) -> Option<Neighbour> {
    nearest(scene, |v| road.lane_at(v.y_m) == Some(lane) && v.x_m <= scene.ego.x_m)
}

/// The nearest vehicle ahead in `lane`, or about to take it: `claims` has the scene's order.
pub(crate) fn ahead_or_entering(
    scene: &Scene,
    road: &Road,
    lane: u8,
    claims: &[Option<u8>],
) -> Option<Neighbour> {
    in_or_entering(scene, road, lane, claims, true)
}

/// The nearest vehicle behind in `lane`, or about to take it.
pub(crate) fn behind_or_entering(
    scene: &Scene,
    road: &Road,
    lane: u8,
    claims: &[Option<u8>],
) -> Option<Neighbour> {
    in_or_entering(scene, road, lane, claims, false)
}

fn in_or_entering(
    scene: &Scene,
    road: &Road,
    lane: u8,
    claims: &[Option<u8>],
    is_ahead: bool,
) -> Option<Neighbour> {
    let both = scene.vehicles.iter().zip(claims);
    let there = both.filter(|(v, claim)| {
        (road.lane_at(v.y_m) == Some(lane) || **claim == Some(lane))
            && (v.x_m > scene.ego.x_m) == is_ahead
    });
    closest(scene, there.map(|(v, _)| v))
}

/// The nearest vehicle ahead whose sides reach within `clearance_m` of ego's path straight on.
pub(crate) fn in_the_way(scene: &Scene, width_m: f64, clearance_m: f64) -> Option<Neighbour> {
    nearest(scene, |v| {
        (v.y_m - scene.ego.y_m).abs() < width_m + clearance_m && v.x_m > scene.ego.x_m
    })
}

fn nearest(scene: &Scene, wanted: impl Fn(&VehicleState) -> bool) -> Option<Neighbour> {
    closest(scene, scene.vehicles.iter().filter(|v| wanted(v)))
}

fn closest<'a>(
    scene: &Scene,
    vehicles: impl Iterator<Item = &'a VehicleState>,
) -> Option<Neighbour> {
    vehicles
        .map(|v| Neighbour { vehicle: *v, gap_m: bumper_distance_m(&scene.ego, v).abs() })
        .min_by(|a, b| a.gap_m.total_cmp(&b.gap_m))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{other, scene};
    use maveric_domain::VehicleId;

    #[test]
    fn the_nearest_is_found_by_lane_by_side_and_by_where_it_means_to_go() {
        let (road, left) = (Road::PAPER, 3.66);
        let scene = scene(
            0.0,
            20.0,
            &[
                other(1, 50.0, 0.0, 20.0),
                other(2, 30.0, 0.0, 20.0),
                other(3, 10.0, left, 20.0),
                other(4, -20.0, left, 20.0),
                other(5, -10.0, 0.0, 20.0),
            ],
        );
        let found = |n: Option<Neighbour>| n.map(|n| (n.vehicle.id.0, n.gap_m));
        assert_eq!(found(ahead(&scene, &road, 0)), Some((2, 30.0)));
        assert_eq!(found(ahead(&scene, &road, 1)), Some((3, 10.0)));
        assert_eq!(found(behind(&scene, &road, 0)), Some((5, 10.0)));
        assert_eq!(found(behind(&scene, &road, 1)), Some((4, 20.0)));
        let nobody = [None; 5];
        let mut over = nobody;
        (over[2], over[4]) = (Some(0), Some(1));
        let ahead = |lane, claims| found(ahead_or_entering(&scene, &road, lane, claims));
        let behind = |lane, claims| found(behind_or_entering(&scene, &road, lane, claims));
        assert_eq!((ahead(0, &nobody), ahead(0, &over)), (Some((2, 30.0)), Some((3, 10.0))));
        assert_eq!((behind(1, &nobody), behind(1, &over)), (Some((4, 20.0)), Some((5, 10.0))));
        let mut near = scene.clone();
        near.vehicles[2].y_m = 2.1;
        assert_eq!(found(in_the_way(&near, 1.9, 0.2)), Some((2, 30.0)));
        near.vehicles[2].y_m = 2.09;
        assert_eq!(found(in_the_way(&near, 1.9, 0.2)), Some((3, 10.0)));
        near.ego.y_m = -0.1;
        assert_eq!(found(in_the_way(&near, 1.9, 0.2)), Some((2, 30.0)));
        near.vehicles.retain(|v| v.id == VehicleId(5));
        assert!(in_the_way(&near, 1.9, 0.2).is_none());
    }
}
