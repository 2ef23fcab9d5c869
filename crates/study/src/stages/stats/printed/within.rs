//! The report of `within`, `rm-anova` and `friedman`.

use super::{
    Printed,
    cells::{degrees, effect, interval, number, optional, p, share, table},
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
    let header = [
        "",
        "*M*",
        "*SD*",
        "95% within-subject CI",
        "Shapiro-Wilk *W*",
        "*p*",
    ];
    let mut table = table(
        "Conditions",
        &header[..if shapiro.is_some() { 6 } else { 4 }],
    );
    let normal = |name: &str| {
        let test = shapiro.and_then(|tests| tests.get(name));
        test.map_or_else(Vec::new, |test| vec![share(test.w), p(test.p)])
    };
    for (name, c) in desc.iter() {
        let ci = interval(c.within_ci_low, c.within_ci_high, optional);
        let mut row = vec![Cell::text(name), number(c.mean), number(c.sd), ci];
        row.extend(normal(name));
        table.rows.push(row);
    }
    if shapiro.is_some() {
        let mut row = vec![
            Cell::text("residuals"),
            Cell::text(""),
            Cell::text(""),
            Cell::text(""),
        ];
        row.extend(normal("residuals"));
        table.rows.push(row);
    }
    table
}

fn variance(found: &RmAnova) -> Table {
    let mut table = table(
        "Analysis of variance",
        &["Source", "*SS*", "*df*", "*MS*", "*F*", "*p*"],
    );
    let (d1, d2) = (found.df1 as f64, found.df2 as f64);
    for (name, sum, df, f, p_value) in [
        (
            "conditions",
            found.ss_condition,
            d1,
            optional(found.f),
            p(found.p),
        ),
        (
            "subjects",
            found.ss_subject,
            d2 / d1,
            Cell::text(""),
            Cell::text(""),
        ),
        ("error", found.ss_error, d2, Cell::text(""), Cell::text("")),
    ] {
        let mean_square = number(sum / df);
        table.rows.push(vec![
            Cell::text(name),
            number(sum),
            degrees(Some(df)),
            mean_square,
            f,
            p_value,
        ]);
    }
    table
}

fn corrections(found: &RmAnova, mauchly: &Mauchly, sphericity: &Sphericity) -> Table {
    let header = [
        "Degrees of freedom times",
        "*ε*",
        "*df*_{1}",
        "*df*_{2}",
        "*p*",
    ];
    let mut table = table("Sphericity", &header);
    let (d1, d2) = (found.df1 as f64, found.df2 as f64);
    let lower = Some(sphericity.lower_bound);
    for (name, epsilon, value) in [
        ("1 (sphericity)", Some(1.0), found.p),
        ("Greenhouse-Geisser", sphericity.gg, sphericity.p_gg),
        ("Huynh-Feldt", sphericity.hf, sphericity.p_hf),
        ("lower bound", lower, sphericity.p_lb),
    ] {
        let times = |df: f64| degrees(epsilon.map(|e| e * df));
        table.rows.push(vec![
            Cell::text(name),
            share(epsilon),
            times(d1),
            times(d2),
            p(value),
        ]);
    }
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
    let mut table = table("Effect sizes", &["", "Estimate", "90% CI"]);
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
        table.rows.push(vec![
            Cell::text(name),
            share(value),
            interval(low, high, share),
        ]);
    }
    table
}

fn ranks(found: &Friedman) -> Table {
    let mut table = table("Friedman", &["By", "Statistic", "*df*", "*p*"]);
    let two = match (found.f_df1, found.f_df2) {
        (Some(a), Some(b)) => Cell::text(format!("{a}, {b}")),
        _ => Cell::Missing,
    };
    let exact = "all orders of the ranks (exact)";
    table.rows = vec![
        vec![
            Cell::text(exact),
            Cell::text(""),
            Cell::text(""),
            p(found.p_exact),
        ],
        vec![
            Cell::text("F (Iman-Davenport)"),
            optional(found.f),
            two,
            p(found.f_p),
        ],
        vec![
            Cell::text("chi-squared"),
            optional(found.chi2),
            degrees(found.df.map(|df| df as f64)),
            p(found.p),
        ],
    ];
    let ci = interval(found.kendall_w_ci90_low, found.kendall_w_ci90_high, share);
    let (w, ci) = (
        super::cells::shown(&share(found.kendall_w)),
        super::cells::shown(&ci),
    );
    table
        .notes
        .push(format!("Kendall's *W* = {w}, 90% CI {ci}"));
    table
}

fn t_pairs(found: &WithinAnalysis) -> Table {
    let header = [
        "",
        "Difference",
        "95% CI",
        "*t*",
        "*p*_{Holm}",
        "*d*_{z}",
        "95% CI",
        "*g*_{z}",
        "*d*_{av}",
        "pooled *p*_{Holm}",
    ];
    let mut table = table("Pairs by paired t (A minus B, Holm)", &header);
    for ((name, t), pooled) in found.paired.iter().zip(found.pooled.values()) {
        table.rows.push(vec![
            Cell::text(name),
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
    table
}

fn rank_pairs(found: &WithinAnalysis) -> Table {
    let header = [
        "",
        "*n*",
        "*W*_{+}",
        "*W*_{−}",
        "Wilcoxon *p*_{Holm}",
        "*r*_{rb}",
        "95% CI",
        "Conover *p*_{Holm}",
        "Nemenyi *p*",
    ];
    let mut table = table("Pairs by ranks (A minus B, Holm)", &header);
    let tests = found.wilcoxon.iter().zip(found.conover.values());
    for (((name, w), conover), nemenyi) in tests.zip(found.nemenyi.values()) {
        let sum = |value: Option<f64>| value.map_or(Cell::Missing, |v| Cell::text(v.to_string()));
        table.rows.push(vec![
            Cell::text(name),
            Cell::count(w.n_used),
            sum(w.w_plus),
            sum(w.w_minus),
            p(w.p_holm),
            share(w.rank_biserial),
            interval(w.rank_biserial_ci_low, w.rank_biserial_ci_high, share),
            p(conover.p_holm),
            p(Some(nemenyi.p)),
        ]);
    }
    table
}
