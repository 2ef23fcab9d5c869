//! The tables of a run, side by side.

use crate::{
    error::StudyError,
    tables::{
        conditions::{ConditionRow, read_conditions},
        embeddings::{EmbeddingRow, read_embeddings},
        measurements::{MeasuredDrive, read_measurements},
        surveys::read_scores,
    },
};
use maveric_domain::{Condition, DrivenBy, Moment, ParticipantId, Score, Study};
use std::path::Path;

/// What the analyses of a study read, as the pipeline left it in one folder.
#[derive(Debug, Clone)]
pub(crate) struct StudyData {
    /// Study 2's participants: those with an own drive, in order.
    pub(crate) participants: Vec<ParticipantId>,
    pub(crate) measurements: Vec<MeasuredDrive>,
    pub(crate) embeddings: Vec<EmbeddingRow>,
    pub(crate) conditions: Vec<ConditionRow>,
    pre: Vec<Score>,
    post: Vec<Score>,
}

impl StudyData {
    pub(crate) fn read(folder: &Path) -> Result<Self, StudyError> {
        let measurements = read_measurements(&folder.join("measurements.parquet"))?;
        let mut participants: Vec<ParticipantId> = measurements
            .iter()
            .filter(|d| d.meta.study == Study::Two && d.meta.condition == Condition::Own)
            .map(|d| d.meta.participant.clone())
            .collect();
        participants.sort();
        participants.dedup();
        if participants.len() < 3 {
            return Err(StudyError::NotPossible {
                problem: format!(
                    "{}: {} participants of Study 2 have an own drive, expected at least 3",
                    folder.display(),
                    participants.len()
                ),
                help: Some("run the pipeline with more participants: --set study2=6".to_owned()),
            });
        }
        Ok(Self {
            participants,
            measurements,
            embeddings: read_embeddings(&folder.join("embeddings.csv"))?,
            conditions: read_conditions(&folder.join("conditions.csv"))?,
            pre: read_scores(&folder.join("scores.csv"))?,
            post: read_scores(&folder.join("rating_scores.csv"))?,
        })
    }

    /// Whether any drive was a driver model's.
    pub(crate) fn is_synthetic(&self) -> bool {
        self.measurements
            .iter()
            .any(|d| d.meta.driven_by == DrivenBy::Synthetic)
    }

    /// A measure of a Study 2 participant's drive in a condition.
    pub(crate) fn measured(
        &self,
        participant: &ParticipantId,
        condition: Condition,
        measure: &str,
    ) -> Option<f64> {
        let drive = self.measurements.iter().find(|d| {
            d.meta.study == Study::Two
                && d.meta.participant == *participant
                && d.meta.condition == condition
        })?;
        drive.values.get(measure).copied().flatten()
    }

    /// A measure of every own drive of Study 1 that has it.
    pub(crate) fn training_drives(&self, measure: &str) -> Vec<f64> {
        let own =
            |d: &&MeasuredDrive| d.meta.study == Study::One && d.meta.condition == Condition::Own;
        self.measurements
            .iter()
            .filter(own)
            .filter_map(|d| d.values.get(measure).copied().flatten())
            .collect()
    }

    /// The own-drive embedding of a participant, fitted with or without the ADB score.
    pub(crate) fn embedding(
        &self,
        participant: &ParticipantId,
        adb_used: bool,
    ) -> Option<&EmbeddingRow> {
        self.embeddings.iter().find(|e| {
            e.participant == *participant && e.condition == Condition::Own && e.adb_used == adb_used
        })
    }

    /// A questionnaire score from before the drives.
    pub(crate) fn pre(
        &self,
        participant: &ParticipantId,
        scale: &str,
        subscale: &str,
    ) -> Option<f64> {
        find(&self.pre, participant, Moment::Pre, scale, subscale)
    }

    /// A questionnaire score about a condition.
    pub(crate) fn post(
        &self,
        participant: &ParticipantId,
        condition: Condition,
        scale: &str,
        subscale: &str,
    ) -> Option<f64> {
        find(
            &self.post,
            participant,
            Moment::After(condition),
            scale,
            subscale,
        )
    }

    /// Subscales of a pre-study scale, in the order in which they were scored.
    pub(crate) fn pre_subscales(&self, scale: &str) -> Vec<String> {
        let mut found: Vec<String> = Vec::new();
        for score in self.pre.iter().filter(|s| s.scale == scale) {
            if !found.contains(&score.subscale) {
                found.push(score.subscale.clone());
            }
        }
        found
    }
}

fn find(
    scores: &[Score],
    participant: &ParticipantId,
    moment: Moment,
    scale: &str,
    subscale: &str,
) -> Option<f64> {
    scores
        .iter()
        .find(|s| {
            s.participant == *participant
                && s.moment == moment
                && s.scale == scale
                && s.subscale == subscale
        })?
        .value
}
