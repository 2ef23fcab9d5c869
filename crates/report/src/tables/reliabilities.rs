//! Whether the items of a scale agree with each other.

use super::{Cell, Table};
use crate::apa::bounded;
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
    Table::of("reliabilities", "Reliability of the questionnaires", rows)
        .text("Scale", |row| &row.scale)
        .right("Items", |row| Cell::count(row.items))
        .right("*n*", |row| Cell::count(row.n))
        .right("Cronbach’s *α*", |row| Cell::bounded(row.alpha, 2))
        .right("95% CI", |row| {
            let ends = row.interval.map(|(low, high)| [low, high].map(|v| bounded(v, 2)));
            ends.map_or(Cell::Missing, |[low, high]| Cell::text(format!("[{low}, {high}]")))
        })
        .right("McDonald’s *ω*", |row| Cell::bounded(row.omega, 2))
        .noted(
            "*n*: answer sheets on which every item of the scale is answered. The interval of *α* is Feldt’s; where people \
             answered several sheets each, that of a bootstrap which draws whole people.",
        )
}
