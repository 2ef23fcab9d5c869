//! Measures of the study's own.

use super::*;

const TOR: &str = "[[measure]]\nid = \"tor_s\"\ntitle = \"Take-over time\"\nunit = \"s\"\n";

/// Six people who took over in 2 s and in 3 s and some tenths, each in a mean of two trials.
fn taken_over(conditions: &[(&str, f64)]) -> Tables {
    let mut tables = Tables::default();
    for i in 0..6 {
        for (condition, seconds) in conditions {
            tables.own.push(maveric_domain::OwnMeasurement {
                participant: person(i),
                condition: id(condition),
                measure: "tor_s".to_owned(),
                value: seconds * (1.0 + 0.1 * i as f64),
                n: 2,
            });
        }
    }
    tables
}

#[test]
fn measures_of_ones_own_are_enough_for_a_study_and_need_no_baseline() {
    let text = plain(&["calm", "sporty"], TOR);
    let a = analysed_by(&text, taken_over(&[("calm", 2.0), ("sporty", 3.0)]));
    assert_eq!(a.panels.len(), 1);
    let time = panel(&a, "tor_s");
    assert_eq!((&*time.title, &*time.unit), ("Take-over time", "s"));
    assert_eq!((time.n, time.differences_from), (6, None));
    // 1 s times 1, 1.1, … 1.5, the second condition above the first.
    near(time.contrasts[0].mean_difference, -1.25);
    assert!(time.comparison.is_some());
    assert!(a.notes.iter().any(|note| note.contains("no drives")), "{:?}", a.notes);
}

#[test]
fn where_somebody_has_a_value_in_the_baseline_differences_from_it_are_compared() {
    let text = plain(&["calm", "sporty"], TOR);
    let three = [("own", 1.0), ("calm", 2.0), ("sporty", 3.0)];
    let a = analysed_by(&text, taken_over(&three));
    let time = panel(&a, "tor_s");
    assert_eq!((time.n, time.differences_from), (6, Some(id("own"))));
    near(time.rows[5][1], 2.0 * 1.5);
    // A measured baseline is one, and nobody was asked anything.
    assert!(a.without_baseline.is_empty() && a.without_answer.is_empty());
    // Somebody without a value is left out, and named.
    let mut less = taken_over(&three);
    less.own.retain(|row| row.participant != person(2) || row.condition != id("own"));
    let less = analysed_by(&text, less);
    assert_eq!(less.without_baseline, ["P3"]);
    let time = panel(&less, "tor_s");
    assert_eq!((time.n, &time.dropped[..]), (5, &["P3".to_owned()][..]));
}

#[test]
fn whoever_was_only_measured_came_and_whom_the_design_leaves_out_has_no_value() {
    let rules = "[exclude]\nfewer_conditions_than = 2\npeople = { P1 = \"withdrew\" }\n";
    let text = plain(&["calm", "sporty"], &format!("{TOR}{rules}"));
    let mut tables = taken_over(&[("calm", 2.0), ("sporty", 3.0)]);
    tables.own.retain(|row| row.participant != person(1) || row.condition != id("calm"));
    let a = analysed_by(&text, tables);
    assert_eq!((a.flow.drove, a.flow.analysed), (6, 4));
    let rows = &panel(&a, "tor_s").participants;
    assert_eq!(rows.join(" "), "P3 P4 P5 P6");
}

#[test]
fn a_value_of_the_first_session_goes_with_its_excluded_drive_whatever_came_in_a_later_one() {
    let sessions = "[protocol]\nsessions = { count = 2, days_between = [2, 14] }\n";
    let rules = "[exclude]\ndrives = { P1-calm = \"the rig failed\" }\n";
    let text = plain(&["calm", "sporty"], &format!("{TOR}{sessions}{rules}"));
    let a = analysed_by(&text, taken_over(&[("calm", 2.0), ("sporty", 3.0)]));
    let time = panel(&a, "tor_s");
    assert_eq!((time.n, &time.dropped[..]), (5, &["P1".to_owned()][..]));
}

#[test]
fn a_measure_that_is_declared_and_that_nobody_has_is_told_and_not_tested() {
    let text =
        plain(&["calm", "sporty"], &format!("{TOR}[[measure]]\nid = \"glances\"\nunit = \"1\"\n"));
    let a = analysed_by(&text, taken_over(&[("calm", 2.0), ("sporty", 3.0)]));
    assert_eq!(a.panels.len(), 1);
    assert!(a.notes.iter().any(|note| note.ends_with("study’s own: glances.")), "{:?}", a.notes);
}
