//! What was answered to each item in each condition.

use crate::mean::{mean, sd};
use maveric_domain::{Answer, ConditionId, Moment, ParticipantId};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Answers to one item in one condition, as they were ticked; of a person with several rides there their mean.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "`columns.toml` says what they are")]
pub struct ItemMean {
    pub scale: String,
    pub item: u32,
    pub condition: ConditionId,
    pub n: usize,
    pub mean: f64,
    pub sd: Option<f64>,
}

/// Each item's answers after each condition: by scale, item and condition.
pub(super) fn item_means(answers: &[Answer]) -> Vec<ItemMean> {
    type People<'a> = BTreeMap<&'a ParticipantId, Vec<f64>>;
    let mut items: BTreeMap<(&str, u32, ConditionId), People<'_>> = BTreeMap::new();
    for answer in answers {
        if let (Moment::After(ride), Some(value)) = (answer.moment, answer.answer) {
            let item = (answer.scale.as_str(), answer.item, ride.condition);
            let people = items.entry(item).or_default();
            let own = people.entry(&answer.participant).or_default();
            own.push(f64::from(value));
        }
    }
    let row = |((scale, item, condition), people): ((&str, u32, ConditionId), People<'_>)| {
        let values: Vec<f64> = people.values().filter_map(|own| mean(own)).collect();
        Some(ItemMean {
            scale: scale.to_owned(),
            item,
            condition,
            n: values.len(),
            mean: mean(&values)?,
            sd: sd(&values),
        })
    };
    items.into_iter().filter_map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_person_with_two_rides_counts_once_and_what_was_asked_before_does_not() {
        let answer = |who: &str, moment: &str, answer: Option<i32>| Answer {
            participant: ParticipantId::new(who).unwrap(),
            moment: moment.parse().unwrap(),
            scale: "calm".to_owned(),
            item: 2,
            answer,
        };
        let answers = [
            answer("A", "pre", Some(5)),
            answer("A", "sporty", Some(1)),
            answer("A", "sporty:s1:t2", Some(3)),
            answer("B", "sporty", Some(4)),
            answer("B", "sporty:s1:t2", None),
            answer("B", "mild", Some(5)),
        ];
        let found = item_means(&answers);
        let said: Vec<_> = found
            .iter()
            .map(|row| (row.condition.as_str(), row.item, row.n, row.mean, row.sd))
            .collect();
        let sd = std::f64::consts::SQRT_2;
        let expected = [("mild", 2, 1, 5.0, None), ("sporty", 2, 2, 3.0, Some(sd))];
        assert_eq!(said, expected);
    }
}
