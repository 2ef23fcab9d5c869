//! `maveric ingest`.

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use maveric_study::stages::ingest::{self, IngestOptions};

/// Turn driving logs (MCAP, CSV, Parquet) into evenly sampled drives
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: maveric ingest logs/study1 --out drives/study1")]
pub(crate) struct Ingest {
    /// Logs, or folders of logs; those of the design when none are given
    logs: Vec<std::path::PathBuf>,
    /// Design of the study (TOML); study.toml of the folder one stands in when not given. Without either nothing is left out
    #[arg(long, value_name = "FILE")]
    design: Option<std::path::PathBuf>,
    /// Who takes part; the design's table when not given
    #[arg(long)]
    participants: Option<std::path::PathBuf>,
    /// Folder to write into: one Parquet file a drive, drives.csv, exclusions.csv
    #[arg(long)]
    out: std::path::PathBuf,
    /// What the columns of a table mean (TOML); needed for tables
    #[arg(long)]
    mapping: Option<std::path::PathBuf>,
    /// Samples a second
    #[arg(long)]
    rate: Option<f64>,
    /// Take what can be read of a damaged log, and say what could not
    #[arg(long)]
    recover: bool,
    /// End well although logs could not be ingested, as long as one drive came through: exclusions.csv lists them
    #[arg(long)]
    keep_going: bool,
    /// Threads
    #[arg(short, long, default_value_t = super::all_cores())]
    jobs: usize,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Ingest {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = IngestOptions {
            logs: self.logs,
            design: self.design,
            participants: self.participants,
            out: self.out,
            mapping: self.mapping,
            rate_hz: self.rate,
            recover: self.recover,
            jobs: self.jobs,
        };
        let mut failed = 0;
        print_outcome(self.format, "could not ingest", |watch| {
            let outcome = ingest::ingest(&options, watch)?;
            failed = outcome.value.failed.len();
            Ok(outcome)
        })?;
        if failed > 0 && !self.keep_going {
            return Err(Failure::Told);
        }
        Ok(())
    }
}
