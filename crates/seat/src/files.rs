//! What becomes of what people do: logs, records, answers and people as files that `maveric run` reads.

use crate::{
    collected::Collected,
    error::SeatError,
    hindrance::Hindrance,
    plan::Styles,
    steps::Texts,
    tables::{self, Given, Standing},
    words::{Words, in_language},
};
use maveric_domain::{DriveId, DriveMeta, ParticipantId, Ride, design::Car};
use maveric_ingest::{Beside, write_mcap_with};
use maveric_model::Model;
use maveric_seat_page::{Record, Replayed};
use maveric_study::{
    DesignFile,
    atomic_write::{atomic_write, atomic_write_bytes, if_there, read_text},
    forget::{Forgotten, forget_person},
    tables::{
        TableName,
        collected::{
            CONSENTS, EVENTS, EventRow, LENT, LentRow, NOT_ADMITTED, NOT_AGREED, NOTES,
            NotAdmitted, NotAgreed, PAYMENT, PaymentRow, STOPPED, write_lent,
        },
        dial::{ENDING, Turn},
        embeddings::read_styles,
        read_rows, write_rows,
    },
};
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

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
    study: DesignFile,
    /// Whether the table of people was made here, with nobody in it.
    people_made: bool,
}

impl Files {
    pub fn nowhere() -> Self {
        Self(None)
    }

    /// The files that a study's design names; records go to `records`.
    pub fn of(study: &DesignFile, records: PathBuf) -> Self {
        let files = study.design.files();
        Self(Some(Place {
            logs: study.resolve(&files.logs).join("seat"),
            records,
            answers: study.resolve(&files.answers),
            people: study.people_file(None),
            study: study.clone(),
            people_made: false,
        }))
    }

    /// Makes the folder of records, which its owner alone may look into, and the table of people, with nobody in it, where there is none.
    ///
    /// # Errors
    /// [`SeatError::Study`] if it cannot be written.
    pub(crate) fn begin(&mut self) -> Result<(), SeatError> {
        let Some(place) = &mut self.0 else {
            return Ok(());
        };
        let io = |source| SeatError::io(&place.records, source);
        std::fs::create_dir_all(&place.records).map_err(io)?;
        #[cfg(unix)]
        {
            let owners_alone = std::os::unix::fs::PermissionsExt::from_mode(0o700);
            std::fs::set_permissions(&place.records, owners_alone).map_err(io)?;
        }
        if !place.people.exists() {
            let (people, nobody) = (&place.people, &mut Standing::default());
            tables::write_people(people, &place.study.design, (&[], &[], false), nobody)?;
            owners_alone(&place.people)?;
            place.people_made = true;
        }
        Ok(())
    }

    /// The styles that conditions of the study name, for `model`, and what keeps them from being ridden; none without a model.
    pub(crate) fn styles(&self, model: Option<&Model>, hindrances: &mut Vec<Hindrance>) -> Styles {
        let mut styles = Styles::new();
        let Some((place, model)) = self.0.as_ref().zip(model) else {
            return styles;
        };
        for condition in place.study.design.conditions() {
            let Some(Car::Embedding(file)) = &condition.car else {
                continue;
            };
            match read_styles(&place.study.resolve(file), model.embedding_size()) {
                Ok(rows) => drop(styles.insert(file.clone(), rows)),
                Err(error) => hindrances.push(Hindrance::Styles {
                    condition: condition.id,
                    problem: error.to_string(),
                    remedy: error.suggestion().unwrap_or_else(|| {
                        "write the file, or give the condition another `car`".to_owned()
                    }),
                }),
            }
        }
        styles
    }

    /// What the table of people is called.
    pub(crate) fn name_of_people(&self) -> String {
        let path = self.0.as_ref().and_then(|place| place.people.file_name());
        path.map_or_else(String::new, |name| name.to_string_lossy().into_owned())
    }

    /// The people who stand in the study's table, or stood there before they were forgotten.
    pub(crate) fn people(&self) -> Result<BTreeSet<String>, SeatError> {
        let Some(place) = &self.0 else {
            return Ok(BTreeSet::new());
        };
        let mut people = tables::people_in(&place.people)?;
        let forgotten = place.study.forgotten()?;
        people.extend(forgotten.ids().map(ToString::to_string));
        Ok(people)
    }

    /// The table of answers as it stands.
    pub(crate) fn answers(&self) -> Result<String, SeatError> {
        match &self.0 {
            Some(place) if place.answers.is_file() => Ok(read_text(&place.answers)?),
            _ => Ok(String::new()),
        }
    }

    /// Writes the record of a drive as it came in: `PARTICIPANT-CONDITION.jsonl`, with `beside` (`cut1`, `repeated1`) for one that
    /// is not the drive of its step.
    pub(crate) fn record(
        &self,
        name: &str,
        beside: Option<String>,
        lines: &str,
    ) -> Result<PathBuf, SeatError> {
        let Some(place) = &self.0 else {
            return Ok(PathBuf::from(name));
        };
        let beside = beside.map_or_else(String::new, |beside| format!(".{beside}"));
        let path = place.records.join(format!("{name}{beside}.jsonl"));
        atomic_write_bytes(&path, lines.as_bytes())?;
        Ok(path)
    }

    /// Takes away what `maveric run` would read of a drive that counts no more: its log and its turns of the dial; and its record, which is
    /// kept under another name.
    pub(crate) fn take_back(&self, name: &str) -> Result<(), SeatError> {
        let Some(place) = &self.0 else {
            return Ok(());
        };
        for path in [
            place.logs.join(format!("{name}.mcap")),
            place.records.join(format!("{name}{ENDING}")),
            place.records.join(format!("{name}.jsonl")),
        ] {
            match std::fs::remove_file(&path) {
                Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
                    return Err(SeatError::Io { path, source });
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Writes a drive that was driven again from its record as a log, by the writer that `generate` uses; the record is attached to
    /// it, and what is to be said of the drive stands in it.
    pub(crate) fn log(
        &self,
        name: &str,
        (participant, ride): (&str, Ride),
        (record, lines, note): (&Record, &str, Option<&str>),
        again: &Replayed,
    ) -> Result<(), SeatError> {
        let Some(place) = &self.0 else {
            return Ok(());
        };
        let path = place.logs.join(format!("{name}.mcap"));
        let bad = |source| SeatError::Record { path: path.clone(), source };
        let meta = DriveMeta::new(
            DriveId::new(name).map_err(|e| bad(e.into()))?,
            ParticipantId::new(participant).map_err(|e| bad(e.into()))?,
            ride.condition,
            record.header.driven_by,
        )
        .on(ride.occasion);
        let beside = Beside {
            trace: &again.rollout.trace,
            attached: Some((RECORD, lines.as_bytes())),
            note,
        };
        atomic_write(&path, |file| {
            Ok(write_mcap_with(&again.rollout.recording, &meta, &beside, file)?)
        })?;
        owners_alone(&path)
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
        let participant = ParticipantId::new(participant)?;
        let turns = turned.iter().map(|&(time_s, points)| Turn {
            participant: participant.clone(),
            time_s,
            points,
            step,
            duration_s,
        });
        let path = place.records.join(format!("{name}{ENDING}"));
        Ok(write_rows(TableName::Dial, &path, turns)?)
    }

    /// Takes everything of somebody out of the study's folder; none where there is no study.
    pub(crate) fn forget(&self, participant: &str) -> Result<Option<Forgotten>, SeatError> {
        let Some(place) = &self.0 else {
            return Ok(None);
        };
        let id = ParticipantId::new(participant)?;
        Ok(Some(forget_person(&place.study, &id)?))
    }

    /// Whom a platform pays; nobody where no file says so.
    pub(crate) fn payment(&self) -> Result<Vec<PaymentRow>, SeatError> {
        let path = self.0.as_ref().map(|place| place.records.join(PAYMENT));
        Ok(path.map_or(Ok(Vec::new()), |path| if_there(&path, read_rows))?)
    }

    /// Writes whom a platform pays, into the folder that is its owner's alone.
    pub(crate) fn write_payment(&self, rows: &[PaymentRow]) -> Result<(), SeatError> {
        match &self.0 {
            Some(place) => Ok(write_rows(TableName::Payment, &place.records.join(PAYMENT), rows)?),
            None => Ok(()),
        }
    }

    /// The folder of records; none where nothing is written.
    pub(crate) fn folder(&self) -> Option<&Path> {
        self.0.as_ref().map(|place| place.records.as_path())
    }

    /// What the table of events has already; nothing where it is not there, or cannot be read as one: it is made anew.
    pub(crate) fn events(&self) -> Vec<EventRow> {
        let path = self.0.as_ref().map(|place| place.records.join(EVENTS));
        let path = path.filter(|path| path.is_file());
        path.and_then(|path| read_rows(&path).ok()).unwrap_or_default()
    }

    /// Writes what was collected beside answers and drives.
    pub(crate) fn collected(&self, collected: &Collected) -> Result<(), SeatError> {
        let Some(place) = &self.0 else {
            return Ok(());
        };
        let records = |name: &str| place.records.join(name);
        write_rows(TableName::Events, &records(EVENTS), &collected.events)?;
        write_rows(TableName::Consents, &records(CONSENTS), &collected.consents)?;
        let stopped = place.study.resolve(Path::new(STOPPED));
        if !collected.stopped.is_empty() || stopped.is_file() {
            write_rows(TableName::Stopped, &stopped, &collected.stopped)?;
            owners_alone(&stopped)?;
        }
        self.lent(&collected.lent)?;
        write_rows(TableName::Notes, &records(NOTES), &collected.notes)?;
        Ok(())
    }

    /// Writes how many people each rule of the screening held back, and how many did not agree to each version of the consent, once
    /// there is somebody.
    pub(crate) fn held_back(
        &self,
        not_admitted: &[NotAdmitted],
        not_agreed: &[NotAgreed],
    ) -> Result<(), SeatError> {
        let Some(place) = &self.0 else {
            return Ok(());
        };
        let path = |name: &str| place.study.resolve(Path::new(name));
        if !not_admitted.is_empty() {
            write_rows(TableName::NotAdmitted, &path(NOT_ADMITTED), not_admitted)?;
        }
        if !not_agreed.is_empty() {
            write_rows(TableName::NotAgreed, &path(NOT_AGREED), not_agreed)?;
        }
        Ok(())
    }

    /// Writes whose style was lent to whom, once somebody's was.
    pub(crate) fn lent(&self, rows: &[LentRow]) -> Result<(), SeatError> {
        let Some(place) = &self.0 else {
            return Ok(());
        };
        let path = place.study.resolve(Path::new(LENT));
        if !rows.is_empty() || path.is_file() {
            write_lent(&path, rows)?;
            owners_alone(&path)?;
        }
        Ok(())
    }

    /// Adds people and answers to the study's tables that are not in them yet, and takes the rows of those `without` out of the table of
    /// people; what stands there then.
    pub(crate) fn write(&self, given: &[Given], without: &[String]) -> Result<Standing, SeatError> {
        let mut standing = Standing::default();
        if let Some(place) = &self.0 {
            let people = (given, without, place.people_made);
            tables::write_people(&place.people, &place.study.design, people, &mut standing)?;
            tables::write_answers(&place.answers, given, &mut standing)?;
            owners_alone(&place.people)?;
            owners_alone(&place.answers)?;
        }
        Ok(standing)
    }
}

/// Lets nobody but its owner read a file of what people gave, if it is there; a later write keeps that.
fn owners_alone(path: &Path) -> Result<(), SeatError> {
    #[cfg(unix)]
    if path.is_file() {
        let mode = std::os::unix::fs::PermissionsExt::from_mode(0o600);
        std::fs::set_permissions(path, mode).map_err(|source| SeatError::io(path, source))?;
    }
    Ok(())
}

/// The texts of a protocol, read from the study's folder: in the study's language first, then in the others among which people choose, whose
/// files are named by them (`consent.de.md`).
///
/// # Errors
/// [`SeatError::Study`] naming the file; [`SeatError::Protocol`] for sentences that cannot be said.
pub fn texts(study: &DesignFile) -> Result<(Texts, Vec<Texts>), SeatError> {
    let protocol = study.design.protocol();
    let others = protocol.languages.iter();
    let others = others.filter(|language| **language != protocol.language);
    let others = others.map(|language| texts_in(study, language));
    Ok((texts_in(study, &protocol.language)?, others.collect::<Result<_, _>>()?))
}

fn texts_in(study: &DesignFile, language: &str) -> Result<Texts, SeatError> {
    let protocol = study.design.protocol();
    let read = |path: &Option<PathBuf>| {
        let path = path.as_ref();
        let path = path.map(|path| study.resolve(&in_language(protocol, path, language)));
        path.as_deref().map(read_text).transpose()
    };
    Ok(Texts {
        consent: read(&protocol.consent)?,
        aftercare: read(&protocol.aftercare)?,
        debrief: read(&protocol.debrief)?,
        thanks: read(&protocol.thanks)?,
        words: Words::of_study(study, language)?,
    })
}
