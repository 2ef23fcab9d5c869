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
    tables::{
        participants::{Enrolled, read_enrolled},
        surveys::{read_answered, refuse_unclear},
    },
};
use maveric_analysis::StudyData;
use maveric_domain::{Answer, DriveMeta, ParticipantId, ProbeAnswer, Recording};
use maveric_ingest::read_log;
use path_slash::PathExt as _;

/// People, answers, drives, what the seat collected, the study's own measures, and what was analysed.
#[derive(Default)]
pub(super) struct Material {
    pub(super) people: Vec<Enrolled>,
    pub(super) answers: Vec<Answer>,
    pub(super) probes: Vec<ProbeAnswer>,
    pub(super) drives: Vec<(DriveMeta, Recording)>,
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
            Ok(read_log(&log.path, &log.settings)?)
        })?;
        let drives = read.into_iter().flatten();
        material.drives = drives.map(|d| (d.meta, d.recording)).collect();
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

    /// Everybody who is in it.
    pub(super) fn ids(&self) -> impl Iterator<Item = &ParticipantId> {
        let people = self.people.iter().map(|p| &p.id);
        let answered = self.answers.iter().map(|a| &a.participant);
        let drove = self.drives.iter().map(|d| &d.0.participant);
        let measured = self.own.iter().map(|row| &row.participant);
        let analysed = self.outcomes.iter().flat_map(|data| &data.participants);
        let probed = self.probes.iter().map(|p| &p.participant);
        let tables = people
            .chain(answered)
            .chain(probed)
            .chain(drove)
            .chain(measured);
        tables.chain(analysed).chain(self.collected.people())
    }
}
