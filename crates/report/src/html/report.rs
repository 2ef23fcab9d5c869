//! What a report is made of.

use super::live::Live;
use crate::card::Card;
use crate::claims::LedgerRow;
use crate::error::ReportError;
use crate::figures::{Context, Figure, check::Check};
use crate::tables::{Exclusion, Table};
use std::collections::BTreeSet;

/// Everything that goes into `index.html` and the files beside it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Report {
    /// Title of the page. Plain text.
    pub title: String,
    /// One sentence below it. Plain text.
    pub subtitle: String,
    /// Whose numbers these are.
    pub context: Context,
    /// The answers, before everything else.
    pub cards: Vec<Card>,
    /// What else is to be said first, a line each, with marks (see [`crate::markup`]).
    pub summary: Vec<String>,
    /// The results, in order.
    pub sections: Vec<Section>,
    /// What is behind them, folded, with ledger, methods, exclusions and provenance.
    pub supplement: Vec<Section>,
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
    /// Words that need one, with their meaning: explained where they stand, and listed. Plain text.
    pub glossary: Vec<(String, String)>,
    /// What the report was made from.
    pub provenance: Provenance,
    /// Files that stand beside the page as they are.
    pub beside: Vec<RenderedFile>,
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
    /// All that the file holds.
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

/// A file to be written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RenderedFile {
    /// Path relative to the report's folder, with `/` between its parts.
    pub path: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

impl Report {
    /// A page with a head and nothing on it yet.
    pub fn new(title: impl Into<String>, subtitle: impl Into<String>, context: &Context) -> Self {
        Self {
            title: title.into(),
            subtitle: subtitle.into(),
            context: context.clone(),
            provenance: Provenance {
                version: env!("CARGO_PKG_VERSION").to_owned(),
                ..Provenance::default()
            },
            ..Self::default()
        }
    }

    /// The results, then what is behind them.
    pub fn all_sections(&self) -> impl Iterator<Item = &Section> {
        self.sections.iter().chain(&self.supplement)
    }

    /// Checks names, tables, and what can be moved.
    ///
    /// # Errors
    /// [`ReportError::BadName`] or [`ReportError::DuplicateName`] for figures and tables, what
    /// [`Table::check`] finds, and [`ReportError::Live`] for a number that is none or a live part without its figure.
    pub fn check(&self) -> Result<(), ReportError> {
        let mut seen = BTreeSet::new();
        for card in &self.cards {
            take(&mut seen, "cards", &card.name)?;
        }
        for section in self.all_sections() {
            for figure in &section.figures {
                take(&mut seen, "figures", &figure.name)?;
            }
            for table in &section.tables {
                take(&mut seen, "tables", &table.name)?;
            }
            section.tables.iter().try_for_each(Table::check)?;
        }
        for live in &self.live {
            live.check()?;
            if !seen.contains(&("figures", live.below.as_str())) {
                return Err(ReportError::Live {
                    below: live.below.clone(),
                    reason: "the page has no figure of that name".to_owned(),
                });
            }
        }
        Ok(())
    }
}

/// Takes a name that can be one, and that nothing else of its kind has.
fn take<'a>(
    seen: &mut BTreeSet<(&'static str, &'a str)>,
    kind: &'static str,
    name: &'a str,
) -> Result<(), ReportError> {
    Check(name).name()?;
    // The page adds these two tables itself.
    let taken = kind == "tables" && matches!(name, "exclusions" | "claims");
    if taken || !seen.insert((kind, name)) {
        let name = name.to_owned();
        return Err(ReportError::DuplicateName { name });
    }
    Ok(())
}
