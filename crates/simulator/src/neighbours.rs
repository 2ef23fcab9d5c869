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
    nearest(scene, |v| {
        road.lane_at(v.y_m) == lane && v.x_m > scene.ego.x_m
    })
}

/// The nearest vehicle behind, or beside with its centre behind, in `lane`.
pub(crate) fn behind(scene: &Scene, road: &Road, lane: u8) -> Option<Neighbour> {
    nearest(scene, |v| {
        road.lane_at(v.y_m) == lane && v.x_m <= scene.ego.x_m
    })
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
        (road.lane_at(v.y_m) == lane || **claim == Some(lane))
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
        .map(|v| Neighbour {
            vehicle: *v,
            gap_m: bumper_distance_m(&scene.ego, v).abs(),
        })
        .min_by(|a, b| a.gap_m.total_cmp(&b.gap_m))
}
