//! The report of `within`, `rm-anova` and `friedman`.

use super::{
    Printed,
    cells::{degrees, effect, ends, estimate, interval, number, optional, p, share, shown, table},
    sentences,
};
use maveric_report::tables::{Cell, Table};
use maveric_stats::{
    ConditionSummary, Friedman, FriedmanAnalysis, Mauchly, Named, RmAnova, RmAnovaAnalysis,
    ShapiroWilk, Sphericity, WithinAnalysis,
};

pub(in crate::stages::stats) fn whole(result: &WithinAnalysis) -> Printed {
    let mut anova = variance(&result.rm_anova);
    anova.notes = sentences(result, &["rm_anova"]);
    let mut ranked = ranks(&result.friedman);
    ranked.notes.splice(0..0, sentences(result, &["friedman"]));
    let corrected = corrections(&result.rm_anova, &result.mauchly, &result.sphericity);
    Printed::within("Within-subject analysis", result.n, result.k, &result.dropped)
        .table(conditions(&result.desc, Some(&result.shapiro)))
        .table(anova)
        .table(corrected)
        .table(sizes(&result.rm_anova))
        .table(ranked)
        .table(t_pairs(result))
        .table(rank_pairs(result))
        .undefined(&result.undefined)
}

pub(in crate::stages::stats) fn rm_anova(result: &RmAnovaAnalysis) -> Printed {
    let mut anova = variance(&result.rm_anova);
    anova.notes = sentences(result, &["rm_anova"]);
    let corrected = corrections(&result.rm_anova, &result.mauchly, &result.sphericity);
    Printed::within("Analysis of variance", result.n, result.k, &result.dropped)
        .table(conditions(&result.desc, None))
        .table(anova)
        .table(corrected)
        .table(sizes(&result.rm_anova))
        .undefined(&result.undefined)
}

pub(in crate::stages::stats) fn friedman(result: &FriedmanAnalysis) -> Printed {
    let mut ranked = ranks(&result.friedman);
    ranked.notes.splice(0..0, sentences(result, &["friedman"]));
    Printed::within("Friedman's test", result.n, result.k, &result.dropped)
        .table(conditions(&result.desc, None))
        .table(ranked)
        .undefined(&result.undefined)
}

/// Means with their within-subject intervals, and the tests of normality if there are any.
pub(super) fn conditions(
    desc: &Named<ConditionSummary>,
    shapiro: Option<&Named<ShapiroWilk>>,
) -> Table {
    let normal = |name: &str| shapiro.and_then(|tests| tests.get(name));
    let rows = desc.iter().map(|(name, c)| (name, Some(c)));
    let mean = |column: fn(&ConditionSummary) -> Cell| {
        move |(_, c): &(&str, Option<&ConditionSummary>)| c.map_or_else(|| Cell::text(""), column)
    };
    let residuals = shapiro.is_some().then_some(("residuals", None));
    table("Conditions", rows.chain(residuals))
        .text("", |(name, _)| *name)
        .right("*M*", mean(|c| estimate(c.mean, c.within_ci)))
        .right("*SD*", mean(|c| number(c.sd)))
        .right("95% within-subject CI", mean(|c| ends(c.within_ci)))
        .and_if(shapiro.is_some(), |table| {
            table
                .right("Shapiro-Wilk *W*", |(name, _)| {
                    normal(name).map_or(Cell::Missing, |test| share(test.w))
                })
                .right("*p*", |(name, _)| normal(name).map_or(Cell::Missing, |test| p(test.p)))
        })
        .done()
}

fn variance(result: &RmAnova) -> Table {
    let (d1, d2) = (result.df1 as f64, result.df2 as f64);
    let blank = || Cell::text("");
    let rows = [
        ("conditions", result.ss_condition, d1, true),
        ("subjects", result.ss_subject, d2 / d1, false),
        ("error", result.ss_error, d2, false),
    ];
    table("Analysis of variance", rows)
        .text("Source", |row| row.0)
        .right("*SS*", |row| number(row.1))
        .right("*df*", |row| degrees(Some(row.2)))
        .right("*MS*", |row| number(row.1 / row.2))
        .right("*F*", |row| if row.3 { optional(result.f) } else { blank() })
        .right("*p*", |row| if row.3 { p(result.p) } else { blank() })
        .done()
}

fn corrections(result: &RmAnova, mauchly: &Mauchly, sphericity: &Sphericity) -> Table {
    let (d1, d2) = (result.df1 as f64, result.df2 as f64);
    let rows = [
        ("1 (sphericity)", Some(1.0), result.p),
        ("Greenhouse-Geisser", sphericity.gg, sphericity.p_gg),
        ("Huynh-Feldt", sphericity.hf, sphericity.p_hf),
        ("lower bound", Some(sphericity.lower_bound), sphericity.p_lb),
    ];
    let mut table = table("Sphericity", rows)
        .text("Degrees of freedom times", |row| row.0)
        .right("*ε*", |row| share(row.1))
        .right("*df*_{1}", |row| degrees(row.1.map(|e| e * d1)))
        .right("*df*_{2}", |row| degrees(row.1.map(|e| e * d2)))
        .right("*p*", |row| p(row.2))
        .done();
    if let (Some(w), Some(chi2), Some(df), Some(p)) =
        (mauchly.w, mauchly.chi2, mauchly.df, mauchly.p)
    {
        use maveric_stats::apa;
        let (w, chi2, p) = (apa::bounded(w, 3), apa::number(chi2, 2), apa::p(p));
        let p = p.markup();
        table.notes.push(format!("Mauchly: *W* = {w}, *χ*^{{2}}({df}) = {chi2}, {p}"));
    }
    table
}

fn sizes(result: &RmAnova) -> Table {
    let rows = [
        ("partial eta squared", result.eta2_partial, result.eta2_partial_ci90),
        ("generalised eta squared", result.eta2_generalized, result.eta2_generalized_ci90),
        ("omega squared", result.omega2_partial, result.omega2_partial_ci90),
    ];
    table("Effect sizes", rows)
        .text("", |row| row.0)
        .right("Estimate", |row| share(row.1))
        .right("90% CI", |row| interval(row.2.holding(row.1), share))
        .done()
}

fn ranks(result: &Friedman) -> Table {
    let two = match (result.f_df1, result.f_df2) {
        (Some(a), Some(b)) => Cell::text(format!("{a}, {b}")),
        _ => Cell::Missing,
    };
    let (blank, df) = (|| Cell::text(""), degrees(result.df.map(|df| df as f64)));
    let rows = [
        ("all orders of the ranks (exact)", blank(), blank(), result.p_exact),
        ("F (Iman-Davenport)", optional(result.f), two, result.f_p),
        ("chi-squared", optional(result.chi2), df, result.p),
    ];
    let ci = interval(result.kendall_w_ci90.holding(result.kendall_w), share);
    let (w, ci) = (shown(&share(result.kendall_w)), shown(&ci));
    table("Friedman", rows)
        .text("By", |row| row.0)
        .right("Statistic", |row| row.1.clone())
        .right("*df*", |row| row.2.clone())
        .right("*p*", |row| p(row.3))
        .noted(format!("Kendall's *W* = {w}, 90% CI {ci}"))
}

fn t_pairs(result: &WithinAnalysis) -> Table {
    let pairs = result.paired.iter().zip(result.pooled.values());
    table("Pairs by paired t (A minus B, Holm)", pairs)
        .text("", |((name, _), _)| *name)
        .right("Difference", |((_, t), _)| number(t.mean_diff))
        .right("95% CI", |((_, t), _)| interval(t.ci, optional))
        .right("*t*", |((_, t), _)| optional(t.t))
        .right("*p*_{Holm}", |((_, t), _)| p(t.p_holm))
        .right("*d*_{z}", |((_, t), _)| effect(t.dz))
        .right("95% CI", |((_, t), _)| interval(t.dz_ci, effect))
        .right("*g*_{z}", |((_, t), _)| effect(t.gz))
        .right("*d*_{av}", |((_, t), _)| effect(t.d_av))
        .right("pooled *p*_{Holm}", |(_, pooled)| p(pooled.p_holm))
        .done()
}

fn rank_pairs(result: &WithinAnalysis) -> Table {
    let sum = |value: Option<f64>| value.map_or(Cell::Missing, |v| Cell::text(v.to_string()));
    let others = result.conover.values().zip(result.nemenyi.values());
    table("Pairs by ranks (A minus B, Holm)", result.wilcoxon.iter().zip(others))
        .text("", |((name, _), _)| *name)
        .right("*n*", |((_, w), _)| Cell::count(w.n_used))
        .right("*V*", |((_, w), _)| sum(w.w_plus))
        .right("*W*_{−}", |((_, w), _)| sum(w.w_minus))
        .right("Wilcoxon *p*_{Holm}", |((_, w), _)| p(w.p_holm))
        .right("*r*_{rb}", |((_, w), _)| share(w.rank_biserial))
        .right("95% CI", |((_, w), _)| interval(w.rank_biserial_ci, share))
        .right("Conover *p*_{Holm}", |(_, (conover, _))| p(conover.p_holm))
        .right("Nemenyi *p*", |(_, (_, nemenyi))| p(Some(nemenyi.p)))
        .done()
}
