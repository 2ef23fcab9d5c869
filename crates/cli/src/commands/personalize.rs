//! `maveric personalize`.

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use maveric_study::stages::personalize::{self, PersonalizeOptions};

/// Fit an embedding to each drive, the networks frozen
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example: maveric personalize --model model.maveric --drives drives/study2 --scores scores.csv --out embeddings.csv"
)]
pub(crate) struct Personalize {
    /// Design of the study (TOML); study.toml of the folder one stands in when not given. Without either every drive counts
    #[arg(long, value_name = "FILE")]
    design: Option<std::path::PathBuf>,
    /// Who takes part; the design's table when not given
    #[arg(long)]
    participants: Option<std::path::PathBuf>,
    /// Trained model
    #[arg(long)]
    model: std::path::PathBuf,
    /// Folder of drives
    #[arg(long)]
    drives: std::path::PathBuf,
    /// Questionnaire scores; each drive is then fitted both with and without its ADB score
    #[arg(long)]
    scores: Option<std::path::PathBuf>,
    /// Embeddings to write
    #[arg(long)]
    out: std::path::PathBuf,
    /// Write how good embeddings are after 1, 2, 5 and 10 minutes, judged on each drive's last fifth (CSV or JSON by name)
    #[arg(long, value_name = "FILE")]
    learning_curve: Option<std::path::PathBuf>,
    /// Share of each drive, from its start, that may be learned from
    #[arg(long, default_value_t = 1.0)]
    fit_fraction: f64,
    /// Root of every random choice
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Threads
    #[arg(short, long, default_value_t = super::all_cores())]
    jobs: usize,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Personalize {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = PersonalizeOptions {
            design: self.design,
            participants: self.participants,
            model: self.model,
            drives: self.drives,
            scores: self.scores,
            out: self.out,
            learning_curve: self.learning_curve,
            fit_fraction: self.fit_fraction,
            seed: self.seed,
            jobs: self.jobs,
        };
        print_outcome(self.format, "could not personalize", |watch| {
            personalize::personalize(&options, watch)
        })
    }
}
