//! Predictions from the recorded past, without driving.

use super::run::Stretch;
use serde::{Deserialize, Serialize};

/// What is predicted, and in which unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Predicted {
    /// Ego's speed, in m/s.
    Speed,
    /// The gap over rows in which ego moves, in m.
    Gap,
}

/// One way to predict, on every driver's test rows; the true past is its input.
///
/// Such a score proves nothing about driving: without ego's speed, the leader's speed less the rate of the gap still
/// *is* ego's speed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OpenLoop {
    /// What is predicted.
    pub predicted: Predicted,
    /// By what, for a person to read.
    pub by: String,
    /// Root mean square error of each driver; `None` without a row to predict.
    pub rmse: Vec<Option<f64>>,
    /// Mean over the drivers that have one.
    pub mean: Option<f64>,
}

impl OpenLoop {
    /// One entry a driver.
    pub fn new(predicted: Predicted, by: impl Into<String>, rmse: Vec<Option<f64>>) -> Self {
        let found: Vec<f64> = rmse.iter().flatten().copied().collect();
        let mean = (!found.is_empty()).then(|| found.iter().sum::<f64>() / found.len() as f64);
        Self {
            predicted,
            by: by.into(),
            rmse,
            mean,
        }
    }
}

/// RMSE of F(v_lead) against the recorded gap over the rows of `stretch` in which ego moves, in m; `None` without any.
///
/// Ego moves above `moving_above_mps` (m/s); a run follows throughout, and to leave out its long gaps would be to
/// choose rows by what is predicted. `distance_m` takes the leader's speed (m/s). A score without driving says
/// little: what counts is the closed loop, see [`simulate`](super::simulate).
pub fn distance_rmse_m(
    stretch: &Stretch<'_>,
    moving_above_mps: f64,
    distance_m: impl Fn(f64) -> f64,
) -> Option<f64> {
    let columns = stretch.run.columns();
    let moving = stretch
        .rows
        .clone()
        .filter(|&row| columns.ego_speed_mps[row] > moving_above_mps);
    rmse(moving.map(|row| distance_m(columns.lead_speed_mps[row]) - columns.gap_m[row]))
}

/// RMSE of a prediction of ego's speed over the rows of `stretch`, in m/s; `None` where it is no number.
///
/// `speed_mps` takes the row of the run.
pub fn speed_rmse_mps(stretch: &Stretch<'_>, speed_mps: impl Fn(usize) -> f64) -> Option<f64> {
    let recorded = &stretch.run.columns().ego_speed_mps;
    rmse(
        stretch
            .rows
            .clone()
            .map(|row| speed_mps(row) - recorded[row]),
    )
}

/// The straight line through gap over lead speed that fits the rows of `stretch` in which ego moves best: gap at 0 m/s
/// (m) and slope (s). A slope of 0 where the leader's speed never changes; `None` without rows.
pub fn straight_line(stretch: &Stretch<'_>, moving_above_mps: f64) -> Option<(f64, f64)> {
    let c = stretch.run.columns();
    let rows: Vec<usize> = stretch
        .rows
        .clone()
        .filter(|&row| c.ego_speed_mps[row] > moving_above_mps)
        .collect();
    if rows.is_empty() {
        return None;
    }
    let mean = |x: &[f64]| rows.iter().map(|&row| x[row]).sum::<f64>() / rows.len() as f64;
    let (speed, gap) = (mean(&c.lead_speed_mps), mean(&c.gap_m));
    let (mut both, mut square) = (0.0, 0.0);
    for &row in &rows {
        let away = c.lead_speed_mps[row] - speed;
        both += away * (c.gap_m[row] - gap);
        square += away * away;
    }
    let slope = if square > 0.0 { both / square } else { 0.0 };
    Some((gap - slope * speed, slope))
}

fn rmse(errors: impl Iterator<Item = f64>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0_usize);
    for error in errors {
        sum += error * error;
        count += 1;
    }
    let rmse = (sum / count as f64).sqrt();
    (count > 0 && rmse.is_finite()).then_some(rmse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made_up::behind;

    #[test]
    fn the_score_is_the_one_worked_out_by_hand() {
        // The leader goes at 10 m/s in the first second of the test rows and at 15 m/s in the other.
        let lead = |t: f64| if t < 4.95 { 10.0 } else { 15.0 };
        let run = behind("P01", 60, 20.0, 10.0, lead);
        let rmse = distance_rmse_m(&run.test(), 2.0, |v| 1.2 * v);
        assert!((rmse.unwrap() - 34_f64.sqrt()).abs() < 1e-12);
        // 0 and 5 m/s off.
        let copied = speed_rmse_mps(&run.test(), |row| run.columns().lead_speed_mps[row]);
        assert!((copied.unwrap() - 12.5_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn standstill_has_no_score() {
        let run = behind("P01", 60, 2.0, 0.0, |_| 0.0);
        assert_eq!(distance_rmse_m(&run.test(), 2.0, |_| 2.0), None);
        assert_eq!(straight_line(&run.fit(), 2.0), None);
    }

    #[test]
    fn a_gap_that_does_not_depend_on_the_leader_has_a_level_line() {
        let run = behind("P01", 300, 20.0, 10.0, |t| 10.0 + t.sin());
        let (at_zero, slope) = straight_line(&run.fit(), 2.0).unwrap();
        assert!((at_zero - 20.0).abs() < 1e-9 && slope.abs() < 1e-9);
    }

    #[test]
    fn the_mean_is_over_the_drivers_that_have_a_score() {
        let row = OpenLoop::new(Predicted::Gap, "F", vec![Some(1.0), None, Some(3.0)]);
        assert_eq!(row.mean, Some(2.0));
        assert_eq!(OpenLoop::new(Predicted::Gap, "F", vec![None]).mean, None);
    }
}
