//! From the numbers that a plan took to samples.

use super::{
    roles::Convention,
    slots::{OBJECT_SLOTS, Slot},
};
use crate::{
    mapping::TwistFrame,
    raw::{EgoSample, EgoSamples, GIVEN_FROM, ObjectSample, ObjectSamples},
};
use std::collections::BTreeMap;

/// A stamp from its two slots; those of ROS 2 fit, others saturate, and a missing one is 0.
pub(crate) fn stamp_ns(row: &[f64]) -> i64 {
    let part = |slot: Slot| slot.known(row).unwrap_or(0.0);
    let (sec, nanosec) = (part(Slot::Sec), part(Slot::Nanosec));
    let whole = sec as i64;
    if sec - whole as f64 == 0.0 {
        // Almost every stamp: nothing behind the point.
        return whole.saturating_mul(1_000_000_000).saturating_add(nanosec as i64);
    }
    (sec.trunc() as i64)
        .saturating_mul(1_000_000_000)
        .saturating_add((sec.fract() * 1e9).round() as i64)
        .saturating_add(nanosec as i64)
}

/// The quaternion x, y, z, w of a row.
fn quaternion(row: &[f64]) -> [f64; 4] {
    [Slot::Qx, Slot::Qy, Slot::Qz, Slot::Qw].map(|slot| slot.at(row))
}

/// Where a quaternion points, as a vector of any length; nowhere if it is all zeros, as in a message nobody filled in.
fn forward([x, y, z, w]: [f64; 4]) -> Option<(f64, f64)> {
    let norm2 = x * x + y * y + z * z + w * w;
    (norm2 > 0.5).then_some((w * w + x * x - y * y - z * z, 2.0 * (w * z + x * y)))
}

fn heading(quaternion: [f64; 4]) -> Option<f64> {
    forward(quaternion).map(|(x, y)| libm::atan2(y, x))
}

/// An object's heading as a vector, of any length; east where it is not known.
fn direction(row: &[f64]) -> (f64, f64) {
    match Slot::Yaw.known(row) {
        Some(yaw) => (libm::cos(yaw), libm::sin(yaw)),
        None => forward(quaternion(row)).unwrap_or((1.0, 0.0)),
    }
}

/// Ego's sample with its twist, whose frame is settled once all are there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EgoRow {
    pub(crate) sample: EgoSample,
    pub(crate) twist: Option<(f64, f64)>,
}

/// When a message came.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Receipt {
    /// Time of receipt, in ns.
    pub(crate) log_ns: i64,
    /// Its number among all messages of the recording.
    pub(crate) nth: u32,
}

/// Ego's slots.
pub(crate) fn ego_row(row: &[f64], receipt: Receipt) -> EgoRow {
    let twist = Slot::Vx.known(row).zip(Slot::Vy.known(row));
    let of_twist = twist.map(|(vx, vy)| libm::hypot(vx, vy).copysign(vx));
    EgoRow {
        sample: EgoSample {
            stamp_ns: stamp_ns(row),
            log_ns: receipt.log_ns,
            nth: receipt.nth,
            x_m: Slot::X.at(row),
            y_m: Slot::Y.at(row),
            yaw_rad: Slot::Yaw.known(row).or_else(|| heading(quaternion(row))),
            speed_mps: Slot::Speed.known(row).or(of_twist),
        },
        twist,
    }
}

const BOX: f64 = 1.0;
const SPHERE: f64 = 2.0;
const CYLINDER: f64 = 3.0;
/// Pedestrians, barriers and signs: no vehicles.
const NO_VEHICLE: [f64; 3] = [4.0, 10.0, 11.0];
/// Autoware's shape without a length of its own.
const POLYGON: f64 = 2.0;
/// Autoware's first label that is no vehicle: pedestrians, then animals and hazards.
const PEDESTRIAN: f64 = 7.0;

/// Makes samples of objects.
#[derive(Debug, Default)]
pub(crate) struct Objects {
    /// Numbers given to UUIDs, texts and numbers that are no usual ones, in the order of their first appearance.
    numbers: BTreeMap<u128, u32>,
}

impl Objects {
    /// An object's slots: the pose is of its centre. None for what is no vehicle.
    pub(crate) fn sample(
        &mut self,
        row: &[f64],
        receipt: Receipt,
        convention: Convention,
        twist: Option<TwistFrame>,
    ) -> Option<ObjectSample> {
        let is = |value: f64, code: f64| (value - code).abs() < 0.5;
        // Between them stands the name of the frame.
        let uuid = row.get(OBJECT_SLOTS.len() + 1..)?;
        let slots = [Slot::Shape, Slot::Size0, Slot::Size1, Slot::Class];
        let [shape, first, second, class] = slots.map(|slot| slot.at(row));
        let (vehicle, length_m) = match convention {
            Convention::Mapped => (true, Slot::Length.known(row)),
            Convention::Autoware => {
                let length = (!is(shape, POLYGON)).then_some(first);
                (class.is_nan() || class < PEDESTRIAN, length)
            }
            Convention::Derived => {
                let length = if is(shape, BOX) {
                    Some(first)
                } else if is(shape, SPHERE) {
                    Some(2.0 * first)
                } else if is(shape, CYLINDER) {
                    Some(2.0 * second)
                } else {
                    None
                };
                (!NO_VEHICLE.iter().any(|&code| is(class, code)), length)
            }
        };
        if !vehicle {
            return None;
        }
        let next = u32::try_from(self.numbers.len()).unwrap_or(u32::MAX);
        let id = if uuid.is_empty() {
            let id = Slot::Id.at(row);
            let usual = id as u32;
            if f64::from(usual).to_bits() == id.to_bits() && usual < GIVEN_FROM {
                usual
            } else {
                let key = u128::from(id.to_bits());
                *self.numbers.entry(key).or_insert(next.saturating_add(GIVEN_FROM))
            }
        } else {
            let key = uuid.iter().fold(0, |key, &byte| key << 8 | u128::from(byte as u8));
            *self.numbers.entry(key).or_insert(next)
        };
        let (vx, vy) = (Slot::Vx.at(row), Slot::Vy.at(row));
        let frame = twist.unwrap_or(match convention {
            Convention::Autoware => TwistFrame::Object,
            Convention::Derived | Convention::Mapped => TwistFrame::Map,
        });
        let forward = match frame {
            TwistFrame::Object => vx,
            TwistFrame::Map => {
                let (x, y) = direction(row);
                vx * x + vy * y
            }
        };
        Some(ObjectSample {
            stamp_ns: stamp_ns(row),
            log_ns: receipt.log_ns,
            nth: receipt.nth,
            id,
            x_m: Slot::X.at(row),
            y_m: Slot::Y.at(row),
            speed_mps: Slot::Speed.known(row).unwrap_or(libm::hypot(vx, vy).copysign(forward)),
            length_m: length_m.filter(|l| l.is_finite() && *l > 0.0).unwrap_or(f64::NAN),
        })
    }
}

/// Speed below which a twist has no direction worth comparing, in m/s.
const MOVING_MPS: f64 = 2.0;
/// Samples that it takes to tell a twist's frame.
const TELLING: u32 = 20;

/// Takes ego's speeds for what they are, and says what was found where that is not what the type promises.
///
/// A twist in the frame of the map instead of ego's own is told from the way ego moves: its speed is then the part along
/// ego's heading. Speeds that are all zero while ego moves are none.
pub(crate) fn settle_speeds(rows: &mut [EgoRow]) -> Option<&'static str> {
    let moved = |a: &EgoRow, b: &EgoRow| (b.sample.x_m - a.sample.x_m, b.sample.y_m - a.sample.y_m);
    let still = |r: &EgoRow| r.sample.speed_mps.is_some_and(|v| v == 0.0);
    if rows.iter().all(still) {
        let way: f64 =
            rows.windows(2).map(|w| moved(&w[0], &w[1])).map(|(x, y)| libm::hypot(x, y)).sum();
        if way > 10.0 {
            for r in rows.iter_mut() {
                r.sample.speed_mps = None;
            }
            return Some("ego moves but its recorded speeds are all 0: they are not used");
        }
        return None;
    }
    let along = |turned: fn((f64, f64), f64) -> (f64, f64)| {
        let (mut sum, mut n) = (0.0, 0);
        for w in rows.windows(2) {
            let (Some(twist), Some(yaw)) = (w[0].twist, w[0].sample.yaw_rad) else {
                continue;
            };
            let (dx, dy) = moved(&w[0], &w[1]);
            let (speed2, way2) = (twist.0 * twist.0 + twist.1 * twist.1, dx * dx + dy * dy);
            let moving = speed2 >= MOVING_MPS * MOVING_MPS && way2 >= 1e-6;
            if moving && speed2.is_finite() && way2.is_finite() {
                let (vx, vy) = turned(twist, yaw);
                sum += (vx * dx + vy * dy) / (speed2 * way2).sqrt();
                n += 1;
            }
        }
        (n >= TELLING).then_some(sum / f64::from(n))
    };
    // Of most recordings the first tells.
    let of_map = along(|twist, _| twist);
    let of_own = || {
        along(|(vx, vy), yaw| {
            let (sin, cos) = libm::sincos(yaw);
            (vx * cos - vy * sin, vx * sin + vy * cos)
        })
    };
    if of_map.is_none_or(|map| map < 0.9) || of_own().is_none_or(|own| own > 0.7) {
        return None;
    }
    for row in rows {
        if let (Some((vx, vy)), Some(yaw)) = (row.twist, row.sample.yaw_rad) {
            let along = vx * libm::cos(yaw) + vy * libm::sin(yaw);
            row.sample.speed_mps = Some(libm::hypot(vx, vy).copysign(along));
        }
    }
    Some(
        "ego's twist is in the frame of the map, not in its own: its speed is the part along its heading",
    )
}

/// Places fixes on a plane that touches the Earth at the first of them: x to the east, y to the north, in m.
///
/// # Source
/// Radii of curvature of the WGS 84 ellipsoid; within 10 km of the first fix the plane is true to some centimetres a km.
pub(crate) fn flatten(ego: &mut EgoSamples) {
    const RADIUS_M: f64 = 6_378_137.0;
    const ECCENTRICITY2: f64 = 6.694_379_990_141e-3;
    let on_earth = |x: f64, y: f64| x.abs() <= 180.0 && y.abs() < 90.0 && (x, y) != (0.0, 0.0);
    let Some(first) = ego.iter().find(|s| on_earth(s.x_m, s.y_m)) else {
        return;
    };
    let (sin, cos) = libm::sincos(first.y_m.to_radians());
    let w2 = 1.0 - ECCENTRICITY2 * sin * sin;
    let east = RADIUS_M / w2.sqrt() * cos;
    let north = RADIUS_M * (1.0 - ECCENTRICITY2) / (w2 * w2.sqrt());
    for (x, y) in ego.x_m.iter_mut().zip(&mut ego.y_m) {
        let there = on_earth(*x, *y);
        let across = (*x - first.x_m + 540.0).rem_euclid(360.0) - 180.0;
        *x = if there { across.to_radians() * east } else { f64::NAN };
        *y = (*y - first.y_m).to_radians() * north;
    }
}

/// Turns a left-handed frame into a right-handed one: y to the left.
pub(crate) fn turn(ego: &mut [EgoRow], objects: &mut ObjectSamples) {
    for row in ego {
        row.sample.y_m = -row.sample.y_m;
        row.sample.yaw_rad = row.sample.yaw_rad.map(|yaw| -yaw);
        row.twist = row.twist.map(|(vx, vy)| (vx, -vy));
    }
    for y_m in &mut objects.y_m {
        *y_m = -*y_m;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(i: i64, x_m: f64, y_m: f64, yaw: f64, twist: (f64, f64)) -> EgoRow {
        EgoRow {
            sample: EgoSample {
                stamp_ns: i * 100_000_000,
                log_ns: 0,
                nth: i as u32,
                x_m,
                y_m,
                yaw_rad: Some(yaw),
                speed_mps: Some(twist.0.hypot(twist.1).copysign(twist.0)),
            },
            twist: Some(twist),
        }
    }

    #[test]
    fn a_twist_in_the_frame_of_the_map_is_told_from_the_way_ego_moves() {
        let west = std::f64::consts::PI;
        let drive = |twist| -> Vec<EgoRow> {
            (0..100).map(|i| row(i, -(i as f64), 0.0, west, twist)).collect()
        };
        let mut own = drive((10.0, 0.0));
        assert_eq!(settle_speeds(&mut own), None);
        assert_eq!(own[5].sample.speed_mps, Some(10.0));
        let mut map = drive((-10.0, 0.0));
        assert!(settle_speeds(&mut map).unwrap().contains("frame of the map"));
        assert_eq!(map[5].sample.speed_mps, Some(10.0));
        // Backwards in its own frame: it moves against its heading.
        let mut back: Vec<EgoRow> =
            (0..100).map(|i| row(i, i as f64, 0.0, west, (-10.0, 0.0))).collect();
        assert_eq!(settle_speeds(&mut back), None);
        assert_eq!(back[5].sample.speed_mps, Some(-10.0));
        let mut zero: Vec<EgoRow> =
            (0..100).map(|i| row(i, i as f64, 0.0, 0.0, (0.0, 0.0))).collect();
        assert!(settle_speeds(&mut zero).unwrap().contains("all 0"));
        assert_eq!(zero[5].sample.speed_mps, None);
    }

    #[test]
    fn a_degree_on_earth_is_as_long_as_it_is() {
        let mut ego: EgoSamples = [(8.0, 50.0), (8.001, 50.0), (8.0, 50.001)]
            .map(|(x, y)| row(0, x, y, 0.0, (0.0, 0.0)).sample)
            .into_iter()
            .collect();
        flatten(&mut ego);
        // Geodesic distances on the WGS 84 ellipsoid.
        assert!((ego.x_m[1] - 71.696).abs() < 0.01, "{}", ego.x_m[1]);
        assert!((ego.y_m[2] - 111.229).abs() < 0.01, "{}", ego.y_m[2]);
    }

    #[test]
    fn a_stamp_is_its_seconds_and_nanoseconds_whole_or_not() {
        for (sec, nanosec, expected) in [
            (3.0, 5.0, 3_000_000_005),
            (-3.0, 5.0, -2_999_999_995),
            (1.25, 0.0, 1_250_000_000),
            (1.5, 7.0, 1_500_000_007),
            (-1.25, 0.0, -1_250_000_000),
            (f64::NAN, 9.0, 9),
            (2.0, f64::NAN, 2_000_000_000),
            (1e300, 0.0, i64::MAX),
        ] {
            assert_eq!(stamp_ns(&[sec, nanosec]), expected, "{sec} {nanosec}");
        }
    }

    #[test]
    fn a_heading_comes_from_a_quaternion_or_a_yaw_and_is_east_where_neither_is() {
        let half = |yaw: f64| [0.0, 0.0, (0.5 * yaw).sin(), (0.5 * yaw).cos()];
        for yaw in [-3.0, -1.0, 0.0, 0.4, 2.5] {
            let quaternion = half(yaw);
            for length in [0.8, 1.0, 1.3] {
                let longer = quaternion.map(|q| length * q);
                assert!((heading(longer).unwrap() - yaw).abs() < 1e-12);
            }
            let mut row = [f64::NAN; 11];
            row[4..8].copy_from_slice(&quaternion);
            let (x, y) = direction(&row);
            assert!((y.atan2(x) - yaw).abs() < 1e-12, "{yaw}");
            // A yaw goes before a quaternion.
            (row[4], row[5], row[6], row[7], row[10]) = (0.0, 0.0, 0.0, 1.0, yaw);
            let (x, y) = direction(&row);
            assert!((y.atan2(x) - yaw).abs() < 1e-12 && (x.hypot(y) - 1.0).abs() < 1e-12);
        }
        // Banked by a little: x and y count too.
        let banked = [0.1, 0.2, 0.6, 0.768];
        let (x, y, z, w) = (0.1_f64, 0.2, 0.6, 0.768);
        let expected = (2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z));
        assert!((heading(banked).unwrap() - expected).abs() < 1e-3);
        assert_eq!(heading([0.5, 0.5, 0.0, 0.0]), None);
        let mut row = [f64::NAN; 11];
        row[4..8].fill(0.0);
        assert_eq!((heading([0.0; 4]), direction(&row)), (None, (1.0, 0.0)));
    }
}
