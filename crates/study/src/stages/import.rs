//! `import`: answers as survey software exports them, to the long table that is scored.

mod alike;
mod columns;
mod encoding;
mod export;
mod families;
mod formats;
mod grid;
mod heads;
mod imported;
mod jspsych;
mod long_table;
mod map_file;
mod pattern;
mod sheets;
mod suggest;
mod wide;
mod word_in_name;
mod workbook;

pub(crate) use export::{column_of_people, has_row_of, refuse_export, told_as_export};
pub use imported::Imported;

use crate::{
    atomic_write::atomic_write_bytes,
    design::DesignFile,
    error::StudyError,
    gate::Gate,
    outcome::{Outcome, Watch},
    run_folder::{exclusions_path, read_scales},
    stage::{Files, Stage},
};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use columns::Columns;
use export::Export;
use imported::Imports;
use maveric_domain::{Design, design::Software};
use path_slash::PathExt as _;
use serde::Serialize;
use sheets::Orders;
use std::path::{Path, PathBuf};

/// Read answers as survey software exports them, and write the table that `score` takes
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
Example: maveric import answers.xlsx --columns columns.toml --out surveys.csv
         maveric import results.json --from jspsych --out surveys.csv
         maveric import --suggest answers.csv --out columns.toml")]
pub struct Import {
    /// The export, as it is: a table (CSV, TSV, .xlsx), or jsPsych's JSON
    pub file: PathBuf,
    /// What wrote it; found out by what stands in it when not given
    #[arg(long, value_parser = software(), value_name = "SOFTWARE")]
    pub from: Option<Software>,
    /// Design of the study (TOML), which says what conditions there are; study.toml of the current directory when not given,
    /// else the paper's
    #[arg(long, value_name = "FILE")]
    pub design: Option<PathBuf>,
    /// What its columns mean (TOML), where they are not called SCALE_ITEM
    #[arg(long)]
    pub columns: Option<PathBuf>,
    /// Sheet of a workbook; that of the map of columns, else the only one with something in it, when not given
    #[arg(long, value_name = "NAME")]
    pub sheet: Option<String>,
    /// Folder of questionnaire definitions; the design's when not given
    #[arg(long)]
    pub scales: Option<PathBuf>,
    /// Propose what its columns mean, with every doubt as a comment, instead of importing
    #[arg(long, conflicts_with = "columns")]
    pub suggest: bool,
    /// Answers to write: participant, moment, scale, item, answer, seconds where they were measured, and condition where something was
    /// asked at the end; with --suggest the map of columns, which is printed when not given
    #[arg(long, required_unless_present = "suggest")]
    pub out: Option<PathBuf>,
}

fn software() -> impl TypedValueParser<Value = Software> {
    let known = Software::IMPORTED;
    let by_id = move |word: String| known.into_iter().find(|software| software.id() == word);
    // No other word comes through.
    PossibleValuesParser::new(known.map(Software::id))
        .map(move |word| by_id(word).unwrap_or(Software::Wide))
}

#[derive(Debug, Clone, Serialize)]
#[serde(untagged)]
pub enum ImportResult {
    Imported(Imported),
    /// What its columns may mean.
    Suggested(SuggestedColumns),
}

/// A map of columns that was proposed for an export.
#[derive(Debug, Clone, Serialize)]
pub struct SuggestedColumns {
    pub software: Software,
    /// The map, TOML with its doubts as comments.
    pub columns: String,
}

impl Stage for Import {
    const NAME: &'static str = "import";
    const FAILURE: &'static str = "could not import the answers";
    type Result = ImportResult;

    fn files(&self, root: &Path) -> Result<Files, StudyError> {
        let study = DesignFile::below_or_paper(root, self.design.as_deref())?;
        let files = Files::default()
            .reads([&self.file])
            .reads([study.scales_folder(self.scales.as_deref())])
            .reads(&self.columns)
            .reads_people(root, self.design.as_deref(), None)
            .writes(&self.out);
        let beside = self.out.as_deref().filter(|_| !self.suggest).map(exclusions_path);
        Ok(files.writes(beside))
    }

    /// Imports answers and writes them as a long table: participant, moment, scale, item, answer, and seconds where the software measured
    /// them.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<ImportResult>, StudyError> {
        let study = DesignFile::find(self.design.as_deref())?;
        let scales = read_scales(&study.scales_folder(self.scales.as_deref()))?;
        let columns = Columns::new(self.columns.as_deref(), &scales, &study.design)?;
        let how = columns.map.how(self.sheet.as_deref());
        let export = Export::read(&self.file, self.from, how)?;
        let Some(out) = self.out.as_deref().filter(|_| !self.suggest) else {
            return self.suggested(&export, &columns, &study.design);
        };
        let own_design = DesignFile::here(self.design.as_deref())?;
        let gate = own_design.map(|study| Gate::where_listed(&study, None)).transpose()?;
        let contents = export.answers(&self.file, &columns, &orders(gate.as_ref()))?;
        watch.check()?;
        let reading = Imports {
            file: &self.file,
            export: &export,
            columns: &columns,
            design: &study.design,
            gate: gate.as_ref(),
        };
        Ok(reading.write(out, contents)?.map(ImportResult::Imported))
    }
}

impl Import {
    fn suggested(
        &self,
        export: &Export,
        columns: &Columns<'_>,
        design: &Design,
    ) -> Result<Outcome<ImportResult>, StudyError> {
        let proposed =
            suggest::columns_of(&self.file, export, columns, design, self.sheet.as_deref())?;
        let mut summary: Vec<String> = proposed.lines().map(str::to_owned).collect();
        if let Some(out) = &self.out {
            if map_file::is_filled_in(out)? {
                let problem =
                    "is filled in already, and a proposal is written over no map of columns";
                let help = "name a new file with --out, or leave out --out to have the proposal printed; then take over what you need";
                return Err(StudyError::file(out, problem).with_help(help));
            }
            atomic_write_bytes(out, proposed.as_bytes())?;
            summary = vec![format!("what the columns may mean: {}", out.to_slash_lossy())];
        }
        let value = ImportResult::Suggested(SuggestedColumns {
            software: export.software(),
            columns: proposed,
        });
        Ok(Outcome::new(value, summary, Vec::new()))
    }
}

/// The conditions of each person in the order of the rides.
fn orders(gate: Option<&Gate>) -> Orders {
    let people = gate.into_iter().flat_map(|gate| &gate.people().enrolled);
    people.map(|person| (person.id.clone(), person.order.clone())).collect()
}

#[cfg(test)]
mod tests;
