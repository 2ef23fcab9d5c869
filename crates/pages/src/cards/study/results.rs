//! All cards of a study, in the order of its findings.

use super::{car, conditions, data::Study, people, presses, retest, style};
use crate::{
    card::{Drawn, card, share_row, tested_card},
    texts::{Texts, value},
    words::{closed_as, closed_by, declared_test, in_unit_of},
};
use maveric_analysis::{Finding, Question, findings};
use maveric_report::{
    Card, ReportError,
    claims::{LedgerRow, Verdict, verdict_counts},
    figures::intervals::IntervalRow,
};
use minijinja::context;

/// The texts of these cards.
pub(super) fn texts() -> Result<Texts, ReportError> {
    Texts::read("study.toml", include_str!("../../../texts/study.toml"))
}

/// A card a finding.
///
/// # Errors
/// [`ReportError::Template`] for a text that asks for a value which is not given.
pub fn cards(study: &Study<'_>) -> Result<Vec<Card>, ReportError> {
    let texts = texts()?;
    let mut cards = Vec::new();
    for finding in &study.analysis.findings {
        cards.extend(match finding.question {
            Question::Primary(number) => primary(study, &texts, finding, number)?,
            Question::Hypothesis(number) => hypothesis(study, &texts, finding, number)?,
            Question::OwnStyle => car::own_style(study, &texts, finding)?,
            Question::Nearer => car::nearer(study, &texts, finding)?,
            Question::Dial | Question::Expected | Question::Noticed => {
                conditions::expected(study, &texts, finding)?
            }
            Question::Differ => Some(conditions::differ(study, &texts, finding)?),
            Question::Stays => Some(conditions::stays(study, &texts, finding)?),
            Question::Style => style::line(study, &texts, finding)?,
            Question::Across => style::across(study, &texts, finding)?,
            Question::Congruence => people::congruence(study, &texts, finding).map(Some)?,
            Question::Which => people::which(study, &texts, finding)?,
            Question::Preferred => Some(people::preferred(study, &texts, finding)?),
            Question::Personality => people::personality(study, &texts, finding)?,
            Question::Pressed => presses::pressed(study, &texts, finding)?,
            Question::Retest => retest::retest(study, &texts, finding)?,
            Question::BeforePress => presses::before(study, &texts, finding)?,
            _ => None,
        });
    }
    Ok(cards)
}

fn primary(
    study: &Study<'_>,
    texts: &Texts,
    finding: &Finding,
    number: usize,
) -> Result<Option<Card>, ReportError> {
    let outcomes = &study.analysis.primary;
    let Some(outcome) = number.checked_sub(1).and_then(|at| outcomes.get(at)) else {
        return Ok(None);
    };
    let values = context! {
        first => study.label(outcome.first),
        second => study.label(outcome.second),
        several => outcomes.len() > 1,
        closed_by => closed_by(outcome, outcomes),
        closed_as => closed_as(outcome, outcomes),
        test => declared_test(outcome.test),
        ..context! { ..in_unit_of(study.analysis, &outcome.outcome), ..value(outcome) }
    };
    let say = |key| texts.say("primary", key, &values);
    let row = IntervalRow::new(say("row")?, outcome.mean_difference, outcome.interval);
    let drawn = outcome.mean_difference.map(|_| Drawn::beside(0.0, [row]));
    let tests = Some(say("test")?).filter(|test| !test.is_empty());
    let tests = tests.into_iter().collect();
    tested_card(texts, finding, &values, drawn, tests).map(Some)
}

fn hypothesis(
    study: &Study<'_>,
    texts: &Texts,
    finding: &Finding,
    number: usize,
) -> Result<Option<Card>, ReportError> {
    let place = number.checked_sub(1);
    let Some(judged) = place.and_then(|at| study.analysis.hypotheses.get(at)) else {
        return Ok(None);
    };
    let values = context! {
        first => study.label(judged.first),
        second => study.label(judged.second),
        ..context! { ..in_unit_of(study.analysis, &judged.outcome), ..value(judged) }
    };
    let say = |key| texts.say("hypothesis", key, &values);
    let row = IntervalRow::new(say("row")?, judged.mean_difference, judged.interval);
    let drawn = Drawn::beside(0.0, [row]).within(judged.bounds);
    let tests = Some(say("test")?).filter(|test| !test.is_empty());
    let tests = tests.into_iter().collect();
    tested_card(texts, finding, &values, Some(drawn), tests).map(Some)
}

/// How many numbers of the paper come out here, of those that could differ.
pub fn against_the_paper(ledger: &[LedgerRow]) -> Result<Card, ReportError> {
    let texts = texts()?;
    let counts = verdict_counts(ledger);
    let count = |verdict| counts.get(&verdict).copied().unwrap_or(0);
    let [agree, same, differ] =
        [Verdict::Agrees, Verdict::SameDirection, Verdict::Differs].map(count);
    let could = agree + same + differ;
    let finding = findings::against_the_paper(agree, could);
    let set = count(Verdict::ByDesign) + count(Verdict::Tuned);
    let values = context! { agree, same, differ, could, set };
    let label = texts.say("paper", "row", &values)?;
    let rows = finding.parts.iter().map(|part| share_row(&label, part));
    let drawn = Drawn::beside(50.0, rows);
    card(&texts, &finding, &values, Some(drawn))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_called_what_it_shows() {
        let texts = texts().unwrap();
        let primary = |odds: Option<f64>, interval: Option<[f64; 2]>| {
            let values = context! { odds, interval };
            texts.say("primary", "what", &values).unwrap()
        };
        assert_eq!(primary(None, Some([0.1, 0.4])), "95% CI");
        assert!(primary(None, None).starts_with("The mean alone"));
        assert!(primary(Some(2.0), None).contains("the test is of the odds"));
        let strongest = |all: usize| {
            let values = context! { all };
            let said = texts.say("personality", "what", &values).unwrap();
            said.starts_with("The three strongest, with intervals")
        };
        assert!(strongest(4) && !strongest(3));
    }

    #[test]
    fn what_cannot_be_tested_says_why_and_what_is_behind_it_what_closed_the_gate() {
        let texts = texts().unwrap();
        let answer = |closed_as: Option<&str>, why_not: Option<&str>| {
            let values = context! {
                first => "Calm", second => "Sporty", n => 24, mean_difference => 2.67,
                closed_by => closed_as.map(|_| "Comfort"), closed_as, why_not, decimals => 2, measured_in => "",
            };
            texts.say("primary", "answer", &values).unwrap()
        };
        let said = answer(None, Some("all answers are 3"));
        assert!(said.ends_with("(24 people). There is no test: all answers are 3."), "{said}");
        assert!(answer(None, None).ends_with("(24 people)."));
        let closed = answer(Some("cannot be tested"), None);
        assert_eq!(closed, "Not tested: Comfort before it cannot be tested.");
        let test = |unbounded: bool| {
            let odds = None::<f64>;
            let values =
                context! { first => "Calm", second => "Sporty", p => 0.01, odds, unbounded };
            texts.say("primary", "test", &values).unwrap()
        };
        assert!(test(true).contains("likelihood ratio") && !test(false).contains("likelihood"));
    }

    #[test]
    fn what_was_measured_has_its_unit_and_as_many_decimals_as_it_needs() {
        let texts = texts().unwrap();
        let said = |card: &str, measured_in: &str, decimals: usize| {
            let none = None::<f64>;
            let values = context! {
                first => "Sporty", second => "Calm", mean_difference => -0.003_97, interval => vec![-0.0057, -0.0023], odds => none,
                n => 19, decimals, measured_in, closed_by => none, bounds => none, why_not => none,
            };
            let said = ["answer", "value", "axis"].map(|key| texts.say(card, key, &values));
            said.map(Result::unwrap)
        };
        for card in ["primary", "hypothesis"] {
            let [answer, value, axis] = said(card, "s", 4);
            assert_eq!(answer.trim(), "On average Sporty lies 0.0040 s below Calm (19 people).");
            assert_eq!(value, "mean difference −0.0040 s, 95% CI [−0.0057, −0.0023]");
            assert_eq!(axis, "Mean difference (s)");
            let [answer, value, axis] = said(card, "", 2);
            assert!(answer.contains("lies 0.00 below"), "{answer}");
            assert_eq!(value, "mean difference 0.00, 95% CI [−0.01, 0.00]");
            assert_eq!(axis, "Mean difference");
        }
    }

    #[test]
    fn a_unit_of_a_measure_of_ones_own_is_no_mark() {
        let texts = texts().unwrap();
        for unit in ["m*s^2", ""] {
            let values = context! {
                title => "Harshness", mean => 0.5, interval => vec![0.4, 0.6], unit, decimals => 2, t => "t", same_within => 1.0, p_equivalent => 0.01,
            };
            for key in ["off", "test"] {
                let said = texts.say("own-style", key, &values).unwrap();
                let plain = maveric_report::markup::plain(&said);
                assert_eq!(plain.contains("0.50 m*s^2 "), !unit.is_empty(), "{said}");
                assert!(plain.contains("0.50 "), "{said}");
            }
        }
    }

    #[test]
    fn what_chance_gives_is_no_zero_where_few_pairs_were_tested() {
        let texts = texts().unwrap();
        let said = |chance: f64| {
            let values = context! { all => 2, kept => 0, low => 0, chance };
            texts.say("personality", "answer", &values).unwrap()
        };
        assert!(said(0.1).contains("where 0.1 would by chance"));
        assert!(said(1.2).contains("where 1 would by chance"));
    }
}
