//! What was answered again and again during a ride.

use super::score::{Sheet, checked, index, one};
use crate::error::MeasureError;
use maveric_domain::{Answer, Moment, ParticipantId, ProbeAnswer, Ride, Scale, Score};
use std::collections::BTreeMap;

/// The score of each participant, drive and subscale: the mean over the probes that were answered, none where none was.
/// [`Score::answered`] and [`Score::items`] count probes. Ordered by participant, drive and scale.
///
/// # Errors
/// As [`score`](super::score) for a scale or an answer that is not possible.
pub fn score_probes(scales: &[Scale], answers: &[ProbeAnswer]) -> Result<Vec<Score>, MeasureError> {
    let index = index(scales)?;
    let mut probed: BTreeMap<(&ParticipantId, Ride, usize), Vec<Option<i32>>> = BTreeMap::new();
    for probe in answers {
        let position = checked(
            scales,
            &index,
            &Answer {
                participant: probe.participant.clone(),
                moment: Moment::Probe(probe.ride),
                scale: probe.scale.clone(),
                item: 1,
                answer: probe.answer,
            },
        )?;
        let key = (&probe.participant, probe.ride, position);
        probed.entry(key).or_default().push(probe.answer);
    }
    let mut scores = Vec::new();
    for ((participant, ride, position), answers) in probed {
        let (scale, moment) = (&scales[position], Moment::Probe(ride));
        for subscale in &scale.subscales {
            let value = |answer: &Option<i32>| {
                let sheet = Sheet::from([(1, *answer)]);
                one(scale, subscale, participant, moment, &sheet).value
            };
            let values: Vec<f64> = answers.iter().filter_map(value).collect();
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            scores.push(Score {
                participant: participant.clone(),
                moment,
                scale: scale.id.clone(),
                subscale: subscale.id.clone(),
                value: (!values.is_empty()).then_some(mean),
                answered: values.len() as u32,
                items: answers.len() as u32,
            });
        }
    }
    Ok(scores)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MISC: &str = "id = \"misc\"\ntitle = \"Misery\"\nreference = \"made up\"\nitems = 1\nmin = 0\nmax = 10\nscoring = \"mean\"\n\
        [[subscales]]\nid = \"total\"\ntitle = \"Misery\"\nitems = [1]\n";

    fn probe(condition: &str, at_s: f64, answer: Option<i32>) -> ProbeAnswer {
        ProbeAnswer {
            participant: ParticipantId::new("P01").unwrap(),
            ride: condition.parse().unwrap(),
            scale: "misc".to_owned(),
            at_s,
            answer,
        }
    }

    #[test]
    fn the_score_of_a_ride_is_the_mean_of_what_was_answered_and_counts_what_was_asked() {
        let answers = [
            probe("calm", 60.0, Some(2)),
            probe("calm", 120.0, None),
            probe("calm", 180.0, Some(5)),
            probe("sporty", 60.0, None),
        ];
        let scales = [Scale::from_toml(MISC).unwrap()];
        let scores = score_probes(&scales, &answers).unwrap();
        let rows: Vec<_> =
            scores.iter().map(|s| (s.moment.to_string(), s.value, s.answered, s.items)).collect();
        assert_eq!(
            rows,
            [("probe:calm".to_owned(), Some(3.5), 2, 3), ("probe:sporty".to_owned(), None, 0, 1)]
        );
    }

    #[test]
    fn an_answer_that_the_scale_does_not_have_is_refused() {
        let scales = [Scale::from_toml(MISC).unwrap()];
        let told = score_probes(&scales, &[probe("calm", 60.0, Some(11))]).unwrap_err();
        assert!(told.to_string().contains("11"), "{told}");
    }
}
