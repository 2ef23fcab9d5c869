//! Answers that look as if nobody had read the items. They are said, not dropped: who to leave out is the researcher's
//! decision, and should be made before the results are seen.

use super::warning::ScoreWarning;
use maveric_domain::{Answer, Moment, ParticipantId, Scale};
use std::collections::BTreeMap;

/// Below this nobody reads and answers an item, in s.
///
/// # Source
/// Huang, Curran, Keeney, Poposki and DeShon (2012), Journal of Business and Psychology 27, 99-114: two seconds an item.
pub const FASTEST_SECONDS_AN_ITEM: f64 = 2.0;

/// A run of equal answers shorter than this says nothing, whatever the scale.
const SHORTEST_RUN: u32 = 8;

/// Fewer answers than this may well be the same, reversed or not.
pub const FEWEST_ITEMS: usize = 6;

/// How long somebody took for the items of a scale.
#[derive(Debug, Clone, PartialEq)]
pub struct SheetTime {
    /// Who.
    pub participant: ParticipantId,
    /// When.
    pub moment: Moment,
    /// Code name of the scale.
    pub scale: String,
    /// Mean over the items whose time is known, in s.
    pub seconds_an_item: f64,
}

/// Warns of sheets that hold one answer only though some items are reversed, and of long strings of one answer.
///
/// One answer throughout contradicts itself where the scale has items of both kinds, unless it is the middle of the
/// range; sheets of fewer than six answers are not judged. Elsewhere a string is long when it spans half the items, and at least
/// eight; the lowest or highest answer throughout, without reversed items, is the scale's floor or ceiling and not judged. Ordered by participant, moment and scale.
///
/// # Source
/// Meade and Craig (2012), Psychological Methods 17, 437-455, and Curran (2016), Journal of Experimental Social Psychology 66,
/// 4-19, for long strings as a sign of careless answers, and half the items as a limit.
pub fn response_styles(scales: &[Scale], answers: &[Answer]) -> Vec<ScoreWarning> {
    type Given = BTreeMap<u32, i32>;
    let mut sheets: BTreeMap<(&ParticipantId, Moment, usize), Given> = BTreeMap::new();
    for answer in answers {
        let scale = scales.iter().position(|s| s.id == answer.scale);
        let rates = |scale: &usize| {
            let item = scales[*scale].item(answer.item);
            item.is_some_and(|item| item.kind.rates())
        };
        if let (Some(scale), Some(given)) = (scale.filter(rates), answer.answer) {
            let key = (&answer.participant, answer.moment, scale);
            sheets.entry(key).or_default().insert(answer.item, given);
        }
    }
    let warn =
        |((participant, moment, scale), given): (&(&ParticipantId, Moment, usize), &Given)| {
            let scale = &scales[*scale];
            let (participant, moment, id) = ((*participant).clone(), *moment, scale.id.clone());
            if let Some(answer) = one_answer(scale, given) {
                return Some(ScoreWarning::OneAnswer {
                    participant,
                    moment,
                    scale: id,
                    answer,
                    items: given.len() as u32,
                });
            }
            let (first, answer, run) = longest_run(given)?;
            // The lowest answer throughout is the floor of the scale, counted as that, and may be the truth.
            let at_an_end = given.len() as u32 == run
                && scale.item(first).is_some_and(|i| answer == i.min || answer == i.max);
            let long = run >= SHORTEST_RUN && 2 * run >= scale.count() && !at_an_end;
            long.then_some(ScoreWarning::LongString {
                participant,
                moment,
                scale: id,
                answer,
                run,
                first,
                items: scale.count(),
            })
        };
    sheets.iter().filter_map(warn).collect()
}

/// Warns of sheets answered in less than [`FASTEST_SECONDS_AN_ITEM`], in the order given.
pub fn too_fast(times: &[SheetTime]) -> Vec<ScoreWarning> {
    times
        .iter()
        .filter(|t| t.seconds_an_item < FASTEST_SECONDS_AN_ITEM)
        .map(|t| ScoreWarning::TooFast {
            participant: t.participant.clone(),
            moment: t.moment,
            scale: t.scale.clone(),
            seconds_an_item: t.seconds_an_item,
        })
        .collect()
}

/// The answer to all items, where that contradicts itself.
fn one_answer(scale: &Scale, given: &BTreeMap<u32, i32>) -> Option<i32> {
    let (first, answer) = given.iter().next().map(|(item, answer)| (*item, *answer))?;
    let middle = scale.item(first).is_some_and(|i| 2 * answer == i.min + i.max);
    let reversed = |item: &u32| {
        scale.subscales.iter().any(|s| s.items.contains(item) && scale.is_reversed(s, *item))
    };
    let turned = given.keys().filter(|i| reversed(i)).count();
    let contradicts = turned > 0 && turned < given.len() && given.len() >= FEWEST_ITEMS && !middle;
    (contradicts && given.values().all(|a| *a == answer)).then_some(answer)
}

/// First item, answer and length of the longest run of one answer over neighbouring items.
fn longest_run(given: &BTreeMap<u32, i32>) -> Option<(u32, i32, u32)> {
    let mut longest: Option<(u32, i32, u32)> = None;
    let mut current: Option<(u32, i32, u32)> = None;
    for (&item, &answer) in given {
        current = match current {
            Some((first, same, run)) if same == answer && item == first + run => {
                Some((first, same, run + 1))
            }
            _ => Some((item, answer, 1)),
        };
        if current.map(|c| c.2) > longest.map(|l| l.2) {
            longest = current;
        }
    }
    longest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scales() -> Vec<Scale> {
        [maveric_data::SCALES_ADB, maveric_data::SCALES_MINI_IPIP, maveric_data::SCALES_SIMILARITY]
            .map(|text| Scale::from_toml(text).unwrap())
            .into()
    }

    fn sheet(scale: &str, answers: &[i32]) -> Vec<Answer> {
        (1..)
            .zip(answers)
            .map(|(item, answer)| Answer {
                participant: ParticipantId::new("P01").unwrap(),
                moment: Moment::Pre,
                scale: scale.to_owned(),
                item,
                answer: Some(*answer),
            })
            .collect()
    }

    fn said(scale: &str, answers: &[i32]) -> Vec<String> {
        let found = response_styles(&scales(), &sheet(scale, answers));
        assert!(found.iter().all(ScoreWarning::is_kept));
        found.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn one_answer_to_reversed_items_too_is_said_and_the_middle_is_not() {
        let all = said("mini_ipip", &[5; 20]);
        assert_eq!(
            all,
            [
                "participant P01 (pre) answered all 20 items of `mini_ipip` with 5, reversed ones too: straight-lining? kept"
            ]
        );
        // Twenty times the middle contradicts nothing, but is a long string.
        assert!(said("mini_ipip", &[3; 20])[0].contains("to all 20 items"));
        assert!(said("similarity", &[6; 4]).is_empty(), "four items say too little");
    }

    #[test]
    fn a_string_of_half_the_items_is_long() {
        let said_of = said;
        let said = said("adb", &[1, 4, 2, 2, 2, 2, 2, 2, 2, 2, 3]);
        assert!(
            said[0].contains("gave the answer 2 to 8 items of `adb` in a row, from item 3 (of 11)"),
            "{said:?}"
        );
        assert!(
            super::response_styles(&scales(), &sheet("adb", &[1, 4, 2, 2, 2, 2, 2, 2, 2, 1, 3]))
                .is_empty()
        );
        assert!(said_of("adb", &[1; 11]).is_empty(), "the floor");
        let mut gap = sheet("adb", &[2; 11]);
        gap[5].answer = None;
        assert!(response_styles(&scales(), &gap).is_empty(), "an item left out ends the string");
    }

    #[test]
    fn under_two_seconds_an_item_is_too_fast() {
        let time = |seconds_an_item| SheetTime {
            participant: ParticipantId::new("P01").unwrap(),
            moment: Moment::Pre,
            scale: "adb".to_owned(),
            seconds_an_item,
        };
        let found = too_fast(&[time(4.0), time(0.8), time(2.0)]);
        assert_eq!(found.len(), 1);
        assert!(found[0].to_string().contains("0.8 s an item"));
    }
}
