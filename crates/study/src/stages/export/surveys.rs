//! Answers as a long table, and as a wide one, laid out as oTree's: a row a participant.

use super::pseudonym::Pseudonyms;
use crate::{
    error::StudyError,
    tables::{TableName, participants::Enrolled, surveys::write_answers, write_rows},
};
use maveric_domain::{
    Answer, ConditionId, Moment, ParticipantId, ProbeAnswer, Ride, Scale, survey::Kind,
};
use serde_json::Value;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// What is to be known of the answers that are given away.
pub(super) struct Answered {
    /// When people were asked, in the order in which they were, as the column `moment` says it.
    pub(super) moments: Vec<&'static str>,
    /// The items that were answered by a number, such as an age or a year: `demographics 1`.
    pub(super) numbers: Vec<String>,
}

impl Answered {
    pub(super) fn new(scales: &[Scale], answers: &[Answer], probes: &[ProbeAnswer]) -> Self {
        let is_asked = |is: fn(Moment) -> bool| answers.iter().any(|a| is(a.moment));
        let moments = [
            (is_asked(|m| m == Moment::Pre), "before the drives (`pre`)"),
            (!probes.is_empty(), "during a ride (`probe:` and its condition)"),
            (is_asked(|m| matches!(m, Moment::After(_))), "after a condition (its id)"),
            (is_asked(|m| m == Moment::Post), "at the end (`post`)"),
        ];
        let moments = moments.into_iter().filter(|(is_asked, _)| *is_asked);
        let given = answers.iter().filter(|a| a.answer.is_some());
        let given: BTreeSet<(&str, u32)> = given.map(|a| (a.scale.as_str(), a.item)).collect();
        let is_number = |(id, item): &(&str, u32)| {
            let scale = scales.iter().find(|scale| scale.id == *id);
            let item = scale.and_then(|scale| scale.item(*item));
            item.is_some_and(|item| item.kind == Kind::Number)
        };
        let numbers = given.into_iter().filter(is_number);
        Self {
            moments: moments.map(|(_, moment)| moment).collect(),
            numbers: numbers.map(|(scale, item)| format!("{scale} {item}")).collect(),
        }
    }

    /// That numbers are given away as they are; nothing where there are none.
    pub(super) fn warning(&self) -> Option<String> {
        (!self.numbers.is_empty()).then(|| {
            format!(
                "answers that are numbers are given away as they are (items {}): an exact age, a year or a rare value may single somebody out",
                self.numbers.join(", ")
            )
        })
    }
}

/// Writes `surveys.csv` and, without what was asked during rides, `surveys_wide.csv`; the answers have pseudonyms then, and stand in their order.
pub(super) fn write(
    out: &Path,
    (answers, probes): (&mut [Answer], &mut [ProbeAnswer]),
    people: &[Enrolled],
    names: &Pseudonyms,
) -> Result<(), StudyError> {
    if answers.is_empty() && probes.is_empty() {
        return Ok(());
    }
    for answer in answers.iter_mut() {
        answer.participant = names.pseudonym(&answer.participant);
    }
    for probe in probes.iter_mut() {
        probe.participant = names.pseudonym(&probe.participant);
    }
    probes.sort_by(|a, b| {
        let key = |p: &ProbeAnswer| (p.participant.clone(), p.ride, p.scale.clone());
        key(a).cmp(&key(b)).then(a.at_s.total_cmp(&b.at_s))
    });
    // Sorted by pseudonym, so that the order of the rows gives nobody away.
    answers.sort_by(|a, b| {
        let a = (&a.participant, a.moment, &a.scale, a.item);
        a.cmp(&(&b.participant, b.moment, &b.scale, b.item))
    });
    write_answers(&out.join("surveys.csv"), answers, probes)?;
    let orders = people.iter();
    let orders = orders.map(|p| (names.pseudonym(&p.id), p.order.as_slice()));
    write_wide(&out.join("surveys_wide.csv"), answers, &orders.collect())
}

/// Writes `participant.label`, `pre.1.player.SCALE_ITEM`, `post.1.player.SCALE_ITEM`, and for the n-th condition that a person sat through
/// `trial.n.player.condition` and `trial.n.player.SCALE_ITEM`: what `maveric import --from otree` reads.
///
/// Conditions stand in the person's own order where it is known, else as everywhere; of several rides in a condition each is a trial, called
/// `calm:s2:t1` where it is not the first.
fn write_wide(
    path: &Path,
    answers: &[Answer],
    orders: &BTreeMap<ParticipantId, &[ConditionId]>,
) -> Result<(), StudyError> {
    let mut cells: BTreeMap<(&ParticipantId, Moment, &str, u32), Option<i32>> = BTreeMap::new();
    let mut rated: BTreeMap<&ParticipantId, BTreeSet<Ride>> = BTreeMap::new();
    let mut before: BTreeSet<(&str, u32)> = BTreeSet::new();
    let mut after: BTreeSet<(&str, u32)> = BTreeSet::new();
    let mut at_end: BTreeSet<(&str, u32)> = BTreeSet::new();
    for answer in answers {
        let (who, item) = (&answer.participant, (answer.scale.as_str(), answer.item));
        cells.insert((who, answer.moment, item.0, item.1), answer.answer);
        let conditions = rated.entry(who).or_default();
        match answer.moment {
            Moment::Pre => {
                before.insert(item);
            }
            Moment::Post => {
                at_end.insert(item);
            }
            // oTree's layout has no page for them.
            Moment::Probe(_) => {}
            Moment::After(ride) => {
                conditions.insert(ride);
                after.insert(item);
            }
        }
    }
    let trials: Vec<Vec<Ride>> = rated
        .iter()
        .map(|(who, conditions)| {
            let order = orders.get(*who).copied().unwrap_or_default();
            let place = |c: &ConditionId| order.iter().position(|o| o == c).unwrap_or(order.len());
            let mut trials: Vec<Ride> = conditions.iter().copied().collect();
            trials.sort_by_key(|r| (r.occasion, place(&r.condition), r.condition));
            trials
        })
        .collect();
    let people: Vec<&ParticipantId> = rated.keys().copied().collect();
    let most = trials.iter().map(Vec::len).max().unwrap_or(0);
    let rows = people.iter().zip(&trials).map(|(who, trials)| {
        let sheet = |page: &str, moment: Option<Moment>, items: &BTreeSet<(&str, u32)>| {
            let cell = |(scale, item): &(&str, u32)| {
                let answer = cells.get(&(*who, moment?, *scale, *item));
                answer.copied().flatten()
            };
            let column = |item: &(&str, u32)| {
                let name = format!("{page}.{}_{}", item.0, item.1);
                (name, Value::from(cell(item)))
            };
            items.iter().map(column).collect::<Vec<_>>()
        };
        let mut columns = sheet("pre.1.player", Some(Moment::Pre), &before);
        for n in 0..most {
            let (page, trial) = (format!("trial.{}.player", n + 1), trials.get(n));
            let condition = trial.map_or_else(String::new, ToString::to_string);
            columns.push((format!("{page}.condition"), condition.into()));
            columns.extend(sheet(&page, trial.map(|ride| Moment::After(*ride)), &after));
        }
        if !at_end.is_empty() {
            // By this word an import knows when it was.
            columns.push(("post.1.player.condition".to_owned(), "post".into()));
        }
        columns.extend(sheet("post.1.player", Some(Moment::Post), &at_end));
        (("participant.label", who.as_str()), columns)
    });
    write_rows(TableName::SurveysWide, path, rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_that_are_numbers_are_named_and_those_on_a_scale_are_not() {
        let scale = Scale::from_toml(
            "id = \"who\"\ntitle = \"Who\"\nreference = \"ours\"\n[[item]]\nkind = \"number\"\ntext = \"Age\"\nmin = 16\nmax = 110\n\
             [[item]]\nkind = \"choice\"\ntext = \"How often\"\nlevels = [\"Never\", \"Often\"]\n[[item]]\nkind = \"number\"\ntext = \"Year\"\nmin = 1930\nmax = 2100\n",
        );
        let scales = [scale.unwrap()];
        let answer = |item, answer| Answer {
            participant: ParticipantId::new("P1").unwrap(),
            moment: Moment::Pre,
            scale: "who".to_owned(),
            item,
            answer,
        };
        let of = |answers: &[Answer]| Answered::new(&scales, answers, &[]);
        let told = of(&[answer(1, Some(25)), answer(2, Some(1)), answer(3, None)]);
        assert_eq!(told.numbers, ["who 1"]);
        assert!(told.warning().unwrap().contains("(items who 1)"));
        assert_eq!(told.moments, ["before the drives (`pre`)"]);
        assert!(of(&[answer(2, Some(1))]).warning().is_none());
        assert!(of(&[]).moments.is_empty());
    }

    #[test]
    fn what_is_asked_at_the_end_is_told_from_what_was_asked_before() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("surveys_wide.csv");
        let answer = |moment, answer| Answer {
            participant: ParticipantId::new("P1").unwrap(),
            moment,
            scale: "mood".to_owned(),
            item: 1,
            answer: Some(answer),
        };
        let write = |answers: &[Answer]| {
            write_wide(&path, answers, &BTreeMap::new()).unwrap();
            std::fs::read_to_string(&path).unwrap()
        };
        let both = [answer(Moment::Pre, 2), answer(Moment::Post, 5)];
        assert_eq!(
            write(&both),
            "participant.label,pre.1.player.mood_1,post.1.player.condition,post.1.player.mood_1\nP1,2,post,5\n"
        );
        assert!(!write(&both[..1]).contains("post"));
    }
}
