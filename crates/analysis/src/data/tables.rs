//! The tables of a study, and who is in it.

use super::cells::FIRST;
use crate::{
    consents::{ConsentRow, NotAgreed, versions},
    exclusions::{Driven, LeftOut, Stopped},
    flow::{self, Flow, NotAdmitted},
    person::Person,
};
use maveric_domain::{
    Answer, ConditionRow, Design, DriveId, EmbeddingRow, MeasuredDrive, Moment, OwnMeasurement,
    ParticipantId, Ride, Scale, Score,
};
use std::collections::{BTreeMap, BTreeSet};

/// The tables of a study, as stages write them: made by a run, or in memory.
#[derive(Debug, Clone, Default)]
pub struct Tables {
    /// Who takes part; where it is empty, everybody who drove was tested.
    pub people: Vec<Person>,
    /// What was measured, a row a drive.
    pub measurements: Vec<MeasuredDrive>,
    /// What the study's own measures say of people in conditions.
    pub own: Vec<OwnMeasurement>,
    /// Fitted embeddings; empty without a model.
    pub embeddings: Vec<EmbeddingRow>,
    /// Where in style space each condition lies; empty without a learned car.
    pub conditions: Vec<ConditionRow>,
    /// Scores of the questionnaires before the drives.
    pub pre: Vec<Score>,
    /// Scores of the ratings after the conditions, those of rides that are left out among them.
    pub post: Vec<Score>,
    /// The questionnaires.
    pub scales: Vec<Scale>,
    /// Answers, by which the design's rules judge sheets.
    pub answers: Vec<Answer>,
    /// How long each drive took, in s, where it is known.
    pub durations_s: BTreeMap<DriveId, f64>,
    /// Drives that the design kept from being measured.
    pub kept_out: Vec<Driven>,
    /// Drives and rides that people stopped.
    pub stopped: Vec<Stopped>,
    /// People who wanted to take part and were not admitted.
    pub not_admitted: Vec<NotAdmitted>,
    /// The texts that people agreed to.
    pub consents: Vec<ConsentRow>,
    /// People who did not agree.
    pub not_agreed: Vec<NotAgreed>,
}

/// Who is in a study, and who is left out of it.
pub(super) struct Who {
    /// Those who are tested and came, whether or not they are left out.
    pub(super) there: BTreeSet<ParticipantId>,
    pub(super) left_out: LeftOut,
    pub(super) flow: Flow,
}

impl Who {
    pub(super) fn new(design: &Design, tables: &Tables) -> Self {
        let driven: Vec<Driven> = tables
            .measurements
            .iter()
            .map(|d| Driven {
                drive: d.meta.drive.clone(),
                participant: d.meta.participant.clone(),
                ride: d.meta.ride(),
                duration_s: tables.durations_s.get(&d.meta.drive).copied(),
            })
            .collect();
        let judged: Vec<Driven> =
            driven.iter().cloned().chain(tables.kept_out.iter().cloned()).collect();
        let in_study = |c| design.baseline_id() == Some(c) || design.condition(c).is_some();
        let tested = |p: &ParticipantId| {
            tables.people.is_empty() || tables.people.iter().any(|q| q.id == *p && q.tested)
        };
        let rated = tables.post.iter().filter_map(|s| match s.moment {
            Moment::After(r) | Moment::Probe(r) if s.value.is_some() => Some((&s.participant, r)),
            _ => None,
        });
        let measured = tables.own.iter();
        let measured = measured.map(|m| (&m.participant, Ride::from(m.condition)));
        let without_drive = rated.chain(measured);
        let came = judged.iter().map(|d| (&d.participant, d.ride));
        let came = came.chain(without_drive.clone());
        let first_session = |ride: &Ride| ride.occasion.session == FIRST;
        let mut left_out = LeftOut::named(design)
            .with_stopped(&tables.stopped)
            .with_excluded(&tables.stopped)
            .with_careless(design, &tables.scales, &tables.answers)
            .with_short(design, &judged)
            .with_few_conditions(design, came.clone().filter(|(_, ride)| first_session(ride)));
        let there: BTreeSet<ParticipantId> = came
            .filter(|(p, ride)| in_study(ride.condition) && tested(p))
            .map(|(p, _)| p.clone())
            .collect();
        let kept: BTreeSet<ParticipantId> = driven
            .iter()
            .map(|d| (&d.participant, d.ride))
            .chain(without_drive)
            .filter(|(p, ride)| in_study(ride.condition) && left_out.keeps(p, *ride))
            .map(|(p, _)| p.clone())
            .collect();
        left_out.and_without_drives(&judged, &kept);
        let flow = flow::flow(
            design,
            &tables.people,
            &there,
            &left_out,
            (&tables.not_admitted, versions(&tables.consents, &tables.not_agreed)),
        );
        Self { there, left_out, flow }
    }
}
