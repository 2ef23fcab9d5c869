//! `maveric verify`.

use super::print_as;
use crate::{
    diagnostics::Failure,
    place::{DEFAULT_PIPELINE, PipelineArgs, place},
};
use maveric_pipeline::{FileState, Finding, Role, Verification};
use maveric_study::outcome::Format;
use std::path::PathBuf;

/// Read every file of a pipeline again and hold it against the ledger; change nothing
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Example: maveric verify pipelines/smoke.toml

Exit status 1 if any file is not as the ledger says.")]
pub(crate) struct Verify {
    /// Pipeline to read
    #[arg(default_value = DEFAULT_PIPELINE)]
    file: PathBuf,
    #[command(flatten)]
    pipeline: PipelineArgs,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Verify {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let pipeline = self.pipeline.read(&self.file)?;
        let verification = maveric_pipeline::verify(&pipeline, &place(&self.file)?)
            .map_err(Failure::pipeline("could not verify the pipeline's files"))?;
        print_as(self.format, &verification, &lines(&verification))?;
        Failure::told_unless(verification.findings.is_empty())
    }
}

fn lines(verification: &Verification) -> Vec<String> {
    let line = |finding: &Finding| {
        let role = match finding.role {
            Role::Input => "which it reads",
            Role::Output => "which it makes",
        };
        let state = match finding.state {
            FileState::Missing => "is not there",
            FileState::NoLongerMade => "is no longer made by any stage",
            FileState::Changed | FileState::Same => "has another content",
        };
        format!("{}: {}, {role}, {state}", finding.stage, finding.path)
    };
    let mut lines: Vec<String> = verification.findings.iter().map(line).collect();
    if !verification.never_run.is_empty() {
        lines.push(format!("never run: {}", verification.never_run.join(", ")));
    }
    if !verification.unfinished.is_empty() {
        let stages = verification.unfinished.join(", ");
        lines.push(format!("last run did not finish: {stages}"));
    }
    lines.push(format!(
        "{} inputs and outputs read, {} not as recorded",
        verification.compared,
        verification.findings.len()
    ));
    lines
}
