//! Who and what is left out before anything is computed, why, and how many are left at each step.

use crate::person::Person;
use maveric_domain::{Answer, ConditionId, Design, DriveId, Moment, ParticipantId, Scale, Score};
use maveric_measures::survey::response_styles;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// A drive that is there.
#[derive(Debug, Clone, PartialEq)]
pub struct Driven {
    /// Its id.
    pub drive: DriveId,
    /// Whose.
    pub participant: ParticipantId,
    /// In which condition.
    pub condition: ConditionId,
    /// How long it took, in s; `None` where it is not known.
    pub duration_s: Option<f64>,
}

/// Why somebody or something is left out.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(tag = "rule", rename_all = "snake_case")]
pub enum Why {
    /// By name, with the reason given in the design.
    Named {
        /// The reason.
        reason: String,
    },
    /// A drive below the shortest that counts.
    Short,
    /// One answer to every item of a questionnaire that has reversed items.
    StraightLined {
        /// The questionnaire.
        scale: String,
    },
    /// Fewer conditions than the design asks for.
    FewConditions,
    /// Neither a drive nor an answer in any condition.
    Absent,
}

impl Why {
    /// The reason in words, as a list of exclusions says it.
    pub fn words(&self, design: &Design) -> String {
        let rules = design.exclude();
        match self {
            Self::Named { reason } => reason.clone(),
            Self::Short => format!(
                "drive shorter than {:.0} s",
                rules.drive_shorter_than_s.unwrap_or_default()
            ),
            Self::StraightLined { scale } => {
                format!("one answer to every item of `{scale}`, reversed ones too")
            }
            Self::FewConditions => format!(
                "fewer than {} conditions",
                rules.fewer_conditions_than.unwrap_or_default()
            ),
            Self::Absent => "no drive and no answer in any condition".to_owned(),
        }
    }
}

/// What the design leaves out.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LeftOut {
    /// People, with all that they drove and answered.
    pub people: BTreeMap<ParticipantId, Why>,
    /// Single drives, with the answers after them.
    pub drives: BTreeMap<DriveId, Why>,
    cells: BTreeSet<(ParticipantId, ConditionId)>,
}

impl LeftOut {
    /// Applies the design's exclusions, by name and by rule; `answers` are judged by the rules for sheets; drives and
    /// the scores in `rated` count as conditions that somebody sat through.
    ///
    /// A person named in `[exclude]` counts as such whatever else would leave them out.
    pub fn of(
        design: &Design,
        drives: &[Driven],
        (scales, answers): (&[Scale], &[Answer]),
        rated: &[Score],
    ) -> Self {
        let rules = design.exclude();
        let mut found = Self::default();
        for (who, reason) in &rules.people {
            let reason = reason.clone();
            found.people.insert(who.clone(), Why::Named { reason });
        }
        if rules.straight_lined {
            for warning in response_styles(scales, answers) {
                if let maveric_measures::ScoreWarning::OneAnswer {
                    participant, scale, ..
                } = warning
                {
                    let why = Why::StraightLined { scale };
                    found.people.entry(participant).or_insert(why);
                }
            }
        }
        for driven in drives {
            let named = rules.drives.get(&driven.drive).map(|reason| Why::Named {
                reason: reason.clone(),
            });
            let short = rules
                .drive_shorter_than_s
                .zip(driven.duration_s)
                .is_some_and(|(least, found)| found < least)
                .then_some(Why::Short);
            if let Some(why) = named.or(short) {
                found.drives.insert(driven.drive.clone(), why);
                found
                    .cells
                    .insert((driven.participant.clone(), driven.condition));
            }
        }
        // A drive whose log never came still has a name, and answers after it.
        for (drive, reason) in &rules.drives {
            let reason = reason.clone();
            found
                .drives
                .entry(drive.clone())
                .or_insert(Why::Named { reason });
            if let Some((who, what)) = drive.as_str().rsplit_once('-')
                && let (Ok(who), Ok(what)) = (ParticipantId::new(who), what.parse())
            {
                found.cells.insert((who, what));
            }
        }
        if let Some(least) = rules.fewer_conditions_than {
            found.few_conditions(design, drives, rated, least);
        }
        found
    }

    fn few_conditions(
        &mut self,
        design: &Design,
        drives: &[Driven],
        rated: &[Score],
        least: usize,
    ) {
        let mut sat: BTreeMap<&ParticipantId, BTreeSet<ConditionId>> = BTreeMap::new();
        let driven = drives.iter().map(|d| (&d.participant, d.condition));
        let answered = rated.iter().filter_map(|s| match s.moment {
            Moment::After(condition) if s.value.is_some() => Some((&s.participant, condition)),
            _ => None,
        });
        for (who, condition) in driven.chain(answered) {
            let of = sat.entry(who).or_default();
            let out = self.cells.contains(&(who.clone(), condition));
            if design.condition(condition).is_some() && !out {
                of.insert(condition);
            }
        }
        for (who, conditions) in sat {
            // Somebody who sat through none is one of those who are learned from, or absent.
            if !conditions.is_empty() && conditions.len() < least {
                self.people.entry(who.clone()).or_insert(Why::FewConditions);
            }
        }
    }

    /// Leaves out whoever has nothing left, for the reason of a drive of theirs.
    pub(crate) fn without_drives(&mut self, drives: &[Driven], kept: &BTreeSet<ParticipantId>) {
        for driven in drives.iter().filter(|d| !kept.contains(&d.participant)) {
            if let Some(why) = self.drives.get(&driven.drive) {
                let who = driven.participant.clone();
                self.people.entry(who).or_insert_with(|| why.clone());
            }
        }
    }

    /// Whether a person's drive in a condition, and what they said of it, stays.
    pub fn keeps(&self, who: &ParticipantId, condition: ConditionId) -> bool {
        !self.people.contains_key(who) && !self.cells.contains(&(who.clone(), condition))
    }

    /// Whether a person stays.
    pub fn keeps_person(&self, who: &ParticipantId) -> bool {
        !self.people.contains_key(who)
    }
}

/// How many people there were at each step: a flow of participants as CONSORT draws it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Flow {
    /// People in the table who were to sit through the conditions.
    pub recruited: usize,
    /// Those of them who drove or rated at least one condition, or drove the baseline.
    pub drove: usize,
    /// People left out, a row a reason.
    pub left_out: Vec<LeftOutFor>,
    /// People analysed.
    pub analysed: usize,
    /// Single drives left out of those analysed, a row a reason.
    pub drives: Vec<LeftOutFor>,
}

/// Those who are left out for one reason.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LeftOutFor {
    /// In words.
    pub why: String,
    /// The people, or the drives.
    pub who: Vec<String>,
}

/// The flow of those who were to be tested: everybody in `there`, where there is no table of people.
pub(crate) fn flow(
    design: &Design,
    people: &[Person],
    there: &BTreeSet<ParticipantId>,
    left_out: &LeftOut,
) -> Flow {
    let recruited: BTreeSet<&ParticipantId> = if people.is_empty() {
        there.iter().collect()
    } else {
        people.iter().filter(|p| p.tested).map(|p| &p.id).collect()
    };
    let mut by_reason: BTreeMap<&Why, Vec<String>> = BTreeMap::new();
    let (mut drove, mut analysed) = (0, 0);
    for &who in &recruited {
        let came = there.contains(who);
        drove += usize::from(came);
        match (left_out.people.get(who), came) {
            (Some(why), _) => by_reason.entry(why).or_default().push(who.to_string()),
            (None, false) => by_reason
                .entry(&Why::Absent)
                .or_default()
                .push(who.to_string()),
            (None, true) => analysed += 1,
        }
    }
    let mut drives: BTreeMap<&Why, Vec<String>> = BTreeMap::new();
    for (drive, why) in &left_out.drives {
        drives.entry(why).or_default().push(drive.to_string());
    }
    let row = |(why, who): (&Why, Vec<String>)| LeftOutFor {
        why: why.words(design),
        who,
    };
    Flow {
        recruited: recruited.len(),
        drove,
        left_out: by_reason.into_iter().map(row).collect(),
        analysed,
        drives: drives.into_iter().map(row).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rule_leaves_out_what_lies_below_it_and_nothing_at_it() {
        let text = "[study]\ntitle = \"t\"\n[[condition]]\nid = \"a\"\n[[condition]]\nid = \"b\"\n\
                    [exclude]\ndrive_shorter_than_s = 300\nfewer_conditions_than = 2\ndrives = { \"P4-b\" = \"lost\" }";
        let design = Design::from_toml(text).unwrap();
        let driven = |who: &str, condition: &str, duration_s| Driven {
            drive: DriveId::new(format!("{who}-{condition}")).unwrap(),
            participant: ParticipantId::new(who).unwrap(),
            condition: condition.parse().unwrap(),
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
        let found = LeftOut::of(&design, &drives, (&[], &[]), &[]);
        let people: Vec<&str> = found.people.keys().map(ParticipantId::as_str).collect();
        // One short drive leaves P2 with one condition; P3 sat through none, which is for others to judge.
        assert_eq!(people, ["P2", "P4"]);
        assert!(found.people.values().all(|why| *why == Why::FewConditions));
        let short: Vec<&str> = found.drives.keys().map(DriveId::as_str).collect();
        assert_eq!(short, ["P2-a", "P4-b"]);
        let who = |text: &str| ParticipantId::new(text).unwrap();
        let (a, b) = ("a".parse().unwrap(), "b".parse().unwrap());
        assert!(found.keeps(&who("P1"), a) && !found.keeps(&who("P2"), b));
        assert!(found.keeps_person(&who("P3")) && !found.keeps(&who("P4"), b));
    }
}
