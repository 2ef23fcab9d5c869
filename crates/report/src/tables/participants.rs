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
    /// Drives that were recorded: by hand, or of a car of the study’s own.
    pub drives: usize,
    /// Drives of the car that are analysed.
    pub driven: usize,
    /// Mean age in years.
    pub mean_age: Option<f64>,
    /// Standard deviation of the age.
    pub sd_age: Option<f64>,
    /// Share who are female, 0 to 1, of all who gave a gender; none where no word for it is known.
    pub female: Option<f64>,
    /// Words that are neither female nor male, with how many gave them.
    pub other_genders: Vec<(String, usize)>,
    /// Mean score of what the dial turns, in points.
    pub mean_score: Option<f64>,
    /// Its standard deviation.
    pub sd_score: Option<f64>,
}

/// Builds the table `participants`; `score` is what the dial turns, where there is a dial.
pub fn participants(groups: &[ParticipantGroup], score: Option<&str>, synthetic: bool) -> Table {
    let mean_of = score.map(|score| format!("{}, *M*", crate::markup::literal(score)));
    let by_hand = groups.iter().any(|group| group.drives > 0);
    let by_car = groups.iter().any(|group| group.driven > 0);
    let mut table = Table::of("participants", "Participants", groups)
        .text("Group", |group| &group.group)
        .right("*n*", |group| Cell::count(group.n))
        .and_if(by_hand || !by_car, |table| {
            // Without drives of the learned car nobody says who drove: a recorded car's are among them.
            let head = if by_car { "Drives by hand" } else { "Drives" };
            table.right(head, |group| Cell::count(group.drives))
        })
        .and_if(by_car, |table| {
            table.right("Drives of the car", |group| Cell::count(group.driven))
        })
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
    let mut notes = Vec::new();
    if synthetic {
        notes.push("Synthetic participants: none of them exists.".to_owned());
    }
    let mut others: Vec<(&str, usize)> = Vec::new();
    for (word, n) in groups.iter().flat_map(|group| &group.other_genders) {
        match others.iter_mut().find(|(known, _)| known == word) {
            Some((_, all)) => *all += n,
            None => others.push((word, *n)),
        }
    }
    if !others.is_empty() {
        let words = others.iter();
        let words = words.map(|(word, n)| format!("“{}” ({n})", crate::markup::literal(word)));
        notes.push(format!(
            "Counted neither as female nor as male: {}.",
            words.collect::<Vec<_>>().join(", ")
        ));
    }
    if notes.is_empty() {
        return table.done();
    }
    table.noted(notes.join(" "))
}
