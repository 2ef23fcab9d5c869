//! Who took part, what they drove, and the seven measures of it.

use crate::{
    design::DesignFile,
    error::StudyError,
    stages::train::adb_of,
    tables::{drives::read_drives, participants::read_participants, surveys::read_scores},
};
use maveric_domain::{AdbScore, Drive, ParticipantId};
use maveric_measures::objective;
use std::{collections::BTreeMap, path::Path};

/// The seven measures: the five that follow aggression, in the paper's order, then the two that do not.
pub(super) const MEASURES: [&str; 7] = [
    "mean_velocity_mps",
    "mean_headway_time_s",
    "headway_merge_back_m",
    "lane_changes",
    "headway_merge_back_s",
    "min_headway_distance_m",
    "left_lane_fraction",
];

/// A drive's [`MEASURES`]; `None` where it has no value.
pub(super) type Values = [Option<f64>; 7];

/// Measures a drive.
pub(super) fn values(drive: &Drive) -> Values {
    MEASURES.map(|name| objective::find(name).and_then(|m| m.of(drive)))
}

/// Somebody who drove twice.
#[derive(Debug)]
pub(super) struct Person {
    pub(super) participant: ParticipantId,
    pub(super) first: Drive,
    pub(super) again: Drive,
    pub(super) adb: Option<AdbScore>,
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
    let scores = read_scores(&folder.join("scores.csv"))?;
    let people = folder.join("participants.csv");
    let design = DesignFile::paper()?.design;
    let baseline = design.baseline_id();
    let latents: BTreeMap<ParticipantId, f64> = if people.exists() {
        let rows = read_participants(&people, &design)?.into_iter();
        rows.map(|p| (p.id, p.traits.aggressiveness)).collect()
    } else {
        BTreeMap::new()
    };
    let own = |name: &str| -> Result<Vec<Drive>, StudyError> {
        let path = folder.join("drives").join(name);
        if !path.exists() {
            return Err(StudyError::BadFile {
                path,
                problem: "is not there: nobody drove twice".to_owned(),
                help: Some(
                    "make the second drives with `maveric generate --repeat-drives`, or run pipelines/validate.toml"
                        .to_owned(),
                ),
            });
        }
        let mut drives = read_drives(&path)?;
        drives.retain(|d| Some(d.meta().condition) == baseline);
        Ok(drives)
    };
    let twice = |name: &str| -> Result<Vec<Person>, StudyError> {
        let mut second: BTreeMap<ParticipantId, Drive> = own(&format!("{name}-again"))?
            .into_iter()
            .map(|d| (d.meta().participant.clone(), d))
            .collect();
        let mut found = Vec::new();
        for first in own(name)? {
            let participant = first.meta().participant.clone();
            if let Some(again) = second.remove(&participant) {
                found.push(Person {
                    adb: adb_of(&first, &scores, baseline)?,
                    latent: latents.get(&participant).copied(),
                    participant,
                    first,
                    again,
                });
            }
        }
        found.sort_by(|a, b| a.participant.cmp(&b.participant));
        Ok(found)
    };
    let (test, training) = (twice("study2")?, twice("study1")?);
    if test.len() < 3 {
        return Err(StudyError::NotPossible {
            problem: format!(
                "{}: {} people who are tested drove twice, expected at least 3",
                folder.display(),
                test.len()
            ),
            help: Some("run the pipeline with more participants: --set study2=6".to_owned()),
        });
    }
    let mut trained_on = Vec::new();
    for drive in read_drives(&folder.join("drives").join("study1"))? {
        trained_on.push((
            values(&drive),
            adb_of(&drive, &scores, baseline)?.map(AdbScore::points),
        ));
    }
    Ok(People {
        test,
        training,
        trained_on,
    })
}

/// Puts measures on one footing: minus mean, over SD, of the training drives; a missing one is 0, the mean.
pub(super) fn standardiser(training: &[Values]) -> impl Fn(&Values) -> Vec<f64> + use<> {
    let scale: Vec<(f64, f64)> = (0..MEASURES.len())
        .map(|k| {
            let known: Vec<f64> = training.iter().filter_map(|v| v[k]).collect();
            let mean = super::mean(&known).unwrap_or(0.0);
            let square = known.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
            let sd = (square / (known.len() as f64 - 1.0).max(1.0)).sqrt();
            (mean, if sd > 0.0 { sd } else { 1.0 })
        })
        .collect();
    move |values| {
        values
            .iter()
            .zip(&scale)
            .map(|(value, (mean, sd))| value.map_or(0.0, |v| (v - mean) / sd))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standardised_measures_have_mean_0_and_sd_1_and_a_missing_one_is_the_mean() {
        let with = |x: f64| {
            let mut values = Values::default();
            values[0] = Some(x);
            values
        };
        let z = standardiser(&[with(1.0), with(2.0), with(3.0)]);
        assert!((z(&with(4.0))[0] - 2.0).abs() < 1e-12);
        assert!(z(&Values::default()).iter().all(|x| x.abs() < 1e-12));
    }
}
