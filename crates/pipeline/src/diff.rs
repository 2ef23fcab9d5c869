//! What two runs differ in: what they were made from, and the numbers that came out.

mod numbers;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use crate::content::Hasher;
use crate::paths::with_ancestors;
use crate::{FactKind, Ledger, PipelineError, Reason, Record};

/// A run: its ledger and where its files are.
#[derive(Debug)]
pub struct RunAt {
    /// What each output was made from.
    pub ledger: Ledger,
    /// Its relative paths start here.
    pub root: PathBuf,
    /// The variant; `None` for what was run without one.
    pub variant: Option<String>,
}

impl RunAt {
    fn records(&self) -> BTreeMap<&str, &Record> {
        self.ledger.variant(self.variant.as_deref())
    }
}

/// What two runs differ in.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct RunDifference {
    /// Stages that only the first run has.
    pub only_first: Vec<String>,
    /// Stages that only the second run has.
    pub only_second: Vec<String>,
    /// Stages of both in which anything differs, by name.
    pub stages: Vec<StageDifference>,
    /// How many stages of both are the same in everything.
    pub same: usize,
}

/// What a stage differs in.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct StageDifference {
    /// Its name, with that of its branch in a fan-out.
    pub stage: String,
    /// Command, parameters, versions and inputs that differ, as if the first run were
    /// before the second.
    pub made_from: Vec<Reason>,
    /// Output files that differ.
    pub outputs: Vec<FileDifference>,
}

/// An output file that differs. Parameters in which paths start (`{out}/scores.csv`) are
/// left in braces, so that runs into different directories can be compared.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum FileDifference {
    /// Only one run has it.
    OnlyIn {
        /// Relative to the root, parameters as `{name}`.
        path: String,
        /// Whether it is the first run.
        first: bool,
    },
    /// A picture.
    Figure {
        /// Relative to the root, parameters as `{name}`.
        path: String,
    },
    /// A table or a JSON file.
    Numbers {
        /// Relative to the root, parameters as `{name}`.
        path: String,
        /// How many numbers were compared.
        compared: usize,
        /// How many of them differ.
        differing: usize,
        /// Those that differ most, relative to their size; at most ten.
        largest: Vec<NumberDifference>,
        /// Places (rows, columns, keys) that only one file has; at most ten.
        unpaired: Vec<String>,
        /// Texts that differ, with both; at most ten.
        texts: Vec<String>,
    },
    /// Anything else.
    Content {
        /// Relative to the root, parameters as `{name}`.
        path: String,
    },
    /// A file that is no longer what its run had made, so that it cannot be compared.
    Gone {
        /// Relative to the root, parameters as `{name}`.
        path: String,
        /// Whether it is the first run's.
        first: bool,
    },
}

/// A number that differs.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct NumberDifference {
    /// Where: `row, column` of a table, `/key/key` of a JSON file.
    pub at: String,
    /// In the first run.
    pub first: f64,
    /// In the second run.
    pub second: f64,
}

/// Compares two runs stage by stage.
///
/// # Errors
/// If a file cannot be read.
pub fn diff(first: &RunAt, second: &RunAt) -> Result<RunDifference, PipelineError> {
    let (before, now) = (first.records(), second.records());
    let names = |run: &BTreeMap<&str, &Record>| {
        let names = run.keys().map(|name| (*name).to_owned());
        names.collect::<BTreeSet<_>>()
    };
    let (a, b) = (names(&before), names(&now));
    let mut stages = Vec::new();
    let mut same = 0;
    for stage in a.intersection(&b) {
        let (before, now) = (before[stage.as_str()], now[stage.as_str()]);
        let templated = |record: &Record| {
            let params = path_params(record);
            let rename = |path: &str| template(path, &params);
            record.made_from.clone().with_inputs_renamed(rename)
        };
        let mut made_from = templated(before).differences(&templated(now));
        // Another folder is no difference.
        let moved = |name: &String| is_root(before, name) && is_root(now, name);
        made_from.retain(
            |reason| !matches!(reason, Reason::ParameterChanged { name, .. } if moved(name)),
        );
        let outputs = outputs(before, now, &first.root, &second.root)?;
        if made_from.is_empty() && outputs.is_empty() {
            same += 1;
        } else {
            stages.push(StageDifference { stage: stage.clone(), made_from, outputs });
        }
    }
    Ok(RunDifference {
        only_first: a.difference(&b).cloned().collect(),
        only_second: b.difference(&a).cloned().collect(),
        stages,
        same,
    })
}

/// Whether the parameter's value is where outputs of a run begin.
fn is_root(record: &Record, name: &str) -> bool {
    let mut facts = record.made_from.facts(FactKind::Parameter);
    let value = facts.find(|(param, _)| *param == name).map(|(_, v)| v);
    let value = value.and_then(crate::paths::normalise);
    value.is_some_and(|value| {
        let mut above = record.outputs.keys().flat_map(|o| with_ancestors(o));
        above.any(|above| above == value)
    })
}

/// Parameters whose values may start a path, the longest value first.
fn path_params(record: &Record) -> Vec<(String, String)> {
    let facts = record.made_from.facts(FactKind::Parameter);
    let owned = |(name, value): (&str, &str)| (name.to_owned(), value.to_owned());
    let mut params: Vec<_> = facts.map(owned).filter(|(_, v)| !v.is_empty()).collect();
    params.sort_by(|a, b| b.1.len().cmp(&a.1.len()).then_with(|| a.0.cmp(&b.0)));
    params
}

fn template(path: &str, params: &[(String, String)]) -> String {
    for (name, value) in params {
        if let Some(rest) = path.strip_prefix(value.as_str())
            && (rest.is_empty() || rest.starts_with('/'))
        {
            return format!("{{{name}}}{rest}");
        }
    }
    path.to_owned()
}

/// The outputs by their paths with parameters in braces: real path and recorded content.
fn templated_outputs(record: &Record) -> BTreeMap<String, (&String, &String)> {
    let params = path_params(record);
    let outputs = record.outputs.iter();
    outputs.map(|(path, content)| (template(path, &params), (path, content))).collect()
}

fn outputs(
    before: &Record,
    now: &Record,
    first: &Path,
    second: &Path,
) -> Result<Vec<FileDifference>, PipelineError> {
    let (a, b) = (templated_outputs(before), templated_outputs(now));
    let mut differences = Vec::new();
    for path in a.keys().chain(b.keys()).collect::<BTreeSet<_>>() {
        let ((a_path, a_content), (b_path, b_content)) = match (a.get(path), b.get(path)) {
            (Some(a), Some(b)) => (*a, *b),
            (one, _) => {
                let (path, first) = (path.clone(), one.is_some());
                differences.push(FileDifference::OnlyIn { path, first });
                continue;
            }
        };
        if a_content == b_content {
            continue;
        }
        let is_there = |root, path: &String, content| {
            let content_now = Hasher::reading_all(root).content(path)?;
            Ok::<_, PipelineError>(content_now.as_ref() == Some(content))
        };
        for (is_there, first) in [
            (is_there(first, a_path, a_content)?, true),
            (is_there(second, b_path, b_content)?, false),
        ] {
            if !is_there {
                let path = path.clone();
                differences.push(FileDifference::Gone { path, first });
            }
        }
        if !matches!(differences.last(), Some(FileDifference::Gone { path: gone, .. }) if gone == path)
        {
            let (a, b) = (first.join(a_path), second.join(b_path));
            compare(path, &a, &b, &mut differences)?;
        }
    }
    Ok(differences)
}

/// Adds what two files, or all files of two directories, differ in.
fn compare(
    path: &str,
    a: &Path,
    b: &Path,
    differences: &mut Vec<FileDifference>,
) -> Result<(), PipelineError> {
    if a.is_dir() && b.is_dir() {
        let names = |folder: &Path| -> Result<BTreeSet<String>, PipelineError> {
            let failed = || PipelineError::io("read the directory", folder);
            let entries = fs::read_dir(folder).map_err(failed())?;
            let name = |entry: std::io::Result<fs::DirEntry>| {
                Ok(entry?.file_name().to_string_lossy().into_owned())
            };
            entries.map(name).collect::<std::io::Result<_>>().map_err(failed())
        };
        let (in_a, in_b) = (names(a)?, names(b)?);
        for name in in_a.union(&in_b) {
            let path = format!("{path}/{name}");
            if in_a.contains(name) && in_b.contains(name) {
                compare(&path, &a.join(name), &b.join(name), differences)?;
            } else {
                let first = in_a.contains(name);
                differences.push(FileDifference::OnlyIn { path, first });
            }
        }
        return Ok(());
    }
    let read = |path: &Path| fs::read(path).map_err(PipelineError::io("read", path));
    let (a, b) = (read(a)?, read(b)?);
    if a != b {
        differences.push(file_difference(path.to_owned(), &a, &b));
    }
    Ok(())
}

fn file_difference(path: String, a: &[u8], b: &[u8]) -> FileDifference {
    let extension = Path::new(&path).extension().unwrap_or_default().to_string_lossy();
    let cells = match &*extension.to_ascii_lowercase() {
        "json" => numbers::json_cells(a).zip(numbers::json_cells(b)),
        "csv" => numbers::csv_cells(a, b',').zip(numbers::csv_cells(b, b',')),
        "tsv" => numbers::csv_cells(a, b'\t').zip(numbers::csv_cells(b, b'\t')),
        "svg" | "png" | "pdf" | "jpg" | "jpeg" => {
            return FileDifference::Figure { path };
        }
        _ => None,
    };
    match cells {
        Some((a, b)) => numbers::difference(path, &a, &b),
        None => FileDifference::Content { path },
    }
}

impl RunDifference {
    /// The differences as a person reads them.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = Vec::new();
        for (stages, run) in [(&self.only_first, "first"), (&self.only_second, "second")] {
            if !stages.is_empty() {
                lines.push(format!("only in the {run} run: {}", stages.join(", ")));
            }
        }
        for stage in &self.stages {
            lines.push(format!("stage {}", stage.stage));
            lines.extend(stage.made_from.iter().map(|reason| format!("    {reason}")));
            lines.extend(stage.outputs.iter().flat_map(FileDifference::lines));
        }
        let noun = if self.same == 1 { "stage is" } else { "stages are" };
        lines.push(format!("{} {noun} the same in both", self.same));
        lines
    }
}

impl FileDifference {
    fn lines(&self) -> Vec<String> {
        let which = |first: &bool| if *first { "first" } else { "second" };
        match self {
            Self::OnlyIn { path, first } => {
                vec![format!("  {path}: only in the {} run", which(first))]
            }
            Self::Figure { path } => vec![format!("  {path}: another picture")],
            Self::Content { path } => vec![format!("  {path}: another content")],
            Self::Gone { path, first } => vec![format!(
                "  {path}: differs, but is no longer what the {} run had made",
                which(first)
            )],
            Self::Numbers { path, compared, differing, largest, unpaired, texts } => {
                let what = match (compared, differing) {
                    (0, _) => "has other texts".to_owned(),
                    (_, 0) => format!("all {compared} numbers are the same, other parts differ"),
                    _ => format!("{differing} of {compared} numbers differ"),
                };
                let mut lines = vec![format!("  {path}: {what}")];
                let number =
                    |n: &NumberDifference| format!("    {}: {} -> {}", n.at, n.first, n.second);
                lines.extend(largest.iter().map(number));
                if *differing > largest.len() {
                    lines.push(format!("    and {} more", differing - largest.len()));
                }
                lines.extend(texts.iter().map(|text| format!("    {text}")));
                lines.extend(unpaired.iter().map(|at| format!("    {at}")));
                lines
            }
        }
    }
}
