//! Which rows of a drive are learned from, and what each counts for.

use crate::{
    error::{ModelError, ModelWarning},
    windows::{SIGNALS, WindowBuffer, WindowSettings},
};
use maveric_domain::Drive;
use serde::{Deserialize, Serialize};

/// How rows are picked.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RowSettings {
    pub(crate) row_rate_hz: f64,
    pub(crate) windows: WindowSettings,
}

/// One row to learn from, in the units of the signals.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    /// See [`crate::Window::values`].
    pub(crate) window: Vec<f64>,
    pub(crate) lead_speed_mps: f64,
    pub(crate) ego_speed_mps: f64,
    /// On the even grid, so it stands for driving as it was; else it is there for its lane change only.
    pub(crate) on_grid: bool,
    /// The gap, on grid rows at which ego follows.
    pub(crate) following_distance_m: Option<f64>,
    /// Whether a change is being started; `None` while one is under way, when nobody asks.
    pub(crate) lane_change: Option<bool>,
    /// Time this row stands for in L2, in s.
    pub(crate) stands_for_s: f64,
}

/// The rows of one drive.
///
/// Rows on a grid of `row_rate_hz`, and every other row at which a lane change is being started. Windows do
/// not reach across a hole. Of the drive only the first `fit_fraction` of its rows is looked at.
///
/// # Errors
/// [`ModelError::DriveTooShort`] if what is looked at lasts less than one window.
pub(crate) fn rows_of(
    drive: &Drive,
    settings: &RowSettings,
    fit_fraction: f64,
) -> Result<Vec<Row>, ModelError> {
    let columns = drive.rows();
    let end = (fit_fraction * drive.len() as f64).floor() as usize;
    let duration = match end {
        0 => 0.0,
        _ => columns.time_s[end - 1] - columns.time_s[0] + 1.0 / drive.rate_hz(),
    };
    if duration < settings.windows.window_s {
        return Err(ModelError::DriveTooShort {
            drive: drive.meta().drive.clone(),
            found_s: duration,
            expected_s: settings.windows.window_s,
        });
    }
    let grid_s = 1.0 / settings.row_rate_hz.min(drive.rate_hz());
    let row_s = 1.0 / drive.rate_hz();
    let mut buffer = WindowBuffer::new(settings.windows);
    let mut due = f64::NEG_INFINITY;
    let mut rows = Vec::new();
    for row in 0..end {
        let time = columns.time_s[row];
        if row > 0 && columns.segment[row] != columns.segment[row - 1] {
            buffer.clear();
            due = f64::NEG_INFINITY;
        }
        let Some(situation) = drive.situation(row) else {
            break;
        };
        buffer.push(&situation)?;
        let on_grid = time + 0.5 * row_s >= due;
        if on_grid {
            due = if due.is_finite() { due + grid_s } else { time + grid_s };
        }
        let starting = columns.lane_change[row];
        if !(on_grid || starting) {
            continue;
        }
        let Some(window) = buffer.window() else {
            continue;
        };
        let following = on_grid && columns.following[row];
        rows.push(Row {
            window: window.values,
            lead_speed_mps: columns.lead_speed_mps[row],
            ego_speed_mps: columns.ego_speed_mps[row],
            on_grid,
            following_distance_m: following.then(|| columns.lead_dx_m[row]),
            lane_change: (starting || columns.changing[row] == 0).then_some(starting),
            stands_for_s: if starting { row_s } else { grid_s },
        });
    }
    Ok(rows)
}

/// The warning that a drive without rows becomes where other drives go on.
pub(crate) fn left_out(error: &ModelError) -> Option<ModelWarning> {
    match error {
        ModelError::DriveTooShort { drive, found_s, expected_s } => {
            Some(ModelWarning::DriveLeftOut {
                drive: drive.clone(),
                found_s: *found_s,
                expected_s: *expected_s,
            })
        }
        _ => None,
    }
}

/// What a row counts for in each loss, relative to a grid row in L3.
///
/// Over the training rows each of L1, L2 and L3 is then a mean over the rows it concerns, L2 with both
/// classes at one half.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RowWeights {
    pub(crate) following: f64,
    pub(crate) changing: f64,
    pub(crate) keeping: f64,
    /// ln of the factor by which the classes' weights raised the odds of a change above the true ones.
    pub(crate) log_odds_raised: f64,
}

impl RowWeights {
    /// Weights from all training rows; a loss without rows, or L2 without both classes, gets 0.
    pub(crate) fn from_rows<'a>(rows: impl Iterator<Item = &'a Row>) -> Self {
        let (mut grid, mut following) = (0.0, 0.0);
        let mut counts = [0.0; 2];
        let mut seconds = [0.0; 2];
        for row in rows {
            grid += f64::from(u8::from(row.on_grid));
            following += f64::from(u8::from(row.following_distance_m.is_some()));
            if let Some(change) = row.lane_change {
                counts[usize::from(change)] += 1.0;
                seconds[usize::from(change)] += row.stands_for_s;
            }
        }
        let share = |n: f64, whole: f64| if n > 0.0 { whole / n } else { 0.0 };
        let both = counts[0] > 0.0 && counts[1] > 0.0;
        let half = if both { 0.5 * grid } else { 0.0 };
        Self {
            following: share(following, grid),
            changing: share(counts[1], half),
            keeping: share(counts[0], half),
            log_odds_raised: if both { libm::log(seconds[0] / seconds[1]) } else { 0.0 },
        }
    }

    /// Weights of a row in L1, L2, L3 and L5.
    pub(crate) fn of_row(&self, row: &Row) -> [f64; 4] {
        let grid = f64::from(u8::from(row.on_grid));
        let following = row.following_distance_m.map_or(0.0, |_| self.following);
        let change = match row.lane_change {
            Some(true) => self.changing,
            Some(false) => self.keeping,
            None => 0.0,
        };
        [following, change, grid, grid]
    }
}

/// The value now of each signal in a row's window.
pub(crate) fn now(row: &Row, signal: usize) -> f64 {
    let steps = row.window.len() / SIGNALS;
    row.window[(signal + 1) * steps - 1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_drives::{RATE_HZ, drivers};

    fn settings() -> RowSettings {
        RowSettings { row_rate_hz: 1.0, windows: WindowSettings::default() }
    }

    #[test]
    fn rows_are_one_a_second_and_every_one_at_which_a_change_is_being_started() {
        let (drive, _) = drivers(1, 120.0).remove(0);
        let rows = rows_of(&drive, &settings(), 1.0).unwrap();
        let grid = rows.iter().filter(|r| r.on_grid).count();
        assert_eq!(grid, 120);
        let starting = drive.rows().lane_change.iter().filter(|&&l| l).count();
        let positive = rows.iter().filter(|r| r.lane_change == Some(true)).count();
        assert!(starting >= 10, "{starting}");
        assert_eq!(positive, starting);
        let half = rows_of(&drive, &settings(), 0.5).unwrap();
        assert_eq!(half.iter().filter(|r| r.on_grid).count(), 60);
        assert_eq!(half[..], rows[..half.len()]);
    }

    #[test]
    fn an_online_buffer_sees_the_windows_of_the_rows() {
        let (drive, _) = drivers(1, 60.0).remove(0);
        let rows = rows_of(&drive, &settings(), 1.0).unwrap();
        let mut buffer = WindowBuffer::new(WindowSettings::default());
        let mut windows = (0..drive.len()).map(|row| {
            buffer.push(&drive.situation(row).unwrap()).unwrap();
            buffer.window().unwrap().values
        });
        for row in &rows {
            assert!(windows.any(|window| window == row.window));
        }
    }

    #[test]
    fn no_window_reaches_across_a_hole() {
        let (drive, _) = drivers(1, 20.0).remove(0);
        let mut columns = drive.rows().clone();
        let hole = (10.0 * RATE_HZ) as usize;
        for row in hole..drive.len() {
            columns.segment[row] = 1;
            columns.time_s[row] += 30.0;
            columns.ego_speed_mps[row] = 99.0;
        }
        let meta = drive.meta().clone();
        let cut = Drive::from_rows(meta, *drive.road(), drive.rate_hz(), columns).unwrap();
        let rows = rows_of(&cut, &settings(), 1.0).unwrap();
        for row in &rows {
            let speeds = &row.window[..20];
            let after = speeds.iter().filter(|&&v| v > 98.0).count();
            assert!(after == 0 || after == 20, "{speeds:?}");
        }
    }

    #[test]
    fn weights_make_means_of_the_rows_each_loss_concerns() {
        let drives = drivers(3, 120.0);
        let rows: Vec<Row> =
            drives.iter().flat_map(|(d, _)| rows_of(d, &settings(), 1.0).unwrap()).collect();
        let weights = RowWeights::from_rows(rows.iter());
        let sum = |i: usize| rows.iter().map(|r| weights.of_row(r)[i]).sum::<f64>();
        for loss in 1..4 {
            assert!((sum(loss) - sum(0)).abs() < 1e-6 * sum(0));
        }
        // A change is rarer than a hundredth of the time or so, and its odds were raised by that much.
        assert!(weights.log_odds_raised > 1.0);
    }
}
