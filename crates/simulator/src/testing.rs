//! Scenes for tests by hand: ego at the origin, every vehicle 5 m long.

use crate::{
    scenario::ControllerSettings,
    traffic::{Car, EgoView, Role},
};
use maveric_domain::{EgoState, Scene, VehicleId, VehicleState};
use std::sync::LazyLock;

/// Numbers of the safety rule that are worked out in the head: without reaction, (v² - v'²) / 16 m.
pub(crate) static AT_ONCE: LazyLock<ControllerSettings> = LazyLock::new(|| ControllerSettings {
    reaction_s: 0.0,
    own_braking_mps2: 8.0,
    other_braking_mps2: 8.0,
    ..ControllerSettings::default()
});

/// Another vehicle `gap_m` ahead of ego's bumper, behind its own where that is negative.
pub(crate) fn other(id: u32, gap_m: f64, y_m: f64, speed_mps: f64) -> VehicleState {
    VehicleState {
        id: VehicleId(id),
        x_m: gap_m + 5.0_f64.copysign(gap_m),
        y_m,
        speed_mps,
        length_m: 5.0,
    }
}

/// Ego at `y_m` with others around it.
pub(crate) fn scene(y_m: f64, speed_mps: f64, vehicles: &[VehicleState]) -> Scene {
    Scene {
        time_s: 0.0,
        ego: EgoState { x_m: 0.0, y_m, speed_mps, length_m: 5.0 },
        vehicles: vehicles.to_vec(),
    }
}

/// Ego at 20 m/s in the right lane as the traffic sees it, on its way to 30 m/s.
pub(crate) fn seen_ego() -> EgoView {
    EgoView {
        x_m: 0.0,
        y_m: 0.0,
        speed_mps: 20.0,
        length_m: 5.0,
        lane: 0,
        bound_for: 0,
        keeping: true,
        target_mps: 30.0,
    }
}

/// A vehicle of the traffic, its lane's centre taken for where it is.
pub(crate) fn car(id: u32, gap_m: f64, lane: u8, speed_mps: f64, role: Role) -> Car {
    Car {
        state: other(id, gap_m, 3.66 * f64::from(lane), speed_mps),
        lane,
        acceleration_mps2: 0.0,
        role,
        track: 0,
    }
}
