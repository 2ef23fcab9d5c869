//! What was imported: the answers that are let in, and why the others are not.

use super::{
    columns::Columns,
    export::Export,
    long_table::{LeftOutAnswers, let_in, refuse_twice, told_unknown, unknown_moments, write},
    sheets::{Contents, Row},
};
use crate::{
    error::StudyError,
    gate::{Gate, counted},
    once::count,
    outcome::Outcome,
    run_folder::exclusions_path,
    stages::score::of_answers,
    tables::{TableName, keys::one_case_of, write_rows},
};
use maveric_domain::{Design, Moment, ParticipantId, design::Software};
use maveric_report::tables::Exclusion;
use path_slash::PathExt as _;
use serde::Serialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

#[derive(Debug, Clone, Serialize)]
pub struct Imported {
    pub software: Software,
    pub participants: usize,
    pub answers: usize,
    /// Sheets (one scale answered once) by scale.
    pub sheets: BTreeMap<String, usize>,
    /// Sheets by the moment at which they were answered.
    pub moments: BTreeMap<Moment, usize>,
    /// Columns or fields that belong to no scale.
    pub unused: usize,
}

/// What an import is made by.
pub(super) struct Imports<'a> {
    pub(super) file: &'a Path,
    pub(super) export: &'a Export,
    pub(super) columns: &'a Columns<'a>,
    pub(super) design: &'a Design,
    pub(super) gate: Option<&'a Gate>,
}

impl Imports<'_> {
    /// Writes the answers of those who are let in, and beside them who is not.
    ///
    /// # Errors
    /// [`StudyError`] for answers that are there twice, none at all, or a table that cannot be written.
    pub(super) fn write(
        &self,
        out: &Path,
        contents: Contents,
    ) -> Result<Outcome<Imported>, StudyError> {
        let scales = self.columns.scales;
        let Contents { mut rows, unused, mut warnings } = contents;
        let unknown = unknown_moments(&mut rows, self.design);
        warnings.extend(told_unknown(&unknown, self.design));
        refuse_twice(self.file, &rows, scales)?;
        let nobody = rows.is_empty() && unknown.is_empty();
        let strangers = self.unknown_people(rows.iter().chain(&unknown));
        let kept_out = let_in(&mut rows, &unknown, self.design, self.gate);
        let why = counted(["answer", "answers"], kept_out.values().flatten());
        if rows.is_empty() {
            return Err(self.nothing(nobody, &[why, strangers].concat()));
        }
        warnings.extend(strangers);
        one_case_of(rows.iter().map(|row| &row.participant))?;
        rows.sort_by(|a, b| {
            let key = |r: &Row| (r.moment, r.scale, r.item);
            a.participant.cmp(&b.participant).then(key(a).cmp(&key(b)))
        });
        write(out, &rows, scales)?;
        write_kept_out(out, &kept_out)?;
        let value = self.counts(&rows, unused.len());
        let unanswered = scales.iter().enumerate();
        let unanswered = unanswered.filter(|(_, s)| !value.sheets.contains_key(&s.id));
        warnings.extend(unanswered.map(|(at, _)| self.unanswered(at, value.unused)));
        let mut summary = vec![
            format!(
                "{} answers of {} participants, as {} writes them: {}",
                value.answers,
                value.participants,
                self.export.title(),
                out.to_slash_lossy()
            ),
            format!(
                "sheets: {}; when: {}; {} columns that belong to no scale were not read",
                list(&value.sheets),
                list(&value.moments),
                value.unused
            ),
        ];
        summary.extend(why);
        Ok(Outcome::new(value, summary, warnings))
    }

    /// The ids that the table of people lacks, with their rows.
    fn unknown_people<'r>(&self, rows: impl Iterator<Item = &'r Row>) -> Vec<String> {
        let row = |place: &str| place.split(", `").next().unwrap_or_default().to_owned();
        let found = rows.map(|r| (&r.participant, row(&r.place)));
        self.gate.map_or_else(Vec::new, |gate| gate.unknown_people(found))
    }

    /// Why nobody answered a scale: its columns are there, or none is called as it should be.
    fn unanswered(&self, scale: usize, unused: usize) -> String {
        let columns = self.columns;
        let id = &columns.scales[scale].id;
        let named = columns.pattern_of(&columns.scales[scale]);
        if self.export.has_columns_of(columns, scale) {
            format!("scale `{id}`: nobody answered it ({named})")
        } else if columns.is_named_by_map(scale) {
            let unread = count(unused, "column belongs", "columns belong");
            format!(
                "scale `{id}`: the map of columns calls its columns `{named}`, and none is called so; {unread} to no scale"
            )
        } else {
            format!("scale `{id}`: no column is called `{named}`")
        }
    }

    /// Why there is not one answer: `nobody` gave one, or nobody is let in.
    fn nothing(&self, nobody: bool, why: &[String]) -> StudyError {
        let (problem, help) = if nobody {
            self.export.no_answers(self.columns)
        } else {
            ("holds no answers of anybody who is let in".to_owned(), why.join("; "))
        };
        StudyError::file(self.file, problem).with_help(help)
    }

    fn counts(&self, rows: &[Row], unused: usize) -> Imported {
        let participants: BTreeSet<&ParticipantId> = rows.iter().map(|r| &r.participant).collect();
        let mut sheets: BTreeMap<String, usize> = BTreeMap::new();
        let mut moments: BTreeMap<Moment, usize> = BTreeMap::new();
        for row in rows.iter().filter(|r| r.item == 1) {
            let scale = self.columns.scales[row.scale].id.clone();
            *sheets.entry(scale).or_default() += 1;
            *moments.entry(row.moment).or_default() += 1;
        }
        Imported {
            software: self.export.software(),
            participants: participants.len(),
            answers: rows.iter().filter(|row| row.is_answered()).count(),
            sheets,
            moments,
            unused,
        }
    }
}

/// Writes whose answers were left out, and why, beside the table.
fn write_kept_out(out: &Path, kept_out: &LeftOutAnswers) -> Result<(), StudyError> {
    let listed = kept_out.iter().map(|((who, moment), why)| Exclusion {
        who: who.to_string(),
        what: of_answers(*moment),
        why: why[0].to_string(),
    });
    write_rows(TableName::LeftOut, &exclusions_path(out), listed)
}

fn list<K: std::fmt::Display>(counts: &BTreeMap<K, usize>) -> String {
    let each: Vec<String> = counts.iter().map(|(key, n)| format!("{key} {n}")).collect();
    each.join(", ")
}
