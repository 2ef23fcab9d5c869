//! How far a closed-loop run is from the recording.

use crate::{closed_loop::ClosedLoop, run::Stretch};
use serde::{Deserialize, Serialize};

/// How far a closed-loop run is from the recording, over the rows after the first.
///
/// # Source
/// The mixed error is that of Kesting and Treiber 2008, "Calibrating car-following models by using trajectory data".
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SimulationErrors {
    /// Root mean square error of the gap, in m: the main one.
    pub gap_rmse_m: f64,
    /// Root mean square error of ego's speed, in m/s.
    pub speed_rmse_mps: f64,
    /// `gap_rmse_m` over the root mean square of the recorded gap.
    pub nrmse: f64,
    /// √(mean(Δ²/gap)/mean(gap)), Δ the error of the gap and gap the recorded one.
    pub mixed: f64,
    /// Whether the simulated gap reached 0.
    pub reached_zero: bool,
}

impl SimulationErrors {
    /// Compares a closed-loop run with the rows of `stretch` that it was made from.
    pub fn between(stretch: &Stretch<'_>, simulated: &ClosedLoop) -> Self {
        let columns = stretch.run.columns();
        let recorded_gap = &columns.gap_m[stretch.rows.clone()];
        let recorded_speed = &columns.ego_speed_mps[stretch.rows.clone()];
        let count = recorded_gap.len().saturating_sub(1) as f64;
        let (mut gap, mut speed, mut square, mut relative, mut total) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for (row, &recorded) in recorded_gap.iter().enumerate().skip(1) {
            let gap_error = (simulated.gap_m[row] - recorded).powi(2);
            gap += gap_error;
            speed += (simulated.speed_mps[row] - recorded_speed[row]).powi(2);
            square += recorded * recorded;
            relative += gap_error / recorded;
            total += recorded;
        }
        Self {
            gap_rmse_m: (gap / count).sqrt(),
            speed_rmse_mps: (speed / count).sqrt(),
            nrmse: (gap / square).sqrt(),
            mixed: (relative / total).sqrt(),
            reached_zero: simulated.reached_zero,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;

    #[test]
    fn errors_are_those_worked_out_by_hand() {
        // Test rows 6 to 8: all but the first count, gaps of 20 m for 17 and 24 m, and 10 m/s for 11 and 12 m/s.
        let run = testing::behind("P01", 9, 20.0, 10.0, |_| 10.0);
        let simulated = ClosedLoop {
            gap_m: vec![99.0, 17.0, 24.0],
            speed_mps: vec![99.0, 11.0, 12.0],
            reached_zero: false,
        };
        let errors = SimulationErrors::between(&run.test(), &simulated);
        assert!((errors.gap_rmse_m - 12.5_f64.sqrt()).abs() < 1e-12);
        assert!((errors.speed_rmse_mps - 2.5_f64.sqrt()).abs() < 1e-12);
        // 25 of 2 times 20²; and (25/20) of 2 times 20.
        assert!((errors.nrmse - (25.0_f64 / 800.0).sqrt()).abs() < 1e-12);
        assert!((errors.mixed - (1.25_f64 / 40.0).sqrt()).abs() < 1e-12);
    }
}
