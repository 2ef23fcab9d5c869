//! `maveric status`.

use super::{print_json, run::print_statuses, seat::hindrances};
use crate::{
    diagnostics::{Failure, tell},
    place::{DEFAULT_PIPELINE, PipelineArgs, check_named_files, place, study_here},
};
use maveric_study::outcome::Format;
use serde_json::json;
use std::path::PathBuf;

/// Say which stages of a pipeline are stale, what is missing of the study, and what the seat lacks to open it; run nothing
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: maveric status pipelines/smoke.toml --format json")]
pub(crate) struct Status {
    /// Pipeline to read
    #[arg(default_value = DEFAULT_PIPELINE)]
    file: PathBuf,
    #[command(flatten)]
    pipeline: PipelineArgs,
    /// Write what is missing of the study, a row a person and time, as a table
    #[arg(long, value_name = "FILE")]
    missing: Option<PathBuf>,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Status {
    pub(crate) fn run(self) -> Result<(), Failure> {
        check_named_files(&self.file)?;
        let pipeline = self.pipeline.read(&self.file)?;
        let statuses = maveric_pipeline::status(&pipeline, &place(&self.file)?)
            .map_err(Failure::pipeline("could not tell the pipeline's status"))?;
        let Some((study, notes, missing)) = study_here(&self.file)? else {
            return match self.missing {
                None => print_statuses(self.format, &statuses),
                Some(_) => Err(Failure::Usage(
                    "--missing lists what is missing of the study in the current directory: leave the pipeline out, in the folder of a study.toml"
                        .to_owned(),
                )),
            };
        };
        if let Some(table) = &self.missing {
            let doing = "could not write what is missing";
            missing.write(table).map_err(Failure::study(doing))?;
        }
        let seat = hindrances(&study);
        if self.format == Format::Json {
            print_json(&json!({ "stages": statuses, "missing": missing, "seat": seat }))?;
        } else {
            print_statuses(self.format, &statuses)?;
        }
        let seat = seat.iter().map(|line| format!("the seat cannot open this study: {line}"));
        for line in notes.into_iter().chain(missing.lines()).chain(seat) {
            tell!("{line}");
        }
        Ok(())
    }
}
