//! `maveric recommend`.

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use maveric_study::stages::recommend::{self, RecommendOptions};

/// Say how far to turn the dial for a person: the recommended shift, how sure it is, why, and which shift to show next
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: maveric recommend study_data/generated/paper --participant S2P07")]
pub(crate) struct Recommend {
    /// Design of the study (TOML); study.toml of the folder one stands in when not given, else the paper's
    #[arg(long, value_name = "FILE")]
    design: Option<std::path::PathBuf>,
    /// Folder of results, as the pipeline leaves it
    results: std::path::PathBuf,
    /// Whom to recommend to; everybody when not given
    #[arg(long)]
    participant: Option<String>,
    /// Recommendations to write (JSON)
    #[arg(long)]
    out: Option<std::path::PathBuf>,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Recommend {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = RecommendOptions {
            design: self.design,
            results: self.results,
            participant: self.participant,
            out: self.out,
        };
        print_outcome(self.format, "could not recommend a shift", |watch| {
            recommend::recommend(&options, watch)
        })
    }
}
