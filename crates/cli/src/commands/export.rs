//! `maveric export`.

use super::{print_outcome, today};
use crate::{
    diagnostics::Failure,
    place::{DEFAULT_PIPELINE, PipelineArgs, place},
};
use maveric_pipeline::{FactKind, Ledger};
use maveric_study::outcome::Format;
use maveric_study::stages::export::{self, About, ExportOptions, PipelineRun, Step};
use std::path::Path;

/// Write a study under pseudonyms, without dates, places and free text, to give away: design, scales, codebook, drives, answers, outcomes
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples: openssl rand -hex 32 > ~/study.key
          maveric export --key ~/study.key --out ../shared --pipeline
                                 in the folder of a study: all of it, and how it was analysed
          maveric export --logs logs --participants participants.csv --surveys results/surveys.csv --key ~/study.key --out shared

Ids become keyed hashes, ages in the table of people bands of ten years, times and positions start at 0; answers stay as they are. A rare
person or a rare style may still be recognised by who knows them: read the warnings.")]
pub(crate) struct Export {
    #[command(flatten)]
    options: ExportOptions,
    /// Licence under which it is given away, as the address of its text, such as https://creativecommons.org/licenses/by/4.0/
    #[arg(long, value_name = "URL", value_parser = address)]
    license: Option<String>,
    /// Pipeline whose run is told of: its text, its stages, and hashes of what they read and made; none when not given, that of the
    /// study's folder where no file is named
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = DEFAULT_PIPELINE)]
    pipeline: Option<std::path::PathBuf>,
    /// Day on which it is given away; today when not given
    #[arg(long, value_name = "YYYY-MM-DD", value_parser = day)]
    date: Option<String>,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Export {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let about = About {
            date: self.date.unwrap_or_else(today),
            licence: self.license,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            run: self.pipeline.as_deref().map(run_of).transpose()?,
        };
        let options = self.options;
        print_outcome(self.format, "could not export the study", |watch| {
            export::export(&options, &about, watch)
        })
    }
}

/// A pipeline and what its ledger says was run.
fn run_of(file: &Path) -> Result<PipelineRun, Failure> {
    let pipeline = PipelineArgs::default().read(file)?;
    let ledger = Ledger::read_any(&place(file)?.ledger)
        .map_err(Failure::pipeline("could not read what was run"))?;
    let set = ledger.run.values().filter(|r| r.variant.is_none());
    let set = set.flat_map(|record| record.set.clone()).collect();
    let owned = |(name, value): (&str, &str)| (name.to_owned(), value.to_owned());
    let steps = ledger.run.values().map(|record| {
        let commands = record.made_from.facts(FactKind::Command);
        Step {
            name: record.stage.clone(),
            command: commands.map(|(_, line)| line).collect(),
            inputs: record.made_from.facts(FactKind::Input).map(owned).collect(),
            outputs: record.outputs.clone(),
        }
    });
    Ok(PipelineRun {
        name: ledger.pipeline.clone(),
        text: pipeline.text().to_owned(),
        set,
        steps: steps.collect(),
    })
}

fn address(text: &str) -> Result<String, String> {
    let rest = text.strip_prefix("https://");
    let rest = rest.or_else(|| text.strip_prefix("http://"));
    let is_address =
        rest.is_some_and(|rest| !rest.is_empty() && !text.contains(char::is_whitespace));
    let expected = "expected an address, as in https://creativecommons.org/licenses/by/4.0/";
    is_address.then(|| text.to_owned()).ok_or_else(|| expected.to_owned())
}

fn day(text: &str) -> Result<String, String> {
    let read = chrono::NaiveDate::parse_from_str(text, "%Y-%m-%d");
    let read = read.map_err(|e| format!("expected a day as in 2026-01-31: {e}"))?;
    Ok(read.format("%Y-%m-%d").to_string())
}

#[cfg(test)]
mod tests {
    use super::address;

    #[test]
    fn a_licence_is_the_address_of_its_text_and_no_word() {
        let url = "https://creativecommons.org/licenses/by/4.0/";
        assert_eq!(address(url).as_deref(), Ok(url));
        for word in ["foo", "CC BY 4.0", "https://", "https://a b"] {
            assert!(address(word).is_err(), "{word}");
        }
    }
}
