//! What is tested: the outcomes of the design, or all that there is.

use crate::data::StudyData;
use maveric_domain::{
    ConditionId, Design, ParticipantId,
    design::{Condition, DeclaredTest, Outcome, Quantity, ScoreName, Sign},
};
use maveric_measures::objective;

/// An outcome with all that is known of it.
#[derive(Debug, Clone)]
pub(crate) struct Asked {
    /// The measure's column, or `SCALE.SUBSCALE`.
    pub(crate) id: String,
    pub(crate) title: String,
    /// Unit in which people read it; empty for counts and shares.
    pub(crate) unit: String,
    /// What a value is multiplied with to be in that unit.
    pub(crate) factor: f64,
    /// The score that means "as I do".
    pub(crate) same: Option<f64>,
    /// Which way a more aggressive drive moves it.
    pub(crate) aggression: Option<Sign>,
    pub(crate) quantity: Quantity,
    /// Lowest and highest score that there can be; none for a measure.
    pub(crate) range: Option<(f64, f64)>,
    /// Differences of at most this much count as none, where the design says so.
    pub(crate) same_within: Option<f64>,
    /// Its test, where the design declares one.
    pub(crate) test: Option<DeclaredTest>,
    /// The contrast that decides about a primary outcome.
    pub(crate) primary: Option<[ConditionId; 2]>,
}

impl Asked {
    fn from_outcome(data: &StudyData, declared: &Outcome) -> Self {
        let mut outcome = match &declared.quantity {
            Quantity::Measure(name) => Self::measure(&data.design, name),
            Quantity::Score(name) => Self::score(data, name),
        };
        if let Some(label) = &declared.label {
            outcome.title.clone_from(label);
        }
        outcome.same_within = declared.same_within;
        (outcome.test, outcome.primary) = (declared.test, declared.primary);
        outcome
    }

    /// A measure of the study's own, an objective one, or another column of the measurements.
    pub(crate) fn measure(design: &Design, name: &str) -> Self {
        let known = objective::find(name);
        let declared = design.measure(name);
        let title = match (declared, known) {
            (Some(declared), _) => declared.title.as_str(),
            (None, Some(known)) => known.title,
            (None, None) => name,
        };
        Self {
            id: name.to_owned(),
            title: title.to_owned(),
            unit: shown_unit(design, name).to_owned(),
            factor: known.map_or(1.0, |m| m.shown.factor(design.speed_unit())),
            same: None,
            aggression: declared.map_or_else(|| known.and_then(|m| m.aggression), |m| m.aggression),
            quantity: Quantity::Measure(name.to_owned()),
            range: None,
            same_within: None,
            test: None,
            primary: None,
        }
    }

    pub(crate) fn score(data: &StudyData, name: &ScoreName) -> Self {
        let subscale = data.subscale(name);
        let range = subscale.map(|(scale, subscale)| scale.score_range(subscale));
        Self {
            id: name.to_string(),
            title: data.score_title(name),
            unit: range.map_or_else(String::new, |(low, high)| format!("rating, {low} to {high}")),
            factor: 1.0,
            same: subscale.and_then(|(_, subscale)| subscale.same),
            aggression: None,
            quantity: Quantity::Score(name.clone()),
            range,
            same_within: None,
            test: None,
            primary: None,
        }
    }

    /// The same outcome by its score without the items that it drops; the contrasts and what is expected of it stay those of the outcome.
    pub(crate) fn without_items(data: &StudyData, outcome: &Outcome) -> Option<Self> {
        let reduced = Self::score(data, &outcome.score_without_items()?);
        Some(Self { id: outcome.id(), test: outcome.test, primary: outcome.primary, ..reduced })
    }

    /// The measure's column; none of a score.
    pub(crate) fn column(&self) -> Option<&str> {
        match &self.quantity {
            Quantity::Measure(name) => Some(name),
            Quantity::Score(_) => None,
        }
    }

    /// What a participant has of it in a condition, in the unit of the tables.
    pub(crate) fn value(&self, data: &StudyData, p: &ParticipantId, c: ConditionId) -> Option<f64> {
        match &self.quantity {
            Quantity::Measure(name) => data.measured(p, c, name),
            Quantity::Score(name) => data.rated(p, c, name),
        }
    }

    /// Which way it moves when the dial is turned up: with aggression, or against it where the score of the style counts calmness.
    fn dial_up(&self, data: &StudyData) -> Option<Sign> {
        let style = data.design.style().map_or(Sign::Plus, |s| s.aggression);
        Some(self.aggression? * style)
    }

    /// Which way a condition is expected to move it against the baseline.
    fn against_baseline(&self, data: &StudyData, condition: &Condition) -> Option<Sign> {
        let expected = condition.expected.get(&self.id).copied();
        expected.or_else(|| Some(self.dial_up(data)? * condition.side()?))
    }

    /// Which way first minus second is expected to lie: as the design says, else by their places on the dial.
    pub(crate) fn expected(
        &self,
        data: &StudyData,
        first: ConditionId,
        second: ConditionId,
    ) -> Option<Sign> {
        let condition_of = |id| data.design.condition(id);
        let is_baseline = |id| data.design.baseline_id() == Some(id);
        let declares = |id| condition_of(id).is_some_and(|c| c.expected.contains_key(&self.id));
        if !declares(first) && !declares(second) {
            let dial =
                |id| condition_of(id).map_or(is_baseline(id).then_some(0.0), Condition::dial);
            return Some(self.dial_up(data)? * Sign::of(dial(first)? - dial(second)?)?);
        }
        let place = |id| -> Option<f64> {
            let condition = condition_of(id);
            let sign = condition.and_then(|c| self.against_baseline(data, c));
            let still = is_baseline(id) || condition?.in_own_style();
            sign.map(Sign::factor).or(still.then_some(0.0))
        };
        Sign::of(place(first)? - place(second)?)
    }
}

/// The unit in which pages show an outcome, and in which bounds of its differences are declared; empty of a score, a count and a share.
pub fn shown_unit<'a>(design: &'a Design, outcome: &str) -> &'a str {
    match (design.measure(outcome), objective::find(outcome)) {
        (Some(declared), _) => declared.shown_unit(),
        (None, Some(known)) => known.shown.unit(design.speed_unit()),
        (None, None) => "",
    }
}

/// The outcomes of the design; where it names none, all measures that somebody has, the study's own last, and every score of a condition.
pub(crate) fn outcomes(data: &StudyData) -> Vec<Asked> {
    let declared = data.design.outcomes();
    if !declared.is_empty() {
        return declared.iter().map(|o| Asked::from_outcome(data, o)).collect();
    }
    let measured = objective::all().iter().map(|m| m.name);
    let measured = measured.chain(data.design.measures().iter().map(|m| m.id.as_str()));
    let measured = measured.filter(|name| data.is_measured(name));
    let rated = data.rated_names().iter().filter(|name| {
        let conditions = data.design.conditions();
        let in_one = |p| conditions.iter().any(|c| data.rated(p, c.id, name).is_some());
        data.participants.iter().any(in_one)
    });
    measured
        .map(|name| Asked::measure(&data.design, name))
        .chain(rated.map(|name| Asked::score(data, name)))
        .collect()
}

/// The outcomes, then those of `more` that are not among them.
pub(crate) fn outcomes_and(data: &StudyData, more: impl IntoIterator<Item = Asked>) -> Vec<Asked> {
    let mut all_outcomes = outcomes(data);
    for one in more {
        if !all_outcomes.iter().any(|a| a.id == one.id) {
            all_outcomes.push(one);
        }
    }
    all_outcomes
}

/// The outcome of this id: declared, a measure, or a score.
pub(crate) fn outcome(data: &StudyData, id: &str) -> Asked {
    let declared = data.design.outcomes().iter().find(|o| o.id() == id);
    match (declared, id.parse::<ScoreName>()) {
        (Some(outcome), _) => Asked::from_outcome(data, outcome),
        (None, Ok(name)) => Asked::score(data, &name),
        (None, Err(_)) => Asked::measure(&data.design, id),
    }
}
