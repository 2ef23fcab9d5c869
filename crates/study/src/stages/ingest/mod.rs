//! `ingest`: raw logs to drives, one Parquet file each.

mod logs;

use crate::{
    design::DesignFile,
    error::StudyError,
    gate::{Gate, LeftOut, counted},
    outcome::{Outcome, Watch, for_each_on},
    tables::{
        TableBuilder,
        drives::{write_drive_list, write_drive_of},
    },
};
use maveric_domain::{Drive, DriveMeta};
use maveric_ingest::{Provenance, Warning, read_log};
use serde::Serialize;
use std::{
    collections::BTreeSet,
    fs::File,
    path::{Path, PathBuf},
};
use tempfile::TempDir;

/// What to ingest.
#[derive(Debug, Clone)]
pub struct IngestOptions {
    /// Logs, or folders of logs; none for all that the design names.
    pub logs: Vec<PathBuf>,
    /// The study's design; `study.toml` of the folder one stands in without. Without either every drive is let in.
    pub design: Option<PathBuf>,
    /// Who takes part; the design's table without.
    pub participants: Option<PathBuf>,
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
    /// Drives that the design does not let in, each with the rule.
    pub left_out: Vec<(DriveMeta, LeftOut)>,
}

/// A drive that is written but not yet in its place.
struct Written {
    /// The file in the folder aside.
    file: PathBuf,
    meta: DriveMeta,
    rows: usize,
    duration_s: f64,
    /// Whether any row has a lead vehicle.
    led: bool,
    warnings: Vec<Warning>,
}

/// Reads logs, finds reference vehicle, lane changes and following rows, and writes the drives.
///
/// Each drive is written as soon as it is read, into a hidden folder on the same disk, and all are renamed into `out`
/// at the end: memory holds one log a thread, and a log that cannot be read refuses the whole call with nothing
/// written. What was repaired or left out within a log is a warning, and a row of `exclusions.csv`.
///
/// # Errors
/// [`StudyError::Ingest`] naming the log; [`StudyError`] if two logs are one drive or a file cannot be written.
pub fn ingest(
    options: &IngestOptions,
    watch: Watch<'_>,
) -> Result<Outcome<IngestedDrives>, StudyError> {
    let study = DesignFile::here(options.design.as_deref())?;
    let gate = study
        .as_ref()
        .map(|study| Gate::of(study, options.participants.as_deref()))
        .transpose()?;
    let logs = logs::of(options, study.as_ref())?;
    let aside = Aside::new(&options.out)?;
    let numbered: Vec<(usize, &logs::Log)> = logs.iter().enumerate().collect();
    let written = for_each_on(options.jobs, &numbered, watch, "logs ingested", |log| {
        write_log(*log, aside.folder.path())
    })?;
    let (mut drives, left_out) = sorted_out(written.into_iter().flatten(), gate.as_ref());
    if let (true, Some((meta, why))) = (drives.is_empty(), left_out.first()) {
        return Err(StudyError::NotPossible {
            problem: format!("no drive is let in; {}: {why}", meta.drive),
            help: Some(
                "say whose drives these are under [names] of the mapping, or add people and conditions to the study".to_owned(),
            ),
        });
    }
    let mut ids = BTreeSet::new();
    if let Some(twice) = drives.iter().find(|d| !ids.insert(&d.meta.drive)) {
        return Err(StudyError::NotPossible {
            problem: format!(
                "two logs, or two vehicles of one, make the drive `{}`",
                twice.meta.drive
            ),
            help: Some("leave one of them out, or ingest them into two folders".to_owned()),
        });
    }
    watch.check()?;
    std::fs::create_dir_all(&options.out).map_err(StudyError::write(&options.out))?;
    for drive in &drives {
        let place = options.out.join(format!("{}.parquet", drive.meta.drive));
        std::fs::rename(&drive.file, &place).map_err(StudyError::write(&place))?;
    }
    write_exclusions(&options.out, &drives, &left_out)?;
    let mut warnings: Vec<String> = Vec::new();
    for drive in &drives {
        warnings.extend(drive.warnings.iter().map(Warning::to_string));
    }
    drives.sort_by(|a, b| a.meta.drive.cmp(&b.meta.drive));
    warnings.extend(drives.iter().filter(|d| !d.led).map(|d| {
        format!(
            "drive {}: no lead vehicle in any row; it cannot teach following or lane changes",
            d.meta.drive
        )
    }));
    warnings.extend(
        left_out
            .iter()
            .map(|(m, w)| format!("drive {}: {w}", m.drive)),
    );
    let rows = drives.iter().map(|d| d.rows).sum();
    let list: Vec<(DriveMeta, usize, f64)> = drives
        .into_iter()
        .map(|d| (d.meta, d.rows, d.duration_s))
        .collect();
    write_drive_list(&options.out, &list)?;
    let mut summary = vec![format!(
        "{} drives, {rows} rows: {}",
        list.len(),
        options.out.display()
    )];
    summary.extend(counted("drives", left_out.iter().map(|(_, why)| why)));
    Ok(Outcome {
        value: IngestedDrives {
            drives: list.into_iter().map(|l| l.0).collect(),
            rows,
            left_out,
        },
        summary,
        warnings,
    })
}

/// A hidden folder on the disk of `out`, in the nearest folder above that exists; it goes when it is dropped.
struct Aside {
    /// Held as long as the folder is in use: it says so to others, whatever ends this program.
    _lock: File,
    folder: TempDir,
}

impl Aside {
    const PREFIX: &str = ".ingest-";
    const LOCK: &str = "in-use";
    /// How far above `out` a call that was killed may have left its folder: `out` was made since.
    const LEVELS: usize = 4;

    /// Makes the folder, and removes those that killed calls left behind.
    fn new(out: &Path) -> Result<Self, StudyError> {
        let out = std::path::absolute(out).map_err(StudyError::write(out))?;
        let exists = out.ancestors().find(|folder| folder.is_dir());
        let place = exists.unwrap_or(&out);
        out.ancestors()
            .take(Self::LEVELS)
            .for_each(Self::remove_left_behind);
        let folder = tempfile::Builder::new()
            .prefix(Self::PREFIX)
            .tempdir_in(place)
            .map_err(StudyError::write(place))?;
        // Locked before it has its name, so that nobody finds it free; where the disk knows no locks nobody takes one.
        let (fresh, lock) = (folder.path().join("new"), folder.path().join(Self::LOCK));
        let file = File::create(&fresh).map_err(StudyError::write(&fresh))?;
        let _ = file.try_lock();
        std::fs::rename(&fresh, &lock).map_err(StudyError::write(&lock))?;
        Ok(Self {
            _lock: file,
            folder,
        })
    }

    /// Removes folders of other calls whose lock nobody holds any more. What cannot be removed stays: it does no harm.
    fn remove_left_behind(place: &Path) {
        for entry in std::fs::read_dir(place).into_iter().flatten().flatten() {
            let folder = entry.path();
            let ours = entry
                .file_name()
                .to_string_lossy()
                .starts_with(Self::PREFIX);
            if let Ok(lock) = File::options().write(true).open(folder.join(Self::LOCK))
                && ours
                && lock.try_lock().is_ok()
            {
                let _ = std::fs::remove_dir_all(&folder);
            }
        }
    }
}

/// The drives that are let in, and the others with the reason.
fn sorted_out(
    written: impl Iterator<Item = Written>,
    gate: Option<&Gate>,
) -> (Vec<Written>, Vec<(DriveMeta, LeftOut)>) {
    let (mut drives, mut left_out) = (Vec::new(), Vec::new());
    for drive in written {
        match gate.and_then(|gate| gate.drive(&drive.meta, drive.duration_s)) {
            None => drives.push(drive),
            Some(why) => left_out.push((drive.meta, why)),
        }
    }
    (drives, left_out)
}

/// Writes the drives of one log into a folder of its own in `aside`, so that equal names do not meet there.
fn write_log((number, log): (usize, &logs::Log), aside: &Path) -> Result<Vec<Written>, StudyError> {
    let provenance = Provenance::of(&log.path, log.mapping.as_deref(), &log.settings)?;
    let mut written = Vec::new();
    for (vehicle, found) in read_log(&log.path, &log.settings)?.into_iter().enumerate() {
        let drive = Drive::from_recording(found.meta, &found.recording)?;
        let folder = aside.join(format!("{number}-{vehicle}"));
        let rows = drive.rows();
        written.push(Written {
            file: write_drive_of(&folder, &drive, &provenance)?,
            meta: drive.meta().clone(),
            rows: drive.len(),
            duration_s: rows.time_s.last().copied().unwrap_or(0.0),
            led: rows.lead_present.contains(&true),
            warnings: found.warnings,
        });
    }
    Ok(written)
}

/// Writes what was repaired or left out, in the order of the logs, then the drives that the design does not let in.
fn write_exclusions(
    folder: &Path,
    drives: &[Written],
    left_out: &[(DriveMeta, LeftOut)],
) -> Result<(), StudyError> {
    let rows: Vec<(&DriveMeta, &Warning)> = drives
        .iter()
        .flat_map(|d| d.warnings.iter().map(move |w| (&d.meta, w)))
        .collect();
    let out = || left_out.iter();
    let log = |w: &Warning| {
        w.file
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned()
    };
    TableBuilder::default()
        .text(
            "drive",
            rows.iter()
                .map(|r| r.0)
                .chain(out().map(|o| &o.0))
                .map(|m| m.drive.as_str()),
        )
        .text(
            "log",
            rows.iter()
                .map(|r| log(r.1))
                .chain(out().map(|_| String::new())),
        )
        .text(
            "what",
            rows.iter()
                .map(|r| r.1.what.clone())
                .chain(out().map(|o| o.1.to_string())),
        )
        .integers(
            "count",
            rows.iter()
                .map(|r| i64::try_from(r.1.count).ok())
                .chain(out().map(|_| Some(1))),
        )
        .write(&folder.join("exclusions.csv"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::AtomicBool;

    const LOG: &str =
        "time_s,ego_x_m,ego_y_m,ego_speed_mps,lead_id,lead_dx_m,lead_dy_m,lead_speed_mps\n";

    fn table(rows: usize) -> String {
        let row = |i: usize| format!("{},{i},0,20,5,20,0,19\n", i as f64 / 20.0);
        LOG.to_owned() + &(0..rows).map(row).collect::<String>()
    }

    fn run(logs: Vec<PathBuf>, out: &Path) -> Result<Outcome<IngestedDrives>, StudyError> {
        let mappings = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../study_data/mappings");
        let options = IngestOptions {
            logs,
            design: None,
            participants: None,
            out: out.to_owned(),
            mapping: Some(mappings.join("ours.toml")),
            rate_hz: None,
            recover: false,
            jobs: 2,
        };
        let (quiet, go_on) = (|_: usize, _: usize, _: &str| (), AtomicBool::new(false));
        ingest(&options, Watch::new(&quiet, &go_on))
    }

    fn names(folder: &Path) -> BTreeSet<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        let name = |e: std::io::Result<std::fs::DirEntry>| e.unwrap().file_name();
        entries
            .map(|e| name(e).to_string_lossy().into_owned())
            .collect()
    }

    #[test]
    fn a_used_folder_keeps_no_drive_that_its_list_no_longer_has_and_no_other_file_goes() {
        let folder = tempfile::tempdir().unwrap();
        let (logs, out) = (folder.path().join("logs"), folder.path().join("drives"));
        std::fs::create_dir(&logs).unwrap();
        for log in ["S1P01-own", "S1P02-own"] {
            std::fs::write(logs.join(format!("{log}.csv")), table(400)).unwrap();
        }
        run(vec![logs.clone()], &out).unwrap();
        std::fs::write(out.join("mine.parquet"), "mine").unwrap();
        assert!(names(&out).contains("S1P02-own.parquet"));
        run(vec![logs.join("S1P01-own.csv")], &out).unwrap();
        let left = names(&out);
        assert!(left.contains("S1P01-own.parquet") && left.contains("mine.parquet"));
        assert!(!left.contains("S1P02-own.parquet"), "{left:?}");
    }

    #[test]
    fn drives_appear_together_and_one_log_that_cannot_be_read_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let (logs, out) = (
            folder.path().join("logs"),
            folder.path().join("made/drives"),
        );
        std::fs::create_dir(&logs).unwrap();
        for name in ["a.csv", "b.csv", "c.csv"] {
            std::fs::write(logs.join(name), table(100)).unwrap();
        }
        std::fs::write(logs.join("d.csv"), table(50).replace(",20,", ",fast,")).unwrap();
        let error = run(vec![logs.clone()], &out).unwrap_err();
        assert!(error.to_string().contains("d.csv"), "{error}");
        assert_eq!(names(folder.path()), BTreeSet::from(["logs".to_owned()]));

        std::fs::remove_file(logs.join("d.csv")).unwrap();
        let made = run(vec![logs.clone()], &out).unwrap();
        assert_eq!((made.value.drives.len(), made.value.rows), (3, 300));
        let expected = [
            "a.parquet",
            "b.parquet",
            "c.parquet",
            "drives.csv",
            "exclusions.csv",
        ];
        assert_eq!(names(&out), expected.map(str::to_owned).into());

        // What a killed call left behind goes at the next one, what another call is using does not.
        let (left, used) = (out.join(".ingest-left"), folder.path().join(".ingest-used"));
        for aside in [&left, &used] {
            std::fs::create_dir(aside).unwrap();
            std::fs::write(aside.join("in-use"), "").unwrap();
        }
        let lock = File::open(used.join("in-use")).unwrap();
        lock.try_lock().unwrap();
        run(vec![logs.clone()], &out).unwrap();
        assert!(!left.exists() && used.exists());
        drop(lock);

        // The same log twice is one drive twice; what stood there before stays.
        let before = std::fs::read(out.join("a.parquet")).unwrap();
        let error = run(vec![logs.clone(), logs.join("a.csv")], &out).unwrap_err();
        assert!(error.to_string().contains("make the drive"), "{error}");
        assert_eq!(names(&out).len(), 5);
        assert_eq!(std::fs::read(out.join("a.parquet")).unwrap(), before);
    }
}
