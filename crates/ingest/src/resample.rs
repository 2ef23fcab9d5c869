//! Uneven samples to even rows, never over a hole.

use std::{f64::consts::PI, sync::LazyLock};

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
    pub(crate) fn interpolated(&self, values: &[f64]) -> f64 {
        let a = values[self.before];
        if self.weight > 0.0 { a + self.weight * (values[self.before + 1] - a) } else { a }
    }

    /// The row's place across the road: where that moves in steps, as a label does, that of the last sample before it, so that no row
    /// knows of what comes after it.
    pub(crate) fn across(&self, y_m: &[f64], in_steps: bool) -> f64 {
        if in_steps { y_m[self.before] } else { self.interpolated(y_m) }
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

/// Times of samples, in s.
pub(crate) fn seconds(stamp_ns: &[i64]) -> Vec<f64> {
    stamp_ns.iter().map(|ns| *ns as f64 / 1e9).collect()
}

/// The rows at multiples of 1/`rate_hz` that samples at `time_s` (rising) reach.
///
/// Between two samples no more than `max_gap_s` apart rows are interpolated linearly; a longer hole stays a
/// hole and the next row starts a segment.
pub(crate) fn grid(time_s: &[f64], rate_hz: f64, max_gap_s: f64) -> Grid {
    let mut grid = Grid { rows: Vec::with_capacity(time_s.len()), holes_s: Vec::new() };
    let mut segment = 0;
    let mut after_hole = false;
    let first_tick = |t: f64| ((t - SAME_TIME_S) * rate_hz).ceil() as i64;
    let mut begin = time_s.first().map_or(0, |t| first_tick(*t));
    for (i, &t) in time_s.iter().enumerate() {
        let next = time_s.get(i + 1).copied();
        let joined = next.filter(|next| next - t <= max_gap_s + SAME_TIME_S);
        let coming = next.map(first_tick);
        let end = match (joined, coming) {
            (Some(_), Some(coming)) => coming,
            // Alone towards the next: only a row at this very time.
            _ => ((t + SAME_TIME_S) * rate_hz).floor() as i64 + 1,
        };
        for tick in std::mem::replace(&mut begin, coming.unwrap_or(end))..end {
            if after_hole && !grid.rows.is_empty() {
                segment += 1;
            }
            after_hole = false;
            let since = tick as f64 / rate_hz - t;
            let weight = match joined {
                Some(next) if since > SAME_TIME_S => (since / (next - t)).min(1.0),
                _ => 0.0,
            };
            grid.rows.push(Row { tick, before: i, weight, segment });
        }
        if let (None, Some(next)) = (joined, next) {
            after_hole = true;
            grid.holes_s.push((t, next));
        }
    }
    grid
}

impl Grid {
    /// Leaves out the rows that another grid has not; a segment begins where either has one.
    pub(crate) fn keep(&mut self, seen: &Self) {
        let mut index = 0;
        // Segments of the last row that was kept, here and there.
        let mut last: Option<(u32, u32)> = None;
        let mut segment = 0;
        self.rows.retain_mut(|row| {
            while seen.rows.get(index).is_some_and(|s| s.tick < row.tick) {
                index += 1;
            }
            let Some(there) = seen.rows.get(index).filter(|s| s.tick == row.tick) else {
                return false;
            };
            let now = (row.segment, there.segment);
            segment += u32::from(last.is_some_and(|before| before != now));
            last = Some(now);
            row.segment = segment;
            true
        });
    }
}

/// A speed on the rows of a grid without aliases, shape `(rows,)`; samples are at `stamp_ns`, which rises.
///
/// Where samples come faster than rows, a row is the mean of the samples within four steps to either side, weighted by
/// a sinc that cuts off at 0.35 of the rate, a Hann window, and the time for which each sample stands: bursts of
/// samples at almost one time count once. Above 0.65 of the rate, which aliases to below 0.35, at most 1 % is left, and
/// about as much again for each 3 % of a step by which the samples' times jitter. The filter is symmetric, so nothing is
/// delayed; at the ends of a run and beside its holes it narrows. Where samples come as slowly as rows or slower, rows are
/// interpolated linearly. Times are compared in whole nanoseconds: rows that lie alike among their samples have the same
/// weights, and those are worked out once.
pub(crate) fn speeds(
    stamp_ns: &[i64],
    values: &[f64],
    grid: &Grid,
    rate_hz: f64,
    max_gap_s: f64,
) -> Vec<f64> {
    let mut runs = Runs::new(stamp_ns, max_gap_s);
    let mut filter = Filter::new(stamp_ns, rate_hz);
    let row = |row: &Row| {
        let run = runs.around(row.before);
        let mean = filter.mean(values, run, row);
        mean.unwrap_or_else(|| row.interpolated(values))
    };
    grid.rows.iter().map(row).collect()
}

/// Patterns of samples around a row whose weights are kept.
const PATTERNS: usize = 8;

/// How the samples around a row lie, and what each counts; with the sample to either side, which says for how long those
/// at the edge stand.
#[derive(Debug, Default)]
struct Pattern {
    /// Times from the row to each sample, in ns.
    offsets_ns: Vec<i64>,
    /// By sample; they add up to 1, or are none where samples all but miss the middle.
    weights: Vec<f64>,
}

/// The filter against aliases, along rising rows.
struct Filter<'a> {
    stamp_ns: &'a [i64],
    rate_hz: f64,
    /// Half its width, in ns.
    widest_ns: i64,
    /// The first sample that a row may reach, and the first behind it.
    window: (usize, usize),
    known: [Pattern; PATTERNS],
    /// Which of them is given up next.
    oldest: usize,
}

impl<'a> Filter<'a> {
    fn new(stamp_ns: &'a [i64], rate_hz: f64) -> Self {
        Self {
            stamp_ns,
            rate_hz,
            widest_ns: (HALF_WIDTH_STEPS / rate_hz * 1e9).round() as i64,
            window: (0, 0),
            known: Default::default(),
            oldest: 0,
        }
    }

    /// The mean around a row of a run of samples; none where samples are too few to have one.
    fn mean(&mut self, values: &[f64], run: (usize, usize), row: &Row) -> Option<f64> {
        let (first, last) = run;
        let (from, to) = (self.stamp_ns[first], self.stamp_ns[last]);
        let step_ns = (to - from) as f64 / (last - first).max(1) as f64;
        if last == first || step_ns * self.rate_hz > DENSE_STEPS * 1e9 {
            return None;
        }
        let before = self.stamp_ns[row.before];
        let time_ns = match self.stamp_ns.get(row.before + 1) {
            Some(next) if row.weight > 0.0 => {
                before + (row.weight * (next - before) as f64).round() as i64
            }
            _ => before,
        };
        let half_ns = self.widest_ns.min(time_ns - from).min(to - time_ns);
        if half_ns as f64 <= step_ns {
            return None;
        }
        // Both ends of the window only ever move on.
        let (mut start, mut end) = (self.window.0.max(first), self.window.1.max(first));
        while self.stamp_ns[start] < time_ns - half_ns {
            start += 1;
        }
        while end <= last && self.stamp_ns[end] <= time_ns + half_ns {
            end += 1;
        }
        self.window = (start, end);
        let outer = (start.max(first + 1) - 1, (end + 1).min(last + 1));
        let around = &self.stamp_ns[outer.0..outer.1];
        let inner = (start - outer.0, end - outer.0);
        let values = &values[start..end];
        let a_ns = self.rate_hz / 1e9;
        if half_ns < self.widest_ns {
            let narrow = |steps: f64| kernel(steps, half_ns as f64 * a_ns);
            let mut pattern = Pattern::default();
            pattern.become_of(around, time_ns, inner, a_ns, narrow);
            return pattern.mean(values);
        }
        let alike = self.known.iter().position(|p| p.is(around, time_ns));
        let known = alike.unwrap_or_else(|| {
            self.oldest = (self.oldest + 1) % PATTERNS;
            self.known[self.oldest].become_of(around, time_ns, inner, a_ns, at_full_width);
            self.oldest
        });
        self.known[known].mean(values)
    }
}

impl Pattern {
    /// Becomes that of a row `at` a time; of the samples `around` it `inner` are within the window, and a nanosecond is `a_ns`
    /// steps.
    fn become_of(
        &mut self,
        around: &[i64],
        at: i64,
        inner: (usize, usize),
        a_ns: f64,
        kernel: impl Fn(f64) -> f64,
    ) {
        self.offsets_ns.clear();
        self.offsets_ns.extend(around.iter().map(|t| t - at));
        let steps = |i: usize| self.offsets_ns[i] as f64 * a_ns;
        let last = around.len() - 1;
        // The steps for which a sample stands, by its neighbours.
        let stands = |i: usize| 0.5 * (steps((i + 1).min(last)) - steps(i.saturating_sub(1)));
        self.weights.clear();
        self.weights.extend((inner.0..inner.1).map(|i| stands(i) * kernel(steps(i))));
        let sum: f64 = self.weights.iter().sum();
        if sum > 0.5 * CUT_OFF {
            let to_one = 1.0 / sum;
            for weight in &mut self.weights {
                *weight *= to_one;
            }
        } else {
            self.weights.clear();
        }
    }

    /// Whether samples `around` a row lie like this.
    fn is(&self, around: &[i64], at: i64) -> bool {
        let same = |(offset, t): (&i64, &i64)| t - at == *offset;
        self.offsets_ns.len() == around.len() && self.offsets_ns.iter().zip(around).all(same)
    }

    fn mean(&self, values: &[f64]) -> Option<f64> {
        if self.weights.is_empty() {
            return None;
        }
        // Four sums at a time: one would wait for itself.
        let (weights, values) = (self.weights.as_chunks::<4>(), values.as_chunks::<4>());
        let mut sums = [0.0; 4];
        for (w, v) in weights.0.iter().zip(values.0) {
            for i in 0..4 {
                sums[i] += w[i] * v[i];
            }
        }
        let rest = weights.1.iter().zip(values.1).map(|(w, v)| w * v);
        Some(sums.iter().sum::<f64>() + rest.sum::<f64>())
    }
}

/// Pieces of a step in which the kernel is a cubic.
const PIECES: usize = 256;

/// The kernel at its full width, by pieces: the cubic through four of its values around each. Off by less than 1e-10.
static FULL_WIDTH: LazyLock<Vec<[f64; 4]>> = LazyLock::new(|| {
    let value = |i: f64| kernel(i / PIECES as f64, HALF_WIDTH_STEPS);
    let cubic = |i: usize| {
        let i = i as f64;
        let (before, a, b, after) = (value(i - 1.0), value(i), value(i + 1.0), value(i + 2.0));
        [
            a,
            b - a / 2.0 - before / 3.0 - after / 6.0,
            0.5 * (before + b) - a,
            (after - before) / 6.0 + 0.5 * (a - b),
        ]
    };
    (0..=HALF_WIDTH_STEPS as usize * PIECES).map(cubic).collect()
});

/// [`kernel`] at its full width.
fn at_full_width(steps: f64) -> f64 {
    let scaled = steps.abs() * PIECES as f64;
    let piece = scaled as usize;
    let Some([a, b, c, d]) = FULL_WIDTH.get(piece) else {
        return 0.0;
    };
    let x = scaled - piece as f64;
    a + x * (b + x * (c + x * d))
}

/// What a sample counts so many steps from its row, in a window of half a width.
fn kernel(steps: f64, half_width: f64) -> f64 {
    let phase = 2.0 * PI * CUT_OFF * steps;
    let sinc = if phase.abs() < 1e-9 { 1.0 } else { libm::sin(phase) / phase };
    sinc * 0.5 * (1.0 + libm::cos(PI * steps / half_width))
}

/// Stretches of samples without a hole, asked for in rising order.
struct Runs<'a> {
    stamp_ns: &'a [i64],
    max_gap_ns: i64,
    first: usize,
    last: usize,
}

impl<'a> Runs<'a> {
    fn new(stamp_ns: &'a [i64], max_gap_s: f64) -> Self {
        let mut runs = Self {
            stamp_ns,
            max_gap_ns: ((max_gap_s + SAME_TIME_S) * 1e9).round() as i64,
            first: 0,
            last: 0,
        };
        runs.reach();
        runs
    }

    fn reach(&mut self) {
        self.last = self.first;
        while let Some(next) = self.stamp_ns.get(self.last + 1)
            && next - self.stamp_ns[self.last] <= self.max_gap_ns
        {
            self.last += 1;
        }
    }

    /// The first and the last sample of the run that holds a sample.
    fn around(&mut self, index: usize) -> (usize, usize) {
        while index > self.last {
            self.first = self.last + 1;
            self.reach();
        }
        (self.first, self.last)
    }
}

#[cfg(test)]
mod tests;
