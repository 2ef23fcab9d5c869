//! `export`: a study without the people's names, to give away.

mod dictionary;
mod left_out;
mod place;
mod pseudonym;
mod ro_crate;
mod seat;
mod sources;
mod wide;

use path_slash::PathExt as _;
pub(crate) use ro_crate::METADATA;
pub use ro_crate::{About, PipelineRun, Step};

use crate::{
    atomic_write::{atomic_write_bytes, write_json, write_recording},
    design::DesignFile,
    error::StudyError,
    forget::refuse_learned_from_gone,
    outcome::{Outcome, Watch, for_each_on},
    tables::{
        TableName,
        participants::{Enrolled, read_enrolled},
        surveys::{read_answers, refuse_unclear},
        write_rows,
    },
};
use left_out::LeftOut;
use maveric_domain::{Answer, ConditionId, Design, DriveId, DriveMeta, ParticipantId, Recording};
use maveric_ingest::{Beside, read_log};
use place::{Place, files};
use pseudonym::Pseudonyms;
use serde::Serialize;
use sources::Sources;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

/// What to give away.
#[derive(Debug, Clone)]
pub struct ExportOptions {
    /// The study's design; `study.toml` of the folder one stands in without, else the paper's.
    pub design: Option<PathBuf>,
    /// Logs, or folders of logs; may be empty. Where no people, answers and seat are named either, all that the study has is exported.
    pub logs: Vec<PathBuf>,
    /// What the columns of tables among them mean; as the design says without it.
    pub mapping: Option<PathBuf>,
    /// Who takes part.
    pub participants: Option<PathBuf>,
    /// Files of answers, long; may be empty.
    pub surveys: Vec<PathBuf>,
    /// Folder of what the seat collected beside answers and drives; none for nothing of it.
    pub seat: Option<PathBuf>,
    /// Whether the experimenter's notes are given away too.
    pub notes: bool,
    /// The secret that pseudonyms are made with, kept apart.
    pub key: PathBuf,
    /// Folder to write into.
    pub out: PathBuf,
    /// Samples a second of the logs; 20 without it.
    pub rate_hz: Option<f64>,
    /// What is said of it for repositories.
    pub about: About,
    /// Threads.
    pub jobs: usize,
}

/// What was written.
#[derive(Debug, Clone, Serialize)]
pub struct Exported {
    /// People.
    pub participants: usize,
    /// Drives.
    pub drives: usize,
    /// Answers.
    pub answers: usize,
}

/// Width of a band of ages, in years.
const BAND_YEARS: u32 = 10;

/// Fewer people than this who share what the table says of them can be found out.
const FEWEST_ALIKE: usize = 3;

/// Writes a study under pseudonyms.
///
/// - Participant ids become keyed hashes: with the key the same person has the same pseudonym in every export; without it
///   neither direction can be computed. No table of who is who is written.
/// - Of a log only the recording is kept: who was where on the road, from time 0 and position 0 on. Dates, positions on a map, other
///   channels and file names are gone.
/// - Whoever the design leaves out by name, was forgotten or has no row in the table of people is in no file of it, and is counted.
/// - The folder is new, or holds nothing but an earlier export, which goes: who has withdrawn since is in none of its files. What
///   was handed out before is not undone, which is said.
/// - `ro-crate-metadata.json` says what it is as a Workflow Run RO-Crate: files with hashes, licence, the pipeline and its stages; no
///   path that names somebody.
/// - `dictionary.csv` says what each column of the tables means.
/// - Of `participants.csv` only who is learned from and who is tested, population, age in bands of ten years, gender, professional and order; of answers only
///   what is scored. Free text and any other column is left out.
///
/// What this cannot do: a driving style, or a rare combination of age, gender and answers, may still single somebody out for who
/// knows them. Groups of fewer than three alike are warned about.
///
/// # Errors
/// [`StudyError`] if a file cannot be read, the key is too short or lies in `out`, `out` holds something else, or nothing was
/// asked for.
pub fn export(options: &ExportOptions, watch: Watch<'_>) -> Result<Outcome<Exported>, StudyError> {
    let study = DesignFile::find(options.design.as_deref())?;
    let design = &study.design;
    if let Some(run) = &options.about.run {
        for model in run.models() {
            refuse_learned_from_gone(&study, &study.resolve(Path::new(model)))?;
        }
    }
    let here = DesignFile::here(options.design.as_deref())?;
    let Sources {
        logs,
        participants,
        surveys,
        seat,
    } = Sources::of(options, here.as_ref())?;
    let mut people = participants
        .as_deref()
        .map(|path| read_enrolled(path, design))
        .transpose()?
        .unwrap_or_default();
    let mut answers: Vec<Answer> = Vec::new();
    for path in &surveys {
        let found = read_answers(path)?;
        refuse_unclear(path, &found, design)?;
        answers.extend(found);
    }
    let seat = seat.as_deref();
    let seat = seat.map(|folder| seat::Collected::read(folder, options.notes));
    let mut collected = seat.transpose()?.unwrap_or_default();
    if people.is_empty() && answers.is_empty() && logs.is_empty() && collected.is_empty() {
        return Err(StudyError::NotPossible {
            problem: "there is nothing to export".to_owned(),
            help: Some(
                "run this in the folder of a study, or give at least one of --logs, --participants, --surveys and --seat"
                    .to_owned(),
            ),
        });
    }
    let place = Place::new(&options.out)?;
    let out = place.fresh();
    let mut names = Pseudonyms::read(&options.key, &options.out)?;
    let read = for_each_on(options.jobs, &logs, watch, "logs read", |log| {
        Ok(read_log(&log.path, &log.settings)?)
    })?;
    let mut found: Vec<(DriveMeta, Recording)> = read
        .into_iter()
        .flatten()
        .map(|d| (d.meta, d.recording))
        .collect();
    let left_out = match &here {
        Some(study) => LeftOut::of(
            study,
            participants.as_deref(),
            (&mut people, &mut answers, &mut found, &mut collected),
        )?,
        None => LeftOut::default(),
    };
    let ids = people
        .iter()
        .map(|p| &p.id)
        .chain(answers.iter().map(|a| &a.participant));
    let driven = found.iter().map(|d| &d.0.participant);
    for id in ids.chain(driven).chain(collected.people()) {
        names.add(id)?;
    }
    if names.len() == 0 {
        return Err(StudyError::NotPossible {
            problem: "nobody is left to export".to_owned(),
            help: Some(left_out.lines().join("; ")),
        });
    }
    let mut drives = Vec::new();
    let mut numbers: BTreeMap<(ParticipantId, String), usize> = BTreeMap::new();
    for (meta, recording) in &found {
        let participant = names.of(&meta.participant);
        let style = meta.condition.to_string();
        let number = numbers
            .entry((participant.clone(), style.clone()))
            .or_default();
        *number += 1;
        let drive = match number {
            1 => format!("{participant}-{style}"),
            n => format!("{participant}-{style}-{n}"),
        };
        let meta = DriveMeta {
            drive: DriveId::new(drive)?,
            participant,
            ..meta.clone()
        };
        drives.push((meta, recording));
    }
    for_each_on(
        options.jobs,
        &drives,
        watch,
        "drives written",
        |(meta, recording)| {
            let path = out.join("logs").join(format!("{}.mcap", meta.drive));
            let moved = from_zero(recording)?;
            write_recording(&path, &moved, meta, &Beside::default())
        },
    )?;
    let mut warnings = left_out.doubts.clone();
    if !people.is_empty() {
        write_people(&out.join("participants.csv"), &people, &names, design)?;
        warnings.extend(alike(&people));
    }
    if !answers.is_empty() {
        for answer in &mut answers {
            answer.participant = names.of(&answer.participant);
        }
        // Sorted by pseudonym, so that the order of the rows gives nobody away.
        answers.sort_by(|a, b| {
            (&a.participant, a.moment, &a.scale, a.item).cmp(&(
                &b.participant,
                b.moment,
                &b.scale,
                b.item,
            ))
        });
        write_rows(TableName::Answers, &out.join("surveys.csv"), &answers)?;
        let orders: BTreeMap<ParticipantId, &[ConditionId]> = people
            .iter()
            .map(|p| (names.of(&p.id), p.order.as_slice()))
            .collect();
        wide::write(&out.join("surveys_wide.csv"), &answers, &orders)?;
    }
    let notes = collected.write(&out, &names)?;
    if notes > 0 {
        warnings.push(format!(
            "{notes} notes are given away as they were written: read seat/notes.csv, they may name somebody"
        ));
    }
    let mut about = options.about.clone();
    if let Some(run) = about.run.take() {
        let originals = names.originals().map(ToString::to_string);
        let originals: Vec<String> = originals.chain(left_out.names.iter().cloned()).collect();
        if ro_crate::names(&run.text, &originals) {
            warnings.push(
                "the pipeline names somebody, so it and its run are not in the export".to_owned(),
            );
        } else {
            let (run, left_out) = run.without(&originals);
            if left_out > 0 {
                warnings.push(format!(
                    "{left_out} paths and commands of the run name somebody and are not in {}",
                    ro_crate::METADATA
                ));
            }
            atomic_write_bytes(&out.join(ro_crate::PIPELINE), run.text.as_bytes())?;
            about.run = Some(run);
        }
    }
    let gone = place.gone(|name| names.has(name))?;
    if gone > 0 {
        warnings.push(format!(
            "{gone} people of the export that stood in {} are not in this one: whoever was given the earlier one has them still, and has to \
             be asked to delete it",
            options.out.to_slash_lossy()
        ));
    }
    dictionary::write(&out, &files(&out)?)?;
    let metadata = ro_crate::metadata(design.title(), &about, &place.given()?);
    write_json(&out.join(ro_crate::METADATA), &metadata)?;
    place.take()?;
    let value = Exported {
        participants: names.len(),
        drives: drives.len(),
        answers: answers.len(),
    };
    let mut summary = vec![
        format!(
            "{} participants under pseudonyms, {} drives, {} answers: {}",
            value.participants,
            value.drives,
            value.answers,
            options.out.to_slash_lossy()
        ),
        format!(
            "keep {} apart: with it the pseudonyms can be made again",
            options.key.to_slash_lossy()
        ),
    ];
    summary.extend(left_out.lines());
    Ok(Outcome {
        value,
        summary,
        warnings,
    })
}

/// The same recording, starting at time 0 and at position 0 along the road, to the millimetre.
fn from_zero(recording: &Recording) -> Result<Recording, StudyError> {
    let millimetres = |x: f64| (x * 1000.0).round() / 1000.0;
    let (time, ego) = (recording.time_s(), recording.ego());
    let (start, origin) = (time[0], ego.x_m[0]);
    let along = |x: &[f64]| {
        x.iter()
            .map(|x| millimetres(x - origin))
            .collect::<Vec<f64>>()
    };
    let rounded = |y: &[f64]| y.iter().map(|y| millimetres(*y)).collect::<Vec<f64>>();
    let mut moved_ego = ego.clone();
    (moved_ego.x_m, moved_ego.y_m) = (along(&ego.x_m), rounded(&ego.y_m));
    moved_ego.speed_mps = rounded(&ego.speed_mps);
    let others = recording.others().iter().map(|track| {
        let mut moved = track.clone();
        (moved.x_m, moved.y_m) = (along(&track.x_m), rounded(&track.y_m));
        moved.speed_mps = rounded(&track.speed_mps);
        moved
    });
    Ok(Recording::new(
        *recording.road(),
        recording.rate_hz(),
        time.iter().map(|t| t - start).collect(),
        recording.segment().to_vec(),
        moved_ego,
        others.collect(),
    )?)
}

/// The band that an age lies in, such as `30-39`.
fn band(age_years: f64) -> String {
    let low = (age_years as u32) / BAND_YEARS * BAND_YEARS;
    format!("{low}-{}", low + BAND_YEARS - 1)
}

fn write_people(
    path: &Path,
    people: &[Enrolled],
    names: &Pseudonyms,
    design: &Design,
) -> Result<(), StudyError> {
    let mut rows: Vec<(ParticipantId, &Enrolled)> =
        people.iter().map(|p| (names.of(&p.id), p)).collect();
    rows.sort_by(|a, b| (!a.1.learned_from, &a.0).cmp(&(!b.1.learned_from, &b.0)));
    let order = |p: &Enrolled| {
        let words: Vec<&str> = p.order.iter().map(ConditionId::as_str).collect();
        words.join(" ")
    };
    let columns = design.people().columns();
    let given = rows.into_iter().map(|(name, p)| {
        let word = |c: &str| p.cells.get(c).cloned().unwrap_or_default();
        let telling: Vec<(&str, String)> = columns.iter().map(|c| (*c, word(c))).collect();
        (
            ("participant", name),
            ("population", p.population.clone().unwrap_or_default()),
            ("age", p.age_years.map_or_else(String::new, band)),
            ("gender", p.gender.clone().unwrap_or_default()),
            ("professional", p.professional),
            ("order", order(p)),
            telling,
        )
    });
    write_rows(TableName::Participants, path, given)
}

/// Warns of people whom few others resemble in what the table still says.
fn alike(people: &[Enrolled]) -> Vec<String> {
    let mut groups: BTreeMap<String, usize> = BTreeMap::new();
    for p in people {
        let said = [
            if p.learned_from {
                "learned from".to_owned()
            } else {
                String::new()
            },
            p.population.clone().unwrap_or_default(),
            p.age_years.map_or_else(String::new, band),
            p.gender.clone().unwrap_or_default(),
            if p.professional {
                "professional".to_owned()
            } else {
                String::new()
            },
        ];
        let said: Vec<String> = said.into_iter().filter(|s| !s.is_empty()).collect();
        *groups.entry(said.join(", ")).or_default() += 1;
    }
    let few = groups.iter().filter(|(_, n)| **n < FEWEST_ALIKE);
    few.map(|(said, n)| format!("only {n} alike ({said}): who knows them may recognise them"))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ages_fall_into_bands_of_ten() {
        assert_eq!(
            (
                band(18.0).as_str(),
                band(39.9).as_str(),
                band(40.0).as_str()
            ),
            ("10-19", "30-39", "40-49")
        );
    }
}
