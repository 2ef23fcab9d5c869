//! The report of Bayes factors: each pair, and what was held likely before.

use super::{
    Printed,
    cells::{number, optional, share, table},
    named_sentences,
};
use maveric_report::tables::{Cell, Table};
use maveric_stats::{BayesCorrelationAnalysis, BayesTAnalysis, Prior};

pub(in crate::stages::stats) fn bayes(found: &BayesTAnalysis) -> Printed {
    let values = |values: &[usize]| {
        let each: Vec<String> = values.iter().map(ToString::to_string).collect();
        Cell::text(each.join(" + "))
    };
    let mut factors = table("Bayes factors (A minus B)", found.bayes_t.iter())
        .text("", |(name, _)| *name)
        .right("*n*", |(_, t)| values(&t.values))
        .right("*t*", |(_, t)| optional(t.t))
        .right("*BF*_{10}", |(_, t)| optional(t.bf10))
        .right("*BF*_{01}", |(_, t)| optional(t.bf01))
        .right("ln *BF*_{10}", |(_, t)| optional(t.log_bf10))
        .done();
    factors.notes = named_sentences(found);
    let who = format!("Bayes factors of t tests: n = {}", found.n);
    Printed::headed(who, found.n, &found.dropped)
        .left_out(found.missing, "values")
        .table(factors)
        .table(priors([("bf10", &found.prior)]))
        .undefined(&found.undefined)
}

pub(in crate::stages::stats) fn bayes_correlation(
    found: &BayesCorrelationAnalysis,
    x: &str,
    y: &str,
) -> Printed {
    let factor = &found.bayes_r;
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
    factors.notes = named_sentences(found);
    let who = format!("Correlation of {x} and {y}: {} pairs", factor.n);
    Printed::headed(who, factor.n, &[])
        .left_out(found.missing, "pairs")
        .table(factors)
        .table(priors([
            ("bf10", &found.prior),
            ("bf10_kappa1", &found.prior_kappa1),
        ]))
        .undefined(&found.undefined)
}

fn priors<'a>(priors: impl IntoIterator<Item = (&'a str, &'a Prior)>) -> Table {
    table("Priors", priors)
        .text("", |(name, _)| *name)
        .text("Of the", |(_, prior)| prior.parameter.as_str())
        .text("Family", |(_, prior)| prior.family.as_str())
        .right("Scale", |(_, prior)| number(prior.scale))
        .done()
}
