//! `ingest`: raw logs to drives, one Parquet file each.

use crate::{
    error::StudyError,
    outcome::{Outcome, Watch, for_each_on},
    tables::{
        TableBuilder,
        drives::{write_drive_list, write_drive_of},
    },
};
use maveric_domain::{Drive, DriveMeta};
use maveric_ingest::{IngestSettings, Mapping, Provenance, log_files, read_log};
use serde::Serialize;
use std::{collections::BTreeSet, path::PathBuf};

/// What to ingest.
#[derive(Debug, Clone)]
pub struct IngestOptions {
    /// Logs, or folders of logs.
    pub logs: Vec<PathBuf>,
    /// Folder to write into.
    pub out: PathBuf,
    /// What columns mean, for tables.
    pub mapping: Option<PathBuf>,
    /// Samples a second; 20 when neither this nor the mapping says otherwise.
    pub rate_hz: Option<f64>,
    /// Whether to take what can be read of a damaged log.
    pub recover: bool,
    /// Threads.
    pub jobs: usize,
}

/// What became of the logs.
#[derive(Debug, Clone, Serialize)]
pub struct IngestedDrives {
    /// The drives written.
    pub drives: Vec<DriveMeta>,
    /// Rows over all drives.
    pub rows: usize,
}

/// Reads logs, finds reference vehicle, lane changes and following rows, and writes the drives.
///
/// A drive that cannot be read refuses the whole call before anything is written; what was repaired or left out
/// within a log is a warning, and a row of `exclusions.csv`.
///
/// # Errors
/// [`StudyError::Ingest`] naming the log; [`StudyError`] if two logs are one drive or a file cannot be written.
pub fn ingest(
    options: &IngestOptions,
    watch: Watch<'_>,
) -> Result<Outcome<IngestedDrives>, StudyError> {
    let mapping = options.mapping.as_deref().map(Mapping::read).transpose()?;
    let settings = IngestSettings {
        mapping,
        rate_hz: options.rate_hz,
        recover: options.recover,
        ..IngestSettings::default()
    };
    let mut files = Vec::new();
    for log in &options.logs {
        let found = log_files(log, settings.mapping.as_ref())?;
        if found.is_empty() {
            return Err(StudyError::file(
                log,
                "holds no logs (.mcap, .csv, .tsv, .txt, .parquet)",
            ));
        }
        files.extend(found);
    }
    let logs = for_each_on(options.jobs, &files, watch, "logs read", |file| {
        let mut drives = Vec::new();
        let provenance = Provenance::of(file, options.mapping.as_deref(), &settings)?;
        for ingested in read_log(file, &settings)? {
            let drive = Drive::from_recording(ingested.meta, &ingested.recording)?;
            drives.push((drive, ingested.warnings, provenance.clone()));
        }
        Ok(drives)
    })?;
    let mut drives: Vec<(Drive, Provenance)> = Vec::new();
    let mut rows = Vec::new();
    let mut ids = BTreeSet::new();
    for (drive, warnings, provenance) in logs.into_iter().flatten() {
        let id = drive.meta().drive.to_string();
        if !ids.insert(id.clone()) {
            return Err(StudyError::NotPossible {
                problem: format!("two logs, or two vehicles of one, make the drive `{id}`"),
                help: Some("leave one of them out, or ingest them into two folders".to_owned()),
            });
        }
        rows.extend(warnings.into_iter().map(|w| (id.clone(), w)));
        drives.push((drive, provenance));
    }
    drives.sort_by(|a, b| a.0.meta().drive.cmp(&b.0.meta().drive));
    for_each_on(options.jobs, &drives, watch, "drives written", |drive| {
        write_drive_of(&options.out, &drive.0, &drive.1)
    })?;
    let drives: Vec<Drive> = drives.into_iter().map(|d| d.0).collect();
    let list: Vec<(DriveMeta, usize, f64)> = drives
        .iter()
        .map(|d| {
            (
                d.meta().clone(),
                d.len(),
                d.rows().time_s.last().copied().unwrap_or(0.0),
            )
        })
        .collect();
    write_drive_list(&options.out, &list)?;
    TableBuilder::default()
        .text("drive", rows.iter().map(|r| r.0.as_str()))
        .text(
            "log",
            rows.iter().map(|r| {
                r.1.file
                    .file_name()
                    .unwrap_or_default()
                    .to_string_lossy()
                    .into_owned()
            }),
        )
        .text("what", rows.iter().map(|r| r.1.what.as_str()))
        .integers("count", rows.iter().map(|r| i64::try_from(r.1.count).ok()))
        .write(&options.out.join("exclusions.csv"))?;
    let total = drives.iter().map(Drive::len).sum();
    let no_lead = drives
        .iter()
        .filter(|d| !d.rows().lead_present.iter().any(|&p| p));
    let mut said: Vec<String> = rows.iter().map(|r| r.1.to_string()).collect();
    said.extend(no_lead.map(|d| {
        format!(
            "drive {}: no lead vehicle in any row; it cannot teach following or lane changes",
            d.meta().drive
        )
    }));
    let summary = vec![format!(
        "{} drives, {total} rows: {}",
        drives.len(),
        options.out.display()
    )];
    Ok(Outcome {
        value: IngestedDrives {
            drives: list.into_iter().map(|l| l.0).collect(),
            rows: total,
        },
        summary,
        warnings: said,
    })
}
