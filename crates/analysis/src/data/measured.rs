//! What was measured of people's drives.

use super::{
    StudyData,
    cells::{Cell, FIRST},
};
use maveric_domain::{ConditionId, MeasureValues, MeasuredDrive, ParticipantId};
use std::{collections::BTreeMap, num::NonZeroU32};

impl StudyData {
    /// What was measured, a row a drive.
    pub fn measurements(&self) -> &[MeasuredDrive] {
        &self.measurements
    }

    /// A measure of a participant's drive, or one of the study's own.
    pub fn measured(
        &self,
        participant: &ParticipantId,
        condition: ConditionId,
        measure: &str,
    ) -> Option<f64> {
        let drive = self.drive(participant, condition);
        let value = drive.and_then(|values| values.get(measure).copied().flatten());
        value.or_else(|| {
            let values = self.own.get(&condition)?.get(participant)?;
            values.get(measure).copied()
        })
    }

    /// Time from the start of a participant's drive over which counts were taken, in s, where the person's drives differ in length.
    pub fn counted_s(&self, participant: &ParticipantId, condition: ConditionId) -> Option<f64> {
        self.cell(participant, condition)?.counted_s
    }

    pub(super) fn cell(
        &self,
        participant: &ParticipantId,
        condition: ConditionId,
    ) -> Option<&Cell> {
        self.cells.get(&(condition, FIRST))?.get(participant)
    }

    /// A measure of a participant's drives in a condition of a session: the mean over them.
    pub(crate) fn measured_in(
        &self,
        session: NonZeroU32,
        participant: &ParticipantId,
        condition: ConditionId,
        measure: &str,
    ) -> Option<f64> {
        let cell = self.cells.get(&(condition, session))?.get(participant)?;
        cell.values.get(measure).copied().flatten()
    }

    /// How many rides of a participant in a condition of the first session count: those that were driven, and those of which something was said.
    pub fn rides(&self, participant: &ParticipantId, condition: ConditionId) -> usize {
        let mut rides = self.post.rides(participant, condition.into());
        let cell = self.cell(participant, condition);
        rides.extend(cell.into_iter().flat_map(|cell| &cell.rides));
        rides.len()
    }

    /// The measures of a participant's drive; of several rides in a condition of the first session their means.
    pub fn drive(
        &self,
        participant: &ParticipantId,
        condition: ConditionId,
    ) -> Option<&MeasureValues> {
        Some(&self.cell(participant, condition)?.values)
    }

    /// A measure of a participant's baseline drive.
    pub fn baseline(&self, participant: &ParticipantId, measure: &str) -> Option<f64> {
        self.measured(participant, self.design.baseline_id()?, measure)
    }

    /// A measure of the baseline drive that a participant made after the first, of those who drove twice.
    pub fn second_drive(&self, participant: &ParticipantId, measure: &str) -> Option<f64> {
        let baseline = self.design.baseline_id()?;
        let drives = self.places.drives.get(&(participant.clone(), baseline))?;
        let second = self.measurements.get(*drives.get(1)?)?;
        second.values.get(measure).copied().flatten()
    }

    /// Whether any tested person's drive has this measure, or any of them was measured so.
    pub(crate) fn is_measured(&self, measure: &str) -> bool {
        let mut cells = self.cells.values().flat_map(BTreeMap::values);
        let mut own_values = self.own.values().flat_map(BTreeMap::values);
        cells.any(|cell| cell.values.get(measure).is_some_and(Option::is_some))
            || own_values.any(|values| values.contains_key(measure))
    }

    /// A measure of every baseline drive that the networks learned from and that has it.
    pub fn training_drives(&self, measure: &str) -> Vec<f64> {
        let learned = |d: &&MeasuredDrive| {
            let person = self.people.get(&d.meta.participant);
            person.is_some_and(|p| p.learned) && Some(d.meta.condition) == self.design.baseline_id()
        };
        self.measurements
            .iter()
            .filter(learned)
            .filter_map(|d| d.values.get(measure).copied().flatten())
            .collect()
    }
}
