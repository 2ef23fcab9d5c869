//! How near the car that drives as the person does comes to the person.

use super::{Cell, Table};
use serde::{Deserialize, Serialize};

/// One measure; accuracies are shares, 1 being exact.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AccuracyRow {
    /// Such as `Mean velocity`.
    pub measure: String,
    /// Drivers with a value in both drives.
    pub n: usize,
    /// Ours.
    pub ours: Option<f64>,
    /// What the paper printed.
    pub paper: Option<f64>,
    /// Guessing the training drivers' mean for everybody.
    pub population_mean: Option<f64>,
    /// Two drives of one driver against each other.
    pub test_retest: Option<f64>,
}

/// Builds the table `accuracy` of the condition called `label`; the column of the paper only where something was printed there.
pub fn accuracy(label: &str, rows: &[AccuracyRow]) -> Table {
    let percent = |share: Option<f64>| Cell::number(share.map(|share| 100.0 * share), 1);
    // Nobody drove twice: then there is no column for it.
    let twice = rows.iter().any(|row| row.test_retest.is_some());
    let printed = rows.iter().any(|row| row.paper.is_some());
    let title = format!(
        "How near {} comes to the own drive (%)",
        crate::markup::literal(label)
    );
    let more = if twice {
        " The same driver’s second drive is about the ceiling."
    } else {
        ""
    };
    Table::of("accuracy", title, rows)
        .text("Measure", |row| &row.measure)
        .right("*n*", |row| Cell::count(row.n))
        .right("Accuracy", |row| percent(row.ours))
        .and_if(printed, |table| table.right("Paper", |row| percent(row.paper)))
        .right("Mean of the training drivers as guess", |row| percent(row.population_mean))
        .and_if(twice, |table| {
            table.right("Same driver, two drives", |row| percent(row.test_retest))
        })
        .noted(format!(
            "Accuracy: 1 − |car − driver| / driver, mean over drivers. A driver without a value in one of the two drives \
             is left out of that row. The guess is the floor: what no personalising gives. No test.{more}"
        ))
}
