//! `maveric train`.

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use maveric_study::stages::train::{self, HeadsKind, TrainOptions};

/// Learn heads and the training drivers' embeddings
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example: maveric train --drives drives/study1 --scores scores.csv --out model.maveric"
)]
pub(crate) struct Train {
    /// Design of the study (TOML); study.toml of the folder one stands in when not given. Without either every drive counts
    #[arg(long, value_name = "FILE")]
    design: Option<std::path::PathBuf>,
    /// Who takes part; the design's table when not given
    #[arg(long)]
    participants: Option<std::path::PathBuf>,
    /// Folder of drives
    #[arg(long)]
    drives: std::path::PathBuf,
    /// Questionnaire scores; without them there is no style head and no aggression line
    #[arg(long)]
    scores: Option<std::path::PathBuf>,
    /// Model to write; its report and the training embeddings go beside it
    #[arg(long)]
    out: std::path::PathBuf,
    /// Which heads learn: linear (habits as events) or paper (its five networks, which the epochs, fractions and patience below
    /// are about)
    #[arg(long, default_value = "linear", value_name = "linear|paper")]
    heads: HeadsKind,
    /// Size of the embedding
    #[arg(long, default_value_t = 3)]
    embedding_size: usize,
    /// Passes over the training rows
    #[arg(long, default_value_t = 40)]
    epochs: usize,
    /// Share of each drive, from its start, that may be learned from
    #[arg(long, default_value_t = 1.0)]
    fit_fraction: f64,
    /// Share of the people whom a run of its own keeps back, to choose the number of passes by (0: no such run)
    #[arg(long, default_value_t = 0.15)]
    validation_fraction: f64,
    /// Passes without a lower loss on those people after which that run stops (0: never)
    #[arg(long, default_value_t = 0)]
    patience: usize,
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
            design: self.design,
            participants: self.participants,
            drives: self.drives,
            scores: self.scores,
            out: self.out,
            heads: self.heads,
            embedding_size: self.embedding_size,
            epochs: self.epochs,
            fit_fraction: self.fit_fraction,
            seed: self.seed,
            jobs: self.jobs,
            validation_fraction: self.validation_fraction,
            patience: self.patience,
        };
        print_outcome(self.format, "could not train", |watch| {
            train::train(&options, watch)
        })
    }
}
