//! From the numbers that a plan took to samples.

use crate::raw::{EgoSample, ObjectSample};

/// A stamp from its two slots; those of ROS 2 fit, and others saturate.
fn stamp_ns(row: &[f64]) -> i64 {
    (row[0] as i64)
        .saturating_mul(1_000_000_000)
        .saturating_add(row[1] as i64)
}

/// Heading from a quaternion; none where it is all zeros, as in a message nobody filled in.
fn yaw_rad(q: &[f64]) -> Option<f64> {
    let &[x, y, z, w] = q else { return None };
    let norm2 = x * x + y * y + z * z + w * w;
    (norm2 > 0.5).then(|| (2.0 * (w * z + x * y)).atan2(w * w + x * x - y * y - z * z))
}

/// Odometry's slots (a pose has no twist): the twist is in ego's own frame.
pub(crate) fn ego_sample(row: &[f64], log_ns: i64) -> EgoSample {
    let speed_mps = match row {
        [.., vx, vy] if row.len() > 8 => Some(vx.hypot(*vy).copysign(*vx)),
        _ => None,
    };
    EgoSample {
        stamp_ns: stamp_ns(row),
        log_ns,
        x_m: row[2],
        y_m: row[3],
        yaw_rad: yaw_rad(&row[4..8]),
        speed_mps,
    }
}

const BOX: f64 = 1.0;
const SPHERE: f64 = 2.0;
const CYLINDER: f64 = 3.0;
/// Pedestrians, barriers and signs: no vehicles.
const NO_VEHICLE: [f64; 3] = [4.0, 10.0, 11.0];

/// An object's slots: the twist is in the frame of the map, the pose is of the centre.
pub(crate) fn object_sample(row: &[f64], log_ns: i64) -> Option<ObjectSample> {
    let &[.., vx, vy, id, shape, first, second, class] = row else {
        return None;
    };
    let is = |value: f64, code: f64| (value - code).abs() < 0.5;
    if NO_VEHICLE.iter().any(|&code| is(class, code)) {
        return None;
    }
    let length_m = if is(shape, BOX) {
        Some(first)
    } else if is(shape, SPHERE) {
        Some(2.0 * first)
    } else if is(shape, CYLINDER) {
        Some(2.0 * second)
    } else {
        None
    };
    let forward = yaw_rad(&row[4..8]).map_or(1.0, |yaw| vx * yaw.cos() + vy * yaw.sin());
    Some(ObjectSample {
        stamp_ns: stamp_ns(row),
        log_ns,
        id: id as u32,
        x_m: row[2],
        y_m: row[3],
        speed_mps: vx.hypot(vy).copysign(forward),
        length_m: length_m.filter(|l| l.is_finite() && *l > 0.0),
    })
}
