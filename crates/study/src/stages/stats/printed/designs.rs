//! The report of factors, groups, bounds and models.

use super::{
    Printed,
    cells::{degrees, effect, interval, number, optional, p, share, table},
};
use maveric_report::{
    markup,
    tables::{Cell, Table},
};
use maveric_stats::{
    AlignedRanks, AssumptionCheck, ByDesign, CellContrast, Equivalence, Factorial, FixedEffect,
    GroupsAnalysis, MarginalMean, Named, Ordinal, OrdinalParameter, RandomIntercept,
    apa::Statements,
};

fn sentences(found: &impl Statements) -> Vec<String> {
    let all = found.statements().into_iter();
    all.map(|(name, said)| format!("{}: {}", markup::literal(&name), said.markup()))
        .collect()
}

fn headed(lines: Vec<String>) -> Printed {
    Printed {
        heading: lines,
        tables: Vec::new(),
    }
}

fn left_out(dropped: &[String]) -> Option<String> {
    (!dropped.is_empty()).then(|| {
        format!(
            "left out for a missing cell: {} ({})",
            dropped.len(),
            dropped.join(", ")
        )
    })
}

pub(in crate::stages::stats) fn factorial(found: &Factorial) -> Printed {
    let factors = found
        .levels
        .iter()
        .map(|(name, levels)| format!("{name} ({})", levels.join(", ")));
    let who = format!(
        "Factorial analysis: {} subjects; {}",
        found.n,
        factors.collect::<Vec<_>>().join("; ")
    );
    let mut effects = effects(found);
    effects.notes = sentences(found);
    let mut printed = headed(
        [Some(who), left_out(&found.dropped)]
            .into_iter()
            .flatten()
            .collect(),
    )
    .table(effects);
    for (name, means) in found.emm.iter() {
        printed = printed.table(marginal(name, means));
    }
    for (name, pairs) in found.contrast.iter() {
        printed = printed.table(contrasts(
            &format!("Pairs of {name} (A minus B, Holm)"),
            pairs,
        ));
    }
    let mut simple = table(
        "Simple effects",
        &["Effect", "*F*", "*df*_{1}", "*df*_{2}", "*p*"],
    );
    let mut pairs = Vec::new();
    for (interaction, all) in found.simple.iter() {
        for (name, test) in all.iter() {
            let whole = format!("{interaction}: {name}");
            let df = [test.df1, test.df2].map(|df| degrees(Some(df as f64)));
            let [df1, df2] = df;
            simple.rows.push(vec![
                Cell::text(&whole),
                optional(test.f),
                df1,
                df2,
                p(test.p),
            ]);
            if test.pairs.len() > 1 {
                pairs.push(contrasts(
                    &format!("Pairs of {whole} (A minus B, Holm)"),
                    &test.pairs,
                ));
            }
        }
    }
    printed = printed.table(simple);
    for table in pairs {
        printed = printed.table(table);
    }
    printed.undefined(&found.undefined)
}

fn effects(found: &Factorial) -> Table {
    let header = [
        "Effect",
        "*F*",
        "*df*_{1}",
        "*df*_{2}",
        "*p*",
        "*ε*_{GG}",
        "*p*_{GG}",
        "*η*_{p}^{2}",
        "90% CI",
        "*η*_{G}^{2}",
    ];
    let mut table = table("Effects", &header);
    for (name, e) in found.anova.iter() {
        let sphericity = found.sphericity.get(name);
        table.rows.push(vec![
            Cell::text(name),
            optional(e.f),
            degrees(Some(e.df1 as f64)),
            degrees(Some(e.df2 as f64)),
            p(e.p),
            sphericity.map_or_else(|| Cell::text(""), |s| share(s.gg)),
            sphericity.map_or_else(|| Cell::text(""), |s| p(s.p_gg)),
            share(e.eta2_partial),
            interval(e.eta2_partial_ci90_low, e.eta2_partial_ci90_high, share),
            share(e.eta2_generalized),
        ]);
    }
    table
}

fn marginal(name: &str, means: &Named<MarginalMean>) -> Table {
    let mut table = table(&format!("Means of {name}"), &["", "*M*", "*SE*", "95% CI"]);
    for (cell, m) in means.iter() {
        let ci = interval(m.ci_low, m.ci_high, optional);
        table
            .rows
            .push(vec![Cell::text(cell), number(m.mean), number(m.se), ci]);
    }
    table
}

fn contrasts(title: &str, pairs: &Named<CellContrast>) -> Table {
    let header = ["", "Difference", "95% CI", "*t*", "*p*", "*p*_{Holm}"];
    let mut table = table(title, &header);
    for (name, c) in pairs.iter() {
        let ci = interval(c.ci_low, c.ci_high, optional);
        table.rows.push(vec![
            Cell::text(name),
            number(c.estimate),
            ci,
            optional(c.t),
            p(c.p),
            p(c.p_holm),
        ]);
    }
    table
}

pub(in crate::stages::stats) fn ranks(found: &AlignedRanks) -> Printed {
    let mut table = table(
        "Effects on aligned ranks",
        &["Effect", "*F*", "*df*_{1}", "*df*_{2}", "*p*"],
    );
    for (name, e) in found.art.iter() {
        let [df1, df2] = [e.df1, e.df2].map(|df| degrees(Some(df as f64)));
        table
            .rows
            .push(vec![Cell::text(name), optional(e.f), df1, df2, p(e.p)]);
    }
    table.notes = sentences(found);
    let who = format!("Aligned ranks: {} subjects", found.n);
    headed(
        [Some(who), left_out(&found.dropped)]
            .into_iter()
            .flatten()
            .collect(),
    )
    .table(table)
    .undefined(&found.undefined)
}

pub(in crate::stages::stats) fn groups(found: &GroupsAnalysis) -> Printed {
    let mut who = vec![format!(
        "Independent groups: {} values, {} groups",
        found.n, found.k
    )];
    if found.missing > 0 {
        who.push(format!("left out for a missing value: {}", found.missing));
    }
    let mut desc = table("Groups", &["", "*n*", "*M*", "*SD*"]);
    for (name, g) in found.desc.iter() {
        desc.rows.push(vec![
            Cell::text(name),
            Cell::count(g.n),
            number(g.mean),
            optional(g.sd),
        ]);
    }
    desc.notes = sentences(found);
    let header = [
        "",
        "Difference",
        "95% CI",
        "*t*",
        "*df*",
        "*p*",
        "*g*",
        "95% CI",
        "*U*",
        "*p*",
        "*r*_{rb}",
    ];
    let mut pairs = table(
        "Pairs by Welch's t and Mann-Whitney (A minus B; not adjusted)",
        &header,
    );
    let tests = found
        .welch_t
        .iter()
        .zip(found.hedges.values())
        .zip(found.mann_whitney.values());
    for (((name, t), size), u) in tests {
        pairs.rows.push(vec![
            Cell::text(name),
            number(t.mean_diff),
            interval(t.ci_low, t.ci_high, optional),
            optional(t.t),
            degrees(t.df),
            p(t.p),
            effect(size.g),
            interval(size.g_ci_low, size.g_ci_high, effect),
            number(u.u),
            p(u.p),
            share(Some(u.rank_biserial)),
        ]);
    }
    let mut printed = headed(who).table(desc).table(pairs);
    if let Some(several) = &found.several {
        let header = [
            "",
            "*t* (Games-Howell)",
            "*df*",
            "*p*",
            "95% CI",
            "*z* (Dunn)",
            "*p*_{Holm}",
        ];
        let mut all = table("Pairs of all groups (A minus B)", &header);
        for ((name, t), z) in several.games_howell.iter().zip(several.dunn.values()) {
            let ci = interval(t.ci_low, t.ci_high, optional);
            let row = vec![
                Cell::text(name),
                optional(t.t),
                degrees(t.df),
                p(t.p),
                ci,
                optional(z.z),
                p(z.p_holm),
            ];
            all.rows.push(row);
        }
        printed = printed.table(all);
    }
    printed.undefined(&found.undefined)
}

pub(in crate::stages::stats) fn equivalence(found: &Equivalence) -> Printed {
    let header = [
        "",
        "Difference",
        "90% CI",
        "Bounds",
        "*p* (two one-sided)",
        "*p*_{Holm}",
        "Equivalent",
        "*p* (difference)",
    ];
    let mut table = table("Equivalence", &header);
    for (name, t) in found.tost.iter() {
        let word = |yes: Option<bool>| {
            yes.map_or(Cell::Missing, |yes| {
                Cell::text(if yes { "yes" } else { "not shown" })
            })
        };
        table.rows.push(vec![
            Cell::text(name),
            number(t.estimate),
            interval(t.ci90_low, t.ci90_high, optional),
            interval(t.low, t.high, optional),
            p(t.p),
            p(t.p_holm),
            word(t.equivalent),
            p(t.p_difference),
        ]);
    }
    table.notes = sentences(found);
    headed(vec![format!(
        "Equivalence by two one-sided tests: {} subjects",
        found.n
    )])
    .table(table)
    .undefined(&found.undefined)
}

pub(in crate::stages::stats) fn mixed(found: &RandomIntercept) -> Printed {
    let who = format!(
        "Mixed model, random intercept: {} = {} rows of {} subjects; {} rows without a value",
        markup::plain(&markup::literal(&found.formula)),
        found.n_obs,
        found.n_subjects,
        found.missing
    );
    let mut terms = table(
        "Terms (type III, Satterthwaite)",
        &["Term", "*F*", "*df*_{1}", "*df*_{2}", "*p*"],
    );
    for (name, t) in found.anova.iter() {
        terms.rows.push(vec![
            Cell::text(name),
            number(t.f),
            degrees(Some(t.df1 as f64)),
            degrees(t.df2),
            p(t.p),
        ]);
    }
    terms.notes = sentences(found);
    let header = ["", "Estimate", "*SE*", "95% CI", "*df*", "*t*", "*p*"];
    let mut coefficients = table(
        "Coefficients (the first level of a factor is the reference)",
        &header,
    );
    for (name, c) in found.coef.iter() {
        coefficients.rows.push(coefficient(name, c));
    }
    coefficients.notes.push(format!(
        "variance of the subjects {}, residual {}; ICC = {}",
        maveric_stats::apa::number(found.variance.subject, 3),
        maveric_stats::apa::number(found.variance.residual, 3),
        maveric_stats::apa::bounded(found.icc, 2)
    ));
    let mut printed = headed(vec![who]).table(terms).table(coefficients);
    for (name, means) in found.emm.iter() {
        printed = printed.table(marginal(name, means));
    }
    printed.undefined(&found.undefined)
}

fn coefficient(name: &str, c: &FixedEffect) -> Vec<Cell> {
    vec![
        Cell::text(name),
        number(c.estimate),
        optional(c.se),
        interval(c.ci_low, c.ci_high, optional),
        degrees(c.df),
        optional(c.t),
        p(c.p),
    ]
}

pub(in crate::stages::stats) fn ordinal(found: &Ordinal) -> Printed {
    let mut who = vec![format!(
        "Ordered answers, cumulative logit with a random intercept: {} answers of {} subjects, {} categories",
        found.n_obs,
        found.n_subjects,
        found.answers.len()
    )];
    if found.missing > 0 {
        who.push(format!(
            "left out for a missing answer: {} rows",
            found.missing
        ));
    }
    let rows = |title: &str, all: &Named<OrdinalParameter>| {
        let mut table = table(title, &["", "Estimate", "*SE*", "95% CI", "*z*", "*p*"]);
        for (name, o) in all.iter() {
            let ci = interval(o.ci_low, o.ci_high, optional);
            table.rows.push(vec![
                Cell::text(name),
                optional(o.estimate),
                optional(o.se),
                ci,
                optional(o.z),
                p(o.p),
            ]);
        }
        table
    };
    let reference = found.conditions.first().map_or("", String::as_str);
    let mut coefficients = rows(
        &format!("Conditions against {reference} (log odds of a higher answer)"),
        &found.quadrature.coef,
    );
    coefficients.notes = sentences(found);
    let mut thresholds = rows("Thresholds between answers", &found.quadrature.threshold);
    if let Some(variance) = found.quadrature.variance.subject {
        let variance = maveric_stats::apa::number(variance, 3);
        thresholds
            .notes
            .push(format!("variance of the subjects {variance}"));
    }
    headed(who)
        .table(coefficients)
        .table(thresholds)
        .undefined(&found.undefined)
}

/// What was chosen by the design, why, and the report of that test.
pub(in crate::stages::stats) fn by_design(found: &ByDesign) -> Printed {
    let (checks, mut inner): (&[AssumptionCheck], Printed) = match found {
        ByDesign::OneFactor(found) => return super::comparison(found),
        ByDesign::Factorial(found) => {
            let mut printed = factorial(&found.found.anova);
            if let Some(aligned) = &found.found.ranks {
                // The effects that count first.
                printed.tables.splice(0..0, ranks(aligned).tables);
            }
            (&found.checks, printed)
        }
        ByDesign::Groups(found) => (&found.checks, groups(&found.found)),
        ByDesign::Mixed(found) => (&found.checks, mixed(&found.found)),
        ByDesign::Ordinal(found) => {
            let printed = ordinal(&found.found.model);
            let beside = found.found.beside.as_ref().map(|beside| {
                let f = &beside.friedman;
                let mut table = table(
                    "Rank test of the complete subjects, as a check",
                    &["", "*p*"],
                );
                table
                    .rows
                    .push(vec![Cell::text("Friedman"), p(f.p_exact.or(f.f_p).or(f.p))]);
                for (name, w) in beside.wilcoxon.iter() {
                    table.rows.push(vec![
                        Cell::text(format!("Wilcoxon {name}, Holm")),
                        p(w.p_holm),
                    ]);
                }
                table
            });
            let printed = match beside {
                Some(beside) => printed.table(beside),
                None => printed,
            };
            (&found.checks, printed)
        }
        _ => return Printed::default(),
    };
    let reasons = found.reasons().iter().enumerate();
    let reasons = reasons.map(|(i, reason)| markup::literal(&format!("{}. {reason}", i + 1)));
    let mut first = Printed::default()
        .lines("Why this test", reasons.collect())
        .table(super::pairs::checks(checks));
    first.heading = std::mem::take(&mut inner.heading);
    first.tables.append(&mut inner.tables);
    first
}
