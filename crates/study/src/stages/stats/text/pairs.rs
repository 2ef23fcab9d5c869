//! The report of `compare` and `posthoc`.

use super::{
    section,
    table::{Columns, NONE, effect, interval, number, optional, p, share},
    undefined, who, within,
};
use maveric_stats::{
    Adjustment, Comparison, EffectName, OmnibusP, OmnibusTest, PMethod, Posthoc, PosthocTest,
};
use serde_json::{Map, Value};

pub(in crate::stages::stats) fn comparison(
    found: &Comparison,
    apa: &Map<String, Value>,
) -> Vec<String> {
    let mut lines = who("Comparison of conditions", found.n, found.k, &found.dropped);
    section(
        &mut lines,
        "Conditions",
        within::conditions(&found.desc, None),
    );
    let mut table = Columns::new(&["assumption", "W", "p", "stands"]);
    for check in &found.checks {
        let stands = match check.passed {
            Some(true) => "yes",
            Some(false) => "no",
            None => NONE,
        };
        table.row([
            check.name.clone(),
            share(check.statistic),
            p(check.p),
            stands.to_owned(),
        ]);
    }
    section(&mut lines, "Checks", table.lines());
    let reasons = found.reasons.iter().enumerate();
    let reasons = reasons.map(|(i, reason)| format!("  {}. {reason}", i + 1));
    section(&mut lines, "Why this test", reasons.collect());
    let omnibus = &found.omnibus;
    let mut below: Vec<String> = apa
        .get("omnibus")
        .and_then(Value::as_str)
        .map(|text| format!("  {text}"))
        .into_iter()
        .collect();
    if omnibus.test == OmnibusTest::Friedman {
        let ci = interval(omnibus.effect.ci_low, omnibus.effect.ci_high, share);
        let how = match omnibus.p_method {
            OmnibusP::Exact => "p is exact: all orders of the ranks within subjects",
            OmnibusP::ImanDavenport => "p is that of Iman and Davenport's F of the ranks",
            _ => "p is that of chi-squared",
        };
        below.push(format!("  90% CI of W {ci}; {how}"));
    }
    below.push(match omnibus.reject {
        Some(true) => "  The conditions differ at .05.".to_owned(),
        Some(false) => "  No difference of the conditions is shown at .05.".to_owned(),
        None => "  The test has no value for these data.".to_owned(),
    });
    let heading = match omnibus.test {
        OmnibusTest::Friedman => "Friedman's test",
        _ => "Repeated-measures analysis of variance",
    };
    section(&mut lines, heading, below);
    section(
        &mut lines,
        &heading_of(&found.posthoc),
        pairs(&found.posthoc),
    );
    undefined(&mut lines, &found.undefined);
    lines
}

pub(in crate::stages::stats) fn posthoc(found: &Posthoc) -> Vec<String> {
    let mut lines = who("Comparison of pairs", found.n, found.k, &found.dropped);
    section(&mut lines, &heading_of(found), pairs(found));
    undefined(&mut lines, &found.undefined);
    lines
}

fn heading_of(found: &Posthoc) -> String {
    let test = match found.test {
        PosthocTest::T => "paired t",
        PosthocTest::PooledT => "t over the pooled error term",
        PosthocTest::Wilcoxon => "Wilcoxon's signed ranks",
        PosthocTest::Conover => "Conover's test of rank sums",
        _ => "Nemenyi's test of mean ranks",
    };
    let adjust = match found.adjust {
        Adjustment::Holm => "p corrected by Holm",
        Adjustment::Bonferroni => "p corrected by Bonferroni",
        Adjustment::Hochberg => "p corrected by Hochberg",
        Adjustment::Bh => "false discovery rate by Benjamini and Hochberg",
        _ if found.test == PosthocTest::Nemenyi => "p holds for all pairs",
        _ => "p not corrected",
    };
    format!(
        "Pairs by {test} (A minus B; {adjust}; * below {})",
        found.alpha
    )
}

fn pairs(found: &Posthoc) -> Vec<String> {
    let statistic = match found.test {
        PosthocTest::Wilcoxon => "W+",
        PosthocTest::Nemenyi => "q",
        _ => "t",
    };
    let effect_name = match found.pairs.values().next().map(|pair| pair.effect.name) {
        Some(EffectName::RankBiserial) => "r_rb",
        _ => "dz",
    };
    let header = [
        "",
        "difference",
        "n",
        statistic,
        "df",
        "p",
        "p adjusted",
        "",
        effect_name,
        "95% CI",
    ];
    let mut table = Columns::new(&header);
    for (name, pair) in found.pairs.iter() {
        let write = |value: Option<f64>| match pair.effect.name {
            EffectName::RankBiserial => share(value),
            _ => effect(value),
        };
        let exact = if pair.p_method == Some(PMethod::Exact) {
            " exact"
        } else {
            ""
        };
        table.row([
            name.to_owned(),
            number(pair.mean_diff),
            pair.n_used.to_string(),
            optional(pair.statistic),
            pair.df.map_or_else(String::new, |df| df.to_string()),
            format!("{}{exact}", p(pair.p)),
            p(pair.p_adjusted),
            if pair.reject == Some(true) { "*" } else { " " }.to_owned(),
            write(pair.effect.value),
            interval(pair.effect.ci_low, pair.effect.ci_high, write),
        ]);
    }
    table.lines()
}
