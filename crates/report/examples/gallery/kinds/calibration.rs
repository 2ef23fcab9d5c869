//! Predicted and observed shares in eight bins.

use super::wobble;
use maveric_report::figures::calibration::{Calibration, CalibrationBin};

pub(crate) fn input() -> Calibration {
    let bins = (0..8).map(|k| {
        let predicted = 0.004 * 1.9_f64.powi(k);
        CalibrationBin {
            predicted,
            observed: predicted * (1.0 + 0.2 * wobble(k as usize, 3)),
            seconds: 6000.0 / f64::from(1 + 3 * k),
        }
    });
    Calibration { bins: bins.collect(), expected_error: 0.0042, drives: 38, held_out: true }
}
