//! Whether the items of a scale agree with each other.

use super::{Cell, Column, Table};
use serde::{Deserialize, Serialize};

/// One scale or subscale.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reliability {
    /// `SCALE.SUBSCALE`, to find it by.
    pub id: String,
    /// Such as `Mini-IPIP conscientiousness`.
    pub scale: String,
    /// Items.
    pub items: usize,
    /// Complete answer sheets.
    pub n: usize,
    /// Cronbach's alpha; `None` if it is undefined.
    pub alpha: Option<f64>,
    /// Its 95 % interval.
    pub interval: Option<(f64, f64)>,
    /// McDonald's omega.
    pub omega: Option<f64>,
}

/// Builds the table `reliabilities`.
pub fn reliabilities(rows: &[Reliability]) -> Table {
    Table {
        name: "reliabilities".to_owned(),
        title: "Reliability of the questionnaires".to_owned(),
        columns: vec![
            Column::left("Scale"),
            Column::right("Items"),
            Column::right("*n*"),
            Column::right("Cronbach’s *α*"),
            Column::right("95% CI"),
            Column::right("McDonald’s *ω*"),
        ],
        rows: rows
            .iter()
            .map(|row| {
                let interval = row.interval.map_or(Cell::Missing, |(low, high)| {
                    use crate::apa::bounded;
                    Cell::text(format!("[{}, {}]", bounded(low, 2), bounded(high, 2)))
                });
                vec![
                    Cell::text(&row.scale),
                    Cell::count(row.items),
                    Cell::count(row.n),
                    Cell::bounded(row.alpha, 2),
                    interval,
                    Cell::bounded(row.omega, 2),
                ]
            })
            .collect(),
        notes: vec![
            "*n*: answer sheets on which every item of the scale is answered. The interval of *α* is Feldt’s; where people \
             answered several sheets each, that of a bootstrap which draws whole people."
                .to_owned(),
        ],
    }
}
