//! `maveric inspect`.

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use maveric_study::stages::inspect::{self, InspectOptions};

/// Say what is in a log, a drive or a model: channels, columns, rates, gaps, what would be ingested and why not
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Example: maveric inspect recording.mcap --format json
         maveric inspect P07-own.mcap av/logs/P07-*.mcap --watch P07.html
         maveric inspect --suggest-mapping drives.csv > mapping.toml")]
pub(crate) struct Inspect {
    /// Files to look into; a folder whose mapping says that every signal has its own file
    #[arg(required_unless_present = "suggest_mapping")]
    files: Vec<std::path::PathBuf>,
    /// What the columns of a table mean (TOML)
    #[arg(long)]
    mapping: Option<std::path::PathBuf>,
    /// Propose a mapping for this table, with its doubts as comments
    #[arg(long, value_name = "FILE", conflicts_with_all = ["files", "mapping", "plot", "watch", "csv"])]
    suggest_mapping: Option<std::path::PathBuf>,
    /// Draw speed, gap and lane of the first file over time
    #[arg(long, value_name = "OUT.png")]
    plot: Option<std::path::PathBuf>,
    /// Write a page that plays the drives of all files side by side; logs only
    #[arg(long, value_name = "OUT.html")]
    watch: Option<std::path::PathBuf>,
    /// Write the rows of the first file's drive, one a sample
    #[arg(long, value_name = "OUT.csv")]
    csv: Option<std::path::PathBuf>,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Inspect {
    pub(crate) fn run(self) -> Result<(), Failure> {
        if let Some(path) = self.suggest_mapping {
            return print_outcome(self.format, "could not suggest a mapping", |_| {
                inspect::suggest(&path)
            });
        }
        let options = InspectOptions {
            files: self.files,
            mapping: self.mapping,
            plot: self.plot,
            watch: self.watch,
            csv: self.csv,
        };
        print_outcome(self.format, "could not inspect", |watch| {
            inspect::inspect(&options, watch)
        })
    }
}
