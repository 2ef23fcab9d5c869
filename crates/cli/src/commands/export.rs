//! `maveric export`.

use super::{print_outcome, today};
use crate::{
    diagnostics::Failure,
    place::{DEFAULT_PIPELINE, PipelineArgs, place},
};
use maveric_pipeline::{FactKind, Ledger};
use maveric_study::outcome::Format;
use maveric_study::stages::export::{self, About, ExportOptions, PipelineRun, Step};
use std::path::Path;

/// Write a study under pseudonyms, without dates, places and free text, to give away
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples: openssl rand -hex 32 > ~/study.key
          maveric export --key ~/study.key --out ../shared --pipeline
                                 in the folder of a study: all of it, and how it was analysed
          maveric export --logs logs --participants participants.csv --surveys results/surveys.csv --key ~/study.key --out shared

Ids become keyed hashes, ages bands of ten years, times and positions start at 0. A rare person or a rare style may still be recognised by
who knows them: read the warnings.")]
pub(crate) struct Export {
    /// Design of the study (TOML); study.toml of the folder one stands in when not given, else the paper's
    #[arg(long, value_name = "FILE")]
    design: Option<std::path::PathBuf>,
    /// Logs, or folders of logs; may be given more than once. Where none of --logs, --participants, --surveys and --seat is given: all that the study has
    #[arg(long)]
    logs: Vec<std::path::PathBuf>,
    /// What the columns of tables among the logs mean (TOML); as study.toml says when not given
    #[arg(long)]
    mapping: Option<std::path::PathBuf>,
    /// Table of who takes part
    #[arg(long)]
    participants: Option<std::path::PathBuf>,
    /// Answers: participant, moment, scale, item, answer; may be given more than once
    #[arg(long)]
    surveys: Vec<std::path::PathBuf>,
    /// Folder of what the seat collected beside answers and drives (seat/): its events and consents
    #[arg(long, value_name = "FOLDER")]
    seat: Option<std::path::PathBuf>,
    /// The notes too, as they were written
    #[arg(long, requires = "seat")]
    notes: bool,
    /// File with the secret that pseudonyms are made with, at least 16 characters; keep it apart
    #[arg(long)]
    key: std::path::PathBuf,
    /// Folder to write into: logs/, participants.csv, surveys.csv, surveys_wide.csv, seat/, ro-crate-metadata.json
    #[arg(long)]
    out: std::path::PathBuf,
    /// Samples a second of the logs
    #[arg(long)]
    rate: Option<f64>,
    /// Licence under which it is given away, as the address of its text, such as https://creativecommons.org/licenses/by/4.0/
    #[arg(long, value_name = "URL")]
    license: Option<String>,
    /// Pipeline whose run is told of: its text, its stages, and hashes of what they read and made; none when not given, that of the
    /// study's folder where no file is named
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = DEFAULT_PIPELINE)]
    pipeline: Option<std::path::PathBuf>,
    /// Day on which it is given away; today when not given
    #[arg(long, value_name = "YYYY-MM-DD", value_parser = day)]
    date: Option<String>,
    /// Threads
    #[arg(short, long, default_value_t = super::all_cores())]
    jobs: usize,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Export {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let about = About {
            date: self.date.unwrap_or_else(today),
            licence: self.license,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            run: self.pipeline.as_deref().map(run_of).transpose()?,
        };
        let options = ExportOptions {
            about,
            design: self.design,
            logs: self.logs,
            mapping: self.mapping,
            participants: self.participants,
            surveys: self.surveys,
            seat: self.seat,
            notes: self.notes,
            key: self.key,
            out: self.out,
            rate_hz: self.rate,
            jobs: self.jobs,
        };
        print_outcome(self.format, "could not export the study", |watch| {
            export::export(&options, watch)
        })
    }
}

/// A pipeline and what its ledger says was run.
fn run_of(file: &Path) -> Result<PipelineRun, Failure> {
    let pipeline = PipelineArgs::default().read(file)?;
    let ledger = Ledger::read_any(&place(file)?.ledger)
        .map_err(Failure::pipeline("could not read what was run"))?;
    let owned = |(name, value): (&str, &str)| (name.to_owned(), value.to_owned());
    let steps = ledger.run.values().map(|record| {
        let commands = record.made_from.facts(FactKind::Command);
        Step {
            name: record.stage.clone(),
            command: commands.map(|(_, line)| line).collect(),
            inputs: record.made_from.facts(FactKind::Input).map(owned).collect(),
            outputs: record.outputs.clone(),
        }
    });
    Ok(PipelineRun {
        name: ledger.pipeline.clone(),
        text: pipeline.text().to_owned(),
        steps: steps.collect(),
    })
}

fn day(text: &str) -> Result<String, String> {
    let read = chrono::NaiveDate::parse_from_str(text, "%Y-%m-%d");
    let read = read.map_err(|e| format!("expected a day as in 2026-01-31: {e}"))?;
    Ok(read.format("%Y-%m-%d").to_string())
}
