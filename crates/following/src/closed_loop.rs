//! Ego's gap and speed under a law, behind the recorded leader.

use crate::{error::FollowingError, run::Stretch};

pub const MIN_ACCEL_MPS2: f64 = -8.0;
pub const MAX_ACCEL_MPS2: f64 = 4.0;

/// Gap and speed of one closed-loop run; the first row holds the recorded values.
#[derive(Debug, Clone, PartialEq)]
pub struct ClosedLoop {
    /// Simulated gap, in m; shape `(m,)`, m the rows of the stretch; below 0 after a collision.
    pub gap_m: Vec<f64>,
    /// Simulated speed, in m/s; shape `(m,)`.
    pub speed_mps: Vec<f64>,
    /// Whether the gap reached 0.
    pub reached_zero: bool,
}

/// Where ego is between two steps.
#[derive(Debug, Clone, Copy)]
struct EgoState {
    gap_m: f64,
    speed_mps: f64,
}

/// Drives ego by `law` from the true gap and speed of the first row to the last, one run.
///
/// `law`, asked once for each row but the last, in order, takes gap (m), ego speed (m/s) and lead speed (m/s) and gives an acceleration (m/s²), which is kept within
/// [`MIN_ACCEL_MPS2`] and [`MAX_ACCEL_MPS2`] and held for one step, v' = max(0, v + a·dt). Ego moves by the mean
/// of v and v' times dt, or by v²/(2|a|) when it stops within the step. Only the leader is recorded.
///
/// A gap that reaches 0 is a collision. It is reported and the run goes on, through the leader if the law does so:
/// the gap is negative then, and the errors cover every row. To hold it at 0 would forgive the collision.
///
/// # Errors
/// [`FollowingError::LawNotFinite`] if `law` gives NaN or infinity; `name` is the law's name in that error.
///
/// # Example
/// ```
/// # use maveric_following::{FollowingColumns, FollowingRun, simulate};
/// # let columns = FollowingColumns {
/// #     time_s: vec![0.0, 0.1, 0.2, 0.3, 0.4, 0.5], leader_x_m: vec![20.0, 21.0, 22.0, 23.0, 24.0, 25.0],
/// #     lead_speed_mps: vec![10.0; 6], ego_speed_mps: vec![10.0; 6], gap_m: vec![20.0; 6],
/// # };
/// let run = FollowingRun::new("P01", 10.0, columns)?;
/// let coasting = simulate(&run.test(), "coasting", |_gap, _ego, _lead| 0.0)?;
/// assert!((coasting.gap_m[1] - 20.0).abs() < 1e-9);
/// # Ok::<(), maveric_following::FollowingError>(())
/// ```
pub fn simulate(
    stretch: &Stretch<'_>,
    name: &str,
    mut law: impl FnMut(f64, f64, f64) -> f64,
) -> Result<ClosedLoop, FollowingError> {
    let mut gap_m = Vec::with_capacity(stretch.rows.len());
    let mut speed_mps = Vec::with_capacity(stretch.rows.len());
    let (columns, first) = (stretch.run.columns(), stretch.rows.start);
    let mut state =
        EgoState { gap_m: columns.gap_m[first], speed_mps: columns.ego_speed_mps[first].max(0.0) };
    gap_m.push(state.gap_m);
    speed_mps.push(state.speed_mps);
    let mut reached_zero = false;
    for row in stretch.rows.clone().skip(1) {
        state = advance(stretch, row, state, &mut law).map_err(|accel_mps2| {
            FollowingError::LawNotFinite {
                driver: stretch.run.driver().to_owned(),
                law: name.to_owned(),
                row: row - 1,
                found: accel_mps2,
            }
        })?;
        reached_zero |= state.gap_m <= 0.0;
        gap_m.push(state.gap_m);
        speed_mps.push(state.speed_mps);
    }
    Ok(ClosedLoop { gap_m, speed_mps, reached_zero })
}

/// One step that ends at `row`; the error is a command that is no number.
#[inline]
fn advance(
    stretch: &Stretch<'_>,
    row: usize,
    state: EgoState,
    law: &mut impl FnMut(f64, f64, f64) -> f64,
) -> Result<EgoState, f64> {
    let columns = stretch.run.columns();
    let command = law(state.gap_m, state.speed_mps, columns.lead_speed_mps[row - 1]);
    if !command.is_finite() {
        return Err(command);
    }
    let leader_moved_m = columns.leader_x_m[row] - columns.leader_x_m[row - 1];
    let (moved_m, speed_mps) = move_ego(state.speed_mps, command, 1.0 / stretch.run.rate_hz());
    let gap_m = state.gap_m + leader_moved_m - moved_m;
    Ok(EgoState { gap_m, speed_mps })
}

/// Distance moved in `step_s` and the speed after it.
fn move_ego(speed_mps: f64, command_mps2: f64, step_s: f64) -> (f64, f64) {
    let accel = command_mps2.clamp(MIN_ACCEL_MPS2, MAX_ACCEL_MPS2);
    let next = speed_mps + accel * step_s;
    if next < 0.0 {
        return (speed_mps * speed_mps / (2.0 * accel.abs()), 0.0);
    }
    (0.5 * (speed_mps + next) * step_s, next)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;

    #[test]
    fn constant_speeds_keep_the_gap() {
        let run = testing::behind("P01", 300, 20.0, 10.0, |_| 10.0);
        let driven = simulate(&run.test(), "none", |_, _, _| 0.0).unwrap();
        assert_eq!(driven.gap_m.len(), 100);
        assert!(driven.gap_m.iter().all(|gap| (gap - 20.0).abs() < 1e-9));
        assert!(!driven.reached_zero);
    }

    #[test]
    fn a_step_moves_by_the_mean_of_both_speeds() {
        let (moved, speed) = move_ego(10.0, 2.0, 0.1);
        assert!((moved - 1.01).abs() < 1e-12 && (speed - 10.2).abs() < 1e-12);
    }

    #[test]
    fn acceleration_stays_within_its_limits() {
        assert!((move_ego(10.0, 99.0, 0.1).1 - 10.4).abs() < 1e-12);
        assert!((move_ego(10.0, -99.0, 0.1).1 - 9.2).abs() < 1e-12);
    }

    #[test]
    fn a_stop_within_a_step_moves_the_braking_distance_and_never_backwards() {
        let (moved, speed) = move_ego(0.4, -8.0, 0.1);
        assert!((moved - 0.01).abs() < 1e-12 && speed.abs() < 1e-12);
        assert!(move_ego(0.0, -8.0, 0.1).0.abs() < 1e-12);
    }

    #[test]
    fn a_gap_that_reaches_zero_is_reported_and_the_run_goes_on() {
        let run = testing::behind("P01", 300, 5.0, 10.0, |_| 0.0);
        let driven = simulate(&run.test(), "blind", |_, _, _| 0.0).unwrap();
        assert!(driven.reached_zero);
        assert_eq!(driven.gap_m.len(), 100);
        assert!((driven.gap_m[99] - (5.0 - 99.0)).abs() < 1e-9);
    }

    #[test]
    fn a_law_without_a_number_is_an_error() {
        let run = testing::behind("P01", 30, 5.0, 10.0, |_| 10.0);
        let error = simulate(&run.test(), "broken", |_, _, _| f64::NAN).unwrap_err();
        assert!(matches!(error, FollowingError::LawNotFinite { row: 20, .. }));
    }
}
