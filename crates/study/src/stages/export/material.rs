//! What a study has to give away.

use super::{
    options::ExportOptions,
    own::{self, OwnRow},
    seat::Collected,
    sources::Sources,
};
use crate::{
    design::DesignFile,
    error::StudyError,
    outcome::{Watch, for_each_on},
    run_folder::read_study,
    stages::ingest::FailedLog,
    tables::{
        participants::{Enrolled, read_enrolled},
        surveys::{read_answered, refuse_unclear},
    },
};
use maveric_analysis::StudyData;
use maveric_domain::{
    Answer, ConditionId, Design, DriveId, DriveMeta, DrivenBy, ParticipantId, ProbeAnswer,
    Recording,
};
use maveric_ingest::{IngestError, IngestSettings, Ingested, named_after, read_log};
use path_slash::PathExt as _;
use std::path::Path;

/// A drive whose log cannot be read, and what is to be said where it is let in.
pub(super) type Unread = (DriveMeta, StudyError);

/// People, answers, drives, what the seat collected, the study's own measures, and what was analysed.
#[derive(Default)]
pub(super) struct Material {
    pub(super) people: Vec<Enrolled>,
    pub(super) answers: Vec<Answer>,
    pub(super) probes: Vec<ProbeAnswer>,
    pub(super) drives: Vec<(DriveMeta, Recording)>,
    /// Drives whose logs cannot be read: they have to be left out.
    pub(super) unread: Vec<Unread>,
    pub(super) collected: Collected,
    pub(super) own: Vec<OwnRow>,
    pub(super) outcomes: Option<StudyData>,
    /// What of it could not be read, where the rest can be given away without.
    pub(super) doubts: Vec<String>,
}

impl Material {
    /// Reads all of it.
    ///
    /// # Errors
    /// [`StudyError`] for a file that is not what it should be; [`StudyError::NotPossible`] where there is nothing.
    pub(super) fn read(
        options: &ExportOptions,
        sources: &Sources,
        study: &DesignFile,
        watch: Watch<'_>,
    ) -> Result<Self, StudyError> {
        let design = &study.design;
        let mut material = Self::default();
        if let Some(path) = &sources.participants {
            material.people = read_enrolled(path, design)?;
        }
        for path in &sources.surveys {
            let answered = read_answered(path)?;
            refuse_unclear(path, &answered.answers, design)?;
            material.answers.extend(answered.answers);
            material.probes.extend(answered.probes);
        }
        if let Some(folder) = &sources.seat {
            material.collected = Collected::read(folder, options.notes)?;
        }
        if let Some(path) = &sources.measures {
            material.own = own::read(path, study)?;
        }
        if material.is_empty() && sources.logs.is_empty() {
            let help = "run this in the folder of a study, or give at least one of --logs, --participants, --surveys and --seat";
            return Err(StudyError::not_possible("there is nothing to export").with_help(help));
        }
        let read = for_each_on(options.jobs, &sources.logs, watch, "logs read", |log| {
            read_or_named(&log.path, &log.settings, design)
        })?;
        for (drives, unread) in read {
            let drives = drives.into_iter().map(|d| (d.meta, d.recording));
            material.drives.extend(drives);
            material.unread.extend(unread);
        }
        if let Some(results) = &sources.results {
            match read_study(results, study, None) {
                Ok(data) => material.outcomes = Some(data),
                Err(error) => material.doubts.push(format!(
                    "there are no outcomes to give away in {} (`maveric run` makes them): {error}",
                    results.to_slash_lossy()
                )),
            }
        }
        Ok(material)
    }

    fn is_empty(&self) -> bool {
        let tables = self.people.is_empty() && self.answers.is_empty() && self.own.is_empty();
        let tables = tables && self.probes.is_empty();
        tables && self.drives.is_empty() && self.collected.is_empty()
    }

    /// Whether anything was driven, measured or answered in a condition.
    pub(super) fn has(&self, condition: ConditionId) -> bool {
        let drove = self.drives.iter().any(|d| d.0.condition == condition);
        let measured = self.own.iter().any(|row| row.condition == condition);
        let mut answers = self.answers.iter();
        drove || measured || answers.any(|a| a.moment.condition() == Some(condition))
    }

    /// Everybody who is in it.
    pub(super) fn ids(&self) -> impl Iterator<Item = &ParticipantId> {
        let people = self.people.iter().map(|p| &p.id);
        let answered = self.answers.iter().map(|a| &a.participant);
        let drove = self.drives.iter().map(|d| &d.0.participant);
        let measured = self.own.iter().map(|row| &row.participant);
        let analysed = self.outcomes.iter().flat_map(|data| &data.participants);
        let probed = self.probes.iter().map(|p| &p.participant);
        let tables = people.chain(answered).chain(probed).chain(drove).chain(measured);
        tables.chain(analysed).chain(self.collected.people())
    }
}

/// The drives of a log; of one that cannot be read and whose name says whose it is, that and the error.
///
/// # Errors
/// Where nothing says whose it is.
fn read_or_named(
    log: &Path,
    settings: &IngestSettings,
    design: &Design,
) -> Result<(Vec<Ingested>, Option<Unread>), StudyError> {
    let error = match read_log(log, settings) {
        Ok(drives) => return Ok((drives, None)),
        Err(error) => error,
    };
    match named(log, settings, design) {
        Some(meta) => {
            let id = DriveId::in_condition(&meta.participant, meta.ride());
            let id = id.unwrap_or_else(|_| meta.drive.clone());
            let way_out = format!(
                "leave its drive out in the design: `drives = {{ \"{id}\" = \"its log cannot be read\" }}` under `[exclude]`"
            );
            Ok((Vec::new(), Some((meta, unreadable(log, error, &way_out)))))
        }
        None => Err(unreadable(log, error, "take it out of the folder of logs")),
    }
}

/// Whose drive a log is by its name; where no mapping says how to read that, a drive that the design leaves out under this name.
fn named(log: &Path, settings: &IngestSettings, design: &Design) -> Option<DriveMeta> {
    let mapping = settings.mapping.as_ref();
    if let Some(names) = mapping.and_then(|m| m.names.as_ref()) {
        return named_after(log, names);
    }
    let stem = log.file_stem()?.to_str()?;
    let mut excluded = design.exclude().drives.keys();
    let drive = excluded.find(|id| id.as_str() == stem)?;
    let own = design.own_drive_label();
    DriveMeta::named(drive.as_str(), stem, own, DrivenBy::Human).ok()
}

/// What there is to say of a log that cannot be read.
fn unreadable(log: &Path, error: IngestError, way_out: &str) -> StudyError {
    let mended = error.suggestion();
    let mended = mended.map_or_else(String::new, |help| format!("{help}; or "));
    let failed = FailedLog::from((log.to_owned(), error));
    StudyError::not_possible(failed.why).with_help(format!("{mended}{way_out}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_ingest::Mapping;

    #[test]
    fn a_log_that_cannot_be_read_is_whose_its_name_says_and_the_error_names_the_way_out() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name);
        std::fs::write(file("P03-calm.csv"), "no table\n").unwrap();
        let mapping = "[names]\nfile = \"{participant}-{condition}\"\nparticipant = \"{participant}\"\n\
                       condition = \"{condition}\"\ndrive = \"{participant}-{condition}\"\n";
        std::fs::write(file("mapping.toml"), mapping).unwrap();
        let design = |exclude: &str| {
            let text = format!(
                "[study]\ntitle = \"t\"\n[[condition]]\nid = \"calm\"\n[exclude]\n{exclude}"
            );
            Design::from_toml(&text).unwrap()
        };
        let read = |settings: &IngestSettings, exclude: &str| {
            read_or_named(&file("P03-calm.csv"), settings, &design(exclude))
        };
        let named = IngestSettings {
            mapping: Some(Mapping::read(&file("mapping.toml")).unwrap()),
            ..IngestSettings::default()
        };
        let (drives, unread) = read(&named, "").unwrap();
        let (meta, error) = unread.unwrap();
        assert!(drives.is_empty());
        assert_eq!((meta.participant.as_str(), meta.condition.as_str()), ("P03", "calm"));
        let help = error.suggestion().unwrap();
        assert!(help.contains("drives = { \"P03-calm\" = "), "{help}");
        let bare = IngestSettings::default();
        let refused = read(&bare, "").err().unwrap().suggestion().unwrap();
        assert!(refused.contains("out of the folder of logs"), "{refused}");
        let (_, unread) = read(&bare, "drives = { P03-calm = \"the rig failed\" }").unwrap();
        assert_eq!(unread.unwrap().0.drive.as_str(), "P03-calm");
    }
}
