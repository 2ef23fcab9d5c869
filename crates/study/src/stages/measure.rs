//! `measure`: the objective measures, a row a drive.

use crate::{
    design::DesignFile,
    error::StudyError,
    gate::{Gate, counted},
    outcome::{Outcome, Watch},
    outputs::spare_inputs,
    tables::{
        drives::read_drives,
        measurements::{MeasuredDrive, write_measurements},
    },
};
use maveric_domain::DriveId;
use path_slash::PathExt as _;
use serde::Serialize;
use std::{collections::BTreeMap, path::PathBuf};

/// What to measure.
#[derive(Debug, Clone)]
pub struct MeasureOptions {
    /// The study's design; `study.toml` of the folder one stands in without. Without either every drive is measured.
    pub design: Option<PathBuf>,
    /// Who takes part; the design's table without.
    pub participants: Option<PathBuf>,
    /// Folders of drives.
    pub drives: Vec<PathBuf>,
    /// Table to write.
    pub out: PathBuf,
}

/// What was measured.
#[derive(Debug, Clone, Serialize)]
pub struct Measured {
    /// Number of drives.
    pub drives: usize,
    /// The measures: code names, in order.
    pub measures: Vec<&'static str>,
    /// How many drives have no value, a measure each, in that order.
    pub missing: Vec<usize>,
}

/// Measures every drive of the folders.
///
/// # Errors
/// [`StudyError`] if a drive cannot be read or the table not written.
pub fn measure(
    options: &MeasureOptions,
    watch: Watch<'_>,
) -> Result<Outcome<Measured>, StudyError> {
    let given = [&options.design, &options.participants];
    let given = given.into_iter().filter_map(Option::as_deref);
    let folders = options.drives.iter().map(|folder| &**folder);
    spare_inputs(given.chain(folders), [&*options.out])?;
    let measures = maveric_measures::objective::all();
    let names: Vec<&'static str> = measures.iter().map(|m| m.name).collect();
    let study = DesignFile::here(options.design.as_deref())?;
    let gate = study
        .map(|study| Gate::of(&study, options.participants.as_deref()))
        .transpose()?;
    let (mut rows, mut left_out) = (Vec::new(), Vec::new());
    let mut from: BTreeMap<DriveId, &PathBuf> = BTreeMap::new();
    for (done, folder) in options.drives.iter().enumerate() {
        for drive in read_drives(folder)? {
            watch.check()?;
            if let Some(first) = from.insert(drive.meta().drive.clone(), folder) {
                return Err(StudyError::BadFile {
                    path: folder.clone(),
                    problem: format!(
                        "holds drive {}, which {} holds too",
                        drive.meta().drive,
                        first.to_slash_lossy()
                    ),
                    help: Some(
                        "measure each drive once: leave out one of the folders or files".to_owned(),
                    ),
                });
            }
            let duration_s = drive.rows().time_s.last().copied().unwrap_or(0.0);
            let why = gate
                .as_ref()
                .and_then(|g| g.drive(drive.meta(), duration_s));
            if let Some(why) = why {
                left_out.push((drive.meta().drive.clone(), why));
                continue;
            }
            let values = measures
                .iter()
                .map(|m| (m.name.to_owned(), m.of(&drive)))
                .collect();
            rows.push(MeasuredDrive {
                meta: drive.meta().clone(),
                values,
            });
        }
        watch.step(done + 1, options.drives.len(), "folders measured")?;
    }
    write_measurements(&options.out, &names, &rows)?;
    let missing: Vec<usize> = names
        .iter()
        .map(|name| rows.iter().filter(|r| r.values[*name].is_none()).count())
        .collect();
    let mut warnings: Vec<String> = measures
        .iter()
        .zip(&missing)
        .filter(|(_, count)| **count > 0)
        .map(|(m, count)| {
            format!(
                "{count} of {} drives have no {}: {}",
                rows.len(),
                m.title.to_lowercase(),
                m.why_missing
            )
        })
        .collect();
    warnings.extend(
        left_out
            .iter()
            .map(|(drive, why)| format!("drive {drive}: {why}")),
    );
    let mut summary = vec![format!(
        "{} drives measured: {}",
        rows.len(),
        options.out.to_slash_lossy()
    )];
    summary.extend(counted("drives", left_out.iter().map(|(_, why)| why)));
    Ok(Outcome {
        value: Measured {
            drives: rows.len(),
            measures: names,
            missing,
        },
        summary,
        warnings,
    })
}

#[cfg(test)]
mod tests {
    use maveric_measures::objective;

    #[test]
    fn the_page_of_outputs_says_of_each_measure_what_it_says_of_itself() {
        let page = include_str!("../../../../docs/outputs.md");
        let (_, said) = page.split_once("## `measurements.parquet`").unwrap();
        let said = said.split("\n## ").next().unwrap();
        let rows = said.lines().filter(|line| line.starts_with("| `"));
        let own = objective::all().iter().map(|m| {
            let what = m.description.trim_end_matches('.');
            format!("| `{}` | {what} ({}) |", m.name, m.unit)
        });
        assert!(own.eq(rows.skip(4)));
    }
}
