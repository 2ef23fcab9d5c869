//! Columns as small integers: sampled, rounded to a quantum, differenced, in as few bytes as they need.

use super::SIGHT_M;
use super::drive::{PlayerDrive, Track};

/// Instants a second that are kept; the player draws straight lines between them.
pub const SAMPLES_PER_S: f64 = 5.0;
/// Positions are kept to this, in m.
pub const POSITION_QUANTUM_M: f64 = 0.01;
/// Speeds are kept to this, in m/s.
pub const SPEED_QUANTUM_MPS: f64 = 0.01;
/// Gaps are kept to this, in m.
pub const GAP_QUANTUM_M: f64 = 0.1;

/// Stands for "no reference vehicle" among the gaps.
const NO_GAP: i64 = -32_768;

/// A run of consecutive samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Run {
    pub(super) first: usize,
    pub(super) count: usize,
}

/// A car while it is in sight.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Seen {
    pub(super) id: u32,
    pub(super) length_m: f64,
    pub(super) width_m: f64,
    pub(super) run: Run,
    pub(super) x_m: Vec<f64>,
    pub(super) y_m: Vec<f64>,
}

/// A drive at [`SAMPLES_PER_S`]; NaN nowhere, holes outside `runs`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sampled {
    /// Samples from the start to the end of the drive, holes included.
    pub(super) samples: usize,
    /// Where there is a recording.
    pub(super) runs: Vec<Run>,
    /// Ego, by sample; values within a hole mean nothing.
    pub(super) x_m: Vec<f64>,
    pub(super) y_m: Vec<f64>,
    pub(super) speed_mps: Vec<f64>,
    pub(super) gap_m: Vec<Option<f64>>,
    pub(super) reference: Vec<Option<u32>>,
    pub(super) seen: Vec<Seen>,
}

impl Sampled {
    /// Whether there is a recording at a sample.
    pub(super) fn has(&self, sample: usize) -> bool {
        let mut runs = self.runs.iter();
        runs.any(|run| (run.first..run.first + run.count).contains(&sample))
    }
}

/// Where a sample lies between rows: a row, and the share of the way to the next.
type Place = Option<(usize, f64)>;

fn places(drive: &PlayerDrive) -> Vec<Place> {
    let time = &drive.time_s;
    let last = time.len() - 1;
    // A row that ends a hair before a sample still is that sample.
    let samples = (time[last] * SAMPLES_PER_S + 1e-6).floor() as usize + 1;
    let mut row = 0;
    let place = |sample: usize| {
        let t = sample as f64 / SAMPLES_PER_S;
        while row < last && time[row + 1] <= t + 1e-9 {
            row += 1;
        }
        if t < time[0] - 1e-9 {
            return None;
        }
        if row == last || (t - time[row]).abs() < 1e-6 {
            return ((t - time[row]).abs() < 1e-6).then_some((row, 0.0));
        }
        let share = (t - time[row]) / (time[row + 1] - time[row]);
        (drive.segment[row] == drive.segment[row + 1]).then_some((row, share))
    };
    (0..samples).map(place).collect()
}

fn between(column: &[f64], (row, share): (usize, f64)) -> f64 {
    let value = column[row];
    match column.get(row + 1) {
        Some(next) if share > 0.0 => value + share * (next - value),
        _ => value,
    }
}

/// Runs of samples for which `holds`.
fn runs(samples: usize, holds: impl Fn(usize) -> bool) -> Vec<Run> {
    let mut out: Vec<Run> = Vec::new();
    for sample in (0..samples).filter(|&sample| holds(sample)) {
        match out.last_mut() {
            Some(run) if run.first + run.count == sample => run.count += 1,
            _ => out.push(Run { first: sample, count: 1 }),
        }
    }
    out
}

/// Samples a drive and keeps the cars that ego has in sight.
pub(super) fn sample(drive: &PlayerDrive) -> Sampled {
    let places = places(drive);
    let column = |values: &[f64]| -> Vec<f64> {
        let value = |place: &Place| place.map_or(0.0, |place| between(values, place));
        places.iter().map(value).collect()
    };
    let nearest = |place: &Place| place.map(|(row, share)| row + usize::from(share > 0.5));
    let x_m = column(&drive.ego.x_m);
    let mut seen = Vec::new();
    for track in &drive.others {
        let place_at = |sample: usize| track_place(track, places[sample]);
        let in_sight = |sample: usize| {
            place_at(sample).is_some_and(|place| {
                let ahead = between(&track.x_m, place) - x_m[sample];
                (-SIGHT_M.0..=SIGHT_M.1).contains(&ahead)
            })
        };
        for run in runs(places.len(), in_sight) {
            let within = || (run.first..run.first + run.count).filter_map(place_at);
            seen.push(Seen {
                id: track.id,
                length_m: track.length_m,
                width_m: track.width_m,
                run,
                x_m: within().map(|p| between(&track.x_m, p)).collect(),
                y_m: within().map(|p| between(&track.y_m, p)).collect(),
            });
        }
    }
    Sampled {
        samples: places.len(),
        runs: runs(places.len(), |sample| places[sample].is_some()),
        y_m: column(&drive.ego.y_m),
        speed_mps: column(&drive.speed_mps),
        gap_m: places.iter().map(|place| nearest(place).and_then(|row| drive.gap_m[row])).collect(),
        reference: places
            .iter()
            .map(|place| nearest(place).and_then(|row| drive.reference[row]))
            .collect(),
        x_m,
        seen,
    }
}

/// The same place counted from the first row of a track; none where it has no rows.
fn track_place(track: &Track, place: Place) -> Place {
    let (row, share) = place?;
    let row = row.checked_sub(track.first_row)?;
    let needs = row + usize::from(share > 0.0);
    (needs < track.x_m.len()).then_some((row, share))
}

/// Bytes of integers: differences of an order, zigzag, seven bits a byte with the lowest first.
#[derive(Debug, Default)]
pub(super) struct Packer {
    bytes: Vec<u8>,
}

impl Packer {
    /// A column of multiples of `quantum`, as differences of the given order.
    pub(super) fn column(
        &mut self,
        values: impl IntoIterator<Item = f64>,
        quantum: f64,
        order: usize,
    ) {
        self.integers(values.into_iter().map(|v| (v / quantum).round() as i64), order);
    }

    fn integers(&mut self, values: impl IntoIterator<Item = i64>, order: usize) {
        let mut before = [0_i64; 2];
        for value in values {
            let mut difference = value;
            for last in &mut before[..order] {
                let now = difference;
                difference -= *last;
                *last = now;
            }
            let mut rest = ((difference << 1) ^ (difference >> 63)) as u64;
            while rest >= 0x80 {
                self.bytes.push((rest & 0x7f) as u8 | 0x80);
                rest >>= 7;
            }
            self.bytes.push(rest as u8);
        }
    }

    /// Everything about a drive, x counted from `start_m`: for each run ego's x, y, speed, gap; for each car seen its x, y;
    /// the places of the centre line.
    pub(super) fn drive(mut self, drive: &PlayerDrive, sampled: &Sampled, start_m: f64) -> Vec<u8> {
        let from_start = |x: &f64| x - start_m;
        for run in &sampled.runs {
            let rows = run.first..run.first + run.count;
            let x = sampled.x_m[rows.clone()].iter().map(from_start);
            self.column(x, POSITION_QUANTUM_M, 2);
            let y = sampled.y_m[rows.clone()].iter().copied();
            self.column(y, POSITION_QUANTUM_M, 1);
            let speed = sampled.speed_mps[rows.clone()].iter().copied();
            self.column(speed, SPEED_QUANTUM_MPS, 1);
            let gap = sampled.gap_m[rows].iter().map(|gap| {
                gap.map_or(NO_GAP, |g| ((g / GAP_QUANTUM_M).round() as i64).max(NO_GAP + 1))
            });
            self.integers(gap, 1);
        }
        for car in &sampled.seen {
            self.column(car.x_m.iter().map(from_start), POSITION_QUANTUM_M, 2);
            self.column(car.y_m.iter().copied(), POSITION_QUANTUM_M, 1);
        }
        if let Some(line) = &drive.centre_line {
            let origin = line.map_m[0];
            let east = line.map_m.iter().map(|place| place.0 - origin.0);
            self.column(east, POSITION_QUANTUM_M, 2);
            let north = line.map_m.iter().map(|place| place.1 - origin.1);
            self.column(north, POSITION_QUANTUM_M, 2);
        }
        self.bytes
    }
}
