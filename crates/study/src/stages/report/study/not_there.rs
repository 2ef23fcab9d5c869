//! What is missing of the study: counts, the first of the people, and where all of them are listed.

use super::Run;
use crate::{
    error::StudyError,
    missing::{KINDS, Missing, MissingRow},
    tables::drives::remove_former,
};
use maveric_domain::{Moment, Occasion};
use maveric_report::{
    figures::completeness::{Completeness, CompletenessPanel, completeness},
    html::Section,
    tables::Table,
};
use std::path::Path;

/// The table of everything that is missing, beside the page.
const FILE: &str = "missing.csv";

/// Rows that the page has.
const MOST_ROWS: usize = 200;

/// What the page calls each kind, in their order.
const TITLES: [&str; 4] = ["Logs", "Drives", "Answers", "Own measures"];

/// The section; none where nothing is missing.
pub(super) fn section_missing(run: &Run, missing: &Missing) -> Result<Option<Section>, StudyError> {
    let Some(summary) = missing.summary() else {
        return Ok(None);
    };
    let rows = missing.counts.iter();
    let awaited = |kind: &usize| missing.counts.iter().any(|time| time.kinds[*kind].1 > 0);
    let panel = |kind: usize| CompletenessPanel {
        title: TITLES[kind].to_owned(),
        counts: missing.counts.iter().map(|time| time.kinds[kind]).collect(),
    };
    let figure = completeness(
        &Completeness {
            rows: rows.map(|time| when(run, time.moment)).collect(),
            panels: (0..KINDS.len()).filter(awaited).map(panel).collect(),
        },
        &run.context,
    )?;
    let shown = &missing.rows[..missing.rows.len().min(MOST_ROWS)];
    let total = missing.rows.len();
    let which = if total > MOST_ROWS {
        format!("The first {MOST_ROWS} of {total} rows")
    } else {
        format!("All {total} rows")
    };
    let reason =
        |kind: usize| move |row: &&MissingRow| row.reasons()[kind].unwrap_or_default().to_owned();
    let table = Table::of("missing", "What is missing", shown)
        .text("Person", |row| row.participant.to_string())
        .text("When", |row| when(run, row.moment))
        .text("Log", reason(0))
        .text("Drive", reason(1))
        .text("Answers", reason(2))
        .text("Own measures", reason(3))
        .noted(format!("{which}; {FILE} beside this page has all of them. An empty cell: it is there, or not awaited."));
    Ok(Some(Section {
        title: "What is not there".to_owned(),
        intro: vec![format!(
            "The page is made of what there is. Still {summary}. An outcome is tested in those people who have a value of it in every \
             condition."
        )],
        figures: vec![figure],
        tables: vec![table],
    }))
}

/// Writes all rows beside the page; where nothing is missing, nothing of an earlier call stays.
pub(super) fn list(page: &Path, missing: &Missing) -> Result<(), StudyError> {
    let table = page.join(FILE);
    if missing.rows.is_empty() {
        return remove_former(&table);
    }
    missing.write(&table)
}

/// What the page calls a time.
fn when(run: &Run, moment: Moment) -> String {
    match moment {
        Moment::Pre => "Before the drives".to_owned(),
        Moment::Post => "At the end".to_owned(),
        Moment::After(ride) | Moment::Probe(ride) => {
            let label = run.design.label(ride.condition);
            match ride.occasion {
                Occasion::FIRST => label,
                occasion => format!("{label}, {occasion}"),
            }
        }
    }
}
