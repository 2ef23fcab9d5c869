//! The report of `compare` and `posthoc`.

use super::{
    Printed,
    cells::{effect, interval, number, optional, p, share, shown, table},
    reasons::{checks, why},
    sentences, within,
};
use maveric_report::tables::{Cell, Table};
use maveric_stats::{
    Adjustment, Comparison, EffectName, OmnibusP, OmnibusTest, PMethod, Posthoc, PosthocPair,
    PosthocTest, apa,
};

pub(super) fn comparison(result: &Comparison) -> Printed {
    let omnibus = &result.omnibus;
    let mut finding = sentences(result, &["omnibus"]);
    if omnibus.test == OmnibusTest::Friedman {
        let ci = shown(&interval(omnibus.effect.ci.holding(omnibus.effect.value), share));
        let how = match omnibus.p_method {
            OmnibusP::Exact => "*p* is exact: all orders of the ranks within subjects",
            OmnibusP::ImanDavenport => "*p* is that of Iman and Davenport's *F* of the ranks",
            _ => "*p* is that of chi-squared",
        };
        finding.push(format!("90% CI of *W* {ci}; {how}"));
    }
    finding.push(
        match omnibus.reject {
            Some(true) => "The conditions differ at .05.",
            Some(false) => "No difference of the conditions is shown at .05.",
            None => "The test has no value for these data.",
        }
        .to_owned(),
    );
    let heading = match omnibus.test {
        OmnibusTest::Friedman => "Friedman's test",
        OmnibusTest::PairedT => "Paired t test",
        OmnibusTest::Wilcoxon => "Wilcoxon's signed ranks",
        _ => "Repeated-measures analysis of variance",
    };
    Printed::within("Comparison of conditions", result.n, result.k, &result.dropped)
        .table(within::conditions(&result.desc, None))
        .table(checks(&result.checks))
        .lines("Why this test", why(&result.reasons))
        .lines(heading, finding)
        .table(pairs(&result.posthoc))
        .undefined(&result.undefined)
}

pub(in crate::stages::stats) fn posthoc(result: &Posthoc) -> Printed {
    Printed::within("Comparison of pairs", result.n, result.k, &result.dropped)
        .table(pairs(result))
        .undefined(&result.undefined)
}

fn heading_of(result: &Posthoc) -> String {
    let test = match result.test {
        PosthocTest::T => "paired t",
        PosthocTest::PooledT => "t over the pooled error term",
        PosthocTest::Wilcoxon => "Wilcoxon's signed ranks",
        PosthocTest::Conover => "Conover's test of rank sums",
        _ => "Nemenyi's test of mean ranks",
    };
    let adjust = match result.adjust {
        Adjustment::Holm => "p corrected by Holm",
        Adjustment::Bonferroni => "p corrected by Bonferroni",
        Adjustment::Hochberg => "p corrected by Hochberg",
        Adjustment::Bh => "false discovery rate by Benjamini and Hochberg",
        _ if result.test == PosthocTest::Nemenyi => "p holds for all pairs",
        _ => "p not corrected",
    };
    let alpha = apa::bounded(result.alpha, 2);
    format!("Pairs by {test} (A minus B; {adjust}; † below {alpha})")
}

fn pairs(result: &Posthoc) -> Table {
    let statistic = match result.test {
        PosthocTest::Wilcoxon => "*V*",
        PosthocTest::Nemenyi => "*q*",
        _ => "*t*",
    };
    let biserial = result
        .pairs
        .values()
        .next()
        .is_some_and(|pair| pair.effect.name == EffectName::RankBiserial);
    let (size, write): (_, fn(Option<f64>) -> Cell) =
        if biserial { ("*r*_{rb}", share) } else { ("*d*_{z}", effect) };
    let exact = |pair: &PosthocPair| match pair.p_method {
        Some(PMethod::Exact) => " exact",
        _ => "",
    };
    table(&heading_of(result), result.pairs.iter())
        .text("", |(name, _)| *name)
        .right("Difference", |(_, pair)| number(pair.mean_diff))
        .right("*n*", |(_, pair)| Cell::count(pair.n_used))
        .right(statistic, |(_, pair)| optional(pair.statistic))
        .right("*df*", |(_, pair)| pair.df.map_or_else(|| Cell::text(""), Cell::count))
        .right("*p*", |(_, pair)| Cell::text(format!("{}{}", shown(&p(pair.p)), exact(pair))))
        .right("*p* adjusted", |(_, pair)| p(pair.p_adjusted))
        .right("", |(_, pair)| Cell::text(if pair.reject == Some(true) { "†" } else { "" }))
        .right(size, |(_, pair)| write(pair.effect.value))
        .right("95% CI", |(_, pair)| interval(pair.effect.ci, write))
        .done()
}
