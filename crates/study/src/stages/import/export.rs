//! An export, by whatever wrote it.

use super::{
    columns::Columns,
    formats::{Format, is_by_questions},
    grid::{Grid, HowToRead},
    jspsych,
    map_file::MapFile,
    sheets::{Contents, Orders},
    wide,
};
use crate::{atomic_write::read_text, design::DesignFile, error::StudyError};
use maveric_domain::{ParticipantId, design::Software};
use path_slash::PathExt as _;
use std::path::Path;

pub(super) enum Export {
    /// A table of words, without the rows below its names that hold no answers.
    Table(Grid, &'static Format),
    Sessions(String),
}

/// Columns of the table that is scored, which a table with a row a participant has not.
const LONG: [&str; 4] = ["moment", "scale", "item", "answer"];

impl Export {
    /// Reads an export of `from`, or of whatever wrote what stands in it.
    ///
    /// # Errors
    /// As [`Grid::read`]; [`StudyError::BadFile`] for a table that another software wrote.
    pub(super) fn read(
        path: &Path,
        from: Option<Software>,
        how: HowToRead<'_>,
    ) -> Result<Self, StudyError> {
        if from == Some(Software::Jspsych) || (from.is_none() && is_json(path)?) {
            return Ok(Self::Sessions(read_text(path)?));
        }
        let grid = Grid::read(path, how)?;
        let known = Format::of_grid(&grid);
        let format = from.and_then(Format::for_software).unwrap_or(known);
        if known.software != Software::Wide && known.software != format.software {
            let problem = format!("is of {} by its head, not of {}", known.title, format.title);
            let help = format!(
                "say --from {id}, or software = \"{id}\" under [files] of the design",
                id = known.software.id()
            );
            return Err(StudyError::file(path, problem).with_help(help));
        }
        Ok(Self::Table(format.without_heads(grid), format))
    }

    pub(super) fn software(&self) -> Software {
        match self {
            Self::Table(_, format) => format.software,
            Self::Sessions(_) => Software::Jspsych,
        }
    }

    /// What it is, for messages.
    fn by_its_head(&self) -> String {
        match self.software() {
            Software::Wide => "another table by its head".to_owned(),
            _ => format!("an export of {} by its head", self.title()),
        }
    }

    /// What wrote it, by its own name.
    pub(super) fn title(&self) -> &'static str {
        match self {
            Self::Table(_, format) => format.title,
            Self::Sessions(_) => "jsPsych",
        }
    }

    pub(super) fn answers(
        &self,
        path: &Path,
        columns: &Columns<'_>,
        orders: &Orders,
    ) -> Result<Contents, StudyError> {
        match self {
            Self::Table(grid, format) => wide::read(grid, format, columns, orders),
            Self::Sessions(text) => jspsych::read(path, text, columns, orders),
        }
    }

    /// Whether any of its columns is called as the items of a scale are; jsPsych's sessions have none, and are not asked.
    pub(super) fn has_columns_of(&self, columns: &Columns<'_>, scale: usize) -> bool {
        let Self::Table(grid, format) = self else {
            return true;
        };
        let mut names = grid.columns.iter();
        names
            .any(|name| columns.is_of(scale, name) || columns.is_of(scale, format.field_of(name).1))
    }

    /// What is wrong with one in which nothing belongs to a scale, and what to do.
    pub(super) fn no_answers(&self, columns: &Columns<'_>) -> (String, String) {
        let scales = columns.scales.iter();
        let patterns: Vec<String> = scales.map(|scale| columns.pattern_of(scale)).collect();
        let problem = format!("holds no answers to any scale; looked for {}", patterns.join(", "));
        let texts = matches!(self, Self::Table(grid, _) if is_by_questions(grid));
        let help = if texts {
            "export it again with the codes of the questions as headings (LimeSurvey: Headings, Question code), by which items are known"
        } else {
            "say what the columns are called: `column` in a scale's file, or --columns MAP.toml, which `maveric import --suggest FILE` proposes"
        };
        (problem, help.to_owned())
    }
}

/// Whether a file begins as an array of JSON does.
fn is_json(path: &Path) -> Result<bool, StudyError> {
    let bytes = std::fs::read(path).map_err(StudyError::read(path))?;
    let text = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(&bytes);
    Ok(text.trim_ascii_start().first() == Some(&b'['))
}

/// A file that is an export and not the table that is scored, by its head; what cannot be read at all is neither.
fn raw(path: &Path) -> Option<Export> {
    let export = Export::read(path, None, HowToRead::default()).ok()?;
    let is_scored = matches!(&export, Export::Table(grid, _) if LONG.iter().any(|name| grid.position(name).is_some()));
    (!is_scored).then_some(export)
}

/// What is wrong with answers that cannot be read to be scored: where they are an export, that, and what to do.
pub(crate) fn told_as_export(path: &Path, error: StudyError) -> StudyError {
    let Some(export) = raw(path) else {
        return error;
    };
    let file = path.to_slash_lossy();
    let problem = format!(
        "is {}, not the table that is scored: a row an answer, with the columns participant, {}",
        export.by_its_head(),
        LONG.join(", ")
    );
    let help = format!(
        "`maveric import --suggest {file} --out columns.toml` proposes what its columns mean, and `maveric import {file} --columns columns.toml --out surveys.csv` makes that table of it"
    );
    StudyError::file(path, problem).with_help(help)
}

/// Refuses answers of a design that says they are the table that is scored, where they are an export.
///
/// # Errors
/// [`StudyError`] naming the design, what the file is and what to write. What cannot be read at all is for whoever needs it to say.
pub(crate) fn refuse_export(study: &DesignFile) -> Result<(), StudyError> {
    let files = study.design.files();
    let path = study.resolve(&files.answers);
    if files.software != Software::Table || !path.is_file() {
        return Ok(());
    }
    let Some(export) = raw(&path) else {
        return Ok(());
    };
    let id = export.software().id();
    Err(study.wrong(
        format!(
            "`files.software`: left out, or \"table\", and {} is {}",
            path.to_slash_lossy(),
            export.by_its_head(),
        ),
        Some(format!("write software = \"{id}\" under [files]")),
    ))
}

/// The column of a study's answers that says whose each row of their table is; none where they are no table, or it has none.
///
/// # Errors
/// [`StudyError`] for a map of columns that is none.
pub(crate) fn column_of_people(study: &DesignFile) -> Result<Option<String>, StudyError> {
    let table = table_of_answers(study)?;
    Ok(table.map(|(grid, column)| grid.columns[column].clone()))
}

/// Whether a study's answers, in whatever table they come, have a row of somebody's.
pub(crate) fn has_row_of(study: &DesignFile, id: &ParticipantId) -> Result<bool, StudyError> {
    let table = table_of_answers(study)?;
    Ok(table.is_some_and(|(grid, column)| grid.column(column).any(|cell| cell == id.as_str())))
}

/// The table of a study's answers, and its column of people.
fn table_of_answers(study: &DesignFile) -> Result<Option<(Grid, usize)>, StudyError> {
    let files = study.design.files();
    let columns = files.columns.as_ref().map(|file| study.resolve(file));
    let map = columns.as_deref().map(MapFile::read).transpose()?.unwrap_or_default();
    let path = study.resolve(&files.answers);
    let read = |from| Export::read(&path, from, map.how(None));
    let Ok(Export::Table(grid, format)) = read(Some(files.software)).or_else(|_| read(None)) else {
        return Ok(None);
    };
    let column = wide::people_column(&grid, format, &map).ok().flatten();
    Ok(column.map(|column| (grid, column)))
}
