//! Items that ask for one answer, to see whether they are read.

use super::warning::ScoreWarning;
use maveric_domain::{Answer, Scale};

/// Warns of each item with an expected answer that was answered otherwise, in the order of the answers. One that was left out is not missed.
pub fn attention_missed(scales: &[Scale], answers: &[Answer]) -> Vec<ScoreWarning> {
    let missed = |given: &Answer| {
        let scale = scales.iter().find(|s| s.id == given.scale)?;
        let item = scale.item(given.item)?;
        let answer = given.answer.filter(|answer| item.is_missed(*answer))?;
        Some(ScoreWarning::AttentionMissed {
            participant: given.participant.clone(),
            moment: given.moment,
            scale: given.scale.clone(),
            item: given.item,
            answer,
            expected: item.expected?,
        })
    };
    answers.iter().filter_map(missed).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::{Moment, ParticipantId};

    #[test]
    fn another_answer_is_a_miss_and_the_expected_one_and_none_are_not() {
        let scale = Scale::from_toml(
            "id = \"read\"\ntitle = \"Read\"\nreference = \"made up\"\nmin = 1\nmax = 7\n[[item]]\ntext = \"Tick 2.\"\nexpected = 2\n[[item]]\ntext = \"I am calm.\"\n",
        );
        let answer = |who: &str, item, answer| Answer {
            participant: ParticipantId::new(who).unwrap(),
            moment: Moment::Pre,
            scale: "read".to_owned(),
            item,
            answer,
        };
        let answers = [
            answer("P1", 1, Some(2)),
            answer("P2", 1, Some(3)),
            answer("P3", 1, None),
            answer("P1", 2, Some(7)),
        ];
        let missed = attention_missed(&[scale.unwrap()], &answers);
        let said: Vec<String> = missed.iter().map(ToString::to_string).collect();
        assert_eq!(
            said,
            [
                "participant P2 (pre) answered item 1 of `read` with 3, which asks for 2: not read? kept"
            ]
        );
    }
}
