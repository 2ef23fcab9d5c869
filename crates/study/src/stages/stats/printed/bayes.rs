//! The report of Bayes factors: each pair, and what was held likely before.

use super::{
    Printed,
    cells::{number, optional, share, table},
    named_sentences,
};
use maveric_report::tables::{Cell, Table};
use maveric_stats::{BayesCorrelationAnalysis, BayesTAnalysis, Prior};

pub(in crate::stages::stats) fn bayes(result: &BayesTAnalysis) -> Printed {
    let values = |values: &[usize]| {
        let each: Vec<String> = values.iter().map(ToString::to_string).collect();
        Cell::text(each.join(" + "))
    };
    let mut factors = table("Bayes factors (A minus B)", result.bayes_t.iter())
        .text("", |(name, _)| *name)
        .right("*n*", |(_, t)| values(&t.values))
        .right("*t*", |(_, t)| optional(t.t))
        .right("*BF*_{10}", |(_, t)| optional(t.bf10))
        .right("*BF*_{01}", |(_, t)| optional(t.bf01))
        .right("ln *BF*_{10}", |(_, t)| optional(t.log_bf10))
        .done();
    factors.notes = named_sentences(result);
    let who = format!("Bayes factors of t tests: n = {}", result.n);
    Printed::headed(who, result.n, &result.dropped)
        .left_out(result.missing, "values")
        .table(factors)
        .table(priors([("bf10", &result.prior)]))
        .undefined(&result.undefined)
}

pub(in crate::stages::stats) fn bayes_correlation(
    result: &BayesCorrelationAnalysis,
    x: &str,
    y: &str,
) -> Printed {
    let factor = &result.bayes_r;
    let rows = [
        ("bf10", factor.bf10, factor.log_bf10),
        ("bf10_kappa1", factor.bf10_kappa1, factor.log_bf10_kappa1),
    ];
    let mut factors = table("Bayes factors of the correlation", rows)
        .text("", |(name, ..)| *name)
        .right("*r*", |_| share(factor.r))
        .right("*BF*_{10}", |(_, bf10, _)| optional(*bf10))
        .right("ln *BF*_{10}", |(.., log)| optional(*log))
        .done();
    factors.notes = named_sentences(result);
    let who = format!("Correlation of {x} and {y}: {} pairs", factor.n);
    Printed::headed(who, factor.n, &[])
        .left_out(result.missing, "pairs")
        .table(factors)
        .table(priors([("bf10", &result.prior), ("bf10_kappa1", &result.prior_kappa1)]))
        .undefined(&result.undefined)
}

fn priors<'a>(priors: impl IntoIterator<Item = (&'a str, &'a Prior)>) -> Table {
    table("Priors", priors)
        .text("", |(name, _)| *name)
        .text("Of the", |(_, prior)| prior.parameter.as_str())
        .text("Family", |(_, prior)| prior.family.as_str())
        .right("Scale", |(_, prior)| number(prior.scale))
        .done()
}
