//! `maveric diff`.

use super::print_as;
use crate::{
    diagnostics::Failure,
    place::{DEFAULT_PIPELINE, place},
};
use maveric_pipeline::{Ledger, RunAt};
use maveric_study::outcome::Format;
use path_slash::PathExt as _;
use std::path::{Path, PathBuf};

/// Say which inputs, parameters, numbers and figures of two runs differ
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples: maveric diff pipelines/paper.toml ../last-week/pipelines/paper.toml
          maveric diff --variant a --variant b      two variants of the default pipeline
          maveric diff --variant b                  what was run without a name, and a variant

A run is a pipeline file, or the .lock file beside it.")]
pub(crate) struct Diff {
    /// One run; with --variant, the pipeline
    first: Option<PathBuf>,
    /// The other
    second: Option<PathBuf>,
    /// Compare variants of one pipeline; given once, against what was run without a name
    #[arg(long = "variant", value_name = "NAME")]
    variants: Vec<String>,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Diff {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let file = |file: Option<PathBuf>| file.unwrap_or_else(|| DEFAULT_PIPELINE.into());
        let (first, second) = match (self.variants.as_slice(), self.first, self.second) {
            ([], Some(first), Some(second)) => (run_of(&first, None)?, run_of(&second, None)?),
            ([one], first, None) => {
                let file = file(first);
                (run_of(&file, None)?, run_of(&file, Some(one))?)
            }
            ([one, other], first, None) => {
                let file = file(first);
                (run_of(&file, Some(one))?, run_of(&file, Some(other))?)
            }
            _ => {
                let message = "name two runs, or one pipeline with one or two --variant";
                return Err(Failure::Usage(message.to_owned()));
            }
        };
        let difference = maveric_pipeline::diff(&first, &second)
            .map_err(Failure::pipeline("could not compare the runs"))?;
        print_as(self.format, &difference, &difference.lines())
    }
}

fn run_of(file: &Path, variant: Option<&String>) -> Result<RunAt, Failure> {
    let place = place(file)?;
    let ledger = Ledger::read_any(&place.ledger)
        .map_err(Failure::pipeline("could not read what the run was made from"))?;
    if let Some(name) = variant.filter(|name| !ledger.variants().contains(name.as_str())) {
        let known: Vec<&str> = ledger.variants().into_iter().collect();
        let known = if known.is_empty() {
            "none has been run".to_owned()
        } else {
            format!("there are {}", known.join(", "))
        };
        return Err(Failure::Usage(format!(
            "{} knows no variant `{name}`: {known}",
            place.ledger.to_slash_lossy()
        )));
    }
    Ok(RunAt { ledger, root: place.root, variant: variant.cloned() })
}
