//! `README.md`: what a stranger reads first.

use super::{
    left_out::LeftOut,
    options::Exported,
    outcomes::compared,
    place::files,
    ro_crate::{About, PIPELINE},
    surveys::Answered,
};
use crate::{
    atomic_write::atomic_write_bytes, error::StudyError, once::count, tables::dictionary::entry_at,
    texts,
};
use maveric_analysis::{Flow, Observed};
use maveric_domain::{ConditionId, Design, design::Condition};
use minijinja::context;
use std::path::Path;

/// What the files are that are no tables, and folders.
const OTHERS: [(&str, &str); 8] = [
    (
        "logs/",
        "The drives: who was where on the road, a recording each (MCAP), from time 0 and position 0 on.",
    ),
    (
        "drives/",
        "The same drives as tables, a row a sample: the signals that the measures are computed from.",
    ),
    ("scales/", "The questionnaires: range, items, reversed items and scores of each (TOML)."),
    ("study.toml", "The design: conditions, factors, outcomes, hypotheses, rules of exclusion."),
    ("scenario.toml", "The road and the traffic of what was simulated or driven in the seat."),
    ("codebook.md", "The questionnaires and the study’s own measures, for people."),
    (
        "pipeline.toml",
        "The stages by which the results were made, with what was set for their run.",
    ),
    ("seat/", "What happened in the seat, and which text was agreed to."),
];

pub(super) struct Holds<'a> {
    pub(super) counts: &'a Exported,
    /// None where nothing was analysed.
    pub(super) flow: Option<&'a Flow>,
    /// The design's, where anything of it is there.
    pub(super) baseline: Option<ConditionId>,
    /// Whether the pipeline has the files of the export.
    pub(super) runs_here: bool,
}

/// Writes it; the other files are there.
pub(super) fn write(
    out: &Path,
    design: &Design,
    about: &About,
    holds: &Holds<'_>,
    observed: &[Observed],
    answered: &Answered,
    left_out: &LeftOut,
) -> Result<(), StudyError> {
    let files = files(out)?;
    let (counts, flow) = (holds.counts, holds.flow);
    let label = |id| format!("{} (`{id}`)", design.label(id));
    let conditions = design.conditions().iter().map(|c| label(c.id));
    let table = ["outcomes_long.csv", "surveys.csv", "participants.csv"];
    let ending = |ending: &str| files.iter().find(|f| f.ends_with(ending)).cloned();
    let values = context! {
        title => design.title(),
        authors => design.authors().join(", "),
        year => about.date.get(..4),
        date => about.date.as_str(),
        version => about.version.as_str(),
        licence => about.licence.as_deref(),
        participants => count(counts.participants, "person", "people"),
        drives => count(counts.drives, "drive", "drives"),
        answers => count(counts.answers, "answer", "answers"),
        recruited => flow.map(|f| f.recruited),
        analysed => flow.map(|f| f.analysed),
        left_out => left_out.lines(),
        baseline => holds.baseline.map(label),
        of_style => design.style().is_some(),
        numbers => &answered.numbers,
        simulated => design.conditions().iter().any(Condition::simulated),
        has_pipeline => files.iter().any(|name| name == PIPELINE),
        runs_here => holds.runs_here,
        conditions => conditions.collect::<Vec<_>>(),
        made_up => design.synthetic(),
        table => table.into_iter().find(|name| files.iter().any(|f| f == name)),
        compared => compared(design, observed).map(|columns| columns.join(",")),
        parquet => ending(".parquet"),
        log => ending(".mcap"),
        files => rows(&files, answered),
    };
    let text = texts::fill(texts::EXPORT_README, values);
    atomic_write_bytes(&out.join("README.md"), text.as_bytes())
}

/// A row a file, and one a folder: its name, and what it holds.
fn rows(files: &[String], answered: &Answered) -> Vec<Vec<String>> {
    let answers = format!("Answers, a row an item: {}.", answered.moments.join(", "));
    let mut rows: Vec<Vec<String>> = Vec::new();
    for file in files {
        let folder = file.split_once('/').map(|(folder, _)| format!("{folder}/"));
        let name = folder.unwrap_or_else(|| file.clone());
        if rows.iter().any(|row| row[0] == name) {
            continue;
        }
        let other = OTHERS.iter().find(|(known, _)| *known == name);
        let entry = || entry_at(file).map(|entry| entry.about.trim());
        let of_answers = (name == "surveys.csv").then_some(answers.as_str());
        let about = other.map(|(_, about)| *about);
        let about = about.or(of_answers).or_else(entry);
        rows.push(vec![name, about.unwrap_or_default().to_owned()]);
    }
    rows
}
