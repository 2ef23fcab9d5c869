//! Answers as a wide table, laid out as oTree's: a row a participant.

use crate::{error::StudyError, tables::TableBuilder};
use maveric_domain::{Answer, ConditionId, Moment, ParticipantId};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// Writes `participant.label`, `pre.1.player.SCALE_ITEM`, and for the n-th condition that a person sat through
/// `trial.n.player.condition` and `trial.n.player.SCALE_ITEM`: what `maveric import --from otree` reads.
///
/// Conditions stand in the person's own order where it is known, else as everywhere.
pub(super) fn write(
    path: &Path,
    answers: &[Answer],
    orders: &BTreeMap<ParticipantId, &[ConditionId]>,
) -> Result<(), StudyError> {
    let mut cells: BTreeMap<(&ParticipantId, Moment, &str, u32), Option<i32>> = BTreeMap::new();
    let mut rated: BTreeMap<&ParticipantId, BTreeSet<ConditionId>> = BTreeMap::new();
    let mut before: BTreeSet<(&str, u32)> = BTreeSet::new();
    let mut after: BTreeSet<(&str, u32)> = BTreeSet::new();
    for answer in answers {
        let (who, item) = (&answer.participant, (answer.scale.as_str(), answer.item));
        cells.insert((who, answer.moment, item.0, item.1), answer.answer);
        let conditions = rated.entry(who).or_default();
        match answer.moment {
            Moment::Pre => {
                before.insert(item);
            }
            Moment::After(condition) => {
                conditions.insert(condition);
                after.insert(item);
            }
        }
    }
    let trials: Vec<Vec<ConditionId>> = rated
        .iter()
        .map(|(who, conditions)| {
            let order = orders.get(*who).copied().unwrap_or_default();
            let place = |c: &ConditionId| order.iter().position(|o| o == c).unwrap_or(order.len());
            let mut trials: Vec<ConditionId> = conditions.iter().copied().collect();
            trials.sort_by_key(|c| (place(c), *c));
            trials
        })
        .collect();
    let people: Vec<&ParticipantId> = rated.keys().copied().collect();
    let mut table =
        TableBuilder::default().text("participant.label", people.iter().map(|p| p.as_str()));
    let cell = |who: &ParticipantId, moment: Moment, (scale, item): (&str, u32)| {
        cells
            .get(&(who, moment, scale, item))
            .copied()
            .flatten()
            .map(i64::from)
    };
    for item in &before {
        let name = format!("pre.1.player.{}_{}", item.0, item.1);
        table = table.integers(
            &name,
            people.iter().map(|who| cell(who, Moment::Pre, *item)),
        );
    }
    for n in 0..trials.iter().map(Vec::len).max().unwrap_or(0) {
        let page = format!("trial.{}.player", n + 1);
        let condition =
            |t: &Vec<ConditionId>| t.get(n).map_or_else(String::new, ToString::to_string);
        table = table.text(&format!("{page}.condition"), trials.iter().map(condition));
        for item in &after {
            let of = |(who, t): (&&ParticipantId, &Vec<ConditionId>)| {
                cell(who, Moment::After(*t.get(n)?), *item)
            };
            let column = people.iter().zip(&trials).map(of);
            table = table.integers(&format!("{page}.{}_{}", item.0, item.1), column);
        }
    }
    table.write(path)
}
