//! `ingest`: raw logs to drives, one Parquet file each.

pub(crate) mod logs;
mod parts;
mod told;

pub(crate) use logs::{logs_of, of_study as logs_of_study};

use crate::{
    aside::Aside,
    design::DesignFile,
    error::StudyError,
    gate::{Gate, counted},
    once::count,
    outcome::{Outcome, Watch, for_each_on},
    outputs::{put_in_place, spare_inputs},
    stage::{Files, Stage},
    stages::orders,
    tables::{
        TableName,
        drives::{ExclusionRow, former_drives, refuse_foreign, write_drive_list, write_drive_of},
        keys::one_case_of,
        write_rows,
    },
};
use maveric_analysis::Why;
use maveric_domain::{Drive, DriveId, DriveMeta, Sees, occasion::is_first};
use maveric_ingest::{IngestError, Provenance, Warning, begins_ns, read_log};
use path_slash::PathExt as _;
use serde::Serialize;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};
use told::{none_ingested, sights, warnings};

/// Turn driving logs (MCAP, CSV, Parquet) into evenly sampled drives
#[derive(Debug, Clone, Default, clap::Args)]
#[command(after_help = "Example: maveric ingest logs/study1 --out drives/study1")]
pub struct Ingest {
    /// Logs, or folders of logs; those of the design when none are given
    pub logs: Vec<PathBuf>,
    /// Design of the study (TOML); study.toml of the current directory when not given. Without either nothing is left out
    #[arg(long, value_name = "FILE")]
    pub design: Option<PathBuf>,
    /// Who takes part; the design's table when not given
    #[arg(long)]
    pub participants: Option<PathBuf>,
    /// Folder to write into: one Parquet file a drive, drives.csv, exclusions.csv; drives of an earlier call in it are removed
    #[arg(long)]
    pub out: PathBuf,
    /// What the columns of a table mean (TOML); needed for tables
    #[arg(long)]
    pub mapping: Option<PathBuf>,
    /// Samples a second
    #[arg(long = "rate", value_name = "RATE")]
    pub rate_hz: Option<f64>,
    /// Take what can be read of a damaged log, and say what could not
    #[arg(long)]
    pub recover: bool,
    /// End well although logs could not be ingested, as long as one drive came through: exclusions.csv lists them
    #[arg(long)]
    pub keep_going: bool,
    /// Threads
    #[arg(short, long, default_value_t = crate::outcome::all_cores())]
    pub jobs: usize,
}

/// What became of the logs.
#[derive(Debug, Clone, Serialize)]
pub struct IngestedDrives {
    pub drives: Vec<DriveMeta>,
    pub rows: usize,
    /// Drives that the design does not let in, each with the rule.
    pub left_out: Vec<LeftOutDrive>,
    /// Logs that could not be ingested, each with the reason.
    pub failed: Vec<FailedLog>,
}

/// A log that could not be ingested.
#[derive(Debug, Clone, Serialize)]
pub struct FailedLog {
    pub log: PathBuf,
    /// The error, with what caused it.
    pub why: String,
}

/// A drive that the design does not let in.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LeftOutDrive {
    pub log: PathBuf,
    pub meta: DriveMeta,
    /// How long it took, in s.
    pub duration_s: f64,
    /// By which rule, and why.
    pub why: Why,
}

/// A drive that is written but not yet in its place.
struct Written {
    /// The file in the folder aside.
    file: PathBuf,
    log: PathBuf,
    meta: DriveMeta,
    rows: usize,
    duration_s: f64,
    /// When its log began, in ns since 1970, where its clock says it.
    begins_ns: Option<u64>,
    /// Whether any row has a lead vehicle.
    led: bool,
    sees: Sees,
    warnings: Vec<Warning>,
}

impl Stage for Ingest {
    const NAME: &'static str = "ingest";
    const FAILURE: &'static str = "could not ingest";
    type Result = IngestedDrives;

    fn files(&self, root: &Path) -> Result<Files, StudyError> {
        let design = self.design.as_deref();
        let files = Files::default()
            .reads(&self.logs)
            .reads(&self.mapping)
            .reads_people(root, design, self.participants.as_deref())
            .writes_into(&self.out, &["drives.csv", "exclusions.csv"]);
        Ok(match DesignFile::below(root, design) {
            Some(study) => logs::declared_files(files, self, &study),
            None => files,
        })
    }

    fn is_success(&self, drives: &IngestedDrives) -> bool {
        self.keep_going || drives.failed.is_empty()
    }

    /// Reads logs, finds reference vehicle, lane changes and following rows, and writes the drives.
    ///
    /// Each drive is written as soon as it is read, into a hidden folder on the same disk, and all are renamed into `out`
    /// at the end: memory holds one log a thread. A log that cannot be read is listed with its reason, and so is what was repaired or
    /// left out within a log: a warning, and a row of `exclusions.csv`.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<IngestedDrives>, StudyError> {
        let study = DesignFile::here(self.design.as_deref())?;
        let gate = study
            .as_ref()
            .map(|study| Gate::of_drives(study, self.participants.as_deref()))
            .transpose()?;
        let logs = logs::named_or_declared(self, study.as_ref())?;
        let (list, exclusions) = (self.out.join("drives.csv"), self.out.join("exclusions.csv"));
        let tables = logs
            .iter()
            .filter_map(|log| log.mapping.as_deref())
            .chain(logs.iter().map(|log| &*log.path));
        spare_inputs(tables, [&*list, &exclusions])?;
        let aside = Aside::new(&self.out)?;
        let numbered: Vec<(usize, &logs::Log)> = logs.iter().enumerate().collect();
        let written = for_each_on(self.jobs, &numbered, watch, "logs ingested", |log| {
            log_or_why(*log, aside.path())
        })?;
        let mut failed = Vec::new();
        let read = written.into_iter().filter_map(|log| log.map_err(|e| failed.push(e)).ok());
        let (mut drives, left_out) = sorted_out(read.flatten(), gate.as_ref());
        if drives.is_empty() {
            return Err(none_ingested(&left_out, failed, gate.as_ref()));
        }
        let failed: Vec<FailedLog> = failed.into_iter().map(FailedLog::from).collect();
        none_twice(&drives)?;
        one_case_of(drives.iter().map(|drive| &drive.meta.participant))?;
        if let (Some(study), Some(gate)) = (&study, &gate) {
            orders_agree(study, self.participants.as_deref(), gate, &drives)?;
        }
        watch.check()?;
        spare_logs(&self.out, &logs, &drives)?;
        refuse_foreign(&self.out, drives.iter().map(|d| d.meta.drive.as_str()))?;
        std::fs::create_dir_all(&self.out).map_err(StudyError::write(&self.out))?;
        for drive in &drives {
            put_in_place(&drive.file, &place_of(&self.out, &drive.meta.drive))?;
        }
        write_exclusions(&self.out, &drives, &left_out, &failed)?;
        drives.sort_by(|a, b| a.meta.drive.cmp(&b.meta.drive));
        let warnings = warnings(&drives, &left_out, &failed, gate.as_ref());
        let sights = sights(&drives);
        let rows = drives.iter().map(|d| d.rows).sum();
        let list: Vec<(DriveMeta, usize, f64)> =
            drives.into_iter().map(|d| (d.meta, d.rows, d.duration_s)).collect();
        write_drive_list(&self.out, &list)?;
        let mut summary = vec![format!(
            "{}, {rows} rows: {}",
            count(list.len(), "drive", "drives"),
            self.out.to_slash_lossy()
        )];
        summary.extend(sights);
        summary.extend(counted(["drive", "drives"], left_out.iter().map(|out| &out.why)));
        if !failed.is_empty() {
            summary.push(format!(
                "{} of {} logs could not be ingested: see {}",
                failed.len(),
                logs.len(),
                exclusions.to_slash_lossy()
            ));
        }
        let value = IngestedDrives {
            drives: list.into_iter().map(|l| l.0).collect(),
            rows,
            left_out,
            failed,
        };
        Ok(Outcome::new(value, summary, warnings))
    }
}

/// The file of a drive in a folder.
fn place_of(folder: &Path, drive: &DriveId) -> PathBuf {
    folder.join(format!("{drive}.parquet"))
}

/// Refuses to write a drive over a log, or to remove a drive of an earlier call that is a log of this one.
///
/// # Errors
/// [`StudyError::BadFile`] naming the log.
fn spare_logs(out: &Path, logs: &[logs::Log], drives: &[Written]) -> Result<(), StudyError> {
    let former = former_drives(out, drives.iter().map(|d| d.meta.drive.as_str()));
    let ids = drives.iter().map(|d| &d.meta.drive);
    let places: Vec<PathBuf> = ids.chain(&former).map(|drive| place_of(out, drive)).collect();
    // In a folder that is one log itself, Parquet is of an earlier call.
    let files = logs.iter().map(|log| &*log.path).filter(|log| log.is_file());
    spare_inputs(files, places.iter().map(|place| &**place))
}

/// Writes the drives of a log aside; why there are none where the log is at fault.
fn log_or_why(
    log: (usize, &logs::Log),
    aside: &Path,
) -> Result<Result<Vec<Written>, (PathBuf, IngestError)>, StudyError> {
    match write_log(log, aside) {
        Ok(written) => Ok(Ok(written)),
        Err(StudyError::Ingest(error)) => Ok(Err((log.1.path.clone(), error))),
        Err(StudyError::Domain(source)) => {
            let path = log.1.path.clone();
            Ok(Err((path.clone(), IngestError::Refused { path, source })))
        }
        Err(error) => Err(error),
    }
}

fn none_twice(drives: &[Written]) -> Result<(), StudyError> {
    let mut made = BTreeMap::new();
    let twice = drives.iter().find_map(|second| {
        let first = made.insert(&second.meta.drive, second)?;
        Some((first, second))
    });
    if let Some((first, second)) = twice {
        let drive = &second.meta.drive;
        let [one, other] = [first, second].map(|made| made.log.to_slash_lossy());
        let problem = if one == other {
            format!(
                "{one} makes the drive `{drive}` twice: it is named twice, or two of its vehicles have one name"
            )
        } else {
            format!("{one} and {other} both make the drive `{drive}`")
        };
        let help = "leave one of them out, or ingest them into two folders";
        return Err(StudyError::not_possible(problem).with_help(help));
    }
    Ok(())
}

/// The drives that are let in, and the others with the reason. What is told of a whole log stays with the first of its drives that is in.
fn sorted_out(
    written: impl Iterator<Item = Written>,
    gate: Option<&Gate>,
) -> (Vec<Written>, Vec<LeftOutDrive>) {
    let (mut drives, mut left_out) = (Vec::new(), Vec::new());
    let mut of_logs: BTreeMap<PathBuf, Vec<Warning>> = BTreeMap::new();
    for mut drive in written {
        match gate.and_then(|gate| gate.drive(&drive.meta, drive.duration_s)) {
            None => {
                let of_log = of_logs.remove(&drive.log);
                drive.warnings.extend(of_log.into_iter().flatten());
                drives.push(drive);
            }
            Some(why) => {
                drive.warnings.retain(|warning| warning.of_file);
                let of_log = of_logs.entry(drive.log.clone()).or_default();
                of_log.append(&mut drive.warnings);
                left_out.push(LeftOutDrive {
                    log: drive.log,
                    meta: drive.meta,
                    duration_s: drive.duration_s,
                    why,
                });
            }
        }
    }
    (drives, left_out)
}

/// Refuses an order of somebody's that their logs contradict.
fn orders_agree(
    study: &DesignFile,
    participants: Option<&Path>,
    gate: &Gate,
    drives: &[Written],
) -> Result<(), StudyError> {
    let table = study.people_file(participants);
    for (row, person) in gate.people().enrolled.iter().enumerate() {
        let theirs = drives.iter().filter(|d| d.meta.participant == person.id);
        let ridden = theirs.filter(|d| study.design.condition(d.meta.condition).is_some());
        let recorded = ridden.map(|d| (d.meta.condition, d.begins_ns)).collect();
        orders::agrees(&table, row, person, &recorded)?;
    }
    Ok(())
}

/// Writes the drives of one log into a folder of its own in `aside`, so that equal names do not meet there.
fn write_log((number, log): (usize, &logs::Log), aside: &Path) -> Result<Vec<Written>, StudyError> {
    let mut written = Vec::new();
    for (vehicle, found) in read_log(&log.path, &log.settings)?.into_iter().enumerate() {
        let provenance = Provenance::of(&found.sources, log.mapping.as_deref(), &log.settings)?;
        let drive = Drive::from_recording(found.meta, &found.recording)?;
        let folder = aside.join(format!("{number}-{vehicle}"));
        let rows = drive.rows();
        written.push(Written {
            file: write_drive_of(&folder, &drive, &provenance)?,
            log: log.path.clone(),
            meta: drive.meta().clone(),
            rows: drive.len(),
            duration_s: rows.time_s.last().copied().unwrap_or(0.0),
            begins_ns: begins_ns(&log.path),
            led: rows.lead_present.contains(&true),
            sees: drive.sees(),
            warnings: found.warnings,
        });
    }
    Ok(written)
}

/// Writes what was repaired or left out, in the order of the logs, then the drives that the design does not let in, then the
/// logs that could not be ingested.
fn write_exclusions(
    folder: &Path,
    drives: &[Written],
    left_out: &[LeftOutDrive],
    failed: &[FailedLog],
) -> Result<(), StudyError> {
    let name = |file: &Path| {
        let name = file.file_name().unwrap_or_default();
        name.to_string_lossy().into_owned()
    };
    let warnings = drives.iter().flat_map(|d| d.warnings.iter().map(move |w| (&d.meta, w)));
    let repaired = warnings.map(|(meta, w)| ExclusionRow {
        drive: meta.drive.to_string(),
        log: name(&w.file),
        what: w.what.clone(),
        count: w.count,
        ..ExclusionRow::default()
    });
    let kept_out = left_out.iter().map(|out| ExclusionRow {
        drive: out.meta.drive.to_string(),
        log: name(&out.log),
        what: out.why.to_string(),
        count: 1,
        participant: out.meta.participant.to_string(),
        condition: out.meta.condition.to_string(),
        session: Some(out.meta.session).filter(|n| !is_first(n)),
        trial: Some(out.meta.trial).filter(|n| !is_first(n)),
        rule: out.why.rule.key().to_owned(),
        duration_s: Some(out.duration_s),
    });
    let lost = failed.iter().map(|log| ExclusionRow {
        log: name(&log.log),
        what: log.to_string(),
        count: 1,
        ..ExclusionRow::default()
    });
    let rows = repaired.chain(kept_out).chain(lost);
    write_rows(TableName::Exclusions, &folder.join("exclusions.csv"), rows)
}

#[cfg(test)]
mod tests;
