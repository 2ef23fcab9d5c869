//! `report`: figures, tables and the page from the results of a run.

mod evaluation;
mod inputs;
mod keys;
mod people;
mod scene;
mod study;

use crate::{
    atomic_write::atomic_write_bytes,
    error::StudyError,
    outcome::{Outcome, Watch},
    outputs::spare_inputs,
    stage::{Files, Stage},
};
pub(crate) use inputs::hashed;
use maveric_report::{Report, html::RenderedFile, markup};
use path_slash::PathExt as _;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Draw the figures, tables and the page from the results of a run
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Example: maveric report study_data/generated/paper --out reports/paper")]
pub struct DrawReport {
    /// Design of the study (TOML); study.toml of the current directory when not given, else the paper's
    #[arg(long, value_name = "FILE")]
    pub design: Option<PathBuf>,
    /// Folder of results, as the pipeline leaves it
    pub results: PathBuf,
    /// Folder to write into: index.html, figures, tables
    #[arg(long)]
    pub out: PathBuf,
    /// Ledger of claims (TOML); the design's when not given, and none where it names none
    #[arg(long)]
    pub claims: Option<PathBuf>,
    /// A parameter of the run, for the page; a value that is a file is shown whole, with its hash
    #[arg(long = "param", value_name = "KEY=VALUE", value_parser = parameter)]
    pub parameters: Vec<(String, String)>,
    /// Table of who took part; RESULTS/participants.csv when not given
    #[arg(long)]
    pub participants: Option<PathBuf>,
    /// The command that makes the same again, for the page; this one when not given
    #[arg(long, value_name = "TEXT")]
    pub command: Option<String>,
}

impl DrawReport {
    fn parameter(&self, key: &str) -> Option<&str> {
        let mut parameters = self.parameters.iter();
        let (_, value) = parameters.find(|(name, _)| name == key)?;
        Some(value)
    }
}

#[derive(Debug, Clone, Serialize)]
pub struct Reported {
    /// Path of the page, index.html.
    pub page: PathBuf,
    /// Files written, the page included.
    pub files: usize,
    /// The findings, a line each.
    pub findings: Vec<String>,
}

impl Stage for DrawReport {
    const NAME: &'static str = "report";
    const FAILURE: &'static str = "could not write the report";
    type Result = Reported;

    fn files(&self, root: &Path) -> Result<Files, StudyError> {
        Ok(inputs::drawn_from(self, root)?.writes([&self.out]))
    }

    fn repeated_by(&mut self, command: &str) {
        self.command.get_or_insert_with(|| command.to_owned());
    }

    /// Draws every figure and table that the results have numbers for, and the page that holds them.
    ///
    /// A folder with `analysis.json` is a study; one with `following.json` and `model_training.json` is an evaluation on recorded driving.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<Reported>, StudyError> {
        let folder = &self.results;
        spare_inputs([&**folder], [&*self.out])?;
        let (page, findings) = if folder.join("analysis.json").exists() {
            study::page(self, watch)?
        } else if folder.join("following.json").exists() {
            evaluation::page(self)?
        } else {
            let problem = "holds neither analysis.json (a study) nor following.json with model_training.json (an evaluation), so there is nothing to report";
            let help = "run a pipeline first, or `maveric stats study` over a study's results";
            return Err(StudyError::file(folder, problem).with_help(help));
        };
        watch.step(1, 2, "report")?;
        let files = maveric_report::render(&page)?;
        write_all(&self.out, &files)?;
        watch.step(2, 2, "report")?;
        let index = self.out.join("index.html");
        let mut summary: Vec<String> = findings.iter().map(|line| markup::plain(line)).collect();
        summary.push(format!("report: {}", index.to_slash_lossy()));
        let value = Reported { page: index, files: files.len(), findings };
        Ok(Outcome::new(value, summary, page.warnings))
    }
}

fn parameter(text: &str) -> Result<(String, String), String> {
    let parts = text.split_once('=').filter(|(key, _)| !key.is_empty());
    let (key, value) = parts.ok_or_else(|| format!("`{text}` is not KEY=VALUE, such as seed=1"))?;
    Ok((key.to_owned(), value.to_owned()))
}

/// Draws a page with its figures and tables into a folder; gives the page's path.
pub(crate) fn write_page(out: &Path, page: &Report) -> Result<PathBuf, StudyError> {
    write_all(out, &maveric_report::render(page)?)?;
    Ok(out.join("index.html"))
}

fn write_all(out: &Path, files: &[RenderedFile]) -> Result<(), StudyError> {
    // The page last: when it is there, everything that it links to is there too.
    let (page, others): (Vec<&RenderedFile>, Vec<&RenderedFile>) =
        files.iter().partition(|f| f.path == "index.html");
    for file in others.into_iter().chain(page) {
        atomic_write_bytes(&out.join(&file.path), &file.bytes)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_that_makes_no_page_says_what_one_is_made_of() {
        let folder = tempfile::tempdir().unwrap();
        let report = DrawReport {
            design: None,
            results: folder.path().join("results"),
            out: folder.path().join("report"),
            claims: None,
            parameters: Vec::new(),
            participants: None,
            command: None,
        };
        std::fs::create_dir(&report.results).unwrap();
        let refused = || report.work(Watch::unwatched()).unwrap_err().to_string();
        assert!(refused().contains("following.json with model_training.json"));
        std::fs::write(report.results.join("following.json"), "{}").unwrap();
        let error = refused();
        let lacks = error.contains("without model_training.json");
        assert!(lacks && error.contains("results"), "{error}");
        std::fs::write(report.results.join("model_training.json"), "{}").unwrap();
        let error = refused();
        assert!(error.contains("following.json: not the JSON"), "{error}");
    }
}
