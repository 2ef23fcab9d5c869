//! Do people press more in some conditions, and was the ride another one just before?

use crate::{
    finding::{Finding, Part, Question},
    presses::Presses,
};

/// One part of the rates; of what came before a press one of seven is enough, whichever way.
pub(super) fn findings(presses: Option<&Presses>) -> Vec<Finding> {
    let Some(presses) = presses else {
        return Vec::new();
    };
    let rates = presses.rates.as_ref().map(|rates| {
        let part = Part::differs("presses", rates.n, (None, rates.p));
        Finding::every(Question::Pressed, vec![part])
    });
    let parts = presses.before.iter().map(|row| {
        let test = &row.test;
        let interval = test.odds_ratio_ci.ends();
        let estimate = (test.odds_ratio, row.p_holm);
        Part::differs(&row.precursor, test.people, estimate).with_interval(interval)
    });
    let parts: Vec<Part> = parts.collect();
    let before = (!parts.is_empty()).then(|| Finding::one(Question::BeforePress, parts));
    rates.into_iter().chain(before).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Analysis, Purpose, Verdict, analyse, finding, testing::pressing};
    use Verdict::{NotShown, Shown};

    fn verdict(analysis: &Analysis, question: Question) -> Option<Verdict> {
        finding::by_question(&analysis.findings, question).map(|f| f.verdict)
    }

    fn analysed(people: usize, presses: impl Fn(usize, usize) -> usize, braking: f64) -> Analysis {
        analyse(&pressing(people, presses, braking), Purpose::Report).unwrap()
    }

    #[test]
    fn who_presses_more_in_one_condition_is_shown_and_who_presses_alike_is_not() {
        let more = analysed(12, |_, condition| 1 + 4 * condition, 0.0);
        assert_eq!(verdict(&more, Question::Pressed), Some(Shown));
        let rates = more.presses.as_ref().unwrap().rates.as_ref().unwrap();
        assert_eq!((rates.n, rates.events.get("slow")), (12, Some(&60)));
        let alike = analysed(12, |person, condition| 1 + (person + condition) % 2, 0.0);
        assert_eq!(verdict(&alike, Question::Pressed), Some(NotShown));
    }

    #[test]
    fn what_came_before_is_found_where_it_came_and_not_where_it_did_not() {
        let caused = analysed(12, |_, _| 3, 0.4);
        assert_eq!(verdict(&caused, Question::BeforePress), Some(Shown));
        let found = finding::by_question(&caused.findings, Question::BeforePress).unwrap();
        let shown: Vec<&str> = found
            .parts
            .iter()
            .filter(|part| part.verdict == Shown)
            .map(|part| part.of.as_str())
            .collect();
        assert_eq!(shown, ["braking_mps2"]);
        let braking = found.parts.iter().find(|p| p.of == "braking_mps2").unwrap();
        assert!(braking.estimate.unwrap() > 1.0);
        let nothing = analysed(12, |_, _| 3, 0.0);
        assert_eq!(verdict(&nothing, Question::BeforePress), Some(NotShown));
    }

    #[test]
    fn below_ten_people_or_thirty_presses_there_is_a_course_and_no_test() {
        for (people, presses) in [(9, 6), (12, 1)] {
            let few = analysed(people, |_, _| presses, 2.0);
            let pressed = few.presses.as_ref().unwrap();
            assert!(pressed.before.is_empty() && !pressed.course.is_empty());
            assert_eq!(verdict(&few, Question::BeforePress), None);
        }
    }

    #[test]
    fn a_study_in_which_nothing_could_be_pressed_asks_nothing() {
        assert_eq!(findings(None), Vec::new());
    }
}
