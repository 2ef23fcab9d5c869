//! What becomes of what people do: logs, records, answers and people as files that `maveric run` reads.

use crate::{
    error::SeatError,
    tables::{self, Given},
};
use maveric_domain::{ConditionId, Design, DriveId, DriveMeta, ParticipantId, design::Software};
use maveric_ingest::{Beside, write_mcap_with};
use maveric_seat_page::{Record, Replayed};
use maveric_study::{
    DesignFile, StudyError,
    atomic_write::{atomic_write, atomic_write_bytes, read_text},
    tables::{
        dial::{ENDING, Turn},
        write_rows,
    },
};
use std::{collections::BTreeSet, path::PathBuf};

/// Name under which a drive's record is attached to its log.
pub(crate) const RECORD: &str = "seat.jsonl";

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
    ///
    /// # Errors
    /// [`StudyError`] naming the key where the study's answers are another program's export, which the seat does not write.
    pub fn of(study: &DesignFile, records: PathBuf) -> Result<Self, StudyError> {
        let (design, files) = (&study.design, study.design.files());
        if files.software != Software::Table {
            return Err(study.wrong(
                format!("`files.software`: found {:?}, expected `table`: the seat writes its answers as a plain table", files.software),
                Some("leave `software` out, or give the seat a study of its own".to_owned()),
            ));
        }
        Ok(Self(Some(Place {
            logs: study.resolve(&files.logs).join("seat"),
            records,
            answers: study.resolve(&files.answers),
            people: study.resolve(&design.people().file),
            design: design.clone(),
        })))
    }

    /// Makes the table of people, with nobody in it, where there is none.
    ///
    /// # Errors
    /// [`SeatError::Study`] if it cannot be written.
    pub fn begin(&self) -> Result<(), SeatError> {
        match &self.0 {
            Some(place) if !place.people.exists() => {
                tables::write_people(&place.people, &place.design, &[])
            }
            _ => Ok(()),
        }
    }

    /// The people who stand in the study's table.
    pub(crate) fn people(&self) -> Result<BTreeSet<String>, SeatError> {
        self.0.as_ref().map_or_else(
            || Ok(BTreeSet::new()),
            |place| tables::people_in(&place.people),
        )
    }

    /// The table of answers as it stands.
    pub(crate) fn answers(&self) -> Result<String, SeatError> {
        match &self.0 {
            Some(place) if place.answers.is_file() => Ok(read_text(&place.answers)?),
            _ => Ok(String::new()),
        }
    }

    /// Writes the record of a drive as it came in: `PARTICIPANT-CONDITION.jsonl`, with `cut` for one that was cut short.
    pub(crate) fn record(
        &self,
        name: &str,
        cut: Option<u32>,
        lines: &str,
    ) -> Result<PathBuf, SeatError> {
        let Some(place) = &self.0 else {
            return Ok(PathBuf::from(name));
        };
        let cut = cut.map_or_else(String::new, |attempt| format!(".cut{attempt}"));
        let path = place.records.join(format!("{name}{cut}.jsonl"));
        atomic_write_bytes(&path, lines.as_bytes())?;
        Ok(path)
    }

    /// Writes a drive that was driven again from its record as a log, by the writer that `generate` uses; the record is attached to
    /// it, and what is to be said of the drive stands in it.
    pub(crate) fn log(
        &self,
        name: &str,
        (participant, condition): (&str, ConditionId),
        (record, lines, note): (&Record, &str, Option<&str>),
        again: &Replayed,
    ) -> Result<(), SeatError> {
        let Some(place) = &self.0 else {
            return Ok(());
        };
        let path = place.logs.join(format!("{name}.mcap"));
        let bad = |source| SeatError::Record {
            path: path.clone(),
            source,
        };
        let meta = DriveMeta {
            drive: DriveId::new(name).map_err(|e| bad(e.into()))?,
            participant: ParticipantId::new(participant).map_err(|e| bad(e.into()))?,
            condition,
            driven_by: record.header.driven_by,
        };
        let beside = Beside {
            trace: &again.rollout.trace,
            attached: Some((RECORD, lines.as_bytes())),
            note,
            ..Beside::default()
        };
        Ok(atomic_write(&path, |file| {
            Ok(write_mcap_with(
                &again.rollout.recording,
                &meta,
                &beside,
                file,
            )?)
        })?)
    }

    /// Writes how the dial was turned in a ride, `(s, points)`, in the study's points.
    pub(crate) fn turns(
        &self,
        (name, participant): (&str, &str),
        turned: &[(f64, f64)],
        step: f64,
        duration_s: f64,
    ) -> Result<(), SeatError> {
        let Some(place) = &self.0 else {
            return Ok(());
        };
        let participant =
            ParticipantId::new(participant).map_err(maveric_study::StudyError::from)?;
        let turns = turned.iter().map(|&(time_s, points)| Turn {
            participant: participant.clone(),
            time_s,
            points,
            step,
            duration_s,
        });
        let turns: Vec<Turn> = turns.collect();
        Ok(write_rows(
            &place.records.join(format!("{name}{ENDING}")),
            &turns,
        )?)
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
    pub(crate) fn write(&self, given: &[Given]) -> Result<(), SeatError> {
        let Some(place) = &self.0 else {
            return Ok(());
        };
        tables::write_answers(&place.answers, given)?;
        tables::write_people(&place.people, &place.design, given)
    }
}

/// The texts of a protocol, read from the study's folder.
///
/// # Errors
/// [`StudyError::Io`] naming the file.
pub fn texts(study: &DesignFile) -> Result<crate::steps::Texts, StudyError> {
    let read = |path: &Option<PathBuf>| {
        let path = path.as_ref().map(|p| study.resolve(p));
        path.as_deref().map(read_text).transpose()
    };
    let protocol = study.design.protocol();
    Ok(crate::steps::Texts {
        consent: read(&protocol.consent)?,
        thanks: read(&protocol.thanks)?,
    })
}
