//! What a study is: one file, `study.toml`, that everything above borrows.
//!
//! [`Design::from_toml`] checks the file's shape once; whether its scales, measures and people exist is for those who
//! hold them to say.

mod answer_rule;
mod car_check;
mod check;
mod condition;
mod contrast;
mod error;
mod exclude;
mod factors;
mod files;
mod lending;
mod needs;
mod orders;
mod outcome;
mod own_measure;
mod people;
mod protocol;
mod protocol_check;
mod ridden;
#[cfg(feature = "schema")]
mod schema;
mod tested;
mod toml_file;
mod validate;
mod which;
mod williams;

pub use answer_rule::{AnswerRule, Than};
pub use condition::{Baseline, By, Car, Color, Condition, Donors, Matched, Role, Sign};
pub use contrast::{Claim, Compare, Hypothesis, LevelContrast, Levels};
pub use error::DesignError;
pub use exclude::Exclude;
pub use factors::crossed;
pub use files::{BeyondRule, Files, Mappings, ModelFile, RigMapping, Software};
pub use lending::{FEWEST_DONORS, Offer, Reach};
pub use needs::{InputDevice, Needs};
pub use orders::OrderPlan;
pub use outcome::{DeclaredTest, Homophily, Outcome, Quantity, ScoreName, Style};
pub use own_measure::{ABOUT_A_ROW, OwnMeasure};
pub use people::{CONDITION, Covariate, Factor, People};
pub use protocol::{
    Crash, Practice, Probe, Protocol, ProtocolStep, Redirect, SeatView, Sessions, World,
};
pub use protocol_check::{DRIVES_S, is_day};
#[cfg(feature = "schema")]
pub use schema::schema;
pub use validate::{Asks, ValidateTable, ValidateTables};
pub use which::WHICH;
pub use williams::{Square, williams, williams_rows};

use crate::{
    condition::ConditionId,
    occasion::{Occasion, Ride},
    survey::Scale,
    units::SpeedUnit,
};
use std::collections::BTreeMap;

/// A study: who takes part, in which conditions, what is measured and what is compared.
///
/// Read from a `study.toml` by [`Design::from_toml`], and never half checked.
///
/// # Example
/// ```
/// # use maveric_domain::Design;
/// let design = Design::from_toml(r#"
///     [study]
///     title = "Calm or sporty"
///     [[condition]]
///     id = "calm"
///     [[condition]]
///     id = "sporty"
///     [baseline]
///     id = "own"
/// "#)?;
/// assert_eq!(design.contrasts().len(), 1);
/// # Ok::<(), maveric_domain::DesignError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    title: String,
    authors: Vec<String>,
    synthetic: bool,
    speed_unit: SpeedUnit,
    files: Files,
    people: People,
    model: Option<ModelFile>,
    beyond: BeyondRule,
    style: Option<Style>,
    conditions: Vec<Condition>,
    baseline: Option<Baseline>,
    roles: Vec<Role>,
    measures: Vec<OwnMeasure>,
    outcomes: Vec<Outcome>,
    hypotheses: Vec<Hypothesis>,
    compare: Compare,
    factors: Vec<Factor>,
    crossed: Vec<Factor>,
    level_contrasts: Vec<LevelContrast>,
    covariates: Vec<Covariate>,
    homophily: Option<Homophily>,
    validate: ValidateTables,
    protocol: Protocol,
    exclude: Exclude,
    amendments: BTreeMap<String, String>,
}

impl Design {
    /// What heads the page.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// Who made the study.
    pub fn authors(&self) -> &[String] {
        &self.authors
    }

    /// Whether the people are made up: said on every page, picture and table.
    pub fn synthetic(&self) -> bool {
        self.synthetic
    }

    /// In which unit people read speeds: metric where the study says nothing.
    pub fn speed_unit(&self) -> SpeedUnit {
        self.speed_unit
    }

    /// Where the study's files are, from the folder of the design's file.
    pub fn files(&self) -> &Files {
        &self.files
    }

    /// Who is learned from, and who is tested.
    pub fn people(&self) -> &People {
        &self.people
    }

    /// The model that was learned elsewhere.
    pub fn model(&self) -> Option<&ModelFile> {
        self.model.as_ref()
    }

    /// What becomes of the dial for somebody beyond what the model has learned from.
    pub fn beyond(&self) -> BeyondRule {
        self.beyond
    }

    /// What the dial turns; none where there is no dial.
    pub fn style(&self) -> Option<&Style> {
        self.style.as_ref()
    }

    /// The conditions, in the order of the page.
    pub fn conditions(&self) -> &[Condition] {
        &self.conditions
    }

    /// The ids of the conditions, in the same order.
    pub fn condition_ids(&self) -> impl ExactSizeIterator<Item = ConditionId> + Clone {
        self.conditions.iter().map(|c| c.id)
    }

    /// The condition of this id.
    pub fn condition(&self, id: ConditionId) -> Option<&Condition> {
        self.conditions.iter().find(|c| c.id == id)
    }

    /// The first condition that drives as the person does.
    pub fn own_style(&self) -> Option<ConditionId> {
        let own = self.conditions.iter().find(|c| c.in_own_style());
        own.map(|c| c.id)
    }

    /// Whether a car in the person's own style stands beside one elsewhere on the dial: then ratings of the two have a difference.
    pub fn has_style_differences(&self) -> bool {
        let mut conditions = self.conditions.iter();
        self.own_style().is_some() && conditions.any(|c| c.side().is_some())
    }

    /// The condition that moves across the dial.
    pub fn across(&self) -> Option<ConditionId> {
        let is_across = |c: &&Condition| c.car == Some(Car::Across);
        self.conditions.iter().find(is_across).map(|c| c.id)
    }

    /// The drive that differences are taken from.
    pub fn baseline(&self) -> Option<&Baseline> {
        self.baseline.as_ref()
    }

    /// The label of its drives; `None` without a baseline.
    pub fn baseline_id(&self) -> Option<ConditionId> {
        self.baseline.as_ref().map(|b| b.id)
    }

    /// The label of a drive by hand in one's own style: the baseline's; without a baseline `own`.
    pub fn own_drive_label(&self) -> &str {
        let baseline = self.baseline.as_ref();
        baseline.map_or("own", |baseline| baseline.id.as_str())
    }

    /// Drives by hand that were asked to be different: learned from, never tested.
    pub fn roles(&self) -> &[Role] {
        &self.roles
    }

    /// The role whose instruction a drive of this label followed: itself, or the one that it repeats; none for what is no role.
    pub fn role(&self, id: ConditionId) -> Option<&Role> {
        let role = self.roles.iter().find(|r| r.id == id)?;
        let first = |of: ConditionId| self.roles.iter().find(|r| r.id == of);
        role.repeats.map_or(Some(role), first)
    }

    /// The measures that the study brings along, in the order of the file.
    pub fn measures(&self) -> &[OwnMeasure] {
        &self.measures
    }

    /// The study's own measure of this id.
    pub fn measure(&self, id: &str) -> Option<&OwnMeasure> {
        self.measures.iter().find(|m| m.id == id)
    }

    /// Whether an outcome, a hypothesis or what is expected of a condition names this measure.
    pub fn names(&self, measure: &str) -> bool {
        let outcome = |o: &Outcome| matches!(&o.quantity, Quantity::Measure(id) if id == measure);
        self.outcomes.iter().any(outcome)
            || self.hypotheses.iter().any(|h| h.outcome == measure)
            || self.conditions.iter().any(|c| c.expected.contains_key(measure))
    }

    /// What is tested, in the order of the page; empty where the file leaves it to what is there: all objective measures,
    /// the study's own, and every scale asked after a condition.
    pub fn outcomes(&self) -> &[Outcome] {
        &self.outcomes
    }

    /// The questionnaires of the study, each with its scores without the items that an outcome drops.
    pub fn with_dropped_items(&self, mut scales: Vec<Scale>) -> Vec<Scale> {
        for outcome in self.outcomes.iter().filter(|o| !o.drop_items.is_empty()) {
            let Quantity::Score(name) = &outcome.quantity else {
                continue;
            };
            for scale in scales.iter_mut().filter(|s| s.id == name.scale) {
                let whole = scale.subscales.iter().find(|s| s.id == name.subscale);
                let reduced = whole.map(|whole| whole.without_items(&outcome.drop_items));
                scale.subscales.extend(reduced);
            }
        }
        scales
    }

    /// What was predicted.
    pub fn hypotheses(&self) -> &[Hypothesis] {
        &self.hypotheses
    }

    /// How contrasts were declared.
    pub fn compare(&self) -> &Compare {
        &self.compare
    }

    /// The pairs of conditions that are compared: one Holm family an outcome.
    pub fn contrasts(&self) -> Vec<[ConditionId; 2]> {
        self.compare.pairs(&self.conditions)
    }

    /// Columns of the people's table that divide them into groups.
    pub fn factors(&self) -> &[Factor] {
        &self.factors
    }

    /// The factors within people, each with its levels in the order of the conditions: those that the conditions cross, else the
    /// conditions themselves.
    pub fn factors_within(&self) -> Vec<(String, Vec<String>)> {
        factors::within(&self.conditions)
    }

    /// The declared contrasts of levels: one Holm family an outcome.
    pub fn level_contrasts(&self) -> &[LevelContrast] {
        &self.level_contrasts
    }

    /// What pages call a factor or a covariate.
    pub fn factor_label(&self, name: &str) -> String {
        let factor = self.factor(name).and_then(|f| f.label.as_ref());
        let covariate = || self.covariates.iter().find(|c| c.column == name)?.label.as_ref();
        factor.or_else(covariate).map_or_else(|| name.to_owned(), Clone::clone)
    }

    /// What pages call a level of a factor.
    pub fn level_label(&self, factor: &str, level: &str) -> String {
        let given = self.factor(factor).and_then(|f| f.levels.get(level));
        let condition = || Some(self.label(level.parse().ok().filter(|_| factor == CONDITION)?));
        given.cloned().or_else(condition).unwrap_or_else(|| level.to_owned())
    }

    fn factor(&self, name: &str) -> Option<&Factor> {
        let mut factors = self.factors.iter().chain(&self.crossed);
        factors.find(|factor| factor.name == name)
    }

    /// A declared test that can never be run over everybody, with what stands in its way, such as `friedman` beside a factor of people; none
    /// where it can be.
    pub fn never_run(&self, test: DeclaredTest) -> Option<String> {
        tested::never_run(test, &self.factors, &self.covariates, &self.conditions)
    }

    /// Refuses a primary outcome whose test can never be run: whoever declares it has to choose another one. A study that is under way goes
    /// on, and the outcome is not testable.
    ///
    /// # Errors
    /// [`DesignError::Key`] naming the first such test.
    pub fn runnable(&self) -> Result<(), DesignError> {
        for (at, outcome) in self.outcomes.iter().enumerate() {
            let test = outcome.test.filter(|_| outcome.primary.is_some());
            if let Some(found) = test.and_then(|test| self.never_run(test)) {
                return Err(DesignError::key(
                    format!("outcome[{}].test", at + 1),
                    found,
                    "\"mixed\": the other tests that a primary outcome can have are of one factor within people, and of nothing else",
                ));
            }
        }
        Ok(())
    }

    /// The columns of the people's table that the tests need: of factors, then of covariates.
    pub fn tested_columns(&self) -> impl Iterator<Item = &str> {
        let factors = self.factors.iter().map(|f| f.name.as_str());
        factors.chain(self.covariates.iter().map(|c| c.column.as_str()))
    }

    /// Columns of the people's table whose influence is taken out.
    pub fn covariates(&self) -> &[Covariate] {
        &self.covariates
    }

    /// Which traits are set against which ratings.
    pub fn homophily(&self) -> Option<&Homophily> {
        self.homophily.as_ref()
    }

    /// The tables about people who are left out in turn.
    pub fn validate(&self) -> &ValidateTables {
        &self.validate
    }

    /// What a person meets in the seat.
    pub fn protocol(&self) -> &Protocol {
        &self.protocol
    }

    /// Whether it says what people meet in the seat; how many sessions and rides they have is said of logs from elsewhere too.
    pub fn has_seat(&self) -> bool {
        let default = Protocol::default();
        let of_the_seat = Protocol {
            rides_per_condition: default.rides_per_condition,
            sessions: default.sessions,
            seed: default.seed,
            ..self.protocol.clone()
        };
        of_the_seat != Protocol::default()
    }

    /// Whether a person has several sessions, or several rides in a condition.
    pub fn repeats(&self) -> bool {
        let rides = self.protocol.rides_per_condition;
        rides > 1 || self.protocol.session_count() > 1
    }

    /// The sessions and trials in which a person drives under a label: every ride of a condition, the baseline once a session, a role once.
    pub fn occasions(&self, label: ConditionId) -> Vec<Occasion> {
        let (sessions, trials) = if self.condition(label).is_some() {
            let rides = self.protocol.rides_per_condition;
            (self.protocol.session_count(), rides)
        } else if self.baseline_id() == Some(label) {
            (self.protocol.session_count(), 1)
        } else {
            (1, 1)
        };
        let session = |s| (1..=trials).filter_map(move |t| Occasion::new(s, t));
        (1..=sessions).flat_map(session).collect()
    }

    /// Every drive or ride of a person under a label, as [`Design::occasions`] has them.
    pub fn rides(&self, condition: ConditionId) -> impl Iterator<Item = Ride> + use<> {
        let occasions = self.occasions(condition).into_iter();
        occasions.map(move |occasion| Ride { condition, occasion })
    }

    /// What is left out before anything is computed.
    pub fn exclude(&self) -> &Exclude {
        &self.exclude
    }

    /// Keys that were changed after the design was frozen, each with its reason.
    pub fn amendments(&self) -> &BTreeMap<String, String> {
        &self.amendments
    }

    /// Every label that a drive may have: baseline, conditions, roles; each once, in this order.
    pub fn labels(&self) -> Vec<ConditionId> {
        let ids = self.baseline_id().into_iter();
        let ids = ids.chain(self.condition_ids());
        let mut labels: Vec<ConditionId> = Vec::new();
        for id in ids.chain(self.roles.iter().map(|r| r.id)) {
            if !labels.contains(&id) {
                labels.push(id);
            }
        }
        labels
    }

    /// Whether a drive may have this label.
    pub fn knows(&self, id: ConditionId) -> bool {
        self.labels().contains(&id)
    }

    /// What a page calls a condition, the baseline or a role.
    pub fn label(&self, id: ConditionId) -> String {
        let condition = self.condition(id).map(|c| &c.label);
        let baseline = self.baseline.iter().filter(|b| b.id == id);
        let role = self.roles.iter().filter(|r| r.id == id);
        let mut named =
            condition.into_iter().chain(baseline.map(|b| &b.label)).chain(role.map(|r| &r.label));
        named.next().map_or_else(|| id.to_string(), ToString::to_string)
    }

    /// Whether a car that was learned drives in some condition.
    pub fn needs_a_model(&self) -> bool {
        let learned = |c: &Condition| c.car.as_ref().is_some_and(|car| *car != Car::Replay);
        self.conditions.iter().any(learned)
    }

    /// Whether the car turns a dial in some condition.
    pub fn has_a_dial(&self) -> bool {
        self.style.is_some()
    }
}
