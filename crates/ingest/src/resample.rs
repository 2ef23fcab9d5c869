//! Uneven samples to even rows, never over a hole.

use std::f64::consts::PI;

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

    /// The row's value of a label: that of the last sample before it, so that no row knows of what comes after it.
    pub(crate) fn held<T>(&self, samples: &[T], value: impl Fn(&T) -> f64) -> f64 {
        value(&samples[self.before])
    }
}

/// Half the width of the filter for speeds, in steps of the result.
const HALF_WIDTH_STEPS: f64 = 4.0;
/// Its cut-off, in cycles a step of the result.
const CUT_OFF: f64 = 0.35;
/// Sources with longer steps than this, in steps of the result, hold nothing that could alias.
const DENSE_STEPS: f64 = 0.75;

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
    let mut grid = Grid {
        rows: Vec::with_capacity(time_s.len()),
        holes_s: Vec::new(),
    };
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

/// A speed on the rows of a grid without aliases, shape `(rows,)`.
///
/// Where samples come faster than rows, a row is the mean of the samples within four steps to either side, weighted by
/// a sinc that cuts off at 0.35 of the rate, a Hann window, and the time for which each sample stands: bursts of
/// samples at almost one time count once. Above 0.65 of the rate, which aliases to below 0.35, at most 1 % is left, and
/// about as much again for each 3 % of a step by which the samples' times jitter. The filter is symmetric, so nothing is delayed; at the ends of a run and beside its holes it narrows. Where samples come
/// as slowly as rows or slower, rows are interpolated linearly.
pub(crate) fn speeds(
    time_s: &[f64],
    values: &[f64],
    grid: &Grid,
    rate_hz: f64,
    max_gap_s: f64,
) -> Vec<f64> {
    let mut runs = Runs::new(time_s, max_gap_s);
    let widest_s = HALF_WIDTH_STEPS / rate_hz;
    let mut waves: Vec<Waves> = Vec::new();
    let mut row = |row: &Row| {
        let linear = row.of(values, |v| *v);
        let (first, last) = runs.around(row.before);
        let (from, to) = (time_s[first], time_s[last]);
        let step_s = (to - from) / (last - first).max(1) as f64;
        if last == first || step_s * rate_hz > DENSE_STEPS {
            return linear;
        }
        let at = row.of(time_s, |t| *t);
        let half_s = widest_s.min(at - from).min(to - at);
        if half_s <= step_s {
            return linear;
        }
        if waves.is_empty() {
            waves.extend(time_s.iter().map(|t| Waves::at(*t, rate_hz)));
        }
        // Beside the ends of a run the window is narrower, and its cosine another.
        let own = (half_s >= widest_s).then(|| Waves::at(at, rate_hz));
        let (mut sum, mut weights) = (0.0, 0.0);
        let start = first + time_s[first..=last].partition_point(|t| *t < at - half_s);
        for i in start..=last {
            let since = time_s[i] - at;
            if since > half_s {
                break;
            }
            let before = time_s[i.saturating_sub(1).max(first)];
            let after = time_s[(i + 1).min(last)];
            let kernel = match &own {
                Some(own) => waves[i].kernel(own, since, rate_hz),
                None => kernel(since, half_s, rate_hz),
            };
            let weight = 0.5 * (after - before) * kernel;
            sum += weight * values[i];
            weights += weight;
        }
        // Samples that all but miss the window's middle have no mean.
        if weights * rate_hz > 0.5 * CUT_OFF {
            sum / weights
        } else {
            linear
        }
    };
    grid.rows.iter().map(&mut row).collect()
}

/// The kernel's two waves at one time: what lies between two times follows from both without another sine.
struct Waves {
    /// Sine and cosine at the cut-off.
    cut_off: (f64, f64),
    /// Of the window, at its full width.
    window: (f64, f64),
}

impl Waves {
    /// Steps of the result after which both waves begin anew: 14 turns and 5.
    const PERIOD_STEPS: f64 = 40.0;

    fn at(time_s: f64, rate_hz: f64) -> Self {
        let steps = time_s.rem_euclid(Self::PERIOD_STEPS / rate_hz) * rate_hz;
        Self {
            cut_off: libm::sincos(2.0 * PI * CUT_OFF * steps),
            window: libm::sincos(PI / HALF_WIDTH_STEPS * steps),
        }
    }

    /// [`kernel`] at the full width, between this time and that of `row`, `since_s` before it.
    fn kernel(&self, row: &Self, since_s: f64, rate_hz: f64) -> f64 {
        let phase = 2.0 * PI * CUT_OFF * rate_hz * since_s;
        let sinc = if phase.abs() < 0.05 {
            // Near 0 the difference of two sines has lost its digits.
            let square = phase * phase;
            1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0))
        } else {
            (self.cut_off.0 * row.cut_off.1 - self.cut_off.1 * row.cut_off.0) / phase
        };
        let cos = self.window.1 * row.window.1 + self.window.0 * row.window.0;
        sinc * 0.5 * (1.0 + cos)
    }
}

fn kernel(since_s: f64, half_s: f64, rate_hz: f64) -> f64 {
    let phase = 2.0 * PI * CUT_OFF * rate_hz * since_s;
    let sinc = if phase.abs() < 1e-9 {
        1.0
    } else {
        libm::sin(phase) / phase
    };
    sinc * 0.5 * (1.0 + libm::cos(PI * since_s / half_s))
}

/// Stretches of samples without a hole, asked for in rising order.
struct Runs<'a> {
    time_s: &'a [f64],
    max_gap_s: f64,
    first: usize,
    last: usize,
}

impl<'a> Runs<'a> {
    fn new(time_s: &'a [f64], max_gap_s: f64) -> Self {
        let mut runs = Self {
            time_s,
            max_gap_s,
            first: 0,
            last: 0,
        };
        runs.reach();
        runs
    }

    fn reach(&mut self) {
        self.last = self.first;
        while let Some(next) = self.time_s.get(self.last + 1)
            && next - self.time_s[self.last] <= self.max_gap_s + SAME_TIME_S
        {
            self.last += 1;
        }
    }

    fn around(&mut self, index: usize) -> (usize, usize) {
        while index > self.last {
            self.first = self.last + 1;
            self.reach();
        }
        (self.first, self.last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn resampled(hz: f64, jitter: f64, signal: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        let time: Vec<f64> = (0..(10.0 * hz) as usize)
            .map(|i| (i as f64 + jitter * (i as f64 * 1.7).sin()) / hz)
            .collect();
        let values: Vec<f64> = time.iter().map(|t| signal(*t)).collect();
        let grid = grid(&time, 20.0, 0.5);
        let found = speeds(&time, &values, &grid, 20.0, 0.5);
        let at = grid.rows.iter().map(|r| r.tick as f64 / 20.0);
        at.zip(found).collect()
    }

    fn largest(found: &[(f64, f64)], wrong: impl Fn(f64, f64) -> f64) -> f64 {
        let inner = found.iter().filter(|(t, _)| (0.5..9.4).contains(t));
        inner.map(|&(t, v)| wrong(t, v).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn what_would_alias_is_gone_and_what_drivers_do_is_kept() {
        for (hz, jitter, most) in [(100.0, 0.0, 0.01), (83.0, 0.05, 0.02), (83.0, 0.3, 0.1)] {
            let at = |f: f64| move |t: f64| (2.0 * PI * f * t).sin();
            let alias = largest(&resampled(hz, jitter, at(18.0)), |_, v| v);
            assert!(
                alias < most,
                "18 Hz would look like 2 Hz: {alias} at {hz} Hz"
            );
            let kept = resampled(hz, jitter, at(1.0));
            let lost = largest(&kept, |t, v| v - at(1.0)(t));
            assert!(lost < 0.01, "1 Hz: {lost} at {hz} Hz");
        }
    }

    #[test]
    fn a_kernel_from_two_times_is_the_kernel_between_them() {
        for rate in [10.0, 20.0, 25.0] {
            for i in 0..2000 {
                let at = 3600.0 + f64::from(i) * 0.37;
                let since = 4.0 / rate * (f64::from(i % 199) / 99.0 - 1.0);
                let (waves, row) = (Waves::at(at + since, rate), Waves::at(at, rate));
                // As the samples' times are: the difference of two numbers.
                let since = (at + since) - at;
                let direct = kernel(since, 4.0 / rate, rate);
                let found = waves.kernel(&row, since, rate);
                assert!((found - direct).abs() < 1e-10, "{i}: {found} {direct}");
            }
        }
    }

    #[test]
    fn a_steady_speed_and_a_steady_acceleration_come_through_to_both_ends() {
        for (t, v) in resampled(100.0, 0.0, |t| 5.0 + 2.0 * t) {
            assert!((v - 5.0 - 2.0 * t).abs() < 1e-6, "{t}: {v}");
        }
        for (_, v) in resampled(83.0, 0.4, |_| 7.0) {
            assert!((v - 7.0).abs() < 1e-12);
        }
    }

    #[test]
    fn slow_sources_are_interpolated_and_a_burst_counts_once() {
        let found = resampled(10.0, 0.0, |t| t);
        assert!(largest(&found, |t, v| v - t) < 1e-9);
        // Ten samples within a microsecond at 5 s, far off: one bad sample's worth, not ten.
        let mut time: Vec<f64> = (0..1000).map(|i| f64::from(i) / 100.0).collect();
        let mut values = vec![10.0; 1000];
        for i in 0..10 {
            time.insert(501 + i, 5.0 + 1e-7 * (i + 1) as f64);
            values.insert(501 + i, 20.0);
        }
        let grid = grid(&time, 20.0, 0.5);
        let found = speeds(&time, &values, &grid, 20.0, 0.5);
        let most = found.iter().copied().fold(0.0, f64::max);
        assert!(most < 11.5, "{most}");
    }

    #[test]
    fn labels_are_those_of_the_sample_before() {
        let time = [0.0, 0.07, 0.1];
        let lanes = [0.0, 1.0, 2.0];
        let grid = grid(&time, 20.0, 0.5);
        let held: Vec<f64> = grid.rows.iter().map(|r| r.held(&lanes, |l| *l)).collect();
        assert_eq!(held, [0.0, 0.0, 2.0]);
    }

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
