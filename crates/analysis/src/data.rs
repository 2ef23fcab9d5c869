//! The tables of a study, side by side.

mod answered;
mod cells;
mod measured;
mod places;
mod tables;

pub use tables::Tables;

use crate::{
    AnalysisError,
    balance::OrderBalance,
    exclusions::Rule,
    flow::Flow,
    person::Person,
    turned::{Settled, Turns},
};
use cells::{Cell, FIRST, OwnValues, Sat, Scores};
use maveric_domain::{
    ConditionId, ConditionRow, Design, DriveId, DrivenBy, EmbeddingRow, MeasuredDrive,
    ParticipantId, Scale, Score,
    design::{Condition, Quantity, ScoreName},
    press::{PressMoment, PressedRide},
};
use places::Places;
use std::{
    collections::{BTreeMap, BTreeSet},
    num::NonZeroU32,
};
use tables::Who;

/// What the analyses of a study read: whoever is left out by the design is not in it.
#[derive(Debug, Clone)]
pub struct StudyData {
    /// What the study is.
    pub design: Design,
    /// Those who were tested and drove or rated something, or were measured, sorted: they are searched so.
    pub participants: Vec<ParticipantId>,
    /// What was measured, a row a drive.
    pub(crate) measurements: Vec<MeasuredDrive>,
    /// Fitted embeddings.
    pub(crate) embeddings: Vec<EmbeddingRow>,
    /// Where in style space each condition lies.
    pub(crate) conditions: Vec<ConditionRow>,
    /// How many there were at each step.
    pub flow: Flow,
    /// Where rows of the tables above stand.
    places: Places,
    people: BTreeMap<ParticipantId, Person>,
    scales: Vec<Scale>,
    /// Where people left the dial, a ride each.
    settled: BTreeMap<ParticipantId, Vec<Settled>>,
    /// What was pressed in the rides, and when.
    pressed: (Vec<PressedRide>, Vec<PressMoment>),
    /// The study's own measures by condition and participant.
    own: BTreeMap<ConditionId, BTreeMap<ParticipantId, OwnValues>>,
    /// What was measured of tested people, by condition in a session and participant.
    cells: BTreeMap<Sat, BTreeMap<ParticipantId, Cell>>,
    /// Subscales answered before the drives and after a condition, in the order in which they were scored.
    before: Vec<ScoreName>,
    after: Vec<ScoreName>,
    pre: Scores,
    post: Scores,
    /// Scores of rides that are left out, since people stopped them.
    of_stopped: Vec<Score>,
}

impl StudyData {
    /// Puts the tables of a study side by side, without what the design leaves out, by name or by rule.
    ///
    /// # Errors
    /// [`AnalysisError::TooFewPeople`] for fewer than three who drove or rated a condition, or were measured in it;
    /// [`AnalysisError::NobodyThere`] for a condition in which nobody is there so.
    pub fn new(design: &Design, tables: Tables) -> Result<Self, AnalysisError> {
        let Who { there, left_out, flow } = Who::new(design, &tables);
        let mut measurements = tables.measurements;
        measurements.retain(|d| left_out.keeps(&d.meta.participant, d.meta.ride()));
        let (mut pre, mut post) = (tables.pre, tables.post);
        let unwell = |who: &ParticipantId, ride| {
            let mut stopped = tables.stopped.iter();
            let theirs =
                stopped.any(|s| s.by_the_person() && s.participant == *who && s.ride() == ride);
            let why = left_out.about(who, ride);
            theirs && why.is_some_and(|why| why.rule == Rule::Stopped)
        };
        let stopped = |score: &&Score| {
            let ride = score.moment.ride();
            score.value.is_some() && ride.is_some_and(|ride| unwell(&score.participant, ride))
        };
        let of_stopped: Vec<Score> = post.iter().filter(stopped).cloned().collect();
        for scores in [&mut pre, &mut post] {
            scores.retain(|s| match s.moment.ride() {
                Some(ride) => left_out.keeps(&s.participant, ride),
                None => left_out.keeps_person(&s.participant),
            });
        }
        let cells = cells::cells(&measurements, &there);
        let own_measures = cells::own_measures(design, tables.own, (&there, &left_out));
        let participants: Vec<ParticipantId> =
            there.into_iter().filter(|p| left_out.keeps_person(p)).collect();
        if participants.len() < 3 {
            return Err(AnalysisError::TooFewPeople { found: participants.len() });
        }
        let data = Self {
            design: design.clone(),
            participants,
            flow,
            settled: BTreeMap::new(),
            pressed: Default::default(),
            own: own_measures,
            cells,
            before: cells::subscales(&pre),
            after: cells::subscales(&post),
            pre: Scores::from_rows(&pre),
            post: Scores::from_rows(&post),
            of_stopped,
            places: Places::new(&measurements, &tables.embeddings, &tables.conditions),
            measurements,
            embeddings: tables.embeddings,
            conditions: tables.conditions,
            people: tables.people.into_iter().map(|p| (p.id.clone(), p)).collect(),
            scales: design.with_dropped_items(tables.scales),
        };
        data.somebody_in_each()?;
        Ok(data)
    }

    /// Refuses a condition in which nobody drove, rated or was measured.
    fn somebody_in_each(&self) -> Result<(), AnalysisError> {
        for condition in self.design.conditions() {
            let id = condition.id;
            if !self.participants.iter().any(|p| self.sat_through(p, id)) {
                return Err(AnalysisError::NobodyThere { condition: id });
            }
        }
        Ok(())
    }

    /// Whether this person drove, rated or was measured in a condition of the first session.
    fn sat_through(&self, participant: &ParticipantId, id: ConditionId) -> bool {
        let own = self.own.get(&id);
        let measured = own.is_some_and(|people| people.contains_key(participant));
        self.cell(participant, id).is_some() || measured || self.answered_after(participant, id)
    }

    /// Whether this person answered anything after a ride in a condition.
    fn answered_after(&self, participant: &ParticipantId, id: ConditionId) -> bool {
        let rated = |name| self.rated(participant, id, name).is_some();
        self.after.iter().any(rated)
    }

    /// Those of whom nothing is there in some condition.
    pub(crate) fn partly(&self) -> impl Iterator<Item = &ParticipantId> {
        let conditions = self.design.conditions();
        let lacks = move |p: &&ParticipantId| conditions.iter().any(|c| !self.sat_through(p, c.id));
        self.participants.iter().filter(lacks)
    }

    /// The same, with what was said of rides that people stopped.
    pub(crate) fn with_stopped(&self) -> Self {
        let post = self.post.clone().and(&self.of_stopped);
        Self { post, of_stopped: Vec::new(), ..self.clone() }
    }

    /// Rides that somebody rated by this score and that are left out, since they stopped them.
    pub(crate) fn stopped_rides(&self, quantity: &Quantity) -> usize {
        let Quantity::Score(name) = quantity else {
            return 0;
        };
        let of_score = |score: &&Score| {
            let known = self.participants.binary_search(&score.participant).is_ok();
            let same = score.scale == name.scale && score.subscale == name.subscale;
            known && same
        };
        self.of_stopped.iter().filter(of_score).count()
    }

    /// The same, with how people turned the dial who could.
    #[must_use]
    pub fn with_turns(mut self, turns: &[Turns]) -> Self {
        for ride in turns {
            if let Some(settled) = ride.settled() {
                let participant = ride.participant.clone();
                self.settled.entry(participant).or_default().push(settled);
            }
        }
        self
    }

    /// The same, with what people pressed in those of their rides that count: in the first session, and not left out.
    #[must_use]
    pub fn with_presses(
        mut self,
        mut rides: Vec<PressedRide>,
        mut moments: Vec<PressMoment>,
    ) -> Self {
        let in_cell = |d: &&MeasuredDrive| {
            let meta = &d.meta;
            meta.session == FIRST && self.cell(&meta.participant, meta.condition).is_some()
        };
        let counted = self.measurements.iter().filter(in_cell);
        let counted: BTreeSet<&DriveId> = counted.map(|d| &d.meta.drive).collect();
        rides.retain(|ride| counted.contains(&ride.drive));
        moments.retain(|moment| counted.contains(&moment.drive));
        self.pressed = (rides, moments);
        self
    }

    /// Rides in which people could press.
    pub(crate) fn pressed_rides(&self) -> impl Iterator<Item = &PressedRide> {
        self.pressed.0.iter()
    }

    /// The moments of these rides.
    pub(crate) fn press_moments(&self) -> impl Iterator<Item = &PressMoment> {
        self.pressed.1.iter()
    }

    /// Where somebody left the dial, a ride each.
    pub fn settled(&self, participant: &ParticipantId) -> &[Settled] {
        self.settled.get(participant).map_or(&[], Vec::as_slice)
    }

    /// Whether the people are made up: the design says so, or a drive was a driver model's.
    pub fn is_synthetic(&self) -> bool {
        self.design.synthetic()
            || self.measurements.iter().any(|d| d.meta.driven_by == DrivenBy::Synthetic)
    }

    /// Whether a script drove in place of a person.
    pub fn is_scripted(&self) -> bool {
        self.measurements.iter().any(|d| d.meta.driven_by == DrivenBy::Scripted)
    }

    /// The conditions elsewhere on the dial, in the order of the design.
    pub fn shifted(&self) -> Vec<ConditionId> {
        let away = |c: &&Condition| c.side().is_some();
        self.design.conditions().iter().filter(away).map(|c| c.id).collect()
    }

    /// The embedding of a participant's baseline drive in a session, fitted with or without the score.
    pub(crate) fn embedding_in(
        &self,
        session: NonZeroU32,
        participant: &ParticipantId,
        adb_used: bool,
    ) -> Option<&EmbeddingRow> {
        let baseline = self.design.baseline_id()?;
        let whose = (participant.clone(), baseline, session, adb_used);
        let index = self.places.embeddings.get(&whose)?;
        self.embeddings.get(*index)
    }

    /// The embedding of a participant's baseline drive, fitted with or without the score.
    pub fn embedding(&self, participant: &ParticipantId, adb_used: bool) -> Option<&EmbeddingRow> {
        self.embedding_in(FIRST, participant, adb_used)
    }

    /// The same study with other embeddings.
    #[cfg(test)]
    pub(crate) fn with_embeddings(mut self, embeddings: Vec<EmbeddingRow>) -> Self {
        self.places = Places::new(&self.measurements, &embeddings, &self.conditions);
        self.embeddings = embeddings;
        self
    }

    /// A participant's row of the conditions.
    pub fn condition(
        &self,
        participant: &ParticipantId,
        condition: ConditionId,
    ) -> Option<&ConditionRow> {
        let whose = (participant.clone(), condition);
        self.conditions.get(*self.places.conditions.get(&whose)?)
    }

    /// The conditions in the order in which a participant met them; empty where it is not known.
    pub fn order(&self, participant: &ParticipantId) -> &[ConditionId] {
        let person = self.people.get(participant);
        person.map_or(&[], |person| person.order.as_slice())
    }

    /// In which place of their order a participant met a condition, from 1.
    pub fn period(&self, participant: &ParticipantId, condition: ConditionId) -> Option<usize> {
        let place = self.order(participant).iter().position(|c| *c == condition);
        place.map(|place| place + 1)
    }

    /// Whether the order of anybody who was tested is known.
    pub fn has_orders(&self) -> bool {
        self.participants.iter().any(|p| !self.order(p).is_empty())
    }

    /// Those of whom nothing of the baseline is there; nobody where the design has none.
    pub(crate) fn without_baseline(&self) -> impl Iterator<Item = &ParticipantId> {
        let baseline = self.design.baseline_id();
        let lacks = move |p: &&ParticipantId| baseline.is_some_and(|b| !self.sat_through(p, b));
        self.participants.iter().filter(lacks)
    }

    /// Those who answered no questionnaire about a condition; nobody where none was asked.
    pub(crate) fn without_answer(&self) -> impl Iterator<Item = &ParticipantId> {
        let conditions = self.design.conditions();
        let asks = !self.after.is_empty();
        let lacks = move |p: &&ParticipantId| {
            asks && !conditions.iter().any(|c| self.answered_after(p, c.id))
        };
        self.participants.iter().filter(lacks)
    }

    /// How evenly the conditions stand in the orders of those who were tested; none where no order is known.
    pub(crate) fn order_balance(&self) -> Option<OrderBalance> {
        let orders = self.participants.iter().map(|id| self.order(id));
        OrderBalance::of(&self.design, orders)
    }

    /// What the table of people says of a participant.
    pub fn column(&self, participant: &ParticipantId, column: &str) -> Option<&str> {
        let value = self.people.get(participant)?.columns.get(column)?;
        Some(value.trim()).filter(|v| !v.is_empty() && *v != "NA")
    }
}
