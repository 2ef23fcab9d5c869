//! One factor within subjects: a comparison of means or ranks, or a model of ordered answers.

use super::{
    ByDesign, Chosen, ChosenTest, DesignChoice, DesignColumns, OrdinalFinding, OutcomeScale,
    RankCheck, SmallSample,
};
use crate::{
    Named, Reasons, StatsError, WithinSubjects, analysis::analyse, apa, compare::run,
    friedman::Exact, ordinal,
};

/// Different answers at most of an item.
const MOST_ANSWERS: usize = 7;

/// Whether the answers are of few whole numbers; and what speaks for or against, in words.
pub(super) fn few_whole_answers(values: &[Option<f64>]) -> Result<String, String> {
    let mut different: Vec<f64> = values.iter().flatten().copied().collect();
    different.sort_by(f64::total_cmp);
    different.dedup_by(|a, b| (*a - *b).abs() <= 0.0);
    if let Some(part) = different.iter().find(|v| v.fract().abs() > 0.0) {
        return Err(format!(
            "{} is no whole number: a mean of items, not an item",
            as_short_as_shows_it(*part)
        ));
    }
    let count = different.len();
    if count > MOST_ANSWERS {
        return Err(format!("{count} different answers are more than {MOST_ANSWERS}"));
    }
    Ok(format!("{count} different whole answers"))
}

/// A number that is not whole, with two decimals, or as many as show that it is not.
fn as_short_as_shows_it(part: f64) -> String {
    let written = |decimals: usize| apa::number(part, decimals);
    let is_whole = |text: &String| text.ends_with('0') && text.trim_end_matches('0').ends_with('.');
    (2..=15).map(written).find(|text| !is_whole(text)).unwrap_or_else(|| part.to_string())
}

/// Whether the answers are modelled as ordered, and why.
pub(super) fn as_answers(scale: OutcomeScale, values: &[Option<f64>]) -> (bool, Option<String>) {
    const MODEL: &str = "cumulative logit with a random intercept of the subject";
    match (scale, few_whole_answers(values)) {
        (OutcomeScale::Measure, Ok(words)) => (
            false,
            Some(format!(
                "{words}, but a measure: its distances count; ordered answers have to be asked for"
            )),
        ),
        (OutcomeScale::Measure, Err(_)) => (false, None),
        (OutcomeScale::Rating, Ok(words)) => {
            (true, Some(format!("an item ({words}), of which only the order counts: {MODEL}")))
        }
        (OutcomeScale::Rating, Err(why)) => {
            (false, Some(format!("a scale, not an item ({why}): its distances count")))
        }
        (OutcomeScale::Ordinal, _) => (true, Some(format!("ordered answers, as asked: {MODEL}"))),
    }
}

pub(super) fn one_factor(
    data: &DesignColumns<'_>,
    conditions: &[String],
    choice: &DesignChoice,
    mut reasons: Vec<String>,
) -> Result<ByDesign, StatsError> {
    let (as_answers, why) = as_answers(choice.scale, data.values);
    reasons.extend(why);
    let complete = WithinSubjects::from_long(data.subjects, conditions, data.values);
    if as_answers {
        let model = ordinal(data.subjects, conditions, data.values)?;
        reasons.push(
            "its likelihood ratio over its degrees of freedom is held against F: against chi-squared it finds too much where people are few"
                .to_owned(),
        );
        reasons
            .push("the rank test of the complete subjects stands beside it, as a check".to_owned());
        let beside = complete.ok().map(|data| rank_check(&data, choice.exact()));
        return Ok(ByDesign::Ordinal(Box::new(Chosen {
            chosen: ChosenTest::Ordinal,
            reasons,
            checks: Vec::new(),
            found: OrdinalFinding {
                small_sample: SmallSample::from_model(&model),
                model,
                period: None,
                contrast: Named::default(),
                ratio: Named::default(),
                beside,
            },
        })));
    }
    let mut comparison = run(&complete?, choice.alpha, choice.exact(), None)?;
    comparison.reasons.splice(0..0, reasons);
    Ok(ByDesign::OneFactor(Box::new(comparison)))
}

fn rank_check(data: &WithinSubjects, exact: Exact) -> RankCheck {
    let tests = analyse(data, exact);
    let mut undefined = Reasons::default();
    for (name, reason) in tests.undefined.iter() {
        if name.starts_with("friedman") || name.starts_with("wilcoxon") {
            undefined.note(name, reason);
        }
    }
    RankCheck {
        n: data.n(),
        left_out: data.dropped().to_vec(),
        friedman: tests.friedman,
        wilcoxon: tests.wilcoxon,
        undefined,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_of_items_is_named_with_as_many_decimals_as_tell_it_from_an_item() {
        let why = |value: f64| few_whole_answers(&[Some(1.0), Some(value)]).unwrap_err();
        assert_eq!(why(35.0 / 6.0), "5.83 is no whole number: a mean of items, not an item");
        assert!(why(3.0004).starts_with("3.0004 is"));
        assert!(why(-0.5).starts_with("−0.50 is"));
        assert_eq!(
            few_whole_answers(&[Some(1.0), None, Some(2.0)]).unwrap(),
            "2 different whole answers"
        );
    }
}
