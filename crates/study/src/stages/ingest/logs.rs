//! Which logs are read, and by which mapping.

use super::Ingest;
use crate::{design::DesignFile, error::StudyError, stage::Files};
use maveric_domain::{ParticipantId, design::Mappings};
use maveric_ingest::{IngestSettings, Mapping, log_files, log_parts, read_log};
use std::path::{Path, PathBuf};

/// A log, and how it is read.
#[derive(Debug, Clone)]
pub(crate) struct Log {
    pub(crate) path: PathBuf,
    pub(super) mapping: Option<PathBuf>,
    pub(crate) settings: IngestSettings,
}

/// The logs that were named; none named, every log below the folders of the design, each rig by its own mapping.
///
/// # Errors
/// [`StudyError::BadFile`] for a folder without logs; [`StudyError::Ingest`] for a mapping that is none.
pub(crate) fn named_or_declared(
    options: &Ingest,
    study: Option<&DesignFile>,
) -> Result<Vec<Log>, StudyError> {
    gathered(options, study, true)
}

/// Every log below the folders of a design; none where they hold none.
pub(crate) fn of_study(options: &Ingest, study: &DesignFile) -> Result<Vec<Log>, StudyError> {
    gathered(options, Some(study), false)
}

/// The logs of somebody, and those that hold drives of others beside theirs or wait for their mapping. Another log that cannot be read is
/// nobody's.
pub(crate) fn logs_of(
    study: &DesignFile,
    id: &ParticipantId,
) -> Result<(Vec<PathBuf>, Vec<PathBuf>), StudyError> {
    let (mut theirs, mut shared) = (Vec::new(), Vec::new());
    for log in of_study(&Ingest::default(), study)? {
        let Ok(drives) = read_log(&log.path, &log.settings) else {
            // Whose it is, a mapping that is not there would say.
            if declared(study, &log.path).is_some_and(|file| !file.is_file()) {
                shared.push(log.path);
            }
            continue;
        };
        let files = log_parts(&log.path, log.settings.mapping.as_ref())?;
        let count = drives.iter().filter(|d| d.meta.participant == *id).count();
        if count > 0 && count == drives.len() {
            theirs.extend(files);
        } else if count > 0 {
            shared.extend(files);
        }
    }
    Ok((theirs, shared))
}

/// How a file is read by itself: by `mapping`; else, where it is one of a study's logs, as the study reads it. What lies elsewhere, such as
/// a drive that was made here, has no mapping.
///
/// # Errors
/// [`StudyError::Ingest`] for a mapping that is none.
pub(crate) fn settings_of(
    path: &Path,
    mapping: Option<&Path>,
    study: Option<&DesignFile>,
) -> Result<IngestSettings, StudyError> {
    let among = |study: &&DesignFile| {
        let files = study.design.files();
        let below = || absolute(path).starts_with(absolute(&study.resolve(&files.logs)));
        matches!(files.mapping, Mappings::Rigs(_)) || below()
    };
    let of_study = || {
        let file = study.filter(among).and_then(|study| declared(study, path));
        file.filter(|file| file.is_file())
    };
    let mapping = mapping.map(Path::to_owned).or_else(of_study);
    Ok(settings(&Ingest::default(), mapping)?.1)
}

/// The files with the mappings that a design has for these logs, and with the logs that it names where none are named.
pub(crate) fn declared_files(files: Files, options: &Ingest, study: &DesignFile) -> Files {
    let declared = study.design.files();
    let named = !options.logs.is_empty();
    let (folders, mappings) = match &declared.mapping {
        Mappings::One(file) => (Vec::new(), vec![file]),
        Mappings::Rigs(rigs) => (
            rigs.iter().map(|rig| &rig.logs).collect(),
            rigs.iter().filter_map(|rig| rig.file.as_ref()).collect(),
        ),
    };
    let folders = folders.into_iter().chain([&declared.logs]);
    let folders = folders.filter(|_| !named).map(|path| study.resolve(path));
    let mappings = mappings.into_iter().filter(|_| options.mapping.is_none());
    files.reads_if_there(folders).reads_if_there(mappings.map(|path| study.resolve(path)))
}

/// As [`of`]; a folder without logs is an error where some are `needed`.
fn gathered(
    options: &Ingest,
    study: Option<&DesignFile>,
    needed: bool,
) -> Result<Vec<Log>, StudyError> {
    let some = |folder: &Path, logs| {
        if needed { refuse_none(folder, logs) } else { Ok(logs) }
    };
    let standing = |folder: &Path, mapping: Option<&Mapping>, apart: &[PathBuf]| {
        if needed || folder.is_dir() { below(folder, mapping, apart) } else { Ok(Vec::new()) }
    };
    let mut gathered: Vec<Log> = Vec::new();
    // What needs no logs does without a mapping that is not there.
    let there = |file: &PathBuf| needed || file.is_file();
    let mapping_of = |path: &Path| match (&options.mapping, study) {
        (Some(given), _) => Some(given.clone()),
        (None, Some(study)) => declared(study, path).filter(there),
        (None, None) => None,
    };
    if !options.logs.is_empty() {
        for path in &options.logs {
            let (mapping, settings) = settings(options, mapping_of(path))?;
            let mut logs = log_files(path, settings.mapping.as_ref())?;
            // What an earlier call made of them are no logs, and parts of a recording are one log however many are named.
            let part = |log: &PathBuf| path.is_file() && log != path;
            let known = |log: &PathBuf| gathered.iter().any(|other| other.path == *log);
            logs.retain(|log| !(made_in(&options.out, path, log) || part(log) && known(log)));
            if logs.is_empty() && path.is_file() {
                continue;
            }
            gathered.extend(read_by(some(path, logs)?, mapping.as_ref(), &settings));
        }
        return Ok(gathered);
    }
    let Some(study) = study else {
        let problem = "no logs are named, and there is no design that names them";
        let help = "name logs or folders of logs, or give --design study.toml";
        return Err(StudyError::not_possible(problem).with_help(help));
    };
    let files = study.design.files();
    let all_logs = study.resolve(&files.logs);
    let mut rigs: Vec<PathBuf> = Vec::new();
    if let Mappings::Rigs(mappings) = &files.mapping {
        // A folder in another rig's, or the one of all logs, may be a rig's too: each log is read once.
        rigs.extend(mappings.iter().map(|rig| study.resolve(&rig.logs)));
        for (rig, folder) in mappings.iter().zip(&rigs) {
            let file = options.mapping.clone();
            let file = file.or_else(|| {
                let own = rig.file.as_ref().map(|f| study.resolve(f));
                own.filter(there)
            });
            let (mapping, settings) = settings(options, file)?;
            let logs = standing(folder, settings.mapping.as_ref(), &rigs)?;
            gathered.extend(read_by(some(folder, logs)?, mapping.as_ref(), &settings));
        }
    }
    let (mapping, settings) = settings(options, mapping_of(&all_logs))?;
    if !rigs.contains(&all_logs) && (all_logs.is_dir() || rigs.is_empty()) {
        let logs = standing(&all_logs, settings.mapping.as_ref(), &rigs)?;
        if rigs.is_empty() {
            some(&all_logs, logs.clone())?;
        }
        gathered.extend(read_by(logs, mapping.as_ref(), &settings));
    }
    Ok(gathered)
}

/// The mapping that a design has for a log or a folder of logs: that of the rig in whose folder it lies, where rigs have their own.
fn declared(study: &DesignFile, path: &Path) -> Option<PathBuf> {
    let mappings = &study.design.files().mapping;
    match mappings {
        // The usual one may be yet to come: recordings need none.
        Mappings::One(file) => Some(study.resolve(file))
            .filter(|file| *mappings != Mappings::default() || file.is_file()),
        Mappings::Rigs(rigs) => rigs
            .iter()
            .map(|rig| (absolute(&study.resolve(&rig.logs)), &rig.file))
            .filter(|(folder, _)| absolute(path).starts_with(folder))
            .max_by_key(|(folder, _)| folder.components().count())
            .and_then(|(_, file)| file.as_ref().map(|file| study.resolve(file))),
    }
}

fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

/// Whether a log lies in the folder of the results, which lies below the one that was named.
fn made_in(out: &Path, named: &Path, log: &Path) -> bool {
    let (out_of, named) = (absolute(out), absolute(named));
    let below = !out.as_os_str().is_empty() && out_of != named && out_of.starts_with(named);
    below && absolute(log).starts_with(out_of)
}

fn settings(
    options: &Ingest,
    mapping: Option<PathBuf>,
) -> Result<(Option<PathBuf>, IngestSettings), StudyError> {
    let settings = IngestSettings {
        mapping: mapping.as_deref().map(Mapping::read).transpose()?,
        rate_hz: options.rate_hz,
        recover: options.recover,
        ..IngestSettings::default()
    };
    Ok((mapping, settings))
}

fn read_by(logs: Vec<PathBuf>, mapping: Option<&PathBuf>, settings: &IngestSettings) -> Vec<Log> {
    let log = |path| Log { path, mapping: mapping.cloned(), settings: settings.clone() };
    logs.into_iter().map(log).collect()
}

fn refuse_none(folder: &Path, logs: Vec<PathBuf>) -> Result<Vec<PathBuf>, StudyError> {
    if logs.is_empty() {
        let problem = "holds no logs (.mcap, .csv, .tsv, .txt, .parquet)";
        return Err(StudyError::file(folder, problem));
    }
    Ok(logs)
}

/// The logs below a folder, without those that lie in another one of `apart`.
fn below(
    folder: &Path,
    mapping: Option<&Mapping>,
    apart: &[PathBuf],
) -> Result<Vec<PathBuf>, StudyError> {
    let inner = |other: &&PathBuf| *other != folder && other.starts_with(folder);
    let mut logs = log_files(folder, mapping)?;
    logs.retain(|log| !apart.iter().filter(inner).any(|other| log.starts_with(other)));
    Ok(logs)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_of_the_study_has_its_mapping_and_a_file_from_elsewhere_the_one_that_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let design = "[study]\ntitle = \"t\"\n[[condition]]\nid = \"calm\"\n[[condition]]\nid = \"sporty\"\n";
        std::fs::write(at("study.toml"), design).unwrap();
        std::fs::write(at("mapping.toml"), "rate_hz = 10\n").unwrap();
        std::fs::write(at("other.toml"), "rate_hz = 5\n").unwrap();
        let study = DesignFile::read(&at("study.toml")).unwrap();
        let rate = |log: &str, mapping: Option<&str>, study: Option<&DesignFile>| {
            let mapping = mapping.map(at);
            let settings = settings_of(&at(log), mapping.as_deref(), study).unwrap();
            settings.rate_hz().unwrap()
        };
        let is = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found}");
        is(rate("logs/day1/a.csv", None, Some(&study)), 10.0);
        is(rate("av/logs/a.mcap", None, Some(&study)), 20.0);
        is(rate("logs/a.csv", None, None), 20.0);
        is(rate("logs/a.csv", Some("other.toml"), Some(&study)), 5.0);
    }

    #[test]
    fn a_mapping_that_is_not_there_hinders_only_what_needs_logs() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let rigs = "[{ logs = \"rig\", file = \"rig.toml\" }]";
        let study = |mapping: &str| {
            let design = format!(
                "[study]\ntitle = \"t\"\n[[condition]]\nid = \"calm\"\n[files]\nmapping = {mapping}\n"
            );
            std::fs::write(at("study.toml"), design).unwrap();
            DesignFile::read(&at("study.toml")).unwrap()
        };
        for mapping in ["\"rig.toml\"", rigs] {
            let study = study(mapping);
            let options = Ingest::default();
            assert!(of_study(&options, &study).unwrap().is_empty());
            let error = named_or_declared(&options, Some(&study)).unwrap_err();
            assert!(error.to_string().contains("rig.toml"), "{error}");
            assert!(settings_of(&at("rig/a.csv"), None, Some(&study)).is_ok());
        }
        std::fs::create_dir(at("logs")).unwrap();
        std::fs::write(at("logs/a.csv"), "no table\n").unwrap();
        let who = ParticipantId::new("P02").unwrap();
        let (theirs, shared) = logs_of(&study("\"rig.toml\""), &who).unwrap();
        assert!(theirs.is_empty());
        assert_eq!(shared, [at("logs/a.csv")]);
    }
}
