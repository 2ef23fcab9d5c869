//! The texts, sections and tables of a page: a file of `texts/` with the values that its templates ask for.

use crate::{
    glossary::glossary,
    table_text::TableText,
    texts::{environment, failed, value},
};
use maveric_domain::{ConditionId, Design};
use maveric_report::{
    Context, Figure, Report, ReportError,
    html::{Methods, Provenance, Section},
    markup,
    tables::Table,
};
use minijinja::{Value, context};
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, sync::Arc};

/// A file of `texts/` that is compiled in.
#[derive(Debug, Clone, Copy)]
pub struct TextFile {
    name: &'static str,
    source: &'static str,
}

macro_rules! files {
    ($($constant:ident $name:literal $what:literal,)*) => {
        $(#[doc = $what] pub const $constant: TextFile = TextFile {
            name: $name,
            source: include_str!(concat!("../texts/", $name)),
        };)*
        #[cfg(test)]
        const ALL: &[TextFile] = &[$($constant),*];
    };
}

files! {
    ABLATION "ablation_page.toml" "What each part of the model is worth.",
    DECLARED "declared.toml" "What was declared, and how many people a study needs.",
    FOLLOWING "following_page.toml" "Car-following of recorded drivers.",
    METHODS "methods.toml" "How a study was done.",
    REHEARSAL "rehearsal_page.toml" "How often tests err, and how many people they need.",
    RESULTS "results.toml" "The results of a study as sentences.",
    STUDY "study_page.toml" "A study.",
    VALIDATION "validation_page.toml" "People who drove twice.",
}

/// What such a file holds; every text is a template.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Parts {
    text: BTreeMap<String, String>,
    section: BTreeMap<String, SectionText>,
    table: BTreeMap<String, TableText>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct SectionText {
    title: String,
    /// Paragraphs; one that comes out empty is left out.
    #[serde(default)]
    intro: Vec<String>,
}

/// The texts of a page with the values that all of them may ask for.
#[derive(Debug, Clone)]
pub struct PageTexts {
    file: &'static str,
    parts: Arc<Parts>,
    values: Value,
}

impl PageTexts {
    /// # Errors
    /// [`ReportError::Template`] naming the file and its fault.
    pub fn new(file: TextFile, values: &impl Serialize) -> Result<Self, ReportError> {
        let TextFile { name, source } = file;
        let parts = toml::from_str(source).map_err(|e| failed(format!("{name}: {e}")))?;
        Ok(Self { file: name, parts: Arc::new(parts), values: value(values) })
    }

    /// The same with further values, which come first.
    #[must_use]
    pub fn with(&self, more: &impl Serialize) -> Self {
        Self { values: context! { ..value(more), ..self.values.clone() }, ..self.clone() }
    }

    /// The same where `label(id)` is what a design calls a condition.
    #[must_use]
    pub fn labelled(self, design: &Design) -> Self {
        let design = design.clone();
        let label = move |id: &str| {
            let known = id.parse::<ConditionId>().map(|id| design.label(id));
            markup::literal(&known.unwrap_or_else(|_| id.to_owned()))
        };
        Self { values: context! { label => Value::from_function(label), ..self.values }, ..self }
    }

    /// Whether a value is there and is not none.
    pub(crate) fn is_given(&self, value: &str) -> bool {
        let given = self.values.get_attr(value);
        given.is_ok_and(|given| !given.is_undefined() && !given.is_none())
    }

    /// A text by its key.
    ///
    /// # Errors
    /// [`ReportError::Template`] naming file and key, for a text that is not there or asks for a value which is not given.
    pub fn text(&self, key: &str) -> Result<String, ReportError> {
        let text = self.parts.text.get(key);
        let text = text.ok_or_else(|| failed(format!("{} has no text `{key}`", self.file)))?;
        self.filled(&format!("text.{key}"), text)
    }

    /// A section of figures and tables with its title and what it says before them.
    pub fn section(
        &self,
        key: &str,
        figures: Vec<Figure>,
        tables: Vec<Table>,
    ) -> Result<Section, ReportError> {
        let text = self.parts.section.get(key);
        let text = text.ok_or_else(|| failed(format!("{} has no section `{key}`", self.file)))?;
        let fill = |text: &String| self.filled(&format!("section.{key}"), text);
        let mut intro = text.intro.iter().map(fill).collect::<Result<Vec<_>, _>>()?;
        intro.retain(|paragraph| !paragraph.is_empty());
        Ok(Section { title: fill(&text.title)?, intro, figures, tables })
    }

    /// A table of rows: its title, columns and notes ask for the values of a row first, then for those of the page.
    ///
    /// # Errors
    /// As [`PageTexts::text`]; also for a cell that is not what its column shows.
    pub fn table<R: Serialize>(
        &self,
        key: &str,
        rows: impl IntoIterator<Item = R>,
    ) -> Result<Table, ReportError> {
        let text = self.parts.table.get(key);
        let text = text.ok_or_else(|| failed(format!("{} has no table `{key}`", self.file)))?;
        let rows = rows.into_iter().map(|row| value(&row)).collect();
        text.table(&format!("{}, table.{key}", self.file), key, rows, &self.values)
    }

    /// The same; `None` without rows.
    pub(crate) fn table_if_any<R: Serialize>(
        &self,
        key: &str,
        rows: impl IntoIterator<Item = R>,
    ) -> Result<Option<Table>, ReportError> {
        let rows: Vec<R> = rows.into_iter().collect();
        let table = || self.table(key, &rows);
        (!rows.is_empty()).then(table).transpose()
    }

    /// A page with its head (`title`, `subtitle` and `method`), the words that it explains and the command that repeats it.
    pub fn page(
        &self,
        context: &Context,
        (seed, command): (u64, Option<&str>),
    ) -> Result<Report, ReportError> {
        let new = Report::new(self.text("title")?, self.text("subtitle")?, context);
        Ok(Report {
            glossary: glossary(),
            methods: Methods { text: vec![self.text("method")?], files: Vec::new() },
            provenance: Provenance {
                seed: Some(seed),
                command: command.unwrap_or_default().to_owned(),
                ..new.provenance
            },
            ..new
        })
    }

    fn filled(&self, key: &str, text: &str) -> Result<String, ReportError> {
        let filled = environment().render_str(text, &self.values);
        filled.map_err(|e| failed(format!("{}, {key}: {e:#}", self.file)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_text_section_and_table_of_every_page_is_a_template() {
        for file in ALL {
            let texts = PageTexts::new(*file, &()).unwrap();
            let sections = texts.parts.section.values();
            let sections = sections.flat_map(|s| s.intro.iter().chain([&s.title]));
            for text in texts.parts.text.values().chain(sections) {
                let read = environment().template_from_str(text).map(|_| ());
                read.unwrap_or_else(|e| panic!("{}: {text}: {e:#}", file.name));
            }
            for (key, table) in &texts.parts.table {
                let read = table.check();
                read.unwrap_or_else(|e| panic!("{}, table.{key}: {e}", file.name));
            }
        }
    }

    #[test]
    fn a_text_that_asks_for_what_nobody_gives_is_named_and_so_is_one_that_is_not_there() {
        let texts = PageTexts::new(ABLATION, &()).unwrap();
        let error = texts.text("subtitle").unwrap_err().to_string();
        assert!(error.contains("ablation_page.toml, text.subtitle"), "{error}");
        let error = texts.text("nothing").unwrap_err().to_string();
        assert!(error.contains("no text `nothing`"), "{error}");
    }
}
