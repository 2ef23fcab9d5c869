//! What was answered to each item in each condition.

use crate::mean::{mean, sd};
use maveric_domain::{Answer, ConditionId, Moment, ParticipantId, Scale};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Answers to one item in one condition, as they were ticked; of a person with several rides there their mean.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ItemMean {
    pub scale: String,
    pub item: u32,
    pub condition: ConditionId,
    pub n: usize,
    pub mean: f64,
    pub sd: Option<f64>,
}

type People<'a> = BTreeMap<&'a ParticipantId, Vec<f64>>;

/// The mean answer to each item after each condition, by scale, item and condition; of items whose answers are numbers, and that are no
/// check of attention.
pub(super) fn item_means<'a>(
    scales: &[Scale],
    answers: impl Iterator<Item = &'a Answer>,
) -> Vec<ItemMean> {
    let counts = |answer: &Answer| {
        let scale = scales.iter().find(|s| s.id == answer.scale);
        let item = scale.and_then(|s| s.item(answer.item));
        item.is_some_and(|item| item.kind.rates() && item.expected.is_none())
    };
    let mut items: BTreeMap<(&str, u32, ConditionId), People<'_>> = BTreeMap::new();
    for answer in answers.filter(|answer| counts(answer)) {
        if let (Moment::After(ride), Some(value)) = (answer.moment, answer.answer) {
            let item = (answer.scale.as_str(), answer.item, ride.condition);
            let people = items.entry(item).or_default();
            let values = people.entry(&answer.participant).or_default();
            values.push(f64::from(value));
        }
    }
    let row = |((scale, item, condition), people): ((&str, u32, ConditionId), People<'_>)| {
        let values: Vec<f64> = people.values().filter_map(|values| mean(values)).collect();
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
    fn a_person_with_two_rides_counts_once_and_what_was_asked_before_or_to_be_read_does_not() {
        let scale = "id = \"calm\"\ntitle = \"Calm\"\nreference = \"made up\"\nmin = 1\nmax = 7\n\
                     [[item]]\ntext = \"Choose 2.\"\nexpected = 2\n[[item]]\ntext = \"I was calm.\"\n";
        let scale = Scale::from_toml(scale).unwrap();
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
            Answer { item: 1, ..answer("B", "mild", Some(2)) },
        ];
        let found = item_means(&[scale], answers.iter());
        let said: Vec<_> = found
            .iter()
            .map(|row| (row.condition.as_str(), row.item, row.n, row.mean, row.sd))
            .collect();
        let sd = std::f64::consts::SQRT_2;
        let expected = [("mild", 2, 1, 5.0, None), ("sporty", 2, 2, 3.0, Some(sd))];
        assert_eq!(said, expected);
    }
}
