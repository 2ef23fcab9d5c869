//! Who took part.

use super::{Cell, Table};
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
    let mean_of = score.map(|score| format!("{}, *M*", crate::markup::literal(score)));
    let mut table = Table::of("participants", "Participants", groups)
        .text("Group", |group| &group.group)
        .right("*n*", |group| Cell::count(group.n))
        .right("Drives", |group| Cell::count(group.drives))
        .right("Age, *M* (years)", |group| Cell::number(group.mean_age, 1))
        .right("*SD*", |group| Cell::number(group.sd_age, 1))
        .right("Female (%)", |group| {
            Cell::number(group.female.map(|share| 100.0 * share), 1)
        });
    if let Some(header) = mean_of {
        table = table
            .right(header, |group| Cell::number(group.mean_score, 1))
            .right("*SD*", |group| Cell::number(group.sd_score, 1));
    }
    if synthetic {
        return table.noted("Synthetic participants: none of them exists.");
    }
    table.done()
}
