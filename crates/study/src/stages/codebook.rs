//! `codebook`: what each questionnaire asks and how it is scored, for people and for programs.

use crate::{
    atomic_write::atomic_write_bytes,
    error::StudyError,
    outcome::{Outcome, Watch},
    outputs::spare_inputs,
    run_folder::read_scales,
    stage::{Files, Stage},
    tables::write_rows,
};
use path_slash::PathExt as _;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Describe the questionnaires: items, ranges, reversals, subscales, norms
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Example: maveric codebook --scales study_data/scales --out codebook")]
pub struct Describe {
    /// Folder of questionnaire definitions
    #[arg(long, default_value = "study_data/scales")]
    pub scales: PathBuf,
    /// Folder to write into: codebook.md, codebook.csv
    #[arg(long)]
    pub out: PathBuf,
}

/// What was described.
#[derive(Debug, Clone, Serialize)]
pub struct Codebook {
    /// Questionnaires.
    pub scales: usize,
    /// Their items.
    pub items: usize,
}

/// An item of a subscale: a row of `codebook.csv`.
#[derive(Serialize, Deserialize)]
struct ItemRow {
    scale: String,
    subscale: String,
    item: u32,
    column: String,
    min: i32,
    max: i32,
    reversed: bool,
    wording: String,
}

impl Stage for Describe {
    const NAME: &'static str = "codebook";
    const FAILURE: &'static str = "could not write the codebook";
    type Result = Codebook;

    fn files(&self, _root: &Path) -> Result<Files, StudyError> {
        Ok(Files::default()
            .reads([&self.scales])
            .writes_into(&self.out, &["codebook.csv", "codebook.md"]))
    }

    /// Writes the codebook of every scale of a folder: Markdown for people; a CSV row an item of each subscale.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<Codebook>, StudyError> {
        let csv = self.out.join("codebook.csv");
        let markdown = self.out.join("codebook.md");
        spare_inputs([&*self.scales], [&*csv, &markdown])?;
        let scales = read_scales(&self.scales)?;
        watch.check()?;
        let page = maveric_pages::codebook(&scales)?;
        let mut rows = Vec::new();
        for scale in &scales {
            for subscale in &scale.subscales {
                rows.extend(subscale.items.iter().map(|&item| {
                    ItemRow {
                        scale: scale.id.clone(),
                        subscale: subscale.id.clone(),
                        item,
                        column: scale.column_of(item),
                        min: scale.min,
                        max: scale.max,
                        reversed: scale.is_reversed(subscale, item),
                        wording: scale
                            .wording
                            .get(item as usize - 1)
                            .cloned()
                            .unwrap_or_default(),
                    }
                }));
            }
        }
        write_rows(&csv, &rows)?;
        atomic_write_bytes(&markdown, page.as_bytes())?;
        let value = Codebook {
            scales: scales.len(),
            items: scales.iter().map(|s| s.items as usize).sum(),
        };
        let summary = vec![format!(
            "{} scales, {} items: {}, {}",
            value.scales,
            value.items,
            markdown.to_slash_lossy(),
            csv.to_slash_lossy()
        )];
        Ok(Outcome {
            value,
            summary,
            warnings: Vec::new(),
        })
    }
}
