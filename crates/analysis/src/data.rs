//! The tables of a study, side by side.

use crate::AnalysisError;
use maveric_domain::{
    ConditionId, ConditionRow, DrivenBy, EmbeddingRow, MeasureValues, MeasuredDrive, Moment,
    ParticipantId, Score,
};
use std::collections::{BTreeMap, BTreeSet};

/// Scores by scale, subscale, moment and participant.
#[derive(Debug, Clone, Default)]
struct Scores(BTreeMap<String, BTreeMap<String, ByMoment>>);

/// Scores of one subscale.
type ByMoment = BTreeMap<Moment, BTreeMap<ParticipantId, f64>>;

impl Scores {
    fn of(scores: &[Score]) -> Self {
        let mut sorted = Self::default();
        for score in scores {
            if let Some(value) = score.value {
                sorted
                    .0
                    .entry(score.scale.clone())
                    .or_default()
                    .entry(score.subscale.clone())
                    .or_default()
                    .entry(score.moment)
                    .or_default()
                    .entry(score.participant.clone())
                    // The first of several, as a reader of the table would find it.
                    .or_insert(value);
            }
        }
        sorted
    }

    fn get(&self, p: &ParticipantId, moment: Moment, scale: &str, subscale: &str) -> Option<f64> {
        self.0
            .get(scale)?
            .get(subscale)?
            .get(&moment)?
            .get(p)
            .copied()
    }
}

/// The tables of a study, as stages write them: made by a run, or in memory.
#[derive(Debug, Clone, Default)]
pub struct Tables {
    /// Those whose drives were learned from.
    pub learned_from: BTreeSet<ParticipantId>,
    /// Those who sat through the conditions.
    pub tested: BTreeSet<ParticipantId>,
    /// What was measured, a row a drive.
    pub measurements: Vec<MeasuredDrive>,
    /// Fitted embeddings.
    pub embeddings: Vec<EmbeddingRow>,
    /// Where in style space each condition lies.
    pub conditions: Vec<ConditionRow>,
    /// Scores of the questionnaires before the drives.
    pub pre: Vec<Score>,
    /// Scores of the ratings after the conditions.
    pub post: Vec<Score>,
}

/// What the analyses of a study read.
#[derive(Debug, Clone)]
pub struct StudyData {
    /// Those who sat through the conditions and have an own drive, in order.
    pub participants: Vec<ParticipantId>,
    /// What was measured, a row a drive.
    pub measurements: Vec<MeasuredDrive>,
    /// Fitted embeddings.
    pub embeddings: Vec<EmbeddingRow>,
    /// Where in style space each condition lies.
    pub conditions: Vec<ConditionRow>,
    learned_from: BTreeSet<ParticipantId>,
    /// The drives of those who are tested by condition and participant.
    drives: BTreeMap<ConditionId, BTreeMap<ParticipantId, usize>>,
    /// Subscales of the pre-study scales, in the order in which they were scored.
    subscales: Vec<(String, String)>,
    pre: Scores,
    post: Scores,
}

impl StudyData {
    /// Puts the tables of a study side by side.
    ///
    /// # Errors
    /// [`AnalysisError::TooFewPeople`] for fewer than three people who are tested.
    pub fn new(tables: Tables) -> Result<Self, AnalysisError> {
        let mut drives: BTreeMap<ConditionId, BTreeMap<ParticipantId, usize>> = BTreeMap::new();
        for (at, drive) in tables.measurements.iter().enumerate() {
            if tables.tested.contains(&drive.meta.participant) {
                let of = drives.entry(drive.meta.condition).or_default();
                of.entry(drive.meta.participant.clone()).or_insert(at);
            }
        }
        let own = drives.get(&ConditionId::OWN);
        let participants: Vec<ParticipantId> =
            own.into_iter().flat_map(BTreeMap::keys).cloned().collect();
        if participants.len() < 3 {
            return Err(AnalysisError::TooFewPeople {
                found: participants.len(),
            });
        }
        let mut subscales: Vec<(String, String)> = Vec::new();
        for score in &tables.pre {
            let known = |(scale, subscale): &(String, String)| {
                *scale == score.scale && *subscale == score.subscale
            };
            if !subscales.iter().any(known) {
                subscales.push((score.scale.clone(), score.subscale.clone()));
            }
        }
        Ok(Self {
            participants,
            learned_from: tables.learned_from,
            drives,
            subscales,
            pre: Scores::of(&tables.pre),
            post: Scores::of(&tables.post),
            measurements: tables.measurements,
            embeddings: tables.embeddings,
            conditions: tables.conditions,
        })
    }

    /// Whether any drive was a driver model's.
    pub fn is_synthetic(&self) -> bool {
        self.measurements
            .iter()
            .any(|d| d.meta.driven_by == DrivenBy::Synthetic)
    }

    /// A measure of a tested participant's drive in a condition.
    pub fn measured(
        &self,
        participant: &ParticipantId,
        condition: ConditionId,
        measure: &str,
    ) -> Option<f64> {
        let at = *self.drives.get(&condition)?.get(participant)?;
        self.measurements[at].values.get(measure).copied().flatten()
    }

    /// The measures of a tested participant's drive in a condition.
    pub fn drive(
        &self,
        participant: &ParticipantId,
        condition: ConditionId,
    ) -> Option<&MeasureValues> {
        let at = *self.drives.get(&condition)?.get(participant)?;
        Some(&self.measurements[at].values)
    }

    /// A measure of every own drive of those who were learned from that has it.
    pub fn training_drives(&self, measure: &str) -> Vec<f64> {
        let own = |d: &&MeasuredDrive| {
            self.learned_from.contains(&d.meta.participant) && d.meta.condition == ConditionId::OWN
        };
        self.measurements
            .iter()
            .filter(own)
            .filter_map(|d| d.values.get(measure).copied().flatten())
            .collect()
    }

    /// The own-drive embedding of a participant, fitted with or without the ADB score.
    pub fn embedding(&self, participant: &ParticipantId, adb_used: bool) -> Option<&EmbeddingRow> {
        self.embeddings.iter().find(|e| {
            e.participant == *participant
                && e.condition == ConditionId::OWN
                && e.adb_used == adb_used
        })
    }

    /// A questionnaire score from before the drives.
    pub fn pre(&self, participant: &ParticipantId, scale: &str, subscale: &str) -> Option<f64> {
        self.pre.get(participant, Moment::Pre, scale, subscale)
    }

    /// A questionnaire score about a condition.
    pub fn post(
        &self,
        participant: &ParticipantId,
        condition: ConditionId,
        scale: &str,
        subscale: &str,
    ) -> Option<f64> {
        self.post
            .get(participant, Moment::After(condition), scale, subscale)
    }

    /// A participant's row of the conditions.
    pub fn condition(
        &self,
        participant: &ParticipantId,
        condition: ConditionId,
    ) -> Option<&ConditionRow> {
        let row = |c: &&ConditionRow| c.participant == *participant && c.condition == condition;
        self.conditions.iter().find(row)
    }

    /// Subscales of a pre-study scale, in the order in which they were scored.
    pub fn pre_subscales(&self, scale: &str) -> Vec<String> {
        let of = self.subscales.iter().filter(|(s, _)| s == scale);
        of.map(|(_, subscale)| subscale.clone()).collect()
    }
}
