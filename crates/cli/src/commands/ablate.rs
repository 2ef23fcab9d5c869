//! `maveric ablate`.

use super::print_outcome;
use crate::{
    args::{Format, Repeat},
    diagnostics::Failure,
};
use maveric_study::stages::ablate::{self, AblateOptions};

/// Compare embedding sizes, losses, window lengths and baselines on drivers held out in turn
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example: maveric ablate --drives drives/study1 --scores scores.csv --sizes 1,2,5,8 --out ablation"
)]
pub(crate) struct Ablate {
    /// Folder of drives
    #[arg(long)]
    drives: std::path::PathBuf,
    /// Questionnaire scores
    #[arg(long)]
    scores: Option<std::path::PathBuf>,
    /// Folder to write into: ablation.json and a page
    #[arg(long)]
    out: std::path::PathBuf,
    /// Embedding sizes beside the default
    #[arg(long, value_delimiter = ',', default_value = "1,2,5,8")]
    sizes: Vec<usize>,
    /// Lengths of a window beside the default, in s
    #[arg(long, value_delimiter = ',', default_value = "2,8")]
    windows: Vec<f64>,
    /// Parts into which the drivers are split
    #[arg(long, default_value_t = 5)]
    folds: usize,
    /// Passes over the rows of each training
    #[arg(long, default_value_t = 40)]
    epochs: usize,
    /// Root of every random choice
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Threads
    #[arg(short, long, default_value_t = super::all_cores())]
    jobs: usize,
    #[command(flatten)]
    repeat: Repeat,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Ablate {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = AblateOptions {
            drives: self.drives,
            scores: self.scores,
            out: self.out,
            sizes: self.sizes,
            windows_s: self.windows,
            folds: self.folds,
            epochs: self.epochs,
            seed: self.seed,
            jobs: self.jobs,
            command: self.repeat.command(),
        };
        print_outcome(self.format, "could not ablate", |watch| {
            ablate::ablate(&options, watch)
        })
    }
}
