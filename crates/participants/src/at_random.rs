//! Answers to questionnaires of which no effect is known: each answer of an item is as likely as another.

use crate::response::{maybe_left_out, stream};
use maveric_domain::{
    Answer, Moment, ParticipantId, ProbeAnswer, Ride, Scale,
    survey::{Item, Kind},
};
use rand::RngExt as _;
use rand_pcg::Pcg64;

/// The answers of one person at one moment, item by item: a point of a slider or a scale, one of several answers, a number within its
/// range; the expected answer where an item asks for one, and none to an item that asks for words. Each depends on the seed, the person,
/// the moment and the scale alone.
pub fn answer_at_random<'a>(
    participant: &ParticipantId,
    moment: Moment,
    scales: impl IntoIterator<Item = &'a Scale>,
    missing_rate: f64,
    seed: u64,
) -> Vec<Answer> {
    let mut answers = Vec::new();
    for scale in scales {
        let when = moment.to_string();
        let mut rng = stream(seed, &[participant.as_str(), "at random", &when, &scale.id]);
        for (number, item) in (1..).zip(&scale.items) {
            answers.push(Answer {
                participant: participant.clone(),
                moment,
                scale: scale.id.clone(),
                item: number,
                answer: answer(item, missing_rate, &mut rng),
            });
        }
    }
    answers
}

/// The answers of one person to the probes of a ride, a scale of one item that is asked at these times, in s. Each ride depends on the
/// seed, the person, the ride and the scale alone.
pub fn probes_at_random(
    participant: &ParticipantId,
    ride: Ride,
    scale: &Scale,
    asked_s: impl IntoIterator<Item = f64>,
    missing_rate: f64,
    seed: u64,
) -> Vec<ProbeAnswer> {
    let when = Moment::Probe(ride).to_string();
    let mut rng = stream(seed, &[participant.as_str(), "at random", &when, &scale.id]);
    let Some(item) = scale.items.first() else {
        return Vec::new();
    };
    let given = |at_s| ProbeAnswer {
        participant: participant.clone(),
        ride,
        scale: scale.id.clone(),
        at_s,
        answer: answer(item, missing_rate, &mut rng),
    };
    asked_s.into_iter().map(given).collect()
}

fn answer(item: &Item, missing_rate: f64, rng: &mut Pcg64) -> Option<i32> {
    if item.kind == Kind::Text {
        return None;
    }
    let points = (item.max - item.min) / item.step;
    let drawn = item.min + item.step * rng.random_range(0..=points);
    maybe_left_out(rng, missing_rate, item.expected.unwrap_or(drawn))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_kind_is_answered_as_it_can_be_and_the_same_again() {
        let scales: Vec<Scale> = ["nasa_tlx", "demographics", "attention", "purpose"]
            .map(|id| Scale::from_toml(maveric_data::scale(id).unwrap()).unwrap())
            .into();
        let people = |seed| -> Vec<Answer> {
            let answered = |n: usize| {
                let who = ParticipantId::new(format!("P{n}")).unwrap();
                answer_at_random(&who, Moment::Pre, &scales, 0.1, seed)
            };
            (0..200).flat_map(answered).collect()
        };
        let answers = people(3);
        assert_eq!(answers, people(3));
        assert_ne!(answers, people(4));
        for scale in &scales {
            for (number, item) in (1..).zip(&scale.items) {
                let given = answers.iter().filter(|a| a.scale == scale.id && a.item == number);
                let given: Vec<i32> = given.filter_map(|a| a.answer).collect();
                assert!(given.iter().all(|a| item.takes(*a)), "{} {number}", scale.id);
                let distinct: BTreeSet<i32> = given.iter().copied().collect();
                let expected = match item.kind {
                    Kind::Text => 0,
                    _ if item.expected.is_some() => 1,
                    // Ages and the like: as many as were drawn.
                    Kind::Number => 50,
                    _ => item.points(),
                };
                assert!(distinct.len() >= expected, "{} {number}: {distinct:?}", scale.id);
                assert!(item.expected.is_none() || distinct.len() == 1);
                assert!(item.kind == Kind::Text || (160..200).contains(&given.len()));
            }
        }
    }
}
