//! `inspect`: what is in a log, a drive or a model.

mod lines;

use crate::{
    atomic_write::atomic_write_bytes,
    design::DesignFile,
    error::StudyError,
    once::count,
    outcome::{Outcome, Watch},
    run_folder::read_model,
    stage::{Files, Stage},
    stages::ingest::{Ingest, logs},
    tables::drives::write_samples,
    watching::{read_watched, write_watch_page},
};
use lines::{lines, one_line};
use maveric_domain::{Drive, DriveMeta, Sees};
use maveric_ingest::{
    IngestError, IngestSettings, LogSummary, Provenance, inspect_with, read_drive_from, read_log,
    suggest_mapping,
};
use maveric_model::{HEADS, Heads, HeadsKind};
use maveric_report::{
    Context,
    figures::drive_overview::{DriveOverview, drive_overview},
};
use path_slash::PathExt as _;
use serde::Serialize;
use std::{
    collections::BTreeMap,
    fs::File,
    io::Read as _,
    path::{Path, PathBuf},
};

/// Say what is in a log, a drive or a model: channels, columns, rates, gaps, what would be ingested and why not
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
Example: maveric inspect recording.mcap --format json
         maveric inspect P07-own.mcap av/logs/P07-*.mcap --watch P07.html
         maveric inspect --suggest-mapping drives.csv --into mapping.toml")]
pub struct Inspect {
    /// Files to look into
    #[arg(required_unless_present = "suggest_mapping")]
    pub files: Vec<PathBuf>,
    /// What the columns of a table mean (TOML); of a log of the study whose study.toml is in the current directory, the design's when not
    /// given
    #[arg(long)]
    pub mapping: Option<PathBuf>,
    /// Propose a mapping for this table, with its doubts as comments
    #[arg(long, value_name = "FILE", conflicts_with_all = ["files", "mapping", "plot", "watch", "csv"])]
    pub suggest_mapping: Option<PathBuf>,
    /// Write the proposed mapping as this file, which must not be there yet
    #[arg(long, value_name = "OUT.toml", requires = "suggest_mapping")]
    pub into: Option<PathBuf>,
    /// Draw speed, gap and lane of the first file over time
    #[arg(long, value_name = "OUT.png")]
    pub plot: Option<PathBuf>,
    /// Write a page that plays the drives of all files side by side; logs only
    #[arg(long, value_name = "OUT.html")]
    pub watch: Option<PathBuf>,
    /// Write the rows of the first file's drive, one a sample
    #[arg(long, value_name = "OUT.csv")]
    pub csv: Option<PathBuf>,
}

/// A mapping that was proposed for a table.
#[derive(Debug, Clone, Serialize)]
pub struct SuggestedMapping {
    pub path: PathBuf,
    /// The mapping, TOML with its doubts as comments.
    pub mapping: String,
}

/// Proposes a mapping for a table; as a file of its own where one is named.
///
/// # Errors
/// [`StudyError::Ingest`] for what is no table or has no proposal; [`StudyError::BadFile`] where the file is there already.
fn suggest(path: &Path, into: Option<&Path>) -> Result<Outcome<Looked>, StudyError> {
    if let Some(into) = into.filter(|into| into.symlink_metadata().is_ok()) {
        let problem = "is there already, and a proposal is written over no mapping";
        let help = "name a new file with --into, and take [names] and [road] over into it from the mapping that you have";
        return Err(StudyError::file(into, problem).with_help(help));
    }
    let mapping = suggest_mapping(path)?;
    let summary = match into {
        None => mapping.lines().map(str::to_owned).collect(),
        Some(into) => {
            atomic_write_bytes(into, mapping.as_bytes())?;
            let doubts = mapping.lines().filter(|l| l.starts_with("# doubt: ")).count();
            let doubts = count(doubts, "doubt", "doubts");
            vec![format!("mapping with {doubts}, each in a comment: {}", into.to_slash_lossy())]
        }
    };
    let value = Looked::Mapping(SuggestedMapping { path: path.to_owned(), mapping });
    Ok(Outcome::new(value, summary, Vec::new()))
}

#[derive(Debug, Clone, Serialize)]
#[serde(untagged)]
pub enum Looked {
    Files(InspectedFiles),
    /// Of a table: what its columns may mean.
    Mapping(SuggestedMapping),
}

#[derive(Debug, Clone, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Inspected {
    Log(Box<LogSummary>),
    /// A drive that was ingested.
    Drive {
        meta: DriveMeta,
        rate_hz: f64,
        rows: usize,
        duration_s: f64,
        segments: usize,
        /// Rows with a reference vehicle.
        lead_rows: usize,
        /// Rows in which ego follows its reference vehicle.
        following_rows: usize,
        lane_changes: usize,
        sees: Sees,
        /// What it was made from, by key.
        provenance: BTreeMap<String, String>,
    },
    Model {
        heads: HeadsKind,
        embedding_size: usize,
        parameters: usize,
        /// Drives that it learned from.
        drives: usize,
        /// Names of the heads that had something to learn from.
        learned: Vec<String>,
        /// Whether it reads a score from a style.
        aggression: bool,
    },
}

/// What the files hold, in their order.
#[derive(Debug, Clone, Serialize)]
pub struct InspectedFiles {
    pub files: Vec<InspectedFile>,
}

/// What one file holds, with its path.
#[derive(Debug, Clone, Serialize)]
pub struct InspectedFile {
    pub path: PathBuf,
    #[serde(flatten)]
    pub content: Inspected,
}

fn begins_with(path: &Path, magic: &[u8]) -> Result<bool, StudyError> {
    if path.is_dir() {
        // A folder may be a log, but is never one of our own files.
        return Ok(false);
    }
    let mut start = Vec::new();
    let file = File::open(path).map_err(StudyError::read(path))?;
    file.take(magic.len() as u64).read_to_end(&mut start).map_err(StudyError::read(path))?;
    Ok(start == magic)
}

impl Stage for Inspect {
    const NAME: &'static str = "inspect";
    const FAILURE: &'static str = "could not inspect";
    type Result = Looked;

    fn files(&self, root: &Path) -> Result<Files, StudyError> {
        let mut files = Files::default();
        if self.mapping.is_none()
            && !self.files.is_empty()
            && let Some(study) = DesignFile::below(root, None)
        {
            let named = Ingest { logs: self.files.clone(), ..Ingest::default() };
            files = logs::declared_files(files.reads_design(None), &named, &study);
        }
        Ok(files
            .reads(&self.files)
            .reads(&self.mapping)
            .reads(&self.suggest_mapping)
            .writes(&self.into)
            .writes(&self.plot)
            .writes(&self.watch)
            .writes(&self.csv))
    }

    /// Says what each file holds; draws the first one's drive if asked to.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<Looked>, StudyError> {
        if let Some(path) = &self.suggest_mapping {
            return suggest(path, self.into.as_deref());
        }
        let study = match self.mapping {
            Some(_) => None,
            None => DesignFile::below(Path::new(""), None),
        };
        let settings_of =
            |path: &PathBuf| logs::settings_of(path, self.mapping.as_deref(), study.as_ref());
        let settings = self.files.iter().map(settings_of);
        let settings: Vec<IngestSettings> = settings.collect::<Result<_, _>>()?;
        let mut files = Vec::new();
        let mut summary = Vec::new();
        for (done, (path, settings)) in self.files.iter().zip(&settings).enumerate() {
            let content = look_into(path, settings)?;
            summary.push(format!("{}", path.to_slash_lossy()));
            summary.extend(lines(&content).iter().map(|line| format!("  {}", one_line(line))));
            files.push(InspectedFile { path: path.clone(), content });
            watch.step(done + 1, self.files.len(), "files")?;
        }
        let first = self.files.first().zip(settings.first());
        if let (Some(out), Some((first, settings))) = (&self.plot, first) {
            plot(first, settings, out)?;
            summary.push(format!("picture: {}", out.to_slash_lossy()));
        }
        if let (Some(out), Some((first, settings))) = (&self.csv, first) {
            let drive = any_drive(first, settings)?;
            write_samples(out, &drive)?;
            summary.push(format!("{} rows: {}", drive.len(), out.to_slash_lossy()));
        }
        if let Some(out) = &self.watch {
            let drives = self.files.iter().zip(&settings);
            let drives = drives.map(|(path, settings)| read_watched(path, settings));
            let drives: Vec<_> = drives.collect::<Result<Vec<_>, _>>()?.concat();
            let logs = self.files.iter().map(|path| path.to_slash_lossy().into_owned());
            let provenance = [
                ("Version", env!("CARGO_PKG_VERSION").to_owned()),
                ("Logs", logs.collect::<Vec<_>>().join(", ")),
            ]
            .map(|(name, value)| (name.to_owned(), value));
            write_watch_page(out, drives, None, &provenance)?;
            summary.push(format!("drives to watch: {}", out.to_slash_lossy()));
        }
        let value = Looked::Files(InspectedFiles { files });
        Ok(Outcome::new(value, summary, Vec::new()))
    }
}

/// The drive in a file of ours; none for another table in Parquet.
fn own_drive(path: &Path) -> Result<Option<(Drive, Provenance)>, StudyError> {
    if !begins_with(path, b"PAR1")? {
        return Ok(None);
    }
    match read_drive_from(path) {
        Ok(found) => Ok(Some(found)),
        Err(IngestError::NotADrive { .. }) => Ok(None),
        Err(error) => Err(error.into()),
    }
}

fn look_into(path: &Path, settings: &IngestSettings) -> Result<Inspected, StudyError> {
    if let Some((drive, provenance)) = own_drive(path)? {
        let rows = drive.rows();
        return Ok(Inspected::Drive {
            meta: drive.meta().clone(),
            rate_hz: drive.rate_hz(),
            rows: drive.len(),
            duration_s: rows.time_s.last().copied().unwrap_or(0.0) - rows.time_s[0],
            segments: rows.segment.last().map_or(0, |s| *s as usize + 1),
            lead_rows: rows.lead_present.iter().filter(|p| **p).count(),
            following_rows: rows.following.iter().filter(|f| **f).count(),
            lane_changes: drive.lane_changes().iter().filter(|c| c.completed).count(),
            sees: drive.sees(),
            provenance: provenance.entries.into_iter().collect(),
        });
    }
    if begins_with(path, b"maveric-model")? {
        let model = read_model(path)?;
        let learned = match model.heads() {
            Heads::Linear(linear) => {
                let heads = linear.heads.iter().zip(&HEADS).filter(|(h, _)| h.learned());
                heads.map(|(_, head)| head.title.to_owned()).collect()
            }
            Heads::Paper(paper) => {
                let learned = paper.learned();
                [
                    (learned.following_distance, "following distance"),
                    (learned.lane_change, "lane change"),
                ]
                .into_iter()
                .filter(|(known, _)| *known)
                .map(|(_, name)| name.to_owned())
                .collect()
            }
        };
        return Ok(Inspected::Model {
            heads: model.kind(),
            embedding_size: model.embedding_size(),
            parameters: model.parameters(),
            drives: model.training().len(),
            learned,
            aggression: model.knows_aggression(),
        });
    }
    Ok(Inspected::Log(Box::new(inspect_with(path, settings)?)))
}

/// The drive in a file of ours, or the first of a log.
fn any_drive(path: &Path, settings: &IngestSettings) -> Result<Drive, StudyError> {
    if let Some((drive, _)) = own_drive(path)? {
        return Ok(drive);
    }
    let Some(log) = read_log(path, settings)?.into_iter().next() else {
        return Err(StudyError::file(path, "holds no drive"));
    };
    Ok(Drive::from_recording(log.meta, &log.recording)?)
}

fn plot(path: &Path, settings: &IngestSettings, out: &Path) -> Result<(), StudyError> {
    let drive = any_drive(path, settings)?;
    let rows = drive.rows();
    let lead = rows.lead_present.iter().zip(&rows.lead_dx_m);
    let input = DriveOverview {
        drive: drive.meta().drive.to_string(),
        source: path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        time_s: rows.time_s.clone(),
        segment: rows.segment.clone(),
        speed_mps: rows.ego_speed_mps.clone(),
        gap_m: lead.map(|(&present, &dx)| present.then_some(dx)).collect(),
        lane: rows.lane.clone(),
        lanes: drive.road().lanes,
    };
    atomic_write_bytes(out, &drive_overview(&input, &Context::real())?.png()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_ingest::Mapping;

    #[test]
    fn a_drive_as_this_program_writes_it_is_known_by_its_columns() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("P01-calm.csv");
        let proposed = |heads: &str| {
            let row = |i: u32| format!("{},{},20,25,19\n", f64::from(i) / 20.0, i);
            let rows: String = (0..100).map(row).collect();
            std::fs::write(&path, format!("{heads}\n{rows}")).unwrap();
            suggest_mapping(&path).unwrap()
        };
        let ours = proposed("time_s,ego_x_m,ego_speed_mps,lead_dx_m,lead_speed_mps");
        for said in [
            "study_data/mappings/ours.toml",
            "Read by it: 1 drive, 100 rows",
            "gap = \"lead_dx_m\"",
            "# participant = ",
        ] {
            assert!(ours.contains(said), "{said} in {ours}");
        }
        let mapping = folder.path().join("mapping.toml");
        std::fs::write(&mapping, ours).unwrap();
        assert!(Mapping::read(&mapping).is_ok());
        // Without a column that it asks for it is a table like another.
        let other = proposed("time_s,ego_x_m,ego_speed_mps,lead_dx_m,speed_ahead");
        assert!(!other.contains("ours.toml"), "{other}");
    }

    #[test]
    fn a_proposal_is_written_as_a_file_of_its_own_and_never_over_one_that_is_there() {
        let folder = tempfile::tempdir().unwrap();
        let (table, into) = (folder.path().join("pair.csv"), folder.path().join("mapping.toml"));
        let row = |i: u32| format!("{},{},20,25\n", f64::from(i) / 10.0, 2 * i);
        let rows: String = (0..50).map(row).collect();
        std::fs::write(&table, format!("t,x_follower,v_follower,spacing\n{rows}")).unwrap();
        let propose = || {
            let inspect = Inspect {
                files: Vec::new(),
                mapping: None,
                suggest_mapping: Some(table.clone()),
                into: Some(into.clone()),
                plot: None,
                watch: None,
                csv: None,
            };
            inspect.run(Watch::unwatched())
        };
        let proposed = propose().unwrap();
        let written = std::fs::read_to_string(&into).unwrap();
        assert_eq!(written, suggest_mapping(&table).unwrap());
        assert!(Mapping::read(&into).is_ok());
        assert_eq!(proposed.summary.len(), 1);
        let said = &proposed.summary[0];
        assert!(
            said.contains("mapping.toml") && said.contains("doubts, each in a comment"),
            "{said}"
        );
        std::fs::write(&into, "# mine\n[names]\n").unwrap();
        let error = propose().unwrap_err();
        assert!(error.to_string().contains("is there already"), "{error}");
        assert_eq!(std::fs::read_to_string(&into).unwrap(), "# mine\n[names]\n");
    }
}
