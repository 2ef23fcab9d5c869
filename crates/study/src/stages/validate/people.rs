//! Who took part, what they drove, and the seven measures of it.

use crate::{
    design::DesignFile,
    error::StudyError,
    style_scores::StyleScores,
    tables::{drives::read_drives, participants::read_participants, surveys::read_scores},
};
use maveric_domain::{Drive, ParticipantId, StyleScore};
use maveric_rehearsal::validation::{Values, values};
use path_slash::PathExt as _;
use std::{collections::BTreeMap, path::Path};

#[derive(Debug)]
pub(super) struct Person {
    pub(super) participant: ParticipantId,
    pub(super) first: Drive,
    pub(super) again: Drive,
    pub(super) adb: Option<StyleScore>,
    /// What the generator drew; none for real people.
    pub(super) latent: Option<f64>,
}

/// A study in which everybody drove twice.
#[derive(Debug)]
pub(super) struct People {
    /// Study 2, ordered by participant.
    pub(super) test: Vec<Person>,
    /// Study 1, own drives only.
    pub(super) training: Vec<Person>,
    /// Measures and score of every drive that the models were trained on, roles included.
    pub(super) trained_on: Vec<(Values, Option<f64>)>,
}

/// Reads what the pipeline left in `folder`: `drives/study1`, `drives/study2`, each again as `…-again`, `scores.csv` and,
/// for made-up people, `participants.csv`.
///
/// # Errors
/// [`StudyError`] if a table cannot be read or fewer than three people who are tested drove twice.
pub(super) fn read(folder: &Path) -> Result<People, StudyError> {
    let scores = StyleScores::of(read_scores(&folder.join("scores.csv"))?, None)?;
    let people = folder.join("participants.csv");
    let design = DesignFile::paper()?.design;
    let baseline = design.baseline_id();
    let latents: BTreeMap<ParticipantId, f64> = if people.exists() {
        let rows = read_participants(&people, &design)?.into_iter();
        rows.map(|p| (p.id, p.traits.aggressiveness)).collect()
    } else {
        BTreeMap::new()
    };
    let own_drives = |name: &str| -> Result<Vec<Drive>, StudyError> {
        let path = folder.join("drives").join(name);
        if !path.exists() {
            let problem = "is not there: nobody drove twice";
            let help = "make the second drives with `maveric generate --repeat-drives`, or run pipelines/validate.toml";
            return Err(StudyError::file(path, problem).with_help(help));
        }
        let mut drives = read_drives(&path)?;
        drives.retain(|d| Some(d.meta().condition) == baseline);
        Ok(drives)
    };
    let twice = |name: &str| -> Result<Vec<Person>, StudyError> {
        let mut second: BTreeMap<ParticipantId, Drive> = own_drives(&format!("{name}-again"))?
            .into_iter()
            .map(|d| (d.meta().participant.clone(), d))
            .collect();
        let mut drivers = Vec::new();
        for first in own_drives(name)? {
            let participant = first.meta().participant.clone();
            if let Some(again) = second.remove(&participant) {
                drivers.push(Person {
                    adb: scores.of_drive(&first, None, baseline)?,
                    latent: latents.get(&participant).copied(),
                    participant,
                    first,
                    again,
                });
            }
        }
        drivers.sort_by(|a, b| a.participant.cmp(&b.participant));
        Ok(drivers)
    };
    let (test, training) = (twice("study2")?, twice("study1")?);
    if test.len() < 3 {
        let problem = format!(
            "{}: {} people who are tested drove twice, expected at least 3",
            folder.to_slash_lossy(),
            test.len()
        );
        let help = "run the pipeline with more participants: --set study2=6";
        return Err(StudyError::not_possible(problem).with_help(help));
    }
    let mut trained_on = Vec::new();
    for drive in read_drives(&folder.join("drives").join("study1"))? {
        trained_on.push((
            values(&drive),
            scores.of_drive(&drive, None, baseline)?.map(StyleScore::points),
        ));
    }
    Ok(People { test, training, trained_on })
}
