//! What becomes of what people do: logs, answers and people as files that `maveric run` reads.

use crate::{error::SeatError, person::Person, serve::Sheet, steps::Step};
use maveric_domain::{ConditionId, Design, DriveId, DriveMeta, ParticipantId};
use maveric_ingest::{Beside, write_mcap_with};
use maveric_seat_page::{Record, replay};
use maveric_study::{
    DesignFile, StudyError,
    atomic_write::{atomic_write, atomic_write_bytes},
    tables::Table,
};
use std::{
    collections::BTreeSet,
    fmt::Write as _,
    path::{Path, PathBuf},
};

/// Where a study's files are; or nowhere, for a seat that only shows.
#[derive(Debug, Clone)]
pub struct Files(Option<Place>);

#[derive(Debug, Clone)]
struct Place {
    logs: PathBuf,
    records: PathBuf,
    answers: PathBuf,
    people: PathBuf,
    design: Design,
}

impl Files {
    /// Nothing is written.
    pub fn nowhere() -> Self {
        Self(None)
    }

    /// The files that a study's design names; records go to `records`.
    pub fn of(study: &DesignFile, records: PathBuf) -> Self {
        let (design, files) = (&study.design, study.design.files());
        Self(Some(Place {
            logs: study.resolve(&files.logs).join("seat"),
            records,
            answers: study.resolve(&files.answers),
            people: study.resolve(&design.people().file),
            design: design.clone(),
        }))
    }

    /// Drives a record again and writes it as a log, by the writer that `generate` uses, and beside it the record itself; gives what is
    /// to be said about it.
    pub(crate) fn drive(
        &self,
        participant: &str,
        condition: Option<ConditionId>,
        lines: &str,
    ) -> Result<Vec<String>, SeatError> {
        let (Some(place), Some(condition)) = (&self.0, condition) else {
            return Ok(Vec::new());
        };
        let name = format!("{participant}-{condition}");
        let record_path = place.records.join(format!("{name}.jsonl"));
        let bad = |source| SeatError::Record {
            path: record_path.clone(),
            source,
        };
        atomic_write_bytes(&record_path, lines.as_bytes())?;
        let record = Record::from_lines(lines).map_err(bad)?;
        let again = replay(&record).map_err(bad)?;
        let meta = DriveMeta {
            drive: DriveId::new(&*name).map_err(|e| bad(e.into()))?,
            participant: ParticipantId::new(participant).map_err(|e| bad(e.into()))?,
            condition,
            driven_by: record.header.driven_by,
        };
        let beside = Beside {
            trace: &again.rollout.trace,
            ..Beside::default()
        };
        atomic_write(&place.logs.join(format!("{name}.mcap")), |file| {
            Ok(write_mcap_with(
                &again.rollout.recording,
                &meta,
                &beside,
                file,
            )?)
        })?;
        let frames = record.chunks.iter().map(|c| c.frames);
        let (drawn, late) = frames.fold((0_u64, 0_u64), |(drawn, late), f| {
            (drawn + u64::from(f.drawn), late + u64::from(f.late))
        });
        let mut said = Vec::new();
        if !again.same() {
            said.push(format!(
                "{name}: the page came through other states than its record gives here"
            ));
        }
        if 100 * late > drawn {
            said.push(format!(
                "{name}: {late} of {drawn} pictures came late (over 50 ms)"
            ));
        }
        Ok(said)
    }

    /// Removes the logs and records of somebody who wants nothing kept.
    pub(crate) fn forget(&self, participant: &str) -> Result<(), SeatError> {
        let Some(place) = &self.0 else {
            return Ok(());
        };
        let theirs = format!("{participant}-");
        for folder in [&place.logs, &place.records] {
            for file in std::fs::read_dir(folder).into_iter().flatten().flatten() {
                if file.file_name().to_string_lossy().starts_with(&theirs) {
                    let path = file.path();
                    std::fs::remove_file(&path).map_err(|source| SeatError::Io { path, source })?;
                }
            }
        }
        Ok(())
    }

    /// Writes the answers of everybody who wants them kept, and adds to the table of people who is not in it yet.
    pub(crate) fn write(&self, given: &[(Person, Vec<(usize, String)>)]) -> Result<(), SeatError> {
        let Some(place) = &self.0 else {
            return Ok(());
        };
        let kept = || {
            given
                .iter()
                .filter(|(p, _)| p.ended.as_deref() != Some("deleted"))
        };
        let mut table = "participant,moment,scale,item,answer,seconds\n".to_owned();
        for (person, answers) in kept() {
            for (step, body) in answers {
                let Some(Step::Scale { scale, moment, .. }) = person.steps.get(*step) else {
                    continue;
                };
                // Only what was checked was kept.
                let Ok(sheet) = serde_json::from_str::<Sheet>(body) else {
                    continue;
                };
                let each_s = sheet.seconds / sheet.answers.len().max(1) as f64;
                for (item, answer) in (1..).zip(&sheet.answers) {
                    let answer = answer.map_or_else(String::new, |a| a.to_string());
                    let _ = writeln!(
                        table,
                        "{},{moment},{scale},{item},{answer},{each_s:.3}",
                        person.participant
                    );
                }
            }
        }
        atomic_write_bytes(&place.answers, table.as_bytes())?;
        place.people(&mut kept().map(|(person, _)| person))
    }
}

impl Place {
    /// Adds a row for everybody who is not in the table; makes it where there is none.
    fn people(&self, everybody: &mut dyn Iterator<Item = &Person>) -> Result<(), SeatError> {
        let path = &self.people;
        let (mut text, columns, known) = if path.is_file() {
            read_people(path)?
        } else {
            let people = self.design.people();
            let columns: Vec<String> = std::iter::once("participant")
                .chain(people.columns())
                .chain(["order"])
                .map(str::to_owned)
                .collect();
            (columns.join(",") + "\n", columns, BTreeSet::new())
        };
        if !text.ends_with('\n') {
            text.push('\n');
        }
        for person in everybody.filter(|p| !known.contains(&p.participant)) {
            let cells: Vec<String> = columns.iter().map(|c| self.cell(person, c)).collect();
            text += &(cells.join(",") + "\n");
        }
        Ok(atomic_write_bytes(path, text.as_bytes())?)
    }

    fn cell(&self, person: &Person, column: &str) -> String {
        let rides: Vec<String> = person
            .steps
            .iter()
            .filter_map(|s| s.drives().filter(|(_, by_hand)| !by_hand))
            .map(|(condition, _)| condition.to_string())
            .collect();
        let people = self.design.people();
        let wanted = if rides.is_empty() {
            &people.learn
        } else {
            &people.test
        };
        match column {
            "participant" => person.participant.clone(),
            "order" => rides.join(" "),
            _ => wanted
                .as_ref()
                .and_then(|w| w.get(column))
                .cloned()
                .unwrap_or_default(),
        }
    }
}

/// Text, columns and ids of a table of people that is there.
fn read_people(path: &Path) -> Result<(String, Vec<String>, BTreeSet<String>), SeatError> {
    let table = Table::read(path)?;
    let ids: Vec<ParticipantId> = table.ids("participant")?;
    let text = std::fs::read_to_string(path).map_err(|source| SeatError::Io {
        path: path.to_owned(),
        source,
    })?;
    let ids = ids.into_iter().map(|id| id.to_string()).collect();
    Ok((text, table.columns(), ids))
}

/// The texts of a protocol, read from the study's folder.
///
/// # Errors
/// [`StudyError::Io`] naming the file.
pub fn texts(study: &DesignFile) -> Result<crate::steps::Texts, StudyError> {
    let read = |path: &Option<PathBuf>| {
        let path = path.as_ref().map(|p| study.resolve(p));
        path.map(|p| maveric_study::atomic_write::read_text(&p))
            .transpose()
    };
    let protocol = study.design.protocol();
    Ok(crate::steps::Texts {
        consent: read(&protocol.consent)?,
        thanks: read(&protocol.thanks)?,
    })
}
