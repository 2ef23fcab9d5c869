//! A leader that has no number of its own: it is another one where it jumps or is of another length.

/// A leader that jumps further than this is another one, in m.
const JUMP_M: f64 = 5.0;
/// One whose length differs by more than this is too, in m: a tracker's guess of the same vehicle differs by less.
const LENGTH_M: f64 = 1.0;
/// Between this and standing still lies the speed of a leader of whom nothing else is known, in m/s.
const FASTEST_MPS: f64 = 90.0;

/// What a sample says of a leader.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sight {
    pub(crate) stamp_ns: i64,
    pub(crate) x_m: f64,
    /// In m/s; NaN where it is not known.
    pub(crate) speed_mps: f64,
    /// In m; NaN where it is not known.
    pub(crate) length_m: f64,
}

/// Counts leaders, in the order of time.
#[derive(Debug, Default)]
pub(crate) struct Leaders {
    last: Option<Sight>,
    before: u32,
}

impl Leaders {
    /// How many other leaders there were before the one of the next sample.
    pub(crate) fn before(&mut self, now: Sight) -> u32 {
        if let Some(last) = self.last {
            let dt = now.stamp_ns.saturating_sub(last.stamp_ns) as f64 / 1e9;
            let mean = 0.5 * (last.speed_mps + now.speed_mps);
            let (slowest, fastest) = if mean.is_nan() {
                (0.0, FASTEST_MPS)
            } else {
                (mean, mean)
            };
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
        let sight = |i: i64, x_m: f64, speed_mps: f64, length_m: f64| Sight {
            stamp_ns: i * 100_000_000,
            x_m,
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
