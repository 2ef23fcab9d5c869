//! `maveric codebook`.

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use maveric_study::stages::codebook::{self, CodebookOptions};

/// Describe the questionnaires: items, ranges, reversals, subscales, norms
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: maveric codebook --scales study_data/scales --out codebook")]
pub(crate) struct Codebook {
    /// Folder of questionnaire definitions
    #[arg(long, default_value = "study_data/scales")]
    scales: std::path::PathBuf,
    /// Folder to write into: codebook.md, codebook.csv
    #[arg(long)]
    out: std::path::PathBuf,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Codebook {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = CodebookOptions {
            scales: self.scales,
            out: self.out,
        };
        print_outcome(self.format, "could not write the codebook", |watch| {
            codebook::codebook(&options, watch)
        })
    }
}
