//! `maveric cite`.

use super::print_as;
use crate::{citation, diagnostics::Failure};
use maveric_study::outcome::Format;

/// Print how to cite this program and the paper whose method it implements
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: maveric cite >> references.bib")]
pub(crate) struct Cite {
    /// BibTeX, or one JSON object with the entries' fields
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Cite {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let entries = citation::entries();
        let result = serde_json::json!({ "entries": entries });
        print_as(self.format, &result, &entries.map(|entry| entry.bibtex()))
    }
}
