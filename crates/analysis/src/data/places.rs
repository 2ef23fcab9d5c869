//! Where the rows of a person stand in the tables: a study may have many people.

use maveric_domain::{ConditionId, ConditionRow, EmbeddingRow, MeasuredDrive, ParticipantId};
use std::{collections::BTreeMap, num::NonZeroU32};

/// Whose drive an embedding is of, in which session, and whether the score took part in its fit.
type OfEmbedding = (ParticipantId, ConditionId, NonZeroU32, bool);

/// Where the first row of each person stands, by what it is of.
#[derive(Debug, Clone, Default)]
pub(super) struct Places {
    pub(super) conditions: BTreeMap<(ParticipantId, ConditionId), usize>,
    pub(super) embeddings: BTreeMap<OfEmbedding, usize>,
    /// All drives of a person in a condition, in the order driven.
    pub(super) drives: BTreeMap<(ParticipantId, ConditionId), Vec<usize>>,
}

impl Places {
    pub(super) fn new(
        measurements: &[MeasuredDrive],
        embeddings: &[EmbeddingRow],
        conditions: &[ConditionRow],
    ) -> Self {
        let mut places = Self::default();
        for (index, row) in conditions.iter().enumerate() {
            let key = (row.participant.clone(), row.condition);
            places.conditions.entry(key).or_insert(index);
        }
        for (index, row) in embeddings.iter().enumerate() {
            let whose = row.participant.clone();
            let key = (whose, row.condition, row.session, row.adb_used);
            places.embeddings.entry(key).or_insert(index);
        }
        for (index, drive) in measurements.iter().enumerate() {
            let key = (drive.meta.participant.clone(), drive.meta.condition);
            places.drives.entry(key).or_default().push(index);
        }
        for drives in places.drives.values_mut() {
            drives.sort_by_key(|&index| measurements[index].meta.occasion());
        }
        places
    }
}
