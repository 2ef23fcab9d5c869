//! The report of mixed models and of ordered answers.

use super::{
    Printed,
    cells::{degrees, interval, number, optional, p, shown, table},
    factors::marginal,
    named_sentences,
};
use maveric_report::tables::Table;
use maveric_stats::{MarginalContrast, Named, Ordinal, OrdinalParameter, RandomIntercept, apa};

pub(in crate::stages::stats) fn mixed(result: &RandomIntercept) -> Printed {
    mixed_with(result, |term| result.contrast.get(term))
}

/// The same with the pairs of each term as they count.
pub(super) fn mixed_with<'a>(
    result: &'a RandomIntercept,
    pairs_of: impl Fn(&str) -> Option<&'a Named<MarginalContrast>>,
) -> Printed {
    let model = match result.variance.subject {
        Some(_) => "Mixed model, random intercept of the subject",
        None => "Linear model (each subject has one row)",
    };
    let who = format!(
        "{model}, fixed {}: {} rows of {} subjects",
        result.formula, result.n_obs, result.n_subjects,
    );
    let mut terms = table("Terms (type III, Satterthwaite)", result.anova.iter())
        .text("Term", |(name, _)| *name)
        .right("*F*", |(_, t)| number(t.f))
        .right("*df*_{1}", |(_, t)| degrees(Some(t.df1 as f64)))
        .right("*df*_{2}", |(_, t)| degrees(t.df2))
        .right("*p*", |(_, t)| p(t.p))
        .done();
    terms.notes = named_sentences(result);
    let title = "Coefficients (the first level of a factor is the reference; covariates at 0)";
    let coefficients = table(title, result.coef.iter())
        .text("", |(name, _)| *name)
        .right("Estimate", |(_, c)| number(c.estimate))
        .right("*SE*", |(_, c)| optional(c.se))
        .right("95% CI", |(_, c)| interval(c.ci, optional))
        .right("*df*", |(_, c)| degrees(c.df))
        .right("*t*", |(_, c)| optional(c.t))
        .right("*p*", |(_, c)| p(c.p))
        .noted(variances(result));
    let mut printed = Printed::headed(who, 0, &[])
        .left_out(result.missing, "rows")
        .table(terms)
        .table(coefficients);
    for (name, means) in result.emm.iter() {
        printed = printed.table(marginal(name, means));
        if let Some(pairs) = pairs_of(name) {
            printed = printed.table(contrasts(name, pairs));
        }
    }
    printed.undefined(&result.undefined)
}

fn variances(result: &RandomIntercept) -> String {
    let residual = shown(&number(result.variance.residual));
    match (result.variance.subject, result.icc) {
        (Some(subject), Some(icc)) => format!(
            "variance of the subjects {}, residual {residual}; ICC = {}",
            shown(&number(subject)),
            apa::bounded(icc, 2)
        ),
        _ => format!("residual variance {residual}"),
    }
}

fn contrasts(term: &str, pairs: &Named<MarginalContrast>) -> Table {
    let title = format!("Pairs of {term} (A minus B, Holm)");
    table(&title, pairs.iter())
        .text("", |(name, _)| *name)
        .right("Difference", |(_, c)| number(c.estimate))
        .right("95% CI", |(_, c)| interval(c.ci, optional))
        .right("*t*", |(_, c)| number(c.t))
        .right("*df*", |(_, c)| degrees(c.df))
        .right("*p*", |(_, c)| p(c.p))
        .right("*p*_{Holm}", |(_, c)| p(c.p_holm))
        .done()
}

pub(in crate::stages::stats) fn ordinal(result: &Ordinal) -> Printed {
    let who = format!(
        "Ordered answers, cumulative logit with a random intercept: {} answers of {} subjects, {} categories",
        result.n_obs,
        result.n_subjects,
        result.answers.len()
    );
    let rows = |title: &str, parameters: &Named<OrdinalParameter>| {
        table(title, parameters.iter())
            .text("", |(name, _)| *name)
            .right("Estimate", |(_, o)| optional(o.estimate))
            .right("*SE*", |(_, o)| optional(o.se))
            .right("95% CI", |(_, o)| interval(o.ci, optional))
            .right("*z*", |(_, o)| optional(o.z))
            .right("*p*", |(_, o)| p(o.p))
            .done()
    };
    let reference = result.conditions.first().map_or("", String::as_str);
    let mut coefficients = rows(
        &format!("Conditions against {reference} (log odds of a higher answer)"),
        &result.quadrature.coef,
    );
    coefficients.notes = named_sentences(result);
    let mut thresholds = rows("Thresholds between answers", &result.quadrature.threshold);
    if let Some(variance) = result.quadrature.variance.subject {
        let variance = shown(&number(variance));
        thresholds.notes.push(format!("variance of the subjects {variance}"));
    }
    Printed::headed(who, 0, &[])
        .left_out(result.missing, "rows")
        .table(coefficients)
        .table(thresholds)
        .undefined(&result.undefined)
}
