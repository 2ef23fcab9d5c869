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

/// A drive or a ride that somebody stopped, since they felt unwell.
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
    /// `unwell` where they pressed the button, else the rule that held.
    pub reason: String,
}

impl Stopped {
    /// The ride, or the drive.
    pub fn ride(&self) -> Ride {
        Ride {
            condition: self.condition,
            occasion: Occasion {
                session: self.session,
                trial: self.trial,
            },
        }
    }

    /// Whether the person stopped it; what the experimenter left out has what they did before a colon.
    pub fn by_the_person(&self) -> bool {
        !self.reason.contains(": ")
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
    /// Its key in the design, or what it is called in a list of exclusions.
    pub fn key(self) -> &'static str {
        match self {
            Self::People => "exclude.people",
            Self::Drives => "exclude.drives",
            Self::Stopped => "stopped",
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
    let Ride {
        condition,
        occasion,
    } = ride;
    if !design.knows(condition) {
        let labels = ConditionId::listed(&design.labels());
        let reason = format!("`{condition}` is none of the design's: {labels}");
        return Some(Why::by(Rule::UnknownCondition, reason));
    }
    let occasions = design.occasions(condition);
    let last = occasions
        .iter()
        .max()
        .filter(|_| !occasions.contains(&occasion))?;
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
            let (who, condition) = (&ride.participant, ride.condition);
            let reason = format!("`{condition}` was stopped: {}", ride.reason);
            let why = Why::by(Rule::Stopped, reason);
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
        let sheets = if rules.straight_lined {
            response_styles(scales, answers)
        } else {
            Vec::new()
        };
        for warning in sheets {
            if let ScoreWarning::OneAnswer {
                participant, scale, ..
            } = warning
            {
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
mod tests {
    use super::*;

    #[test]
    fn who_misses_as_many_checks_of_attention_as_the_rule_says_is_left_out_and_who_misses_fewer_is_not()
     {
        let scale = "id = \"read\"\ntitle = \"Read\"\nreference = \"made up\"\nmin = 1\nmax = 7\n\
                     [[item]]\ntext = \"Tick 2.\"\nexpected = 2\n[[item]]\ntext = \"Tick 7.\"\nexpected = 7\n";
        let scales = [Scale::from_toml(scale).unwrap()];
        let answer = |who: &str, item, answer| Answer {
            participant: ParticipantId::new(who).unwrap(),
            moment: maveric_domain::Moment::Pre,
            scale: "read".to_owned(),
            item,
            answer: Some(answer),
        };
        let answers = [
            [answer("P1", 1, 3), answer("P1", 2, 3)],
            [answer("P2", 1, 2), answer("P2", 2, 1)],
            [answer("P3", 1, 2), answer("P3", 2, 7)],
        ];
        let design = |rule: &str| {
            let text = format!("[study]\ntitle = \"t\"\n[[condition]]\nid = \"a\"\n{rule}");
            Design::from_toml(&text)
        };
        let left_out = |rule: &str| {
            let left_out = LeftOut::default();
            let design = design(rule).unwrap();
            let left_out = left_out.with_careless(&design, &scales, answers.as_flattened());
            let people = left_out.people.iter();
            let people = people.map(|(who, why)| format!("{who} {}", why.reason));
            people.collect::<Vec<_>>()
        };
        let otherwise =
            "of the items that are there for attention answered otherwise than asked for";
        let (both, one) = (format!("P1 2 {otherwise}"), format!("P2 1 {otherwise}"));
        let from_one = left_out("[exclude]\nattention_missed_at_least = 1");
        assert_eq!(from_one, [both.clone(), one]);
        let from_two = left_out("[exclude]\nattention_missed_at_least = 2");
        assert_eq!(from_two, [both]);
        assert!(left_out("").is_empty());
        assert!(design("[exclude]\nattention_missed_at_least = 0").is_err());
    }

    #[test]
    fn a_stopped_ride_is_left_out_with_what_was_said_of_it_and_named_with_its_condition_and_reason()
    {
        let design = Design::from_toml(
            "[study]\ntitle = \"t\"\n[[condition]]\nid = \"a\"\n[[condition]]\nid = \"b\"",
        )
        .unwrap();
        let who = |id: &str| ParticipantId::new(id).unwrap();
        let id = |id: &str| id.parse::<ConditionId>().unwrap();
        let stop = |id: &str, condition: &str, reason: &str| Stopped {
            participant: who(id),
            condition: condition.parse().unwrap(),
            session: first(),
            trial: first(),
            time_s: 34.0,
            reason: reason.to_owned(),
        };
        let stopped = [
            stop("P1", "a", "misc >= 6"),
            stop("P2", "a", "misc >= 6"),
            stop("P3", "b", "unwell"),
        ];
        let left_out = LeftOut::named(&design).with_stopped(&stopped);
        let long = "P".repeat(63);
        let too_long = LeftOut::default().with_stopped(&[stop(&long, "a", "unwell")]);
        assert!(too_long.drives.is_empty() && !too_long.keeps(&who(&long), id("a")));
        assert!(!left_out.keeps(&who("P1"), id("a")));
        assert!(left_out.keeps(&who("P1"), id("b")) && left_out.keeps_person(&who("P1")));
        let flow = crate::flow::flow(
            &design,
            &[],
            &[who("P1"), who("P2"), who("P3")].into(),
            &left_out,
            (&[], Vec::new()),
        );
        let rows: Vec<(&str, usize)> = flow
            .drives
            .iter()
            .map(|row| (row.why.as_str(), row.who.len()))
            .collect();
        assert_eq!(
            rows,
            [
                ("`a` was stopped: misc >= 6", 2),
                ("`b` was stopped: unwell", 1)
            ]
        );
        assert!(flow.drives.iter().all(|row| row.rule == Rule::Stopped));
    }

    #[test]
    fn of_several_rides_each_is_judged_alone_and_one_too_many_is_named_with_what_was_declared() {
        let text = "[study]\ntitle = \"t\"\n[[condition]]\nid = \"a\"\n[baseline]\nid = \"own\"\n\
                    [protocol]\nrides_per_condition = 2\nsessions = { count = 2, days_between = [2, 14] }\n\
                    [exclude]\ndrive_shorter_than_s = 300\nfewer_conditions_than = 1\ndrives = { \"P1-a_s2_t1\" = \"lost\" }";
        let design = Design::from_toml(text).unwrap();
        let who = ParticipantId::new("P1").unwrap();
        let ride = |text: &str| text.parse::<Ride>().unwrap();
        let driven = |ride: Ride, duration_s| Driven {
            drive: DriveId::in_condition(&who, ride).unwrap(),
            participant: who.clone(),
            ride,
            duration_s: Some(duration_s),
        };
        let rides = ["a", "a:s1:t2", "a:s2:t1", "a:s2:t2"].map(ride);
        let drives = [
            driven(rides[0], 299.0),
            driven(rides[1], 300.0),
            driven(rides[2], 400.0),
            driven(rides[3], 400.0),
        ];
        let came = || drives.iter().map(|d| (&d.participant, d.ride));
        let left_out = LeftOut::named(&design)
            .with_short(&design, &drives)
            .with_few_conditions(&design, came());
        assert_eq!(
            rides.map(|ride| left_out.keeps(&who, ride)),
            [false, true, false, true]
        );
        assert!(left_out.keeps_person(&who));
        let why = |text: &str| unknown_ride(&design, ride(text));
        for known in ["a", "a:s2:t2", "own", "own:s2:t1"] {
            assert_eq!(why(known), None, "{known}");
        }
        for (unknown, words) in [
            (
                "a:s1:t3",
                "session 1, trial 3 of `a`, expected sessions up to 2 and trials up to 2",
            ),
            ("a:s3:t1", "session 3, trial 1"),
            ("own:s1:t2", "trials up to 1"),
        ] {
            let why = why(unknown).unwrap();
            assert_eq!(why.rule, Rule::UnknownOccasion);
            assert!(why.reason.contains(words), "{why}");
        }
        assert_eq!(why("b").unwrap().rule, Rule::UnknownCondition);
    }

    #[test]
    fn a_rule_leaves_out_what_lies_below_it_and_nothing_at_it() {
        let text = "[study]\ntitle = \"t\"\n[[condition]]\nid = \"a\"\n[[condition]]\nid = \"b\"\n\
                    [exclude]\ndrive_shorter_than_s = 300\nfewer_conditions_than = 2\ndrives = { \"P4-b\" = \"lost\" }";
        let design = Design::from_toml(text).unwrap();
        let driven = |who: &str, condition: &str, duration_s| Driven {
            drive: DriveId::new(format!("{who}-{condition}")).unwrap(),
            participant: ParticipantId::new(who).unwrap(),
            ride: condition.parse().unwrap(),
            duration_s,
        };
        let drives = [
            driven("P1", "a", Some(300.0)),
            driven("P1", "b", None),
            driven("P2", "a", Some(299.9)),
            driven("P2", "b", Some(400.0)),
            driven("P3", "own", Some(400.0)),
            driven("P4", "a", Some(400.0)),
        ];
        let left_out = LeftOut::named(&design)
            .with_short(&design, &drives)
            .with_few_conditions(&design, drives.iter().map(|d| (&d.participant, d.ride)));
        let people: Vec<&str> = left_out.people.keys().map(ParticipantId::as_str).collect();
        // One short drive leaves P2 with one condition; P3 sat through none, which is for others to judge.
        assert_eq!(people, ["P2", "P4"]);
        assert!(
            left_out
                .people
                .values()
                .all(|why| why.rule == Rule::FewConditions)
        );
        let short: Vec<&str> = left_out.drives.keys().map(DriveId::as_str).collect();
        assert_eq!(short, ["P2-a", "P4-b"]);
        let who = |text: &str| ParticipantId::new(text).unwrap();
        let (a, b): (Ride, Ride) = ("a".parse().unwrap(), "b".parse().unwrap());
        assert!(left_out.keeps(&who("P1"), a) && !left_out.keeps(&who("P2"), b));
        assert!(left_out.keeps_person(&who("P3")) && !left_out.keeps(&who("P4"), b));
    }
}
