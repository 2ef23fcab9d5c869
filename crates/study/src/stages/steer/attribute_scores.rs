//! Scores of the training drivers, by name, and the heads fitted to them.

use super::Steer;
use crate::{
    error::StudyError,
    run_folder::embeddings_path,
    tables::{
        Table,
        embeddings::{EmbeddingRow, read_embeddings},
        surveys::read_scores,
    },
};
use maveric_domain::{ConditionId, DriveId, Moment, ParticipantId, nearest};
use maveric_model::{
    Model,
    style_space::{AttributeHead, LinearHead},
};
use serde::Serialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    fmt,
    path::Path,
};

/// Name of the model's own head, S.
pub(super) const AGGRESSION: &str = "aggression";

/// What a head that was fitted to scores is worth.
#[derive(Debug, Clone, Serialize)]
pub struct AttributeSummary {
    pub name: String,
    /// Training drives it was fitted to.
    pub drives: usize,
    /// Training drives without the score.
    pub without_score: usize,
    /// Scored drivers who are not among the training drivers.
    pub unknown: usize,
    pub r_squared: f64,
    /// The same, drives left out one at a time.
    pub r_squared_leave_one_out: Option<f64>,
    /// Uncertainty of the direction, in degrees.
    pub direction_se_deg: f64,
    pub range: [f64; 2],
}

impl fmt::Display for AttributeSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let left_out = self.r_squared_leave_one_out.map_or("-".to_owned(), |r| format!("{r:.2}"));
        write!(
            f,
            "  {}: R² {:.2} ({left_out} leaving drives out), direction ± {:.0}°, {} drives",
            self.name, self.r_squared, self.direction_se_deg, self.drives
        )
    }
}

/// The heads of a move: the one to move along first, then those to hold.
#[derive(Debug, Default)]
pub(super) struct Heads {
    pub(super) all: Vec<LinearHead>,
    pub(super) summaries: Vec<AttributeSummary>,
    pub(super) warnings: Vec<String>,
}

impl Heads {
    pub(super) fn fit(
        model: &Model,
        axis: &LinearHead,
        (options, attribute): (&Steer, &String),
        baseline: Option<ConditionId>,
    ) -> Result<Self, StudyError> {
        let Some(scores) = &options.scores else {
            let problem = format!("no table is named in which {attribute} stands");
            let help = "name it with --scores";
            return Err(StudyError::not_possible(problem).with_help(help));
        };
        let training = read_embeddings(&embeddings_path(&options.model))?;
        let mut heads = Self::default();
        for name in std::iter::once(attribute).chain(&options.hold) {
            if name == AGGRESSION {
                heads.all.push(axis.clone());
                continue;
            }
            let by_drive = scores_of(scores, name, &training, baseline)?;
            let head = AttributeHead::fit(model, name, &by_drive.scores)?;
            heads.note(&head, &by_drive);
            heads.all.push(head.head);
        }
        Ok(heads)
    }

    fn note(&mut self, head: &AttributeHead, by_drive: &Scores) {
        let name = head.head.name();
        let unknown = by_drive.unknown + head.unknown.len();
        let without = head.without_score.len();
        if without > 0 {
            self.warnings.push(format!(
                "{name}: {without} of {} training drives have no such score and do not count",
                without + head.drives
            ));
        }
        if head.r_squared_leave_one_out.is_some_and(|r| r <= 0.0) {
            self.warnings.push(format!(
                "{name}: style space says less of it than its mean does (R² leaving drives out is not above 0), so moving along it means little"
            ));
        }
        self.summaries.push(AttributeSummary {
            name: name.to_owned(),
            drives: head.drives,
            without_score: without,
            unknown,
            r_squared: head.r_squared,
            r_squared_leave_one_out: head.r_squared_leave_one_out,
            direction_se_deg: head.direction_se_rad.to_degrees(),
            range: head.head.range(),
        });
    }
}

/// A score of each training drive that has it.
#[derive(Debug, Default)]
struct Scores {
    scores: BTreeMap<DriveId, f64>,
    /// Drivers with the score and without a training drive.
    unknown: usize,
}

/// Reads a score: `SCALE.SUBSCALE` from a table of questionnaire scores, else a column of a table with a row a `drive`
/// or a `participant`.
fn scores_of(
    path: &Path,
    name: &str,
    training: &[EmbeddingRow],
    baseline: Option<ConditionId>,
) -> Result<Scores, StudyError> {
    let table = Table::read(path)?;
    if ["participant", "moment", "scale", "subscale", "value"]
        .iter()
        .all(|column| table.has(column))
    {
        return questionnaire(path, name, training, baseline);
    }
    let mut by_drive = Scores::default();
    let values = table.numbers(name)?;
    if table.has("drive") {
        let drives: Vec<DriveId> = table.ids("drive")?;
        for (drive, value) in drives.into_iter().zip(values) {
            if !training.iter().any(|t| t.drive == drive) {
                by_drive.unknown += usize::from(value.is_some());
            } else if let Some(value) = value
                && by_drive.scores.insert(drive.clone(), value).is_some()
            {
                return Err(StudyError::file(path, format!("drive {drive} has two rows")));
            }
        }
        return Ok(by_drive);
    }
    let participants: Vec<ParticipantId> = table.ids("participant")?;
    for (participant, value) in participants.iter().zip(values) {
        let Some(value) = value else { continue };
        let row = training
            .iter()
            .find(|t| t.participant == *participant && Some(t.condition) == baseline);
        match row {
            None => by_drive.unknown += 1,
            Some(row) => {
                if by_drive.scores.insert(row.drive.clone(), value).is_some() {
                    let problem = format!("participant {participant} has two rows");
                    return Err(StudyError::file(path, problem));
                }
            }
        }
    }
    Ok(by_drive)
}

fn questionnaire(
    path: &Path,
    name: &str,
    training: &[EmbeddingRow],
    baseline: Option<ConditionId>,
) -> Result<Scores, StudyError> {
    let scores = read_scores(path)?;
    let full = |scale: &str, subscale: &str| format!("{scale}.{subscale}");
    let names: BTreeSet<String> = scores.iter().map(|s| full(&s.scale, &s.subscale)).collect();
    if !names.contains(name) {
        let nearest = nearest(name, names.iter().map(String::as_str)).map(str::to_owned);
        return Err(StudyError::NoColumn {
            path: path.to_owned(),
            wanted: name.to_owned(),
            found: names.into_iter().collect(),
            nearest,
        });
    }
    let mut by_drive = Scores::default();
    let mut unknown = BTreeSet::new();
    for score in scores.iter().filter(|s| full(&s.scale, &s.subscale) == name) {
        let Some(value) = score.value else { continue };
        if !training.iter().any(|t| t.participant == score.participant) {
            unknown.insert(&score.participant);
        }
        // A professional's role has its own answers, given after it.
        let drives = training.iter().filter(|t| {
            t.participant == score.participant
                && score.moment
                    == match t.condition {
                        condition if Some(condition) == baseline => Moment::Pre,
                        role => Moment::after(role),
                    }
        });
        for drive in drives {
            by_drive.scores.insert(drive.drive.clone(), value);
        }
    }
    by_drive.unknown = unknown.len();
    Ok(by_drive)
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::Embedding;

    fn training(drive: &str, participant: &str, condition: &str) -> EmbeddingRow {
        EmbeddingRow::new(
            DriveId::new(drive).unwrap(),
            ParticipantId::new(participant).unwrap(),
            condition.parse().unwrap(),
            Embedding::new(vec![0.0]).unwrap(),
        )
    }

    fn read(text: &str, name: &str) -> Result<Scores, StudyError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scores.csv");
        std::fs::write(&path, text).unwrap();
        let training = [
            training("A-own", "A", "own"),
            training("A-aggressive", "A", "aggressive"),
            training("B-own", "B", "own"),
        ];
        scores_of(&path, name, &training, "own".parse().ok())
    }

    const LONG: &str = "participant,moment,scale,subscale,value,answered,items
A,pre,ipip,openness,3.5,4,4
A,aggressive,ipip,openness,4.5,4,4
B,pre,ipip,openness,,0,4
C,pre,ipip,openness,2.5,4,4
";

    #[test]
    fn a_questionnaire_is_read_by_role_and_strangers_are_counted() {
        let by_drive = read(LONG, "ipip.openness").unwrap();
        let values: Vec<(&str, f64)> =
            by_drive.scores.iter().map(|(d, v)| (d.as_str(), *v)).collect();
        assert_eq!(values, [("A-aggressive", 4.5), ("A-own", 3.5)]);
        assert_eq!(by_drive.unknown, 1);
    }

    #[test]
    fn an_unknown_score_gets_the_nearest_name() {
        let error = read(LONG, "ipip.opennes").unwrap_err();
        assert_eq!(error.suggestion().unwrap(), "did you mean `ipip.openness`?");
    }

    #[test]
    fn any_table_with_a_row_a_driver_will_do() {
        let by_drive = read("drive,gap\nA-own,1\nZ-own,2\nB-own,\n", "gap").unwrap();
        assert_eq!((by_drive.scores.len(), by_drive.unknown), (1, 1));
        let by_drive = read("participant,gap\nA,1\nB,2\n", "gap").unwrap();
        assert_eq!(by_drive.scores.len(), 2);
        assert!(read("participant,gap\nA,1\nA,2\n", "gap").is_err());
        assert!(read("participant,gap\nA,NaN\n", "gap").is_err());
        assert!(read("who,gap\nA,1\n", "gap").is_err());
    }
}
