//! What is given away, and how.

use serde::Serialize;
use std::path::PathBuf;

/// What to give away, and what of it.
#[derive(Debug, Clone, clap::Args)]
pub struct ExportOptions {
    /// Design of the study (TOML); study.toml of the current directory when not given, else the paper's
    #[arg(long, value_name = "FILE")]
    pub design: Option<PathBuf>,
    /// Logs, or folders of logs; may be given more than once. Where none of --logs, --participants, --surveys and --seat is given: all that the study has
    #[arg(long)]
    pub logs: Vec<PathBuf>,
    /// What the columns of tables among the logs mean (TOML); as study.toml says when not given
    #[arg(long)]
    pub mapping: Option<PathBuf>,
    /// Table of who takes part
    #[arg(long)]
    pub participants: Option<PathBuf>,
    /// Answers: participant, moment, scale, item, answer; may be given more than once
    #[arg(long)]
    pub surveys: Vec<PathBuf>,
    /// Folder of what the seat collected beside answers and drives (seat/): its events and consents
    #[arg(long, value_name = "FOLDER")]
    pub seat: Option<PathBuf>,
    /// The experimenter's notes too, as they were written, but for those that name somebody who is left out
    #[arg(long)]
    pub notes: bool,
    /// Each drive also as a table in drives/, a row a sample: the signals that the measures are computed from
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub drives: Option<DriveTables>,
    /// File with the secret that pseudonyms are made with, at least 16 characters; keep it apart
    #[arg(long)]
    pub key: PathBuf,
    /// Folder to write into, new or of an earlier export: README.md says what it holds
    #[arg(long)]
    pub out: PathBuf,
    /// Samples a second of the logs
    #[arg(long)]
    pub rate: Option<f64>,
    /// Threads
    #[arg(short, long, default_value_t = crate::outcome::all_cores())]
    pub jobs: usize,
}

/// How drives are written as tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum DriveTables {
    /// Text, for any program
    Csv,
    /// Parquet, which `maveric` reads as a drive
    Parquet,
}

#[derive(Debug, Clone, Serialize)]
pub struct Exported {
    /// People in it, each under a pseudonym.
    pub participants: usize,
    pub drives: usize,
    /// Answers to items, those asked for during drives among them.
    pub answers: usize,
}
