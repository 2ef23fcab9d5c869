//! What a report is made of.

use super::live::Live;
use crate::claims::LedgerRow;
use crate::error::ReportError;
use crate::figures::{Context, Figure};
use crate::tables::{Exclusion, Table};
use std::collections::BTreeSet;

/// Everything that goes into `index.html` and the files beside it.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Title of the page. Plain text.
    pub title: String,
    /// One sentence below it. Plain text.
    pub subtitle: String,
    /// Whose numbers these are.
    pub context: Context,
    /// The findings, one line each, with marks (see [`crate::markup`]).
    pub summary: Vec<String>,
    /// The body, in order.
    pub sections: Vec<Section>,
    /// What can be moved and played on the page, each below a figure of `sections`.
    pub live: Vec<Live>,
    /// The claims ledger, if the run has one.
    pub ledger: Option<Vec<LedgerRow>>,
    /// How it was done, with what it was set to.
    pub methods: Methods,
    /// Who and what was left out, and why.
    pub exclusions: Vec<Exclusion>,
    /// What else a reader has to know about the data. Plain text.
    pub warnings: Vec<String>,
    /// What the report was made from.
    pub provenance: Provenance,
}

/// A part of the body.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Section {
    /// Heading. Plain text.
    pub title: String,
    /// Paragraphs before the figures, with marks.
    pub intro: Vec<String>,
    /// Figures, shown in order.
    pub figures: Vec<Figure>,
    /// Tables, shown after them.
    pub tables: Vec<Table>,
}

/// How a study was done. The parameters themselves stand in [`Provenance::parameters`].
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Methods {
    /// Paragraphs, with marks.
    pub text: Vec<String>,
    /// Files of parameters, whole.
    pub files: Vec<ParameterFile>,
}

/// A file of parameters, shown whole on the page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ParameterFile {
    /// Its path, relative to the project.
    pub path: String,
    /// Its text.
    pub text: String,
}

/// What a report was made from. All plain text.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Provenance {
    /// Version of the program.
    pub version: String,
    /// Root seed, if anything was drawn at random.
    pub seed: Option<u64>,
    /// Command that repeats the run.
    pub command: String,
    /// Parameters actually used: name and value.
    pub parameters: Vec<(String, String)>,
    /// Files that were read.
    pub inputs: Vec<Input>,
}

/// A file that was read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Input {
    /// Its path, relative to the project.
    pub path: String,
    /// Hash of its content.
    pub hash: String,
}

impl Report {
    /// Checks names, tables, and what can be moved.
    ///
    /// # Errors
    /// [`ReportError::BadName`] or [`ReportError::DuplicateName`] for figures and tables, what
    /// [`Table::check`] finds, and [`ReportError::Live`] for a number that is none or a live part without its figure.
    pub fn check(&self) -> Result<(), ReportError> {
        let mut seen = BTreeSet::new();
        for section in &self.sections {
            let figures = section
                .figures
                .iter()
                .map(|figure| ("figures", &figure.name));
            let tables = section.tables.iter().map(|table| ("tables", &table.name));
            for (kind, name) in figures.chain(tables) {
                let usable =
                    |sign: char| sign.is_ascii_lowercase() || sign.is_ascii_digit() || sign == '-';
                if name.is_empty() || !name.chars().all(usable) {
                    return Err(ReportError::BadName { name: name.clone() });
                }
                // The page adds these two tables itself.
                let taken = kind == "tables" && matches!(name.as_str(), "exclusions" | "claims");
                if taken || !seen.insert((kind, name)) {
                    return Err(ReportError::DuplicateName { name: name.clone() });
                }
            }
            for table in &section.tables {
                table.check()?;
            }
        }
        for live in &self.live {
            live.check()?;
            if !seen.contains(&("figures", &live.below)) {
                return Err(ReportError::Live {
                    below: live.below.clone(),
                    reason: "the page has no figure of that name".to_owned(),
                });
            }
        }
        Ok(())
    }
}
