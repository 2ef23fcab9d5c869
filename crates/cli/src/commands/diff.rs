//! `maveric diff`.

use super::{print_json, print_lines};
use crate::{args::Format, diagnostics::Failure, place::place};
use maveric_pipeline::{Ledger, RunAt};
use std::path::{Path, PathBuf};

/// Say which inputs, parameters, numbers and figures of two runs differ
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Example: maveric diff pipelines/paper.toml ../last-week/pipelines/paper.toml

A run is a pipeline file, or the .lock file beside it.")]
pub(crate) struct Diff {
    /// One run
    first: PathBuf,
    /// The other
    second: PathBuf,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Diff {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let difference = maveric_pipeline::diff(&run_of(&self.first)?, &run_of(&self.second)?)
            .map_err(Failure::pipeline("could not compare the runs"))?;
        match self.format {
            Format::Json => print_json(&difference),
            Format::Text => print_lines(&difference.lines()),
        }
    }
}

fn run_of(file: &Path) -> Result<RunAt, Failure> {
    let place = place(file)?;
    let ledger = Ledger::read_any(&place.ledger).map_err(Failure::pipeline(
        "could not read what the run was made from",
    ))?;
    let root = place.root;
    Ok(RunAt { ledger, root })
}
