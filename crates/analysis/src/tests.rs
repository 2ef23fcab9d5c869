//! A study of six people, computed by hand.

mod conditions;
mod groups;
mod hypotheses;
mod own_measures;
mod own_style;
mod who_is_in;

use crate::{
    AnalysisError, ContrastTest, Described, Judged, Panel, Person, PlannedTest, Purpose, Question,
    StudyData, Tables, Verdict, analyse, pairs, planned,
    testing::{
        DESIGN, FASTER, OWN, SPEED, analysed, analysed_by, design, drive as drive_of, id, near,
        panel, person, plain, steered, tables,
    },
};
use maveric_domain::{
    Moment, Scale,
    design::{ScoreName, Sign},
};
use maveric_stats::{
    ByDesign, EffectMethod, FactorialDesign, OmnibusTest, factorial, mean_interval,
};

/// A row of the table of people.
fn listed(i: usize, learned: bool, columns: &[(&str, &str)]) -> Person {
    let owned = |(name, cell): &(&str, &str)| ((*name).to_owned(), (*cell).to_owned());
    Person {
        id: person(i),
        learned,
        tested: !learned,
        order: Vec::new(),
        columns: columns.iter().map(owned).collect(),
    }
}

/// The people with a city, and an age where it is known.
fn with_people(ages: [&str; 6]) -> Tables {
    let mut with = tables();
    let row = |i: usize| listed(i, false, &[("city", ["A", "B"][i % 2]), ("age", ages[i])]);
    with.people = (0..6).map(row).collect();
    with
}

const AGES: [&str; 6] = ["30", "25", "61", "44", "38", "52"];
