//! A leader that has no number of its own: it is another one where it jumps or is of another length.

use super::ObjectSample;
use crate::speed_limits::FASTEST_MPS;

/// A leader that jumps further than this is another one, in m.
const JUMP_M: f64 = 5.0;
/// One whose length differs by more than this is too, in m: a tracker's guess of the same vehicle differs by less.
const LENGTH_M: f64 = 1.0;

/// Counts leaders, in the order of time.
#[derive(Debug, Default)]
pub(crate) struct Leaders {
    last: Option<ObjectSample>,
    before: u32,
}

impl Leaders {
    /// How many other leaders there were before the one of the next sample; a speed or a length that is not known is NaN.
    pub(crate) fn before(&mut self, now: ObjectSample) -> u32 {
        if let Some(last) = self.last {
            let dt = now.stamp_ns.saturating_sub(last.stamp_ns) as f64 / 1e9;
            let mean = 0.5 * (last.speed_mps + now.speed_mps);
            // One of whom nothing else is known stands, or drives as fast as any car.
            let (slowest, fastest) = if mean.is_nan() { (0.0, FASTEST_MPS) } else { (mean, mean) };
            let moved = now.x_m - last.x_m;
            let jumps = moved < slowest * dt - JUMP_M || moved > fastest * dt + JUMP_M;
            // Not where a length is unknown.
            let grows = (now.length_m - last.length_m).abs() > LENGTH_M;
            self.before += u32::from(jumps || grows);
        }
        self.last = Some(now);
        self.before
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leader_is_another_one_after_a_jump_or_with_another_length() {
        let sight = |i: i64, x_m: f64, speed_mps: f64, length_m: f64| ObjectSample {
            stamp_ns: i * 100_000_000,
            log_ns: 0,
            nth: 0,
            id: 0,
            x_m,
            y_m: 0.0,
            speed_mps,
            length_m,
        };
        let (unknown, car) = (f64::NAN, 4.5);
        for (next, another) in [
            (sight(1, 2.0, 20.0, car), 0),
            (sight(1, 7.1, 20.0, car), 1),
            (sight(1, -3.1, 20.0, car), 1),
            (sight(1, 2.0, 20.0, 5.4), 0),
            (sight(1, 2.0, 20.0, 16.5), 1),
            (sight(1, 2.0, 20.0, unknown), 0),
            // Of an unknown speed any up to 90 m/s may be its own.
            (sight(1, 13.9, unknown, car), 0),
            (sight(1, 14.1, unknown, car), 1),
            (sight(1, -5.1, unknown, car), 1),
        ] {
            let mut leaders = Leaders::default();
            assert_eq!(leaders.before(sight(0, 0.0, 20.0, car)), 0);
            assert_eq!(leaders.before(next), another, "{next:?}");
        }
    }
}
