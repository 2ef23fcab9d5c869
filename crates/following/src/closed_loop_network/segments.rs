//! The stretches of rows that are simulated as one.

use super::{
    ClosedLoopSettings,
    lanes::{LANES, nothing},
    world::{Batch, Row},
};
use crate::Stretch;
use maveric_laws::Real;

/// Segments over each row when an embedding is fitted: with each row in one only, the fit hangs on where they begin.
pub(super) const OVERLAP: usize = 5;

/// Some rows of a driver, the error over which has a weight in the loss.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Segment {
    pub(super) driver: usize,
    /// The first of its rows among those of the driver.
    pub(super) start: usize,
    pub(super) weight: f64,
    /// Which embedding drives it.
    pub(super) embedding: usize,
}

pub(super) fn segment_steps(drivers: &[Stretch<'_>], settings: &ClosedLoopSettings) -> usize {
    let rate_hz = drivers[0].run.rate_hz();
    let shortest = drivers.iter().map(|s| s.rows.len() - 1).min().unwrap_or(1);
    ((settings.segment_s * rate_hz).round() as usize).clamp(1, shortest)
}

/// Cuts each driver's rows into segments of `steps` steps, one after the other from `phase` on; each is driven by the driver's embedding.
pub(super) fn one_after_the_other(
    drivers: &[Stretch<'_>],
    steps: usize,
    phase: usize,
) -> Vec<Segment> {
    let starts = |row_count: usize| {
        let phase = phase.min(row_count - steps);
        (0..(row_count - phase) / steps)
            .map(|i| phase + i * steps)
            .collect()
    };
    cut(drivers, starts)
}

/// Cuts each driver's rows into segments of `steps` steps that begin a share of a segment apart.
pub(super) fn overlapping(drivers: &[Stretch<'_>], steps: usize, share: usize) -> Vec<Segment> {
    let between = (steps / share).max(1);
    let starts = |row_count: usize| {
        let count = 1 + (row_count - steps).div_ceil(between);
        (0..count)
            .map(|i| (i * between).min(row_count - steps))
            .collect()
    };
    cut(drivers, starts)
}

/// Every driver weighs the same, and so does every segment of a driver; `starts` gives where they begin among so many steps.
fn cut(drivers: &[Stretch<'_>], starts: impl Fn(usize) -> Vec<usize>) -> Vec<Segment> {
    let mut segments = Vec::new();
    for (driver, stretch) in drivers.iter().enumerate() {
        let starts = starts(stretch.rows.len() - 1);
        let weight = 1.0 / (drivers.len() * starts.len()) as f64;
        segments.extend(starts.into_iter().map(|start| Segment {
            driver,
            start,
            weight,
            embedding: driver,
        }));
    }
    segments
}

/// What was recorded of a driver: gap, ego's speed, the leader's speed and how far it moved, row by row.
pub(super) type Recorded<T> = Vec<[T; 4]>;

pub(super) fn recorded<T: Real>(stretch: &Stretch<'_>) -> Recorded<T> {
    let columns = stretch.run.columns();
    let row = |row: usize| {
        let x = &columns.leader_x_m;
        let moved = if row == 0 { 0.0 } else { x[row] - x[row - 1] };
        let speed = columns.ego_speed_mps[row].max(0.0);
        [
            columns.gap_m[row],
            speed,
            columns.lead_speed_mps[row],
            moved,
        ]
        .map(T::of)
    };
    stretch.rows.clone().map(row).collect()
}

/// The segments side by side, [`LANES`] of them at a time.
pub(super) fn batches<T: Real>(
    recorded: &[Recorded<T>],
    segments: &[Segment],
    steps: usize,
) -> Vec<Batch<T>> {
    segments
        .chunks(LANES)
        .map(|some| batch(recorded, some, steps))
        .collect()
}

fn batch<T: Real>(recorded: &[Recorded<T>], segments: &[Segment], steps: usize) -> Batch<T> {
    // A lane without a segment repeats the first one, without weight.
    let lane = |l: usize| {
        let filling = Segment {
            weight: 0.0,
            ..segments[0]
        };
        segments.get(l).copied().unwrap_or(filling)
    };
    let lanes: [Segment; LANES] = std::array::from_fn(lane);
    let of_lane = lanes.map(|s| &recorded[s.driver][s.start..=s.start + steps]);
    let row = |step: usize| {
        let mut row = Row {
            gap_m: nothing(),
            speed_mps: nothing(),
            lead_mps: nothing(),
            lead_moved_m: nothing(),
        };
        for (l, rows) in of_lane.iter().enumerate() {
            [
                row.gap_m[l],
                row.speed_mps[l],
                row.lead_mps[l],
                row.lead_moved_m[l],
            ] = rows[step];
        }
        row
    };
    Batch {
        embeddings: lanes.map(|s| s.embedding),
        weights: lanes.map(|s| s.weight),
        rows: (0..=steps).map(row).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        run::{FollowingColumns, FollowingRun},
        testing,
    };

    /// Drivers whose recorded gap is the row it stands in.
    fn runs(rows: &[usize]) -> Vec<FollowingRun> {
        let run = |(i, rows): (usize, &usize)| {
            let run = testing::behind(&format!("P{i}"), *rows, 10.0, 5.0, |_| 5.0);
            let columns = FollowingColumns {
                gap_m: (0..*rows).map(|row| (row + 1) as f64).collect(),
                ..run.columns().clone()
            };
            FollowingRun::new(format!("P{i}"), testing::RATE_HZ, columns).unwrap()
        };
        rows.iter().enumerate().map(run).collect()
    }

    /// Driver, first and last row, and weight of every segment; lanes that only fill up are left out.
    fn found(
        stretches: &[Stretch<'_>],
        segments: &[Segment],
        steps: usize,
    ) -> Vec<(usize, usize, usize, f64)> {
        let recorded: Vec<Recorded<f64>> = stretches.iter().map(recorded).collect();
        let mut found = Vec::new();
        for batch in batches(&recorded, segments, steps) {
            assert_eq!(batch.rows.len(), steps + 1);
            for lane in (0..LANES).filter(|l| batch.weights[*l] > 0.0) {
                let row = |step: usize| batch.rows[step].gap_m[lane] as usize - 1;
                assert!((0..=steps).all(|step| row(step) == row(0) + step));
                found.push((
                    batch.embeddings[lane],
                    row(0),
                    row(steps),
                    batch.weights[lane],
                ));
            }
        }
        found
    }

    #[test]
    fn segments_follow_one_another_from_a_phase_or_overlap_to_the_end() {
        let runs = runs(&[31, 22]);
        let stretches: Vec<Stretch<'_>> = (runs.iter())
            .map(|run| Stretch {
                run,
                rows: 1..run.rows(),
            })
            .collect();
        let after = |phase| {
            let segments = one_after_the_other(&stretches, 10, phase);
            found(&stretches, &segments, 10)
        };
        let rows = |found: &[(usize, usize, usize, f64)]| -> Vec<_> {
            found.iter().map(|f| (f.0, f.1, f.2)).collect()
        };
        // 29 and 20 steps: from the third on there are two of ten, and one; the second's phase is cut to where one still fits.
        assert_eq!(rows(&after(3)), [(0, 4, 14), (0, 14, 24), (1, 4, 14)]);
        // Every driver weighs the same.
        let weights: Vec<f64> = after(3).iter().map(|f| f.3).collect();
        assert_eq!(weights, [0.25, 0.25, 0.5]);
        assert_eq!(rows(&after(15)), [(0, 16, 26), (1, 11, 21)]);
        // A fifth of a segment apart, the last at the end.
        let apart = found(&stretches, &overlapping(&stretches, 10, 5), 10);
        let starts = |driver: usize| -> Vec<usize> {
            let own = apart.iter().filter(|f| f.0 == driver);
            own.map(|f| f.1).collect()
        };
        assert_eq!(starts(0), [1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 20]);
        assert_eq!(starts(1), [1, 3, 5, 7, 9, 11]);
        let total: f64 = apart.iter().map(|f| f.3).sum();
        assert!((total - 1.0).abs() < 1e-12);
        assert!((apart[0].3 - 0.5 / 11.0).abs() < 1e-12);
        // Short ones move on by a row.
        assert_eq!(overlapping(&stretches[1..], 3, 5).len(), 18);
    }

    #[test]
    fn a_lane_holds_what_was_recorded_and_how_far_the_leader_moved() {
        let run = testing::behind("P", 12, 20.0, 7.0, |t| 5.0 + t);
        let whole = Stretch {
            run: &run,
            rows: 0..12,
        };
        let segment = |start, weight| Segment {
            driver: 0,
            start,
            weight,
            embedding: 0,
        };
        let found = batch(
            &[recorded::<f64>(&whole)],
            &[segment(0, 1.0), segment(6, 0.5)],
            5,
        );
        assert_eq!(
            (found.weights[0], found.weights[1], found.weights[2]),
            (1.0, 0.5, 0.0)
        );
        let columns = run.columns();
        for (step, of_step) in found.rows.iter().enumerate() {
            for (lane, start) in [(0, 0), (1, 6), (2, 0)] {
                let row = start + step;
                let numbers = [
                    of_step.gap_m[lane],
                    of_step.speed_mps[lane],
                    of_step.lead_mps[lane],
                ];
                let expected = [20.0, 7.0, columns.lead_speed_mps[row]];
                let bits = |values: [f64; 3]| values.map(f64::to_bits);
                assert_eq!(bits(numbers), bits(expected), "row {row}");
                let moved = if row == 0 {
                    0.0
                } else {
                    0.5 * (columns.lead_speed_mps[row] + columns.lead_speed_mps[row - 1])
                        / testing::RATE_HZ
                };
                assert!(
                    (of_step.lead_moved_m[lane] - moved).abs() < 1e-9,
                    "row {row}"
                );
            }
        }
    }

    #[test]
    fn a_segment_is_as_long_as_wanted_and_no_longer_than_the_shortest() {
        let runs = runs(&[401, 101]);
        let of = |run: usize, segment_s: f64| {
            let stretches: Vec<Stretch<'_>> = (runs[run..].iter())
                .map(|run| Stretch {
                    run,
                    rows: 0..run.rows(),
                })
                .collect();
            let settings = ClosedLoopSettings {
                segment_s,
                ..ClosedLoopSettings::default()
            };
            segment_steps(&stretches, &settings)
        };
        assert_eq!((of(0, 5.0), of(0, 30.0), of(1, 0.01)), (50, 100, 1));
    }
}
