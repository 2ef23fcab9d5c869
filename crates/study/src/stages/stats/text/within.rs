//! The report of `within`, `rm-anova` and `friedman`.

use super::{
    section,
    table::{Columns, NONE, degrees, effect, interval, number, optional, p, share},
    undefined, who,
};
use maveric_stats::{
    ConditionSummary, Friedman, FriedmanAnalysis, Mauchly, Named, RmAnova, RmAnovaAnalysis,
    ShapiroWilk, Sphericity, WithinAnalysis,
};
use serde_json::{Map, Value};

/// The APA strings said about `names`, indented.
fn said(apa: &Map<String, Value>, names: &[&str]) -> Vec<String> {
    let texts = names.iter().filter_map(|name| apa.get(*name)?.as_str());
    texts.map(|text| format!("  {text}")).collect()
}

pub(in crate::stages::stats) fn whole(
    found: &WithinAnalysis,
    apa: &Map<String, Value>,
) -> Vec<String> {
    let mut lines = who("Within-subject analysis", found.n, found.k, &found.dropped);
    section(
        &mut lines,
        "Conditions",
        conditions(&found.desc, Some(&found.shapiro)),
    );
    let below = [
        said(apa, &["rm_anova"]),
        variance(&found.rm_anova, &found.mauchly, &found.sphericity),
    ];
    section(&mut lines, "Analysis of variance", below.concat());
    let below = [said(apa, &["friedman"]), ranks(&found.friedman)];
    section(&mut lines, "Friedman", below.concat());
    section(
        &mut lines,
        "Pairs by paired t (A minus B, Holm)",
        t_pairs(found),
    );
    section(
        &mut lines,
        "Pairs by ranks (A minus B, Holm)",
        rank_pairs(found),
    );
    undefined(&mut lines, &found.undefined);
    lines
}

pub(in crate::stages::stats) fn rm_anova(
    found: &RmAnovaAnalysis,
    apa: &Map<String, Value>,
) -> Vec<String> {
    let mut lines = who("Analysis of variance", found.n, found.k, &found.dropped);
    lines.extend(said(apa, &["rm_anova"]));
    section(&mut lines, "Conditions", conditions(&found.desc, None));
    let below = variance(&found.rm_anova, &found.mauchly, &found.sphericity);
    section(&mut lines, "Analysis of variance", below);
    undefined(&mut lines, &found.undefined);
    lines
}

pub(in crate::stages::stats) fn friedman(
    found: &FriedmanAnalysis,
    apa: &Map<String, Value>,
) -> Vec<String> {
    let mut lines = who("Friedman's test", found.n, found.k, &found.dropped);
    lines.extend(said(apa, &["friedman"]));
    section(&mut lines, "Conditions", conditions(&found.desc, None));
    section(&mut lines, "Friedman", ranks(&found.friedman));
    undefined(&mut lines, &found.undefined);
    lines
}

/// Means with their within-subject intervals, and the tests of normality if there are any.
pub(super) fn conditions(
    desc: &Named<ConditionSummary>,
    shapiro: Option<&Named<ShapiroWilk>>,
) -> Vec<String> {
    let header = [
        "",
        "mean",
        "sd",
        "95% within-subject CI",
        "Shapiro-Wilk W",
        "p",
    ];
    let mut table = Columns::new(&header[..if shapiro.is_some() { 6 } else { 4 }]);
    let normal = |name: &str| {
        let test = shapiro.and_then(|tests| tests.get(name));
        test.map_or_else(Vec::new, |test| vec![share(test.w), p(test.p)])
    };
    for (name, c) in desc.iter() {
        let ci = interval(c.within_ci_low, c.within_ci_high, optional);
        let cells = vec![name.to_owned(), number(c.mean), number(c.sd), ci];
        table.row(cells.into_iter().chain(normal(name)));
    }
    if shapiro.is_some() {
        let empty = || String::new();
        let cells = vec!["residuals".to_owned(), empty(), empty(), empty()];
        table.row(cells.into_iter().chain(normal("residuals")));
    }
    table.lines()
}

fn variance(found: &RmAnova, mauchly: &Mauchly, sphericity: &Sphericity) -> Vec<String> {
    let mut table = Columns::new(&["source", "SS", "df", "MS", "F", "p"]);
    let (d1, d2) = (found.df1 as f64, found.df2 as f64);
    let subjects = d2 / d1;
    table.row([
        "conditions".to_owned(),
        number(found.ss_condition),
        found.df1.to_string(),
        number(found.ss_condition / d1),
        optional(found.f),
        p(found.p),
    ]);
    for (name, sum, df) in [
        ("subjects", found.ss_subject, subjects),
        ("error", found.ss_error, d2),
    ] {
        table.row([
            name.to_owned(),
            number(sum),
            df.to_string(),
            number(sum / df),
        ]);
    }
    let mut lines = table.lines();
    lines.push(String::new());
    let mut table = Columns::new(&["degrees of freedom times", "epsilon", "df1", "df2", "p"]);
    let lower = Some(sphericity.lower_bound);
    for (name, epsilon, value) in [
        ("1 (sphericity)", Some(1.0), found.p),
        ("Greenhouse-Geisser", sphericity.gg, sphericity.p_gg),
        ("Huynh-Feldt", sphericity.hf, sphericity.p_hf),
        ("lower bound", lower, sphericity.p_lb),
    ] {
        let times = |df: f64| degrees(epsilon.map(|e| e * df));
        table.row([
            name.to_owned(),
            share(epsilon),
            times(d1),
            times(d2),
            p(value),
        ]);
    }
    lines.extend(table.lines());
    if let (Some(w), Some(chi2), Some(df)) = (mauchly.w, mauchly.chi2, mauchly.df) {
        let (w, chi2, p) = (share(Some(w)), number(chi2), p(mauchly.p));
        lines.push(format!("  Mauchly: W = {w}, chi2({df}) = {chi2}, p = {p}").replace("= <", "<"));
    }
    lines.push(String::new());
    let mut table = Columns::new(&["effect size", "estimate", "90% CI"]);
    for (name, value, low, high) in [
        (
            "partial eta squared",
            found.eta2_partial,
            found.eta2_partial_ci90_low,
            found.eta2_partial_ci90_high,
        ),
        (
            "generalised eta squared",
            found.eta2_generalized,
            found.eta2_generalized_ci90_low,
            found.eta2_generalized_ci90_high,
        ),
        (
            "omega squared",
            found.omega2_partial,
            found.omega2_partial_ci90_low,
            found.omega2_partial_ci90_high,
        ),
    ] {
        table.row([name.to_owned(), share(value), interval(low, high, share)]);
    }
    lines.extend(table.lines());
    lines
}

fn ranks(found: &Friedman) -> Vec<String> {
    let mut table = Columns::new(&["by", "statistic", "df", "p"]);
    let df = |df: Option<f64>| df.map_or_else(|| NONE.to_owned(), |df| df.to_string());
    table.row([
        "all orders of the ranks (exact)".to_owned(),
        String::new(),
        String::new(),
        p(found.p_exact),
    ]);
    table.row([
        "F (Iman-Davenport)".to_owned(),
        optional(found.f),
        format!("{}, {}", df(found.f_df1), df(found.f_df2)),
        p(found.f_p),
    ]);
    table.row([
        "chi-squared".to_owned(),
        optional(found.chi2),
        df(found.df.map(|df| df as f64)),
        p(found.p),
    ]);
    let mut lines = table.lines();
    let ci = interval(found.kendall_w_ci90_low, found.kendall_w_ci90_high, share);
    lines.push(format!(
        "  Kendall's W = {}, 90% CI {ci}",
        share(found.kendall_w)
    ));
    lines
}

fn t_pairs(found: &WithinAnalysis) -> Vec<String> {
    let header = [
        "",
        "difference",
        "95% CI",
        "t",
        "p",
        "dz",
        "95% CI",
        "gz",
        "d_av",
        "pooled p",
    ];
    let mut table = Columns::new(&header);
    for ((name, t), pooled) in found.paired.iter().zip(found.pooled.values()) {
        table.row([
            name.to_owned(),
            number(t.mean_diff),
            interval(t.ci_low, t.ci_high, optional),
            optional(t.t),
            p(t.p_holm),
            effect(t.dz),
            interval(t.dz_ci_low, t.dz_ci_high, effect),
            effect(t.gz),
            effect(t.d_av),
            p(pooled.p_holm),
        ]);
    }
    table.lines()
}

fn rank_pairs(found: &WithinAnalysis) -> Vec<String> {
    let header = [
        "",
        "n",
        "W+",
        "W−",
        "Wilcoxon p",
        "r_rb",
        "95% CI",
        "Conover p",
        "Nemenyi p",
    ];
    let mut table = Columns::new(&header);
    let tests = found.wilcoxon.iter().zip(found.conover.values());
    for (((name, w), conover), nemenyi) in tests.zip(found.nemenyi.values()) {
        let sum = |value: Option<f64>| value.map_or_else(|| NONE.to_owned(), |v| v.to_string());
        table.row([
            name.to_owned(),
            w.n_used.to_string(),
            sum(w.w_plus),
            sum(w.w_minus),
            p(w.p_holm),
            share(w.rank_biserial),
            interval(w.rank_biserial_ci_low, w.rank_biserial_ci_high, share),
            p(conover.p_holm),
            p(Some(nemenyi.p)),
        ]);
    }
    table.lines()
}
