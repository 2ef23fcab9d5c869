//! Uneven samples to even rows, never over a hole.

/// How far a row may lie from a sample and still be that sample, in s: stamps are rounded to nanoseconds.
const SAME_TIME_S: f64 = 1e-6;

/// One even row between two samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Row {
    /// Multiple of 1/rate.
    pub(crate) tick: i64,
    /// Sample at or before it.
    pub(crate) before: usize,
    /// Weight of the sample after that one, in 0..1.
    pub(crate) weight: f64,
    /// Rises by one after each hole.
    pub(crate) segment: u32,
}

impl Row {
    /// The row's value of a column of samples.
    pub(crate) fn of<T>(&self, samples: &[T], value: impl Fn(&T) -> f64) -> f64 {
        let a = value(&samples[self.before]);
        if self.weight > 0.0 {
            a + self.weight * (value(&samples[self.before + 1]) - a)
        } else {
            a
        }
    }
}

/// Even rows and the holes between them.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Grid {
    pub(crate) rows: Vec<Row>,
    /// From and to, in s.
    pub(crate) holes_s: Vec<(f64, f64)>,
}

/// The rows at multiples of 1/`rate_hz` that samples at `time_s` (rising) reach.
///
/// Between two samples no more than `max_gap_s` apart rows are interpolated linearly; a longer hole stays a
/// hole and the next row starts a segment.
pub(crate) fn grid(time_s: &[f64], rate_hz: f64, max_gap_s: f64) -> Grid {
    let mut grid = Grid::default();
    let mut segment = 0;
    let mut after_hole = false;
    let first_tick = |t: f64| ((t - SAME_TIME_S) * rate_hz).ceil() as i64;
    for (i, &t) in time_s.iter().enumerate() {
        let next = time_s.get(i + 1).copied();
        let joined = next.filter(|next| next - t <= max_gap_s + SAME_TIME_S);
        let end = match joined {
            Some(next) => first_tick(next),
            // Alone towards the next: only a row at this very time.
            None => ((t + SAME_TIME_S) * rate_hz).floor() as i64 + 1,
        };
        for tick in first_tick(t)..end {
            if after_hole && !grid.rows.is_empty() {
                segment += 1;
            }
            after_hole = false;
            let since = tick as f64 / rate_hz - t;
            let weight = match joined {
                Some(next) if since > SAME_TIME_S => (since / (next - t)).min(1.0),
                _ => 0.0,
            };
            grid.rows.push(Row {
                tick,
                before: i,
                weight,
                segment,
            });
        }
        if let (None, Some(next)) = (joined, next) {
            after_hole = true;
            grid.holes_s.push((t, next));
        }
    }
    grid
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_on_the_grid_come_through_unchanged() {
        let time: Vec<f64> = (0..40).map(|i| f64::from(i) * 0.05 + 2e-10).collect();
        let grid = grid(&time, 20.0, 0.5);
        assert_eq!(grid.rows.len(), 40);
        assert!(
            grid.rows
                .iter()
                .enumerate()
                .all(|(i, r)| r.before == i && r.weight.to_bits() == 0)
        );
    }

    #[test]
    fn short_dropouts_are_bridged_and_long_ones_start_a_segment() {
        let time = [0.0, 0.1, 0.5, 2.0, 2.1];
        let grid = grid(&time, 10.0, 0.5);
        let ticks: Vec<(i64, u32)> = grid.rows.iter().map(|r| (r.tick, r.segment)).collect();
        let expected = [
            (0, 0),
            (1, 0),
            (2, 0),
            (3, 0),
            (4, 0),
            (5, 0),
            (20, 1),
            (21, 1),
        ];
        assert_eq!(ticks, expected);
        assert_eq!(grid.holes_s, [(0.5, 2.0)]);
        assert!((grid.rows[3].of(&time, |t| *t) - 0.3).abs() < 1e-12);
    }
}
