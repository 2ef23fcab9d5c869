//! All cards of a study, in the order of its findings.

use super::{car, conditions, data::Study, people, presses, retest, style};
use crate::{
    card::{Drawn, card, share_row, tested_card},
    texts::{Texts, value},
    words::{closed_by, declared_test},
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
        test => declared_test(outcome.test),
        ..value(outcome)
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
        ..value(judged)
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
