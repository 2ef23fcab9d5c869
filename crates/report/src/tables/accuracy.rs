//! How near the car that drives as the person does comes to the person.

use super::{Cell, Column, Table};
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
    let mut columns = vec![
        Column::left("Measure"),
        Column::right("*n*"),
        Column::right("Accuracy"),
    ];
    let printed = rows.iter().any(|row| row.paper.is_some());
    if printed {
        columns.push(Column::right("Paper"));
    }
    columns.push(Column::right("Mean of the training drivers as guess"));
    let mut note = "Accuracy: 1 − |car − driver| / driver, mean over drivers. A driver without a value in one of the two drives \
                    is left out of that row. The guess is the floor: what no personalising gives. No test."
        .to_owned();
    if twice {
        columns.push(Column::right("Same driver, two drives"));
        note += " The same driver’s second drive is about the ceiling.";
    }
    let row = |row: &AccuracyRow| {
        let mut cells = vec![
            Cell::text(&row.measure),
            Cell::count(row.n),
            percent(row.ours),
        ];
        if printed {
            cells.push(percent(row.paper));
        }
        cells.push(percent(row.population_mean));
        if twice {
            cells.push(percent(row.test_retest));
        }
        cells
    };
    Table {
        name: "accuracy".to_owned(),
        title: format!(
            "How near {} comes to the own drive (%)",
            crate::markup::literal(label)
        ),
        columns,
        rows: rows.iter().map(row).collect(),
        notes: vec![note],
    }
}
