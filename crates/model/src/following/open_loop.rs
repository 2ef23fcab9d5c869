//! A following distance beside the recorded gap, without driving.

use super::run::Stretch;

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
    let (mut sum, mut count) = (0.0, 0_usize);
    for row in stretch.rows.clone() {
        if columns.ego_speed_mps[row] > moving_above_mps {
            sum += (distance_m(columns.lead_speed_mps[row]) - columns.gap_m[row]).powi(2);
            count += 1;
        }
    }
    let rmse = (sum / count as f64).sqrt();
    (count > 0 && rmse.is_finite()).then_some(rmse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::following::made_up::behind;

    #[test]
    fn the_score_is_the_one_worked_out_by_hand() {
        // The leader goes at 10 m/s in the first second of the test rows and at 15 m/s in the other.
        let lead = |t: f64| if t < 4.95 { 10.0 } else { 15.0 };
        let run = behind("P01", 60, 20.0, 10.0, lead);
        let rmse = distance_rmse_m(&run.test(), 2.0, |v| 1.2 * v);
        assert!((rmse.unwrap() - 34_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn standstill_has_no_score() {
        let run = behind("P01", 60, 2.0, 0.0, |_| 0.0);
        assert_eq!(distance_rmse_m(&run.test(), 2.0, |_| 2.0), None);
    }
}
