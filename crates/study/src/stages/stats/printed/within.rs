//! The report of `within`, `rm-anova` and `friedman`.

use super::{
    Printed,
    cells::{degrees, effect, interval, number, optional, p, share, shown, table},
    sentences,
};
use maveric_report::tables::{Cell, Table};
use maveric_stats::{
    ConditionSummary, Friedman, FriedmanAnalysis, Mauchly, Named, RmAnova, RmAnovaAnalysis,
    ShapiroWilk, Sphericity, WithinAnalysis,
};

pub(in crate::stages::stats) fn whole(found: &WithinAnalysis) -> Printed {
    let mut anova = variance(&found.rm_anova);
    anova.notes = sentences(found, &["rm_anova"]);
    let mut ranked = ranks(&found.friedman);
    ranked.notes.splice(0..0, sentences(found, &["friedman"]));
    Printed::of("Within-subject analysis", found.n, found.k, &found.dropped)
        .table(conditions(&found.desc, Some(&found.shapiro)))
        .table(anova)
        .table(corrections(
            &found.rm_anova,
            &found.mauchly,
            &found.sphericity,
        ))
        .table(sizes(&found.rm_anova))
        .table(ranked)
        .table(t_pairs(found))
        .table(rank_pairs(found))
        .undefined(&found.undefined)
}

pub(in crate::stages::stats) fn rm_anova(found: &RmAnovaAnalysis) -> Printed {
    let mut anova = variance(&found.rm_anova);
    anova.notes = sentences(found, &["rm_anova"]);
    Printed::of("Analysis of variance", found.n, found.k, &found.dropped)
        .table(conditions(&found.desc, None))
        .table(anova)
        .table(corrections(
            &found.rm_anova,
            &found.mauchly,
            &found.sphericity,
        ))
        .table(sizes(&found.rm_anova))
        .undefined(&found.undefined)
}

pub(in crate::stages::stats) fn friedman(found: &FriedmanAnalysis) -> Printed {
    let mut ranked = ranks(&found.friedman);
    ranked.notes.splice(0..0, sentences(found, &["friedman"]));
    Printed::of("Friedman's test", found.n, found.k, &found.dropped)
        .table(conditions(&found.desc, None))
        .table(ranked)
        .undefined(&found.undefined)
}

/// Means with their within-subject intervals, and the tests of normality if there are any.
pub(super) fn conditions(
    desc: &Named<ConditionSummary>,
    shapiro: Option<&Named<ShapiroWilk>>,
) -> Table {
    let normal = |name: &str| shapiro.and_then(|tests| tests.get(name));
    let rows = desc.iter().map(|(name, c)| (name, Some(c)));
    let mean = |of: fn(&ConditionSummary) -> Cell| {
        move |(_, c): &(&str, Option<&ConditionSummary>)| c.map_or_else(|| Cell::text(""), of)
    };
    let residuals = shapiro.is_some().then_some(("residuals", None));
    table("Conditions", rows.chain(residuals))
        .text("", |(name, _)| *name)
        .right("*M*", mean(|c| number(c.mean)))
        .right("*SD*", mean(|c| number(c.sd)))
        .right(
            "95% within-subject CI",
            mean(|c| interval(c.within_ci_low, c.within_ci_high, optional)),
        )
        .and_if(shapiro.is_some(), |table| {
            table
                .right("Shapiro-Wilk *W*", |(name, _)| {
                    normal(name).map_or(Cell::Missing, |test| share(test.w))
                })
                .right("*p*", |(name, _)| {
                    normal(name).map_or(Cell::Missing, |test| p(test.p))
                })
        })
        .done()
}

fn variance(found: &RmAnova) -> Table {
    let (d1, d2) = (found.df1 as f64, found.df2 as f64);
    let blank = || Cell::text("");
    let rows = [
        ("conditions", found.ss_condition, d1, true),
        ("subjects", found.ss_subject, d2 / d1, false),
        ("error", found.ss_error, d2, false),
    ];
    table("Analysis of variance", rows)
        .text("Source", |row| row.0)
        .right("*SS*", |row| number(row.1))
        .right("*df*", |row| degrees(Some(row.2)))
        .right("*MS*", |row| number(row.1 / row.2))
        .right("*F*", |row| if row.3 { optional(found.f) } else { blank() })
        .right("*p*", |row| if row.3 { p(found.p) } else { blank() })
        .done()
}

fn corrections(found: &RmAnova, mauchly: &Mauchly, sphericity: &Sphericity) -> Table {
    let (d1, d2) = (found.df1 as f64, found.df2 as f64);
    let rows = [
        ("1 (sphericity)", Some(1.0), found.p),
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
        table
            .notes
            .push(format!("Mauchly: *W* = {w}, *χ*^{{2}}({df}) = {chi2}, {p}"));
    }
    table
}

fn sizes(found: &RmAnova) -> Table {
    let rows = [
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
    ];
    table("Effect sizes", rows)
        .text("", |row| row.0)
        .right("Estimate", |row| share(row.1))
        .right("90% CI", |row| interval(row.2, row.3, share))
        .done()
}

fn ranks(found: &Friedman) -> Table {
    let two = match (found.f_df1, found.f_df2) {
        (Some(a), Some(b)) => Cell::text(format!("{a}, {b}")),
        _ => Cell::Missing,
    };
    let (blank, df) = (|| Cell::text(""), degrees(found.df.map(|df| df as f64)));
    let rows = [
        (
            "all orders of the ranks (exact)",
            blank(),
            blank(),
            found.p_exact,
        ),
        ("F (Iman-Davenport)", optional(found.f), two, found.f_p),
        ("chi-squared", optional(found.chi2), df, found.p),
    ];
    let ci = interval(found.kendall_w_ci90_low, found.kendall_w_ci90_high, share);
    let (w, ci) = (shown(&share(found.kendall_w)), shown(&ci));
    table("Friedman", rows)
        .text("By", |row| row.0)
        .right("Statistic", |row| row.1.clone())
        .right("*df*", |row| row.2.clone())
        .right("*p*", |row| p(row.3))
        .noted(format!("Kendall's *W* = {w}, 90% CI {ci}"))
}

fn t_pairs(found: &WithinAnalysis) -> Table {
    let pairs = found.paired.iter().zip(found.pooled.values());
    table("Pairs by paired t (A minus B, Holm)", pairs)
        .text("", |((name, _), _)| *name)
        .right("Difference", |((_, t), _)| number(t.mean_diff))
        .right("95% CI", |((_, t), _)| {
            interval(t.ci_low, t.ci_high, optional)
        })
        .right("*t*", |((_, t), _)| optional(t.t))
        .right("*p*_{Holm}", |((_, t), _)| p(t.p_holm))
        .right("*d*_{z}", |((_, t), _)| effect(t.dz))
        .right("95% CI", |((_, t), _)| {
            interval(t.dz_ci_low, t.dz_ci_high, effect)
        })
        .right("*g*_{z}", |((_, t), _)| effect(t.gz))
        .right("*d*_{av}", |((_, t), _)| effect(t.d_av))
        .right("pooled *p*_{Holm}", |(_, pooled)| p(pooled.p_holm))
        .done()
}

fn rank_pairs(found: &WithinAnalysis) -> Table {
    let sum = |value: Option<f64>| value.map_or(Cell::Missing, |v| Cell::text(v.to_string()));
    let others = found.conover.values().zip(found.nemenyi.values());
    table(
        "Pairs by ranks (A minus B, Holm)",
        found.wilcoxon.iter().zip(others),
    )
    .text("", |((name, _), _)| *name)
    .right("*n*", |((_, w), _)| Cell::count(w.n_used))
    .right("*W*_{+}", |((_, w), _)| sum(w.w_plus))
    .right("*W*_{−}", |((_, w), _)| sum(w.w_minus))
    .right("Wilcoxon *p*_{Holm}", |((_, w), _)| p(w.p_holm))
    .right("*r*_{rb}", |((_, w), _)| share(w.rank_biserial))
    .right("95% CI", |((_, w), _)| {
        interval(w.rank_biserial_ci_low, w.rank_biserial_ci_high, share)
    })
    .right("Conover *p*_{Holm}", |(_, (conover, _))| p(conover.p_holm))
    .right("Nemenyi *p*", |(_, (_, nemenyi))| p(Some(nemenyi.p)))
    .done()
}
