//! `maveric status`.

use super::run::print_statuses;
use crate::{
    diagnostics::{Failure, tell},
    place::{DEFAULT_PIPELINE, PipelineArgs, place, study_notes},
};
use maveric_study::outcome::Format;
use std::path::PathBuf;

/// Say which stages of a pipeline are stale, and why; run nothing
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: maveric status pipelines/smoke.toml --format json")]
pub(crate) struct Status {
    /// Pipeline to read
    #[arg(default_value = DEFAULT_PIPELINE)]
    file: PathBuf,
    #[command(flatten)]
    pipeline: PipelineArgs,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Status {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let pipeline = self.pipeline.read(&self.file)?;
        let statuses = maveric_pipeline::status(&pipeline, &place(&self.file)?)
            .map_err(Failure::pipeline("could not tell the pipeline's status"))?;
        print_statuses(self.format, &statuses)?;
        for note in study_notes(&self.file)? {
            tell!("{note}");
        }
        Ok(())
    }
}
