//! What is exported: what was named, or all that the study has.

use super::options::ExportOptions;
use crate::{
    design::DesignFile,
    error::StudyError,
    stages::ingest::{
        Ingest,
        logs::{self, Log},
    },
    tables::collected::{EVENTS, SEAT},
};
use maveric_domain::design::Software;
use std::path::{Path, PathBuf};

/// Where `maveric run` writes in a study's folder.
pub(super) const RESULTS: &str = "results";
/// Answers that came from survey software, among the results.
const IMPORTED: &str = "answers.csv";
/// Ratings of people who are made up, among the results.
const RATINGS: &str = "ratings.csv";

#[derive(Default)]
pub(super) struct Sources {
    pub(super) logs: Vec<Log>,
    pub(super) participants: Option<PathBuf>,
    pub(super) surveys: Vec<PathBuf>,
    pub(super) seat: Option<PathBuf>,
    /// Values of the study's own measures.
    pub(super) measures: Option<PathBuf>,
    /// The folder of what a run made.
    pub(super) results: Option<PathBuf>,
}

impl Sources {
    /// Those that were named; where none was, those of the study's folder that are there.
    pub(super) fn find(
        options: &ExportOptions,
        study: Option<&DesignFile>,
    ) -> Result<Self, StudyError> {
        let named = Self {
            participants: options.participants.clone(),
            surveys: options.surveys.clone(),
            seat: options.seat.clone(),
            ..Self::default()
        };
        if !options.logs.is_empty() {
            let ingested = Ingest {
                logs: options.logs.clone(),
                mapping: options.mapping.clone(),
                rate_hz: options.rate,
                out: options.out.clone(),
                ..Ingest::default()
            };
            let logs = logs::named_or_declared(&ingested, study)?;
            return Ok(Self { logs, ..named });
        }
        if named.participants.is_some() || !named.surveys.is_empty() || named.seat.is_some() {
            return Ok(named);
        }
        study.map_or(Ok(named), |study| Self::of_study(options, study))
    }

    fn of_study(options: &ExportOptions, study: &DesignFile) -> Result<Self, StudyError> {
        let files = study.design.files();
        let there = |path: &Path| Some(study.resolve(path)).filter(|path| path.is_file());
        let answers = match files.software {
            Software::Table => there(&files.answers),
            _ => there(&Path::new(RESULTS).join(IMPORTED)),
        };
        // What made-up people said of the conditions is among the results of a run.
        let ratings = there(&Path::new(RESULTS).join(RATINGS)).filter(|_| study.design.synthetic());
        let ingested =
            Ingest { mapping: options.mapping.clone(), rate_hz: options.rate, ..Ingest::default() };
        Ok(Self {
            logs: logs::of_study(&ingested, study)?,
            participants: there(&study.design.people().file),
            surveys: answers.into_iter().chain(ratings).collect(),
            seat: there(&Path::new(SEAT).join(EVENTS)).and(Some(study.resolve(Path::new(SEAT)))),
            measures: Some(&files.measures)
                .filter(|_| !study.design.measures().is_empty())
                .and_then(|path| there(path)),
            results: Some(study.resolve(Path::new(RESULTS))).filter(|folder| folder.is_dir()),
        })
    }
}
