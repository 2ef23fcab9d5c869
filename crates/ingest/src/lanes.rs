//! From the frame of a log to the frame of the road: x along it, y to the left, lane 0 around y = 0.

use crate::{
    mapping::FrameKind,
    median::median,
    raw::{EgoSamples, ObjectSample, RawDrive},
};

/// Largest distance from a straight line at which a path still counts as straight, in m.
const STRAIGHT_M: f64 = 10.0;
/// Least way between two samples that has a direction, in m.
const DIRECTION_M: f64 = 0.1;

/// Moves ego and the others into the frame of the road.
///
/// `Map`: the log's frame is the road's; only `right_lane_centre_y_m` is taken off y. `Path`: x is the way that ego has
/// driven (the integral of its speed; straight distances over holes of more than `max_gap_s`), y is 0, and
/// the others are placed ahead of and beside ego by its heading, which is wrong far ahead in a bend. `Auto`: where ego
/// stays within 10 m of the line from its first to its last position, that line is x and ego's median y is 0; else
/// `Path`. Samples are synchronised and have speeds.
pub(crate) fn place(
    drive: &mut RawDrive,
    frame: FrameKind,
    right_lane_centre_y_m: f64,
    max_gap_s: f64,
) {
    match frame {
        FrameKind::Map => {}
        FrameKind::Path => along_path(drive, max_gap_s),
        FrameKind::Auto => match straight_line(&drive.ego) {
            Some(line) => along_line(drive, &line),
            None => along_path(drive, max_gap_s),
        },
    }
    if right_lane_centre_y_m != 0.0 {
        drive.move_all(|x, y| (x, y - right_lane_centre_y_m));
    }
}

/// Where ego was, for times that mostly rise: each search starts where the last one ended.
#[derive(Debug)]
pub(crate) struct EgoPath<'a> {
    ego: &'a EgoSamples,
    /// The first sample after the time that was asked for last.
    next: usize,
    /// What was asked for last, and the answer: a message's objects have one stamp.
    last: Option<(i64, Option<(f64, f64)>)>,
}

impl<'a> EgoPath<'a> {
    /// Takes samples that are sorted by time.
    pub(crate) fn new(ego: &'a EgoSamples) -> Self {
        Self { ego, next: 0, last: None }
    }

    /// Ego at `time_ns`, between its samples: `(x, y)` in m; none outside them.
    pub(crate) fn at(&mut self, time_ns: i64) -> Option<(f64, f64)> {
        match self.last {
            Some((asked, there)) if asked == time_ns => there,
            _ => {
                let there = self.between(time_ns);
                self.last = Some((time_ns, there));
                there
            }
        }
    }

    /// Ego at `time_ns`: `(x, y)` in m, and its heading as a unit vector; none outside its samples or where it has no heading.
    pub(crate) fn pose(&mut self, time_ns: i64) -> Option<(f64, f64, (f64, f64))> {
        let (x_m, y_m) = self.at(time_ns)?;
        let (before, after, w) = self.bracket(time_ns)?;
        let (a, b) = (self.ego.at(before), self.ego.at(after));
        let (cos, sin) = match (a.yaw_rad, b.yaw_rad) {
            (Some(from), Some(to)) => {
                let mix = |f: fn(f64) -> f64| f(from) + w * (f(to) - f(from));
                (mix(libm::cos), mix(libm::sin))
            }
            _ => (b.x_m - a.x_m, b.y_m - a.y_m),
        };
        let length = libm::hypot(cos, sin);
        (length > 0.0).then(|| (x_m, y_m, (cos / length, sin / length)))
    }

    fn between(&mut self, time_ns: i64) -> Option<(f64, f64)> {
        let (before, after, w) = self.bracket(time_ns)?;
        let mix = |column: &[f64]| column[before] + w * (column[after] - column[before]);
        Some((mix(&self.ego.x_m), mix(&self.ego.y_m)))
    }

    /// The samples around `time_ns` and the weight of the second.
    fn bracket(&mut self, time_ns: i64) -> Option<(usize, usize, f64)> {
        let stamps = &self.ego.stamp_ns;
        let is_past = |ns: &i64| *ns <= time_ns;
        if self.next > 0 && !is_past(&stamps[self.next - 1]) {
            self.next = stamps.partition_point(is_past);
        }
        while stamps.get(self.next).is_some_and(is_past) {
            self.next += 1;
        }
        let before = self.next.checked_sub(1)?;
        let from = stamps[before];
        let Some(after) = stamps.get(self.next) else {
            return (from == time_ns).then_some((before, before, 0.0));
        };
        let w = (time_ns - from) as f64 / (after - from) as f64;
        Some((before, self.next, w))
    }
}

struct Line {
    x_m: f64,
    y_m: f64,
    cos: f64,
    sin: f64,
}

impl Line {
    fn along(&self, x_m: f64, y_m: f64) -> (f64, f64) {
        let (dx, dy) = (x_m - self.x_m, y_m - self.y_m);
        (dx * self.cos + dy * self.sin, dy * self.cos - dx * self.sin)
    }
}

fn straight_line(ego: &EgoSamples) -> Option<Line> {
    let (first, last) = (ego.first()?, ego.last()?);
    let (dx, dy) = (last.x_m - first.x_m, last.y_m - first.y_m);
    let length = libm::hypot(dx, dy);
    if length <= 0.0 {
        return None;
    }
    let line = Line { x_m: first.x_m, y_m: first.y_m, cos: dx / length, sin: dy / length };
    // Ego that turns back is on no straight road either.
    let mut furthest = f64::NEG_INFINITY;
    for (&x, &y) in ego.x_m.iter().zip(&ego.y_m) {
        let (x, y) = line.along(x, y);
        furthest = furthest.max(x);
        if y.abs() > STRAIGHT_M || x < furthest - STRAIGHT_M {
            return None;
        }
    }
    Some(line)
}

fn along_line(drive: &mut RawDrive, line: &Line) {
    drive.move_all(|x, y| line.along(x, y));
    let median = median(&mut drive.ego.y_m.clone()).unwrap_or(0.0);
    drive.move_all(|x, y| (x, y - median));
}

fn along_path(drive: &mut RawDrive, max_gap_s: f64) {
    let way = driven_way(&drive.ego, max_gap_s);
    let headings = headings(&drive.ego);
    let mut path = EgoPath::new(&drive.ego);
    drive.objects.retain_mut(|o| {
        // Where ego was not there the object cannot be placed.
        let Some(placed) = beside_path(&mut path, &way, &headings, o) else {
            return false;
        };
        (o.x_m, o.y_m) = placed;
        o.x_m.is_finite()
    });
    drive.ego.x_m = way;
    drive.ego.y_m.fill(0.0);
}

fn driven_way(ego: &EgoSamples, max_gap_s: f64) -> Vec<f64> {
    let mut way = Vec::with_capacity(ego.len());
    let mut so_far = 0.0;
    for (i, sample) in ego.iter().enumerate() {
        if let Some(before) = i.checked_sub(1).map(|i| ego.at(i)) {
            let dt = (sample.stamp_ns - before.stamp_ns) as f64 / 1e9;
            so_far += match (before.speed_mps, sample.speed_mps) {
                (Some(a), Some(b)) if dt <= max_gap_s => 0.5 * (a + b) * dt,
                _ => libm::hypot(sample.x_m - before.x_m, sample.y_m - before.y_m),
            };
        }
        way.push(so_far);
    }
    way
}

/// Ego's heading as a unit vector: as recorded, else its direction of movement, kept while it stands.
fn headings(ego: &EgoSamples) -> Vec<(f64, f64)> {
    let moved = |i: usize| {
        let a = ego.at(i.saturating_sub(1));
        let b = ego.at((i + 1).min(ego.len() - 1));
        let (dx, dy) = (b.x_m - a.x_m, b.y_m - a.y_m);
        let way = libm::hypot(dx, dy);
        (way > DIRECTION_M).then(|| (dx / way, dy / way))
    };
    let known = |i: usize| match ego.at(i).yaw_rad {
        Some(yaw) => Some((libm::cos(yaw), libm::sin(yaw))),
        None => moved(i),
    };
    let mut heading = (0..ego.len()).find_map(known).unwrap_or((1.0, 0.0));
    (0..ego.len())
        .map(|i| {
            heading = known(i).unwrap_or(heading);
            heading
        })
        .collect()
}

fn beside_path(
    path: &mut EgoPath<'_>,
    way: &[f64],
    headings: &[(f64, f64)],
    object: &ObjectSample,
) -> Option<(f64, f64)> {
    let (x, y) = path.at(object.stamp_ns)?;
    let (before, after, w) = path.bracket(object.stamp_ns)?;
    let s = way[before] + w * (way[after] - way[before]);
    let (cos, sin) = headings[before];
    let (dx, dy) = (object.x_m - x, object.y_m - y);
    Some((s + dx * cos + dy * sin, dy * cos - dx * sin))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raw::EgoSample;

    fn ego(points: &[(f64, f64)]) -> EgoSamples {
        let sample = |(i, &(x_m, y_m)): (i64, &(f64, f64))| EgoSample {
            stamp_ns: i * 100_000_000,
            log_ns: 0,
            nth: 0,
            x_m,
            y_m,
            yaw_rad: None,
            speed_mps: Some(10.0),
        };
        (0..).zip(points).map(sample).collect()
    }

    fn object(stamp_ns: i64, x_m: f64, y_m: f64) -> ObjectSample {
        ObjectSample {
            stamp_ns,
            log_ns: 0,
            nth: 0,
            id: 1,
            x_m,
            y_m,
            speed_mps: 10.0,
            length_m: f64::NAN,
        }
    }

    #[test]
    fn ego_is_found_at_any_time_in_any_order() {
        let ego = ego(&[(0.0, 0.0), (1.0, 2.0), (3.0, 2.0)]);
        let mut path = EgoPath::new(&ego);
        for (ns, expected) in [
            (-1, None),
            (50_000_000, Some((0.5, 1.0))),
            (200_000_000, Some((3.0, 2.0))),
            (100_000_000, Some((1.0, 2.0))),
            (150_000_000, Some((2.0, 2.0))),
            (200_000_001, None),
            (0, Some((0.0, 0.0))),
            (-1, None),
        ] {
            assert_eq!(path.at(ns), expected, "{ns}");
        }
    }

    #[test]
    fn a_straight_drive_in_any_direction_becomes_x() {
        let mut drive = RawDrive {
            ego: ego(&[(5.0, 5.0), (5.0, 6.0), (5.0, 7.0)]),
            objects: [object(0, 4.0, 25.0)].into_iter().collect(),
            ..RawDrive::default()
        };
        place(&mut drive, FrameKind::Auto, 0.0, 0.5);
        assert!((drive.ego.x_m[2] - 2.0).abs() < 1e-12 && drive.ego.y_m[2].abs() < 1e-12);
        let o = drive.objects.at(0);
        assert!((o.x_m - 20.0).abs() < 1e-12 && (o.y_m - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_winding_drive_is_unrolled_along_its_path() {
        let circle: Vec<(f64, f64)> = (0..400)
            .map(|i| (50.0 * (0.02 * f64::from(i)).cos(), 50.0 * (0.02 * f64::from(i)).sin()))
            .collect();
        let mut drive = RawDrive {
            ego: ego(&circle),
            objects: [object(10_000_000_000, circle[103].0, circle[103].1)].into_iter().collect(),
            ..RawDrive::default()
        };
        place(&mut drive, FrameKind::Auto, 0.0, 0.5);
        assert!((drive.ego.x_m[399] - 399.0).abs() < 1e-9);
        let o = drive.objects.at(0);
        assert!((o.x_m - 103.0).abs() < 0.1 && o.y_m.abs() < 0.2);
    }
}
