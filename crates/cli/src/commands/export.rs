//! `maveric export`.

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use maveric_study::stages::export::{self, ExportOptions};

/// Write a study under pseudonyms, without dates, places and free text, to give away
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Example: openssl rand -hex 32 > ~/study.key
         maveric export --logs logs --participants participants.csv --surveys results/surveys.csv --key ~/study.key --out shared

Ids become keyed hashes, ages bands of ten years, times and positions start at 0. A rare person or a rare style may still be recognised by
who knows them: read the warnings.")]
pub(crate) struct Export {
    /// Design of the study (TOML); study.toml of the folder one stands in when not given, else the paper's
    #[arg(long, value_name = "FILE")]
    design: Option<std::path::PathBuf>,
    /// Logs, or folders of logs; may be given more than once
    #[arg(long)]
    logs: Vec<std::path::PathBuf>,
    /// What the columns of tables among the logs mean (TOML)
    #[arg(long)]
    mapping: Option<std::path::PathBuf>,
    /// Table of who takes part
    #[arg(long)]
    participants: Option<std::path::PathBuf>,
    /// Answers: participant, moment, scale, item, answer; may be given more than once
    #[arg(long)]
    surveys: Vec<std::path::PathBuf>,
    /// File with the secret that pseudonyms are made with, at least 16 characters; keep it apart
    #[arg(long)]
    key: std::path::PathBuf,
    /// Folder to write into: logs/, participants.csv, surveys.csv, surveys_wide.csv
    #[arg(long)]
    out: std::path::PathBuf,
    /// Samples a second of the logs
    #[arg(long)]
    rate: Option<f64>,
    /// Threads
    #[arg(short, long, default_value_t = super::all_cores())]
    jobs: usize,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Export {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = ExportOptions {
            design: self.design,
            logs: self.logs,
            mapping: self.mapping,
            participants: self.participants,
            surveys: self.surveys,
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
