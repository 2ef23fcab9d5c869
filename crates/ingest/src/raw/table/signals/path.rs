//! The path that ego has driven, and where something seen from it lies along it.

/// Slower than this a velocity has no direction, in m/s.
const MOVING_MPS: f64 = 1.0;
/// How far along the path is looked for what lies ahead, in m.
const AHEAD_M: f64 = 300.0;
/// Least way between two points of the path that are compared, in m: standing for an hour adds none.
const STEP_M: f64 = 0.5;

/// Direction of movement at a time: nanoseconds, and rad counter-clockwise from east.
pub(super) type Heading = (i64, f64);

/// The direction of an earth-centred velocity in the plane of the ground; none at a standstill.
pub(super) fn heading(time_ns: i64, position: [f64; 3], velocity: [f64; 3]) -> Option<Heading> {
    let length = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let up = position.map(|c| c / length(position));
    let east = [-up[1], up[0], 0.0].map(|c| c / libm::hypot(up[0], up[1]));
    let north = [
        up[1] * east[2] - up[2] * east[1],
        up[2] * east[0] - up[0] * east[2],
        up[0] * east[1] - up[1] * east[0],
    ];
    let (e, n) = (dot(velocity, east), dot(velocity, north));
    (libm::hypot(e, n) > MOVING_MPS).then(|| (time_ns, libm::atan2(n, e)))
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Knot {
    stamp_ns: i64,
    pub(super) speed_mps: f64,
    /// Way driven so far.
    pub(super) way_m: f64,
    /// Where that was, in a plane in which ego starts at the origin.
    east_m: f64,
    north_m: f64,
    yaw_rad: f64,
}

/// Ego's path, dead-reckoned from speed and direction.
#[derive(Debug)]
pub(super) struct DrivenPath {
    knots: Vec<Knot>,
    /// Every half metre one of them.
    spine: Vec<Knot>,
    /// The samples as they came, with the way driven; the readers behind sort and count them.
    raw: Vec<(i64, f64, f64)>,
}

impl DrivenPath {
    /// Integrates speeds (ns, m/s) along directions; without directions the path is straight. Over holes of more
    /// than `max_gap_s` the way is that of the mean of both ends' speeds, and no row will lie there.
    pub(super) fn new(speeds: &[(i64, f64)], mut headings: Vec<Heading>, max_gap_s: f64) -> Self {
        headings.sort_by_key(|h| h.0);
        let mut sorted = speeds.to_vec();
        sorted.sort_by_key(|s| s.0);
        sorted.dedup_by_key(|s| s.0);
        let mut knots: Vec<Knot> = Vec::with_capacity(sorted.len());
        for (stamp_ns, speed_mps) in sorted {
            let yaw_rad = heading_at(&headings, stamp_ns, max_gap_s)
                .or(knots.last().map(|k| k.yaw_rad))
                .or(headings.first().map(|h| h.1))
                .unwrap_or(0.0);
            let knot = match knots.last() {
                None => Knot {
                    stamp_ns,
                    speed_mps,
                    way_m: 0.0,
                    east_m: 0.0,
                    north_m: 0.0,
                    yaw_rad,
                },
                Some(before) => {
                    let dt = stamp_ns.saturating_sub(before.stamp_ns) as f64 / 1e9;
                    let step = 0.5 * (before.speed_mps + speed_mps) * dt;
                    let middle = before.yaw_rad + 0.5 * turn(before.yaw_rad, yaw_rad);
                    Knot {
                        stamp_ns,
                        speed_mps,
                        way_m: before.way_m + step,
                        east_m: before.east_m + step * libm::cos(middle),
                        north_m: before.north_m + step * libm::sin(middle),
                        yaw_rad,
                    }
                }
            };
            knots.push(knot);
        }
        let way_at = |stamp_ns: i64| {
            let index = knots.partition_point(|k| k.stamp_ns < stamp_ns);
            knots.get(index).map_or(0.0, |k| k.way_m)
        };
        let raw = speeds.iter().map(|&(t, v)| (t, way_at(t), v)).collect();
        let mut spine: Vec<Knot> = Vec::new();
        for knot in &knots {
            if spine
                .last()
                .is_none_or(|l| (knot.way_m - l.way_m).abs() >= STEP_M)
            {
                spine.push(*knot);
            }
        }
        Self { knots, spine, raw }
    }

    /// Ego's samples in the order of the file: ns, way driven in m, m/s.
    pub(super) fn samples(&self) -> impl Iterator<Item = (i64, f64, f64)> + '_ {
        self.raw.iter().copied()
    }

    /// Ego at a time: its knot there, interpolated; none outside its samples.
    pub(super) fn at(&self, stamp_ns: i64) -> Option<Knot> {
        let next = self.knots.partition_point(|k| k.stamp_ns <= stamp_ns);
        let before = self.knots.get(next.checked_sub(1)?)?;
        let Some(after) = self.knots.get(next) else {
            return (before.stamp_ns == stamp_ns).then_some(*before);
        };
        let w = (stamp_ns - before.stamp_ns) as f64 / (after.stamp_ns - before.stamp_ns) as f64;
        let mix = |a: f64, b: f64| a + w * (b - a);
        Some(Knot {
            stamp_ns,
            speed_mps: mix(before.speed_mps, after.speed_mps),
            way_m: mix(before.way_m, after.way_m),
            east_m: mix(before.east_m, after.east_m),
            north_m: mix(before.north_m, after.north_m),
            yaw_rad: before.yaw_rad + w * turn(before.yaw_rad, after.yaw_rad),
        })
    }

    /// Ego at a time that lies in no hole of its speed longer than `max_gap_s`.
    pub(super) fn seen_at(&self, stamp_ns: i64, max_gap_s: f64) -> Option<Knot> {
        let next = self.knots.partition_point(|k| k.stamp_ns <= stamp_ns);
        let (before, after) = (self.knots.get(next.checked_sub(1)?)?, self.knots.get(next)?);
        let hole_s = (after.stamp_ns - before.stamp_ns) as f64 / 1e9;
        (hole_s <= max_gap_s).then(|| self.at(stamp_ns)).flatten()
    }

    /// Ego's first and last time; none without a sample.
    pub(super) fn ends_ns(&self) -> Option<(i64, i64)> {
        Some((self.knots.first()?.stamp_ns, self.knots.last()?.stamp_ns))
    }

    /// Where a point `forward_m` ahead of ego's centre and `left_m` beside it lies at a time: ego's way, the point's
    /// way along the path and its offset to the left of the path, and ego's speed. None where ego was not there.
    pub(super) fn place(&self, stamp_ns: i64, forward_m: f64, left_m: f64) -> Option<Placed> {
        let ego = self.at(stamp_ns)?;
        let (sin, cos) = libm::sincos(ego.yaw_rad);
        let east = ego.east_m + forward_m * cos - left_m * sin;
        let north = ego.north_m + forward_m * sin + left_m * cos;
        // The nearest point ahead; beyond the end of the path it goes straight on.
        let next = self.spine.partition_point(|k| k.way_m <= ego.way_m);
        let ahead = self.spine[next.saturating_sub(1)..]
            .iter()
            .take_while(|k| k.way_m <= ego.way_m + AHEAD_M);
        let distance = |k: &&Knot| libm::hypot(k.east_m - east, k.north_m - north);
        let nearest = ahead.min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        let (sin, cos) = libm::sincos(nearest.yaw_rad);
        let (de, dn) = (east - nearest.east_m, north - nearest.north_m);
        Some(Placed {
            ego_speed_mps: ego.speed_mps,
            way_m: nearest.way_m + de * cos + dn * sin,
            left_m: dn * cos - de * sin,
            ego_way_m: ego.way_m,
        })
    }
}

/// A point along the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placed {
    pub(super) ego_way_m: f64,
    pub(super) ego_speed_mps: f64,
    pub(super) way_m: f64,
    pub(super) left_m: f64,
}

/// The direction at a time, interpolated the short way round; none in holes.
fn heading_at(headings: &[Heading], stamp_ns: i64, max_gap_s: f64) -> Option<f64> {
    let next = headings.partition_point(|h| h.0 <= stamp_ns);
    let before = headings.get(next.checked_sub(1)?)?;
    let after = headings.get(next)?;
    let (dt, since) = (
        after.0.saturating_sub(before.0),
        stamp_ns.saturating_sub(before.0),
    );
    let joined = dt as f64 / 1e9 <= max_gap_s;
    joined.then(|| before.1 + since as f64 / dt as f64 * turn(before.1, after.1))
}

/// The turn from one direction to another, in -π..π.
fn turn(from: f64, to: f64) -> f64 {
    let full = std::f64::consts::TAU;
    let turn = (to - from).rem_euclid(full);
    if turn > 0.5 * full { turn - full } else { turn }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn in_a_bend_the_vehicle_on_the_path_is_straight_ahead() {
        // A circle to the left of 100 m at 10 m/s: 0.1 rad a second.
        let speeds: Vec<(i64, f64)> = (0..400).map(|i| (i * 50_000_000, 10.0)).collect();
        let headings = (0..400)
            .map(|i| (i * 50_000_000, 0.1 * (i as f64 * 0.05)))
            .collect();
        let path = DrivenPath::new(&speeds, headings, 0.5);
        // 40 m further on along the circle, as seen from ego.
        let (angle, radius): (f64, f64) = (0.4, 100.0);
        let (forward, left) = (radius * angle.sin(), radius * (1.0 - angle.cos()));
        let placed = path.place(5_000_000_000, forward, left).unwrap();
        assert!(
            (placed.way_m - placed.ego_way_m - 40.0).abs() < 0.05,
            "{placed:?}"
        );
        assert!(placed.left_m.abs() < 0.05, "{placed:?}");
        // Straight ahead of ego's nose is the outside of the bend.
        let outside = path.place(5_000_000_000, 40.0, 0.0).unwrap();
        assert!(outside.left_m < -6.0, "{outside:?}");
    }

    #[test]
    fn an_earth_centred_velocity_has_a_direction_on_the_ground() {
        let equator = [6_378_137.0, 0.0, 0.0];
        let (_, north) = heading(0, equator, [0.0, 0.0, 5.0]).unwrap();
        assert!((north - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        let (_, east) = heading(0, equator, [0.0, 5.0, 0.0]).unwrap();
        assert!(east.abs() < 1e-12);
        assert_eq!(heading(0, equator, [9.0, 0.1, 0.0]), None, "straight up");
    }
}
