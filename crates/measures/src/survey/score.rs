//! From answers to scores: reverse keys, subscales, missing items.

use super::{item_matrix::ItemMatrix, warning::ScoreWarning};
use crate::error::MeasureError;
use maveric_domain::{Answer, Moment, ParticipantId, Scale, Score, Subscale, survey::Scoring};
use std::collections::{BTreeMap, BTreeSet};

/// Scores, what their reliabilities need, and what was left out.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scored {
    /// Ordered by participant, moment, and then as the scales and their subscales are given.
    pub scores: Vec<Score>,
    /// One a subscale that was answered, in the order of the scales; rows by participant and moment.
    pub matrices: Vec<ItemMatrix>,
    /// What was left out.
    pub warnings: Vec<ScoreWarning>,
}

/// The answers of one participant at one moment to one scale, by item; `None` was left out.
pub(super) type Sheet = BTreeMap<u32, Option<i32>>;
/// Sheets by participant, moment and position of the scale.
type Sheets = BTreeMap<(ParticipantId, Moment, usize), Sheet>;

/// Scores answers by the scales' definitions.
///
/// `answers` are as given, before reversal, in any order. With `participants` (those of the study) people
/// without answers are warned about and strangers are left out; without, whoever answered is scored. A subscale is scored
/// when at least [`Scale::min_answered`] of its items are answered, the mean of the answered ones standing in for the others;
/// else its score is `None`, with a warning.
///
/// A participant is expected to answer the scales that anybody answered before the drives or at the end, and, after a drive, those that they
/// answered themselves after another drive and anybody answered after this one: professionals who answer one
/// scale in a role are not asked for the rest.
///
/// # Errors
/// [`MeasureError::ScaleTwice`]; [`MeasureError::UnknownScale`],
/// [`MeasureError::UnknownItem`], [`MeasureError::AnswerOutOfRange`] or [`MeasureError::DoubleAnswer`] naming
/// participant, scale and item.
///
/// # Source
/// Method section 8; design of the scales, "Missing items".
pub fn score(
    scales: &[Scale],
    answers: &[Answer],
    participants: Option<&[ParticipantId]>,
) -> Result<Scored, MeasureError> {
    let index = index(scales)?;
    let known: Option<BTreeSet<&ParticipantId>> = participants.map(|p| p.iter().collect());
    let mut strangers: BTreeMap<&ParticipantId, usize> = BTreeMap::new();
    let mut sheets = Sheets::new();
    for answer in answers {
        let position = checked(scales, &index, answer)?;
        if known.as_ref().is_some_and(|k| !k.contains(&answer.participant)) {
            *strangers.entry(&answer.participant).or_default() += 1;
            continue;
        }
        let key = (answer.participant.clone(), answer.moment, position);
        let before = sheets.entry(key).or_default().insert(answer.item, answer.answer);
        if before.is_some() {
            return Err(MeasureError::DoubleAnswer {
                participant: answer.participant.clone(),
                moment: answer.moment,
                scale: answer.scale.clone(),
                item: answer.item,
            });
        }
    }

    let mut scored = Scored::default();
    for (participant, answers) in strangers {
        scored
            .warnings
            .push(ScoreWarning::UnknownParticipant { participant: participant.clone(), answers });
    }
    if let Some(known) = known {
        scored.warnings.extend(unanswered(scales, &sheets, &known));
    }
    for ((participant, moment, position), sheet) in &sheets {
        let scale = &scales[*position];
        for subscale in &scale.subscales {
            let score = one(scale, subscale, participant, *moment, sheet);
            if score.value.is_none() {
                scored.warnings.push(ScoreWarning::TooFewAnswers {
                    participant: participant.clone(),
                    moment: *moment,
                    scale: scale.id.clone(),
                    subscale: subscale.id.clone(),
                    answered: score.answered,
                    items: score.items,
                });
            }
            scored.scores.push(score);
        }
    }
    scored.matrices = matrices(scales, &sheets);
    Ok(scored)
}

pub(super) fn index(scales: &[Scale]) -> Result<BTreeMap<&str, usize>, MeasureError> {
    let mut index = BTreeMap::new();
    for (position, scale) in scales.iter().enumerate() {
        if index.insert(scale.id.as_str(), position).is_some() {
            return Err(MeasureError::ScaleTwice { scale: scale.id.clone() });
        }
    }
    Ok(index)
}

/// The position of the scale that an answer belongs to, if the answer is possible.
pub(super) fn checked(
    scales: &[Scale],
    index: &BTreeMap<&str, usize>,
    answer: &Answer,
) -> Result<usize, MeasureError> {
    let Some(&position) = index.get(answer.scale.as_str()) else {
        let known: Vec<&str> = scales.iter().map(|s| s.id.as_str()).collect();
        return Err(MeasureError::UnknownScale {
            participant: answer.participant.clone(),
            moment: answer.moment,
            scale: answer.scale.clone(),
            known: known.join(", ").into(),
        });
    };
    let scale = &scales[position];
    let Some(item) = scale.item(answer.item) else {
        return Err(MeasureError::UnknownItem {
            participant: answer.participant.clone(),
            moment: answer.moment,
            scale: scale.id.clone(),
            item: answer.item,
            items: scale.count(),
        });
    };
    match answer.answer {
        Some(found) if !item.takes(found) => Err(MeasureError::AnswerOutOfRange {
            participant: answer.participant.clone(),
            moment: answer.moment,
            scale: scale.id.clone(),
            item: answer.item,
            found,
            asked: Box::new(item.clone()),
        }),
        _ => Ok(position),
    }
}

/// The answers to these items of a subscale after reversal.
fn keyed(scale: &Scale, subscale: &Subscale, items: &[u32], sheet: &Sheet) -> Vec<Option<f64>> {
    let value = |number: &u32| {
        let answer = f64::from(sheet.get(number).copied().flatten()?);
        let item = scale.item(*number)?;
        let reversed = f64::from(item.min) + f64::from(item.max) - answer;
        Some(if scale.is_reversed(subscale, *number) { reversed } else { answer })
    };
    items.iter().map(value).collect()
}

/// Sum or mean of a subscale that is no sum of others, before its weight; `None` where too few items were answered.
fn raw(scale: &Scale, subscale: &Subscale, sheet: &Sheet) -> Option<f64> {
    let answers = keyed(scale, subscale, &subscale.items, sheet);
    let answers: Vec<f64> = answers.into_iter().flatten().collect();
    let items = subscale.items.len() as f64;
    // Without the small margin 0.8 · 5 = 4.000…1 would ask for five of five.
    let needed = scale.min_answered * items - 1e-9;
    if answers.is_empty() || (answers.len() as f64) < needed {
        return None;
    }
    let mean = answers.iter().sum::<f64>() / answers.len() as f64;
    Some(match scale.scoring {
        Scoring::Mean => mean,
        Scoring::Sum => mean * items,
    })
}

pub(super) fn one(
    scale: &Scale,
    subscale: &Subscale,
    participant: &ParticipantId,
    moment: Moment,
    sheet: &Sheet,
) -> Score {
    let items = scale.items_of(subscale);
    let answered = keyed(scale, subscale, &items, sheet);
    let parts = scale.parts(subscale).into_iter();
    let sum = parts.map(|part| raw(scale, part, sheet)).sum::<Option<f64>>();
    Score {
        participant: participant.clone(),
        moment,
        scale: scale.id.clone(),
        subscale: subscale.id.clone(),
        value: sum.map(|sum| subscale.weight * sum),
        answered: answered.iter().flatten().count() as u32,
        items: items.len() as u32,
    }
}

fn unanswered(
    scales: &[Scale],
    sheets: &Sheets,
    known: &BTreeSet<&ParticipantId>,
) -> Vec<ScoreWarning> {
    let asked_of_some: BTreeSet<(Moment, usize)> =
        sheets.keys().map(|(_, m, s)| (*m, *s)).collect();
    let mut answered: BTreeMap<&ParticipantId, BTreeSet<(Moment, usize)>> = BTreeMap::new();
    for (participant, moment, position) in sheets.keys() {
        let theirs = answered.entry(participant).or_default();
        theirs.insert((*moment, *position));
    }
    let mut warnings = Vec::new();
    for &participant in known {
        let Some(theirs) = answered.get(participant) else {
            warnings.push(ScoreWarning::NoAnswers { participant: participant.clone() });
            continue;
        };
        let after = theirs.iter().filter(|(m, _)| matches!(m, Moment::After(_)));
        let after: BTreeSet<usize> = after.map(|(_, position)| *position).collect();
        for &(moment, position) in &asked_of_some {
            let expected = moment.condition().is_none() || after.contains(&position);
            if expected && !theirs.contains(&(moment, position)) {
                warnings.push(ScoreWarning::Unanswered {
                    participant: participant.clone(),
                    moment,
                    scale: scales[position].id.clone(),
                });
            }
        }
    }
    warnings
}

fn matrices(scales: &[Scale], sheets: &Sheets) -> Vec<ItemMatrix> {
    let mut matrices = Vec::new();
    for (position, scale) in scales.iter().enumerate() {
        let mine: Vec<(&(ParticipantId, Moment, usize), &Sheet)> =
            sheets.iter().filter(|((_, _, s), _)| *s == position).collect();
        if mine.is_empty() {
            continue;
        }
        for subscale in &scale.subscales {
            let items = scale.items_of(subscale);
            let answers = mine.iter();
            matrices.push(ItemMatrix {
                scale: scale.id.clone(),
                subscale: subscale.id.clone(),
                respondents: mine.iter().map(|((p, m, _), _)| (p.clone(), *m)).collect(),
                answers: answers.map(|(_, sheet)| keyed(scale, subscale, &items, sheet)).collect(),
                items,
            });
        }
    }
    matrices
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn scale(id: &str, scoring: Scoring) -> Scale {
        let scoring = match scoring {
            Scoring::Sum => "sum",
            Scoring::Mean => "mean",
        };
        Scale::from_toml(&format!(
            "id = \"{id}\"\ntitle = \"Calm\"\nreference = \"made up\"\nitems = 5\nmin = 1\nmax = 7\nscoring = \"{scoring}\"\n\
             reversed = [2]\n[[subscales]]\nid = \"calm\"\ntitle = \"Calm\"\nitems = [1, 2, 3, 4, 5]\n"
        ))
        .unwrap()
    }

    fn id(text: &str) -> ParticipantId {
        ParticipantId::new(text).unwrap()
    }

    fn sheet(who: &str, moment: Moment, scale: &str, answers: &[Option<i32>]) -> Vec<Answer> {
        (1..)
            .zip(answers)
            .map(|(item, &answer)| Answer {
                participant: id(who),
                moment,
                scale: scale.to_owned(),
                item,
                answer,
            })
            .collect()
    }

    fn calm(answers: &[Option<i32>]) -> Result<Scored, MeasureError> {
        let scales = [scale("calm", Scoring::Mean)];
        score(&scales, &sheet("P01", Moment::Pre, "calm", answers), None)
    }

    #[test]
    fn reversed_items_count_as_eight_minus_the_answer() {
        let scored = calm(&[Some(6), Some(2), Some(6), Some(6), Some(6)]).unwrap();
        assert_eq!(scored.scores[0].value, Some(6.0));
        assert_eq!(scored.matrices[0].answers[0], vec![Some(6.0); 5]);
    }

    #[test]
    fn four_of_five_answers_are_enough_and_three_are_not() {
        let four = calm(&[Some(5), None, Some(5), Some(5), Some(5)]).unwrap();
        assert_eq!((four.scores[0].value, four.warnings.len()), (Some(5.0), 0));
        let three = calm(&[Some(5), None, Some(5), Some(5)]).unwrap();
        assert_eq!((three.scores[0].value, three.scores[0].answered), (None, 3));
        assert!(matches!(
            three.warnings[..],
            [ScoreWarning::TooFewAnswers { answered: 3, items: 5, .. }]
        ));
    }

    #[test]
    fn in_a_sum_the_mean_stands_in_for_a_missing_item() {
        let answers =
            sheet("P01", Moment::Pre, "calm", &[Some(4), None, Some(4), Some(4), Some(4)]);
        let scored = score(&[scale("calm", Scoring::Sum)], &answers, None).unwrap();
        assert_eq!(scored.scores[0].value, Some(20.0));
    }

    #[test]
    fn a_reversal_in_one_subscale_leaves_the_others_alone() {
        let mut both = scale("calm", Scoring::Mean);
        both.items[1].reversed = false;
        both.subscales[0].reversed = vec![1, 2, 3, 4, 5];
        let mut plain = both.subscales[0].clone();
        (plain.id, plain.reversed) = ("plain".to_owned(), vec![]);
        both.subscales.push(plain);
        let answers = sheet("P01", Moment::Pre, "calm", &[Some(2); 5]);
        let scored = score(&[both], &answers, None).unwrap();
        let values: Vec<Option<f64>> = scored.scores.iter().map(|s| s.value).collect();
        assert_eq!(values, [Some(6.0), Some(2.0)]);
    }

    #[test]
    fn impossible_answers_are_refused_by_participant_scale_and_item() {
        let refused = |answers: &[Answer]| {
            score(&[scale("calm", Scoring::Mean)], answers, None).unwrap_err().to_string()
        };
        let high = refused(&sheet("P01", Moment::Pre, "calm", &[Some(3), Some(8)]));
        assert_eq!(high, "participant P01 (pre), scale `calm`, item 2: answer 8 is not in 1 to 7");
        let mut twice = sheet("P01", Moment::Pre, "calm", &[Some(3)]);
        twice.push(twice[0].clone());
        assert!(refused(&twice).contains("item 1 is answered twice"));
        let six = refused(&sheet("P01", Moment::Pre, "calm", &[Some(3); 6]));
        assert!(six.contains("item 6 is not among its 5 items"), "{six}");
        let stranger = refused(&sheet("P01", Moment::Pre, "clam", &[Some(3)]));
        assert!(stranger.contains("`clam`") && stranger.contains("calm"), "{stranger}");
    }

    #[test]
    fn who_did_not_answer_is_counted_and_who_was_not_asked_is_not() {
        let scales = [scale("calm", Scoring::Mean), scale("trust", Scoring::Mean)];
        let full = [Some(4); 5];
        let mimic = Moment::After("mimic".parse().unwrap());
        let aggressive = Moment::After("aggressive".parse().unwrap());
        let answers = [
            sheet("P01", Moment::Pre, "calm", &full),
            sheet("P01", mimic, "trust", &full),
            sheet("P01", aggressive, "trust", &full),
            sheet("P02", mimic, "trust", &full),
            // A professional, in a role: nobody expects trust of them.
            sheet("P03", Moment::Pre, "calm", &full),
            sheet("P03", aggressive, "calm", &full),
            sheet("P99", Moment::Pre, "calm", &full),
        ]
        .concat();
        let people = [id("P01"), id("P02"), id("P03"), id("P04")];
        let warnings = score(&scales, &answers, Some(&people)).unwrap().warnings;
        assert!(!warnings.iter().any(ScoreWarning::is_kept));
        let warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        assert_eq!(
            warnings,
            [
                "5 answers of P99, who is not in the study, left out",
                "participant P02 (pre) did not answer scale `calm`",
                "participant P02 (aggressive) did not answer scale `trust`",
                "participant P04 answered no questionnaire",
            ]
        );
    }

    #[test]
    fn a_matrix_has_a_row_each_moment_and_shows_what_was_left_out() {
        let mimic = Moment::After("mimic".parse().unwrap());
        let answers = [
            sheet("P01", Moment::Pre, "calm", &[Some(4); 5]),
            sheet("P02", Moment::Pre, "calm", &[Some(4); 4]),
            sheet("P02", mimic, "calm", &[Some(3); 5]),
        ]
        .concat();
        let scored = score(&[scale("calm", Scoring::Mean)], &answers, None).unwrap();
        let matrix = &scored.matrices[0];
        let pre = matrix.respondents.iter().zip(&matrix.answers);
        let pre = pre.filter(|((_, moment), _)| *moment == Moment::Pre);
        let mut rows = pre.map(|(_, row)| row);
        assert_eq!(rows.next().unwrap(), &[Some(4.0); 5]);
        assert!(rows.next().unwrap().contains(&None));
        assert!(rows.next().is_none());
    }

    proptest! {
        #[test]
        fn a_score_stays_within_the_range_of_the_scale(answers in proptest::collection::vec(proptest::option::of(1..=7_i32), 5)) {
            for score in calm(&answers).unwrap().scores {
                prop_assert!(score.value.is_none_or(|v| (1.0..=7.0).contains(&v)));
            }
        }

        #[test]
        fn the_order_of_the_rows_does_not_matter(answers in proptest::collection::vec(1..=7_i32, 5), turn in 0..5_usize) {
            let answers: Vec<Option<i32>> = answers.into_iter().map(Some).collect();
            let mut rows = sheet("P01", Moment::Pre, "calm", &answers);
            let scales = [scale("calm", Scoring::Mean)];
            let before = score(&scales, &rows, None).unwrap();
            rows.rotate_left(turn);
            prop_assert_eq!(score(&scales, &rows, None).unwrap(), before);
        }
    }
}
