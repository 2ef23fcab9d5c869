//! Acceleration and jerk from speed, smoothed.

use maveric_domain::Drive;
use std::f64::consts::{PI, SQRT_2};

/// Border of the low pass, in Hz: people brake below it, sensors tremble above.
const BORDER_HZ: f64 = 2.0;
/// Lowest rate at which it is applied, in Hz.
const LOWEST_HZ: f64 = 10.0;

/// Acceleration (m/s²) and jerk (m/s³) at each row, as [`derivatives`] of the speed.
pub(super) fn acceleration_and_jerk(drive: &Drive) -> Option<[Vec<Option<f64>>; 2]> {
    derivatives(drive, &drive.rows().ego_speed_mps, BORDER_HZ)
}

/// First and second derivative of a signal at each row: central differences of it behind a second-order low pass, that never span two
/// segments. `None` below 10 Hz; a row at the rim of a segment has neither.
///
/// # Source
/// A Butterworth filter by the bilinear transform, as Oppenheim and Schafer have it (?); run forwards once, from the state in which the
/// first speed had lasted for ever.
pub(crate) fn derivatives(
    drive: &Drive,
    signal: &[f64],
    border_hz: f64,
) -> Option<[Vec<Option<f64>>; 2]> {
    if drive.rate_hz() < LOWEST_HZ {
        return None;
    }
    let rows = drive.rows();
    let mut smooth = Vec::with_capacity(drive.len());
    for piece in rows.segment.chunk_by(|a, b| a == b) {
        let from = smooth.len();
        let values = &signal[from..from + piece.len()];
        smooth.extend(low_pass(values, drive.rate_hz(), border_hz));
    }
    let smooth: Vec<Option<f64>> = smooth.into_iter().map(Some).collect();
    let first = slopes(drive, &smooth);
    let second = slopes(drive, &first);
    Some([first, second])
}

fn low_pass(values: &[f64], rate_hz: f64, border_hz: f64) -> Vec<f64> {
    let Some(first) = values.first() else {
        return Vec::new();
    };
    let k = libm::tan(PI * border_hz / rate_hz);
    let scale = 1.0 / (1.0 + SQRT_2 * k + k * k);
    let b0 = k * k * scale;
    let (b1, b2) = (2.0 * b0, b0);
    let (a1, a2) = (2.0 * (k * k - 1.0) * scale, (1.0 - SQRT_2 * k + k * k) * scale);
    let mut later = (b2 - a2) * first;
    let mut next = (b1 - a1) * first + later;
    let step = |value: &f64| {
        let out = b0 * value + next;
        next = b1 * value - a1 * out + later;
        later = b2 * value - a2 * out;
        out
    };
    values.iter().map(step).collect()
}

/// Central differences over the two neighbours of each row.
fn slopes(drive: &Drive, values: &[Option<f64>]) -> Vec<Option<f64>> {
    let rows = drive.rows();
    let slope = |row: usize| {
        let (low, high) = (row.checked_sub(1)?, row + 1);
        let inside = high < values.len() && rows.segment[low] == rows.segment[high];
        let span_s = inside.then(|| rows.time_s[high] - rows.time_s[low])?;
        Some((values[high]? - values[low]?) / span_s)
    };
    (0..values.len()).map(slope).collect()
}

#[cfg(test)]
mod tests {
    use super::super::testing::*;
    use super::*;

    #[test]
    fn what_is_slow_passes_and_what_trembles_does_not() {
        let wave = |hz: f64| -> Vec<f64> {
            (0..400).map(|i| (2.0 * PI * hz * f64::from(i) / 20.0).sin()).collect()
        };
        let height = |hz: f64| {
            let out = low_pass(&wave(hz), 20.0, BORDER_HZ);
            // Of whole periods.
            (out[200..].iter().map(|v| v * v).sum::<f64>() / 100.0).sqrt()
        };
        assert!(height(0.2) > 0.99 && height(6.0) < 0.1, "{} {}", height(0.2), height(6.0));
        // At the border half of the power is left.
        assert!((height(2.0) - 0.5_f64.sqrt()).abs() < 0.01, "{}", height(2.0));
        let level = low_pass(&[20.0; 50], 20.0, BORDER_HZ);
        assert!(level.iter().all(|v| (v - 20.0).abs() < 1e-12));
    }

    #[test]
    fn nothing_is_differentiated_across_a_hole_or_below_10_hz() {
        let hole = |rate_hz: f64| {
            by_rows(rate_hz, 100, |rows| {
                rows.segment[50..].fill(1);
                rows.ego_speed_mps[50..].fill(5.0);
            })
        };
        let [acceleration, jerk] = acceleration_and_jerk(&hole(10.0)).unwrap();
        assert!(acceleration.iter().flatten().all(|a| a.abs() < 1e-9));
        assert_eq!([acceleration[49], acceleration[50], jerk[48], jerk[51]], [None; 4]);
        assert!(acceleration[48].is_some() && jerk[47].is_some() && jerk[52].is_some());
        assert!(acceleration_and_jerk(&hole(9.9)).is_none());
    }
}
