//! Who and what is left out, and by which rule: the one place that judges drives, answers and people alike.

use maveric_domain::{
    Answer, ConditionId, Design, DriveId, Occasion, ParticipantId, Ride, Scale,
    occasion::{first, is_first},
};
use maveric_measures::{
    ScoreWarning,
    survey::{attention_missed, response_styles},
};
use serde::{Deserialize, Serialize};
use std::{
    collections::{BTreeMap, BTreeSet},
    fmt,
    num::NonZeroU32,
};

/// A drive that is there.
#[derive(Debug, Clone, PartialEq)]
pub struct Driven {
    /// Its id.
    pub drive: DriveId,
    /// Whose.
    pub participant: ParticipantId,
    /// In which condition, and which of several.
    pub ride: Ride,
    /// How long it took, in s; `None` where it is not known.
    pub duration_s: Option<f64>,
}

/// A drive or a ride that somebody stopped, since they felt unwell, or that the experimenter left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Stopped {
    /// Who.
    pub participant: ParticipantId,
    /// In which condition.
    pub condition: ConditionId,
    /// Of which session.
    #[serde(default = "first", skip_serializing_if = "is_first")]
    pub session: NonZeroU32,
    /// Which drive of the session in the condition.
    #[serde(default = "first", skip_serializing_if = "is_first")]
    pub trial: NonZeroU32,
    /// How long they had driven, in s.
    pub time_s: f64,
    /// `unwell` where they pressed the button, else the rule that held, or what the experimenter did and why.
    pub reason: String,
}

/// What the experimenter does with a drive, and with all of a person's.
const SKIPPED: &str = "skipped";
const ABORTED: &str = "aborted";
const EXCLUDED: &str = "excluded";

impl Stopped {
    /// The ride, or the drive.
    pub fn ride(&self) -> Ride {
        Ride {
            condition: self.condition,
            occasion: Occasion { session: self.session, trial: self.trial },
        }
    }

    /// Whether the person stopped it.
    pub fn by_the_person(&self) -> bool {
        self.by_the_experimenter().is_none()
    }

    /// What the experimenter did with it, and what follows that: a colon and why, or nothing where it was kept back. None where the person
    /// stopped it.
    fn by_the_experimenter(&self) -> Option<(&str, &str)> {
        let act = self.reason.split(": ").next()?;
        let why = self.reason.strip_prefix(act)?;
        [SKIPPED, ABORTED, EXCLUDED].contains(&act).then_some((act, why))
    }

    /// Why it is left out.
    fn why(&self) -> Why {
        let (condition, reason) = (self.condition, &self.reason);
        match self.by_the_experimenter() {
            Some((EXCLUDED, why)) => Why::by(Rule::Excluded, format!("by the experimenter{why}")),
            Some((act, why)) => Why::by(Rule::Stopped, format!("`{condition}` was {act}{why}")),
            None => Why::by(Rule::Stopped, format!("`{condition}` was stopped: {reason}")),
        }
    }
}

/// What somebody or something is left out by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Rule {
    /// A person whom the design names.
    #[serde(rename = "exclude.people")]
    People,
    /// A drive that the design names.
    #[serde(rename = "exclude.drives")]
    Drives,
    /// A drive or a ride that the person stopped.
    #[serde(rename = "stopped")]
    Stopped,
    /// All that a person drove, by the experimenter.
    #[serde(rename = "excluded")]
    Excluded,
    /// A drive below the shortest that counts.
    #[serde(rename = "exclude.drive_shorter_than_s")]
    Short,
    /// One answer to every item of a questionnaire that has reversed items.
    #[serde(rename = "exclude.straight_lined")]
    StraightLined,
    /// Other answers than were asked for to items that are there for attention.
    #[serde(rename = "exclude.attention_missed_at_least")]
    Attention,
    /// Fewer conditions than the design asks for.
    #[serde(rename = "exclude.fewer_conditions_than")]
    FewConditions,
    /// Neither a drive nor an answer in any condition.
    #[serde(rename = "absent")]
    Absent,
    /// A person who was forgotten.
    #[serde(rename = "forgotten")]
    Forgotten,
    /// Somebody who is not in the table of people.
    #[serde(rename = "unknown participant")]
    UnknownParticipant,
    /// A condition that the design does not have.
    #[serde(rename = "unknown condition")]
    UnknownCondition,
    /// A session or a trial that the design does not have.
    #[serde(rename = "unknown session or trial")]
    UnknownOccasion,
}

impl Rule {
    /// Those of the design and of the list of stopped rides that name whom or what they leave out, which is known without the data.
    pub const BY_NAME: [Self; 4] = [Self::People, Self::Drives, Self::Stopped, Self::Excluded];

    /// Its key in the design, or what it is called in a list of exclusions.
    pub fn key(self) -> &'static str {
        match self {
            Self::People => "exclude.people",
            Self::Drives => "exclude.drives",
            Self::Stopped => "stopped",
            Self::Excluded => EXCLUDED,
            Self::Short => "exclude.drive_shorter_than_s",
            Self::StraightLined => "exclude.straight_lined",
            Self::Attention => "exclude.attention_missed_at_least",
            Self::FewConditions => "exclude.fewer_conditions_than",
            Self::Absent => "absent",
            Self::Forgotten => "forgotten",
            Self::UnknownParticipant => "unknown participant",
            Self::UnknownCondition => "unknown condition",
            Self::UnknownOccasion => "unknown session or trial",
        }
    }
}

/// Why somebody or something is left out.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Why {
    /// By which rule.
    pub rule: Rule,
    /// The reason, as a list of exclusions says it.
    #[serde(rename = "why")]
    pub reason: String,
}

impl Why {
    /// By a rule, for a reason.
    pub fn by(rule: Rule, reason: impl Into<String>) -> Self {
        let reason = reason.into();
        Self { rule, reason }
    }
}

impl fmt::Display for Why {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "left out by {}: {}", self.rule.key(), self.reason)
    }
}

/// Why a drive of this length (s) is too short for the design; none where it is long enough.
pub fn too_short(design: &Design, duration_s: f64) -> Option<Why> {
    let shortest = design.exclude().drive_shorter_than_s?;
    let reason = || format!("the drive is {duration_s:.0} s long, expected at least {shortest} s");
    (duration_s < shortest).then(|| Why::by(Rule::Short, reason()))
}

/// Why what is about a condition, a session or a trial that the design does not have is left out; none where it has it.
pub fn unknown_ride(design: &Design, ride: Ride) -> Option<Why> {
    let Ride { condition, occasion } = ride;
    if !design.knows(condition) {
        let labels = ConditionId::listed(&design.labels());
        let reason = format!("`{condition}` is none of the design's: {labels}");
        return Some(Why::by(Rule::UnknownCondition, reason));
    }
    let occasions = design.occasions(condition);
    let last = occasions.iter().max().filter(|_| !occasions.contains(&occasion))?;
    let reason = format!(
        "{occasion} of `{condition}`, expected sessions up to {} and trials up to {} by `protocol.sessions` and `protocol.rides_per_condition`",
        last.session, last.trial
    );
    Some(Why::by(Rule::UnknownOccasion, reason))
}

/// Whom and what the design leaves out.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LeftOut {
    /// People, with all that they drove and answered.
    pub people: BTreeMap<ParticipantId, Why>,
    /// Single drives, with the answers after them.
    pub drives: BTreeMap<DriveId, Why>,
    cells: BTreeMap<(ParticipantId, Ride), Why>,
}

impl LeftOut {
    /// Those that the design names.
    pub fn named(design: &Design) -> Self {
        let mut named = Self::default();
        let rules = design.exclude();
        for (who, reason) in &rules.people {
            named.and_person(who.clone(), Why::by(Rule::People, reason));
        }
        for (drive, reason) in &rules.drives {
            named.and_drive(drive.clone(), Why::by(Rule::Drives, reason));
        }
        named
    }

    /// A person, who keeps the reason that there is already.
    pub fn and_person(&mut self, who: ParticipantId, why: Why) {
        self.people.entry(who).or_insert(why);
    }

    /// A drive, which keeps the reason that there is already.
    pub fn and_drive(&mut self, drive: DriveId, why: Why) {
        self.drives.entry(drive).or_insert(why);
    }

    /// And drives and rides that were stopped, with what was said of them.
    #[must_use]
    pub fn with_stopped(mut self, stopped: &[Stopped]) -> Self {
        for ride in stopped {
            let (who, why) = (&ride.participant, ride.why());
            let cell = (who.clone(), ride.ride());
            self.cells.entry(cell).or_insert(why.clone());
            // The ids of the two may be too long for one: then no drive has their name.
            if let Ok(drive) = DriveId::in_condition(who, ride.ride()) {
                self.and_drive(drive, why);
            }
        }
        self
    }

    /// And drives below the shortest that counts.
    #[must_use]
    pub fn with_short(mut self, design: &Design, drives: &[Driven]) -> Self {
        for driven in drives {
            let named = self.drives.get(&driven.drive).cloned();
            let short = || too_short(design, driven.duration_s?);
            if let Some(why) = named.or_else(short) {
                let cell = (driven.participant.clone(), driven.ride);
                self.cells.insert(cell, why.clone());
                self.drives.insert(driven.drive.clone(), why);
            }
        }
        self
    }

    /// And people who answered without reading, where the design asks for that.
    #[must_use]
    pub fn with_careless(mut self, design: &Design, scales: &[Scale], answers: &[Answer]) -> Self {
        let rules = design.exclude();
        if let Some(least) = rules.attention_missed_at_least {
            let mut missed: BTreeMap<ParticipantId, usize> = BTreeMap::new();
            for warning in attention_missed(scales, answers) {
                *missed.entry(warning.participant().clone()).or_default() += 1;
            }
            for (who, n) in missed.into_iter().filter(|(_, n)| *n >= least.get()) {
                let reason = format!(
                    "{n} of the items that are there for attention answered otherwise than asked for"
                );
                self.and_person(who, Why::by(Rule::Attention, reason));
            }
        }
        let sheets =
            if rules.straight_lined { response_styles(scales, answers) } else { Vec::new() };
        for warning in sheets {
            if let ScoreWarning::OneAnswer { participant, scale, .. } = warning {
                let reason = format!("one answer to every item of `{scale}`, reversed ones too");
                self.and_person(participant, Why::by(Rule::StraightLined, reason));
            }
        }
        self
    }

    /// And people with fewer conditions than the design asks for, of those in which they `came`: drove, answered or were measured.
    #[must_use]
    pub fn with_few_conditions<'a>(
        mut self,
        design: &Design,
        came: impl IntoIterator<Item = (&'a ParticipantId, Ride)>,
    ) -> Self {
        let Some(least) = design.exclude().fewer_conditions_than else {
            return self;
        };
        let mut sat: BTreeMap<&ParticipantId, BTreeSet<ConditionId>> = BTreeMap::new();
        for (who, ride) in came {
            let conditions = sat.entry(who).or_default();
            if design.condition(ride.condition).is_some() && self.keeps(who, ride) {
                conditions.insert(ride.condition);
            }
        }
        for (who, conditions) in sat {
            // Somebody who sat through none is one of those who are learned from, or absent.
            if !conditions.is_empty() && conditions.len() < least {
                let reason = format!("fewer than {least} conditions");
                self.and_person(who.clone(), Why::by(Rule::FewConditions, reason));
            }
        }
        self
    }

    /// And whoever has nothing left, for the reason of a drive of theirs.
    pub(crate) fn and_without_drives(&mut self, drives: &[Driven], kept: &BTreeSet<ParticipantId>) {
        for driven in drives.iter().filter(|d| !kept.contains(&d.participant)) {
            if let Some(why) = self.drives.get(&driven.drive) {
                let why = why.clone();
                self.and_person(driven.participant.clone(), why);
            }
        }
    }

    /// And, as people, those of whom the experimenter left out all that they drove.
    #[must_use]
    pub(crate) fn with_excluded(mut self, stopped: &[Stopped]) -> Self {
        for ride in stopped {
            let why = ride.why();
            if why.rule == Rule::Excluded {
                self.and_person(ride.participant.clone(), why);
            }
        }
        self
    }

    /// Single drives: not those of whoever, of these people, the experimenter left out as a whole.
    pub(crate) fn single_drives(
        &self,
        people: &BTreeSet<&ParticipantId>,
    ) -> impl Iterator<Item = (&DriveId, &Why)> {
        let whole = |who: &ParticipantId, why: &Why| {
            why.rule == Rule::Excluded && people.contains(who) && !self.keeps_person(who)
        };
        let cells = self.cells.iter();
        let cells = cells.filter(|((who, _), why)| whole(who, why));
        let names = cells.filter_map(|((who, ride), _)| DriveId::in_condition(who, *ride).ok());
        let names: BTreeSet<DriveId> = names.collect();
        let drives = self.drives.iter();
        drives.filter(move |(drive, _)| !names.contains(*drive))
    }

    /// Why what somebody said of a ride is left out, or drove in it: of several in a condition each is judged alone. A drive left out by the name that this program gives it counts
    /// whether or not its log came, and whatever its log is called.
    pub fn about(&self, who: &ParticipantId, ride: impl Into<Ride>) -> Option<&Why> {
        let ride = ride.into();
        let cell = || self.cells.get(&(who.clone(), ride));
        let named = || {
            let drive = DriveId::in_condition(who, ride).ok()?;
            self.drives.get(&drive)
        };
        self.people.get(who).or_else(named).or_else(cell)
    }

    /// Whether a person's drive in a condition, and what they said of it, stays.
    pub fn keeps(&self, who: &ParticipantId, ride: impl Into<Ride>) -> bool {
        self.about(who, ride).is_none()
    }

    /// Whether a person stays.
    pub fn keeps_person(&self, who: &ParticipantId) -> bool {
        !self.people.contains_key(who)
    }
}

#[cfg(test)]
mod tests;
