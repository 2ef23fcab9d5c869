//! `report`: figures, tables and the page from the results of a run.

mod evaluation;
mod inputs;
mod keys;
mod people;
mod scene;
mod study;
pub(crate) mod words;

use crate::{
    atomic_write::atomic_write_bytes,
    error::StudyError,
    outcome::{Outcome, Watch},
    outputs::spare_inputs,
};
pub(crate) use inputs::hashed;
use maveric_report::{
    Context, Report,
    html::{Methods, Provenance, RenderedFile},
    markup,
};
use path_slash::PathExt as _;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What to report.
#[derive(Debug, Clone)]
pub struct ReportOptions {
    /// The study's design; `study.toml` of the folder one stands in without, else the paper's.
    pub design: Option<PathBuf>,
    /// Folder of results, as the pipeline leaves it.
    pub results: PathBuf,
    /// Folder to write into.
    pub out: PathBuf,
    /// The ledger of claims; the design's without, and none where it names none.
    pub claims: Option<PathBuf>,
    /// The command that makes the same again, for the page.
    pub command: String,
    /// Parameters of the run, listed on the page; a value that is a file stands there whole, with its hash.
    pub parameters: Vec<(String, String)>,
    /// Who took part; `participants.csv` among the results without.
    pub participants: Option<PathBuf>,
}

/// What was written.
#[derive(Debug, Clone, Serialize)]
pub struct Reported {
    /// The page.
    pub page: PathBuf,
    /// Files written, the page included.
    pub files: usize,
    /// The findings, a line each.
    pub findings: Vec<String>,
}

/// Draws every figure and table that the results have numbers for, and the page that holds them.
///
/// A folder with `analysis.json` is a study; one with `following.json` is an evaluation on recorded driving.
///
/// # Errors
/// [`StudyError`] if the folder holds neither, a result cannot be read, or a figure refuses its numbers.
pub fn report(options: &ReportOptions, watch: Watch<'_>) -> Result<Outcome<Reported>, StudyError> {
    let folder = &options.results;
    // What a page is drawn from has names that the page's own tables have too.
    spare_inputs([&**folder], [&*options.out])?;
    let (page, findings) = if folder.join("analysis.json").exists() {
        study::page(options, watch)?
    } else if folder.join("following.json").exists() {
        evaluation::page(options)?
    } else {
        return Err(StudyError::BadFile {
            path: folder.clone(),
            problem:
                "holds neither analysis.json nor following.json, so there is nothing to report"
                    .to_owned(),
            help: Some(
                "run a pipeline first, or `maveric stats study` over a study's results".to_owned(),
            ),
        });
    };
    watch.step(1, 2, "report")?;
    let files = maveric_report::render(&page)?;
    write_all(&options.out, &files)?;
    watch.step(2, 2, "report")?;
    let index = options.out.join("index.html");
    let mut summary: Vec<String> = findings.iter().map(|line| markup::plain(line)).collect();
    summary.push(format!("report: {}", index.to_slash_lossy()));
    let value = Reported {
        page: index,
        files: files.len(),
        findings,
    };
    Ok(Outcome {
        value,
        summary,
        warnings: page.warnings,
    })
}

/// A page with its head, the words that it explains, how its numbers were made and the command that repeats them; the results are
/// still to come.
pub(crate) fn page_of(
    head: (&str, String),
    context: &Context,
    method: impl Into<String>,
    (seed, command): (u64, &str),
) -> Report {
    let new = Report::new(head.0, head.1, context);
    Report {
        glossary: words::glossary(),
        methods: Methods {
            text: vec![method.into()],
            files: Vec::new(),
        },
        provenance: Provenance {
            seed: Some(seed),
            command: command.to_owned(),
            ..new.provenance
        },
        ..new
    }
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
