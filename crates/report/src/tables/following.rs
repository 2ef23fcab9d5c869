//! Closed-loop errors on recorded people.

use super::{Cell, Column, Table};
use serde::{Deserialize, Serialize};

/// One model, means over drivers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FollowingRow {
    /// Such as `IDM, own`.
    pub model: String,
    /// Root-mean-square error of the gap, in metres.
    pub gap_rmse_m: Option<f64>,
    /// Median over drivers of the same, in metres.
    pub gap_rmse_median_m: Option<f64>,
    /// Root-mean-square error of the speed, in m/s.
    pub speed_rmse_mps: Option<f64>,
    /// The gap's error over the root mean square of the gap.
    pub gap_nrmse: Option<f64>,
    /// The mixed error of Kesting and Treiber.
    pub mixed: Option<f64>,
    /// Whether it is the best of its kind.
    pub best: bool,
    /// Drivers whose simulated gap reached 0.
    pub reached_zero: Option<usize>,
}

/// Builds the table `following-errors`.
pub fn following_errors(rows: &[FollowingRow], data_set: &str, drivers: usize) -> Table {
    Table {
        name: "following-errors".to_owned(),
        title: "Following in closed loop on the unseen last third".to_owned(),
        columns: vec![
            Column::left("Model"),
            Column::right("Gap RMSE (m)"),
            Column::right("Median (m)"),
            Column::right("Speed RMSE (m/s)"),
            Column::right("Gap NRMSE"),
            Column::right("Mixed error"),
            Column::right("Gap reached 0"),
        ],
        rows: rows
            .iter()
            .map(|row| {
                let reached = row
                    .reached_zero
                    .map(|count| Cell::text(format!("{count}/{drivers}")));
                vec![
                    Cell::text(if row.best {
                        format!("{} *", row.model)
                    } else {
                        row.model.clone()
                    }),
                    Cell::number(row.gap_rmse_m, 2),
                    Cell::number(row.gap_rmse_median_m, 2),
                    Cell::number(row.speed_rmse_mps, 2),
                    Cell::number(row.gap_nrmse, 3),
                    Cell::number(row.mixed, 3),
                    reached.unwrap_or(Cell::Missing),
                ]
            })
            .collect(),
        notes: vec![format!(
            "{}, *n* = {drivers} drivers, each with the same weight. Recorded is only the vehicle \
             ahead; nothing of the last third was read before it but by the floor. The asterisk marks \
             the least error of the gap among those that know the driver's first two thirds, and among \
             those that are the same for everybody. No test.",
            crate::markup::literal(data_set)
        )],
    }
}
