//! Tests that take the period out, and tests that were declared.

use std::collections::BTreeSet;

use super::{
    AskedTest, ByDesign, Chosen, ChosenTest, DesignChoice, DesignColumns, MissingCells,
    OrdinalFinding, PERIOD, SmallSample, carry_over::is_connected, kept, one_factor::as_answers,
};
use crate::{
    MarginalContrast, Ordinal, PosthocTest, StatsError, WithinSubjects,
    compare::run,
    ordinal::{Difference, by_period, ratios_of_pairs},
};

/// The test that was asked for; where orders are known, with the period.
pub(super) fn with_period_or_declared(
    data: &DesignColumns<'_>,
    choice: &DesignChoice,
) -> Result<ByDesign, StatsError> {
    let periods = !data.periods.is_empty();
    if let (MissingCells::Listwise, Some(whole)) = (choice.missing, kept::listwise(data)) {
        // Nobody is left in whom a cell is missing.
        return with_period_or_declared(&whole.columns(), choice);
    }
    if periods {
        StatsError::same_length(PERIOD, data.periods.len(), data.values.len())?;
        if !is_connected(data) {
            return Err(StatsError::no_fit(
                "condition and period cannot be told apart in the orders that there are",
            ));
        }
    }
    let one_factor = match (&data.within[..], &data.between[..], &data.covariates[..]) {
        ([(_, conditions)], [], []) => Some(*conditions),
        _ => None,
    };
    let (mut reasons, as_answers) = match (choice.test, one_factor) {
        (AskedTest::Chosen, Some(_)) => {
            let (as_answers, why) = as_answers(choice.scale, data.values);
            (why.into_iter().collect(), as_answers)
        }
        _ => (Vec::new(), choice.test == AskedTest::Ordinal),
    };
    let test = match choice.test {
        AskedTest::RmAnova => Some(PosthocTest::T),
        AskedTest::Friedman => Some(PosthocTest::Wilcoxon),
        _ => None,
    };
    if choice.test != AskedTest::Chosen && test.is_none() {
        reasons.push("declared, not chosen by what the data look like".to_owned());
    }
    if periods {
        reasons.push(
            "people met the conditions in an order: the period is a factor of the test, whatever its p"
                .to_owned(),
        );
    }
    match (test, one_factor) {
        (Some(_), Some(_)) if periods => Err(StatsError::no_fit(
            "a test of ranks or differences takes no period, and orders are known",
        )),
        (Some(test), Some(conditions)) => {
            let complete = WithinSubjects::from_long(data.subjects, conditions, data.values)?;
            let comparison = run(&complete, choice.alpha, choice.exact(), Some(test))?;
            Ok(ByDesign::OneFactor(Box::new(comparison)))
        }
        (None, Some(conditions)) if as_answers => ordered(data, conditions, reasons),
        (None, _) if !as_answers => {
            reasons.push(kept::model_of(data).to_owned());
            kept::mixed(data, choice, reasons)
        }
        _ => Err(StatsError::no_fit(
            "the test that was asked for is of one factor within subjects alone",
        )),
    }
}

/// Ordered answers, with the period where orders are known.
fn ordered(
    data: &DesignColumns<'_>,
    conditions: &[String],
    mut reasons: Vec<String>,
) -> Result<ByDesign, StatsError> {
    let (model, pairs) = by_period(data.subjects, conditions, data.periods, data.values)?;
    reasons.push(
        "cumulative logit with a random intercept of the subject; likelihood ratios over their degrees of freedom are held against F, and \
         coefficients against t: against chi-squared and the normal distribution they find too much where people are few"
            .to_owned(),
    );
    let met = data.periods.iter().zip(data.values);
    let met: BTreeSet<usize> = met.filter(|(_, v)| v.is_some()).map(|(p, _)| *p).collect();
    let further = met.len().saturating_sub(1);
    let lr = &model.quadrature.lr;
    let small_sample = lr.chi2.and_then(|chi2| SmallSample::of_ratio(&model, chi2, lr.df, further));
    let period = if further > 0 {
        let (without, _) = by_period(data.subjects, conditions, &[], data.values)?;
        let top = |model: &Ordinal| model.quadrature.log_likelihood;
        let chi2 = top(&model).zip(top(&without)).map(|(with, without)| 2.0 * (with - without));
        chi2.and_then(|chi2| SmallSample::of_ratio(&model, chi2.max(0.0), further, lr.df))
    } else {
        None
    };
    let columns = (data.subjects, conditions, data.periods, data.values);
    let ratios = ratios_of_pairs(columns, &model, &pairs)?;
    let others = lr.df.saturating_sub(1) + further;
    let against_f =
        |(name, chi2): (String, f64)| Some((name, SmallSample::of_ratio(&model, chi2, 1, others)?));
    let ratio = ratios.into_iter().filter_map(against_f).collect();
    let freedom = small_sample.as_ref().map(|test| test.df2 as f64);
    let by_t = |(name, (estimate, se)): (String, Difference)| {
        let contrast = MarginalContrast::from_estimate(estimate, se, freedom);
        (name, contrast)
    };
    let contrast = MarginalContrast::family(pairs.into_iter().map(by_t));
    Ok(ByDesign::Ordinal(Box::new(Chosen {
        chosen: ChosenTest::Ordinal,
        reasons,
        checks: Vec::new(),
        found: OrdinalFinding { small_sample, period, contrast, ratio, model, beside: None },
    })))
}
