//! `codebook`: what each questionnaire asks and how it is scored, and what a study measures of its own, for people and for programs.

use crate::{
    atomic_write::atomic_write_bytes,
    design::DesignFile,
    error::StudyError,
    outcome::{Outcome, Watch},
    run_folder::read_scales,
    stage::{Files, Stage},
    tables::{TableName, write_rows},
};
use maveric_domain::{
    Design, Scale, Subscale,
    design::{OwnMeasure, Sign},
    survey::Kind,
};
use maveric_pages::named_answers;
use path_slash::PathExt as _;
use serde::Serialize;
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

/// Describe the questionnaires (items, ranges, reversals, subscales, norms) and the study's own measures
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Example: maveric codebook --scales study_data/scales --out codebook")]
pub struct Describe {
    /// Folder of questionnaire definitions; the design's when not given
    #[arg(long)]
    pub scales: Option<PathBuf>,
    /// Design of the study (TOML), for its own measures; study.toml of the current directory when not given
    #[arg(long, value_name = "FILE")]
    pub design: Option<PathBuf>,
    /// Folder to write into: codebook.md, codebook.csv and, of a study with measures of its own, codebook_measures.csv
    #[arg(long)]
    pub out: PathBuf,
}

const PATHS: [&str; 3] = ["codebook.csv", "codebook.md", "codebook_measures.csv"];

#[derive(Debug, Clone, Serialize)]
pub struct Codebook {
    pub scales: usize,
    /// Items of all of them together.
    pub items: usize,
    /// Measures of the study's own.
    pub measures: usize,
}

/// An item of a subscale, or one that is only asked: a row of `codebook.csv`.
#[derive(Serialize)]
struct ItemRow {
    scale: String,
    subscale: Option<String>,
    item: u32,
    column: String,
    kind: Kind,
    min: i32,
    max: i32,
    reversed: bool,
    wording: String,
    answers: String,
}

/// A measure of the study's own: a row of `codebook_measures.csv`.
#[derive(Serialize)]
struct MeasureRow {
    id: String,
    title: String,
    unit: String,
    aggression: &'static str,
}

impl Stage for Describe {
    const NAME: &'static str = "codebook";
    const FAILURE: &'static str = "could not write the codebook";
    type Result = Codebook;

    fn files(&self, root: &Path) -> Result<Files, StudyError> {
        let study = DesignFile::below_or_paper(root, self.design.as_deref())?;
        Ok(Files::default()
            .reads([study.scales_folder(self.scales.as_deref())])
            .reads_design(self.design.as_deref())
            .writes_into(&self.out, &PATHS))
    }

    /// Writes the codebook of every scale of a folder: Markdown for people; a CSV row an item of each subscale.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<Codebook>, StudyError> {
        let paths = PATHS.map(|name| self.out.join(name));
        let study = DesignFile::here(self.design.as_deref())?;
        let scales = read_scales(&self.scales_folder()?)?;
        watch.check()?;
        let value = write_codebook(&scales, study.as_ref().map(|s| &s.design), &self.out)?;
        let [csv, markdown, _] = paths;
        let summary = vec![format!(
            "{} scales, {} items: {}, {}",
            value.scales,
            value.items,
            markdown.to_slash_lossy(),
            csv.to_slash_lossy()
        )];
        Ok(Outcome::new(value, summary, Vec::new()))
    }
}

impl Describe {
    /// The folder of questionnaires that it describes.
    ///
    /// # Errors
    /// As [`DesignFile::find`].
    pub fn scales_folder(&self) -> Result<PathBuf, StudyError> {
        let study = DesignFile::find(self.design.as_deref())?;
        Ok(study.scales_folder(self.scales.as_deref()))
    }
}

/// Writes the codebook of these scales and of a design's own measures into a folder.
pub(crate) fn write_codebook(
    scales: &[Scale],
    design: Option<&Design>,
    folder: &Path,
) -> Result<Codebook, StudyError> {
    let [csv, markdown, of_measures] = PATHS.map(|name| folder.join(name));
    let page = maveric_pages::codebook(scales, design)?;
    let mut rows = Vec::new();
    for scale in scales {
        let row = |subscale: Option<&Subscale>, number: u32| {
            let place = number as usize - 1;
            let (item, words) = (&scale.items[place], &scale.wording.items[place]);
            let pair = words.pair.as_ref();
            ItemRow {
                scale: scale.id.clone(),
                subscale: subscale.map(|s| s.id.clone()),
                item: number,
                column: scale.column_of(number),
                kind: item.kind,
                min: item.min,
                max: item.max,
                reversed: subscale.is_some_and(|s| scale.is_reversed(s, number)),
                wording: pair.map_or_else(|| words.text.clone(), |pair| pair.join(" – ")),
                answers: named_answers(item, words),
            }
        };
        let mut scored = BTreeSet::new();
        for subscale in &scale.subscales {
            let items = scale.items_of(subscale);
            rows.extend(items.iter().map(|&item| row(Some(subscale), item)));
            scored.extend(items);
        }
        let unscored = (1..=scale.count()).filter(|item| !scored.contains(item));
        rows.extend(unscored.map(|item| row(None, item)));
    }
    write_rows(TableName::Codebook, &csv, &rows)?;
    let measure = |measure: &OwnMeasure| MeasureRow {
        id: measure.id.clone(),
        title: measure.title.clone(),
        unit: measure.unit.clone(),
        aggression: match measure.aggression {
            Some(Sign::Plus) => "up",
            Some(Sign::Minus) => "down",
            None => "not known",
        },
    };
    let measures = design.into_iter().flat_map(Design::measures);
    let measures: Vec<MeasureRow> = measures.map(measure).collect();
    if !measures.is_empty() {
        write_rows(TableName::CodebookMeasures, &of_measures, &measures)?;
    }
    atomic_write_bytes(&markdown, page.as_bytes())?;
    Ok(Codebook {
        scales: scales.len(),
        items: scales.iter().map(|s| s.items.len()).sum(),
        measures: measures.len(),
    })
}
