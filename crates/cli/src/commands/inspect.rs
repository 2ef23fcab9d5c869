//! `maveric inspect`.

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use maveric_study::stages::inspect::{self, InspectOptions};

/// Say what is in a log, a drive or a model: channels, rates, gaps, schema, sanity
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: maveric inspect recording.mcap --format json")]
pub(crate) struct Inspect {
    /// Files to look into
    #[arg(required = true)]
    files: Vec<std::path::PathBuf>,
    /// What the columns of a table mean (TOML)
    #[arg(long)]
    mapping: Option<std::path::PathBuf>,
    /// Draw speed, gap and lane of the first file over time
    #[arg(long, value_name = "OUT.png")]
    plot: Option<std::path::PathBuf>,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Inspect {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = InspectOptions {
            files: self.files,
            mapping: self.mapping,
            plot: self.plot,
        };
        print_outcome(self.format, "could not inspect", |watch| {
            inspect::inspect(&options, watch)
        })
    }
}
