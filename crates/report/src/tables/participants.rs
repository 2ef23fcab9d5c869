//! Who took part.

use super::{Cell, Column, Table};
use serde::{Deserialize, Serialize};

/// A group of participants.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParticipantGroup {
    /// Such as `Tested, internal`.
    pub group: String,
    /// How many.
    pub n: usize,
    /// Drives by hand.
    pub drives: usize,
    /// Mean age in years.
    pub mean_age: Option<f64>,
    /// Standard deviation of the age.
    pub sd_age: Option<f64>,
    /// Share who are female, 0 to 1.
    pub female: Option<f64>,
    /// Mean score of what the dial turns, in points.
    pub mean_score: Option<f64>,
    /// Its standard deviation.
    pub sd_score: Option<f64>,
}

/// Builds the table `participants`; `score` is what the dial turns, where there is a dial.
pub fn participants(groups: &[ParticipantGroup], score: Option<&str>, synthetic: bool) -> Table {
    let score = score.map(|score| {
        [
            Column::right(format!("{}, *M*", crate::markup::literal(score))),
            Column::right("*SD*"),
        ]
    });
    let width = if score.is_some() { 8 } else { 6 };
    Table {
        name: "participants".to_owned(),
        title: "Participants".to_owned(),
        columns: vec![
            Column::left("Group"),
            Column::right("*n*"),
            Column::right("Drives"),
            Column::right("Age, *M* (years)"),
            Column::right("*SD*"),
            Column::right("Female (%)"),
        ]
        .into_iter()
        .chain(score.into_iter().flatten())
        .collect(),
        rows: groups
            .iter()
            .map(|group| {
                let mut cells = vec![
                    Cell::text(&group.group),
                    Cell::count(group.n),
                    Cell::count(group.drives),
                    Cell::number(group.mean_age, 1),
                    Cell::number(group.sd_age, 1),
                    Cell::number(group.female.map(|share| 100.0 * share), 1),
                    Cell::number(group.mean_score, 1),
                    Cell::number(group.sd_score, 1),
                ];
                cells.truncate(width);
                cells
            })
            .collect(),
        notes: if synthetic {
            vec!["Synthetic participants: none of them exists.".to_owned()]
        } else {
            Vec::new()
        },
    }
}
