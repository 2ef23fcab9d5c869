//! `maveric init`.

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use maveric_study::stages::init::{self, InitOptions};

/// Make the folder of a study of your own: pipeline, scales, mappings, and what goes where
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: maveric init my_study")]
pub(crate) struct Init {
    /// The folder; not there yet, or empty
    folder: std::path::PathBuf,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Init {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = InitOptions {
            folder: self.folder,
        };
        print_outcome(self.format, "could not make the study's folder", |watch| {
            init::init(&options, watch)
        })
    }
}
