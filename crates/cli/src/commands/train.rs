//! `maveric train`.

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use maveric_study::stages::train::{self, TrainOptions};

/// Train the networks and the training drivers' embeddings
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example: maveric train --drives drives/study1 --scores scores.csv --out model.maveric"
)]
pub(crate) struct Train {
    /// Folder of drives
    #[arg(long)]
    drives: std::path::PathBuf,
    /// Questionnaire scores; without them there is no style head and no aggression line
    #[arg(long)]
    scores: Option<std::path::PathBuf>,
    /// Model to write; its report and the training embeddings go beside it
    #[arg(long)]
    out: std::path::PathBuf,
    /// Size of the embedding
    #[arg(long, default_value_t = 3)]
    embedding_size: usize,
    /// Passes over the training rows
    #[arg(long, default_value_t = 40)]
    epochs: usize,
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

impl Train {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = TrainOptions {
            drives: self.drives,
            scores: self.scores,
            out: self.out,
            embedding_size: self.embedding_size,
            epochs: self.epochs,
            fit_fraction: self.fit_fraction,
            seed: self.seed,
            jobs: self.jobs,
        };
        print_outcome(self.format, "could not train", |watch| {
            train::train(&options, watch)
        })
    }
}
