//! What people have in a condition of a session: what was measured, what they said.

use crate::exclusions::LeftOut;
use maveric_domain::{
    ConditionId, Design, MeasureValues, MeasuredDrive, Moment, Occasion, OwnMeasurement,
    ParticipantId, Ride, Score, design::ScoreName, occasion::first,
};
use maveric_stats::mean;
use std::{
    collections::{BTreeMap, BTreeSet},
    num::NonZeroU32,
};

/// Scores by scale, subscale, moment and participant; a moment is that of a session's first ride, and has a score a ride.
#[derive(Debug, Clone, Default)]
pub(super) struct Scores(BTreeMap<String, BTreeMap<String, ByMoment>>);

/// Scores of one subscale.
pub(super) type ByMoment = BTreeMap<Moment, BTreeMap<ParticipantId, BTreeMap<NonZeroU32, f64>>>;

/// The first session.
pub(super) const FIRST: NonZeroU32 = first();

/// A condition in a session.
pub(super) type Sat = (ConditionId, NonZeroU32);

/// A condition in the session of a ride, and which ride of it.
pub(super) fn sat(ride: Ride) -> (Sat, NonZeroU32) {
    let Occasion { session, trial } = ride.occasion;
    ((ride.condition, session), trial)
}

/// What was measured of a person in a condition of a session: the mean over its rides that stayed.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cell {
    pub(super) values: MeasureValues,
    pub(super) counted_s: Option<f64>,
    /// Which of the rides stayed.
    pub(super) rides: BTreeSet<NonZeroU32>,
}

impl Cell {
    /// Means of the rides that have a value, measure by measure.
    pub(super) fn from_rides(rides: &BTreeMap<NonZeroU32, &MeasuredDrive>) -> Self {
        let mut values: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        for (measure, value) in rides.values().flat_map(|ride| &ride.values) {
            values.entry(measure.clone()).or_default().extend(*value);
        }
        let counted: Vec<f64> = rides.values().filter_map(|ride| ride.counted_s).collect();
        Self {
            values: values.into_iter().map(|(measure, values)| (measure, mean(&values))).collect(),
            counted_s: mean(&counted),
            rides: rides.keys().copied().collect(),
        }
    }
}

impl Scores {
    pub(super) fn from_rows(scores: &[Score]) -> Self {
        Self::default().and(scores)
    }

    /// The same with these scores too.
    pub(super) fn and(mut self, scores: &[Score]) -> Self {
        let sorted = &mut self;
        for score in scores {
            if let Some(value) = score.value {
                let ride = score.moment.ride().map(|ride| ride.occasion);
                let Occasion { session, trial } = ride.unwrap_or_default();
                let moment = score.moment.on(Occasion { session, trial: FIRST });
                sorted
                    .0
                    .entry(score.scale.clone())
                    .or_default()
                    .entry(score.subscale.clone())
                    .or_default()
                    .entry(moment)
                    .or_default()
                    .entry(score.participant.clone())
                    .or_default()
                    .entry(trial)
                    // The first of several, as a reader of the table would find it.
                    .or_insert(value);
            }
        }
        self
    }

    /// Which rides of a condition in a session have a score, said after them or on the way; `first` is its first ride.
    pub(super) fn rides(&self, p: &ParticipantId, first: Ride) -> BTreeSet<NonZeroU32> {
        let moments = [Moment::After(first), Moment::Probe(first)];
        let of_scores = self.0.values().flat_map(BTreeMap::values);
        let of_moments =
            of_scores.flat_map(|score| moments.iter().filter_map(move |m| score.get(m)));
        let rides = of_moments.filter_map(|people| people.get(p));
        rides.flat_map(BTreeMap::keys).copied().collect()
    }

    /// The score of a moment, of several rides in the condition their mean.
    pub(super) fn get(
        &self,
        p: &ParticipantId,
        moment: Moment,
        scale: &str,
        subscale: &str,
    ) -> Option<f64> {
        let rides = self.0.get(scale)?.get(subscale)?.get(&moment)?.get(p)?;
        mean(&rides.values().copied().collect::<Vec<f64>>())
    }
}

/// What was measured of those who are there, by condition in a session.
pub(super) fn cells(
    measurements: &[MeasuredDrive],
    there: &BTreeSet<ParticipantId>,
) -> BTreeMap<Sat, BTreeMap<ParticipantId, Cell>> {
    let mut rides: BTreeMap<Sat, BTreeMap<ParticipantId, BTreeMap<_, _>>> = BTreeMap::new();
    for drive in measurements {
        if there.contains(&drive.meta.participant) {
            let (sat, trial) = sat(drive.meta.ride());
            let people = rides.entry(sat).or_default();
            let rides = people.entry(drive.meta.participant.clone()).or_default();
            rides.entry(trial).or_insert(drive);
        }
    }
    let cells = rides.into_iter().map(|(sat, people)| {
        let cells = people.into_iter().map(|(who, rides)| (who, Cell::from_rides(&rides)));
        (sat, cells.collect())
    });
    cells.collect()
}

/// Values of the study's own measures, by name.
pub(super) type OwnValues = BTreeMap<String, f64>;

/// What the study's own measures say of those who are there: a mean over the rides of the first session stays as long as one of
/// them does.
pub(super) fn own_measures(
    design: &Design,
    rows: Vec<OwnMeasurement>,
    (there, left_out): (&BTreeSet<ParticipantId>, &LeftOut),
) -> BTreeMap<ConditionId, BTreeMap<ParticipantId, OwnValues>> {
    let mut measured: BTreeMap<ConditionId, BTreeMap<ParticipantId, OwnValues>> = BTreeMap::new();
    for row in rows {
        let keeps =
            |ride: Ride| ride.occasion.session == FIRST && left_out.keeps(&row.participant, ride);
        if there.contains(&row.participant) && design.rides(row.condition).any(keeps) {
            let people = measured.entry(row.condition).or_default();
            let values = people.entry(row.participant).or_default();
            values.insert(row.measure, row.value);
        }
    }
    measured
}

/// The subscales of these scores, in their order.
pub(super) fn subscales(scores: &[Score]) -> Vec<ScoreName> {
    let mut names: Vec<ScoreName> = Vec::new();
    for score in scores {
        let name = ScoreName { scale: score.scale.clone(), subscale: score.subscale.clone() };
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}
