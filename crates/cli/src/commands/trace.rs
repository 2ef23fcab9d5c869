//! `maveric trace`.

use super::print_as;
use crate::{
    diagnostics::Failure,
    place::{DESIGNED_FOLDER, place},
};
use maveric_pipeline::{Ledger, PipelineError, below_root};
use maveric_study::outcome::Format;
use std::path::PathBuf;

/// Walk back from a file to the stages, rows and files that it came from
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Example: maveric trace reports/paper/index.html
         maveric trace study_data/generated/smoke/scores.csv --pipeline pipelines/smoke.toml")]
pub(crate) struct Trace {
    /// A file that a stage made, or one in a folder that a stage made
    path: PathBuf,
    /// The pipeline that made it; when not given, whichever in `pipelines/` did, or the one that follows from study.toml
    #[arg(long)]
    pipeline: Option<PathBuf>,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Trace {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let doing = "could not trace the file";
        let files = match &self.pipeline {
            Some(file) => vec![file.clone()],
            None => ledgers().map_err(|e| Failure::io(doing, e))?,
        };
        let mut not_made = None;
        for file in &files {
            let place = place(file)?;
            let ledger = Ledger::read_any(&place.ledger).map_err(Failure::pipeline(doing))?;
            let path = below_root(&self.path, &place.root);
            match maveric_pipeline::trace(&ledger, &place, &path) {
                Ok(trace) => return print_as(self.format, &trace, &trace.lines()),
                Err(error @ PipelineError::NotMade { .. }) => not_made = Some(error),
                Err(error) => return Err(Failure::pipeline(doing)(error)),
            }
        }
        match not_made {
            Some(error) => Err(Failure::pipeline(doing)(error)),
            None => Err(Failure::Usage(
                "nothing was run here: there is no pipelines/*.lock, and no .maveric/*.lock; name the pipeline with --pipeline".to_owned(),
            )),
        }
    }
}

/// The ledgers of this folder's pipelines, in order: those of files, then that of the pipeline that follows from a design.
fn ledgers() -> std::io::Result<Vec<PathBuf>> {
    let mut ledgers = Vec::new();
    for folder in ["pipelines", DESIGNED_FOLDER] {
        let entries = match std::fs::read_dir(folder) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => continue,
            entries => entries?,
        };
        let mut files = Vec::new();
        for entry in entries {
            files.push(entry?.path());
        }
        files.retain(|file| file.extension().is_some_and(|e| e == "lock"));
        files.sort();
        ledgers.extend(files);
    }
    Ok(ledgers)
}
