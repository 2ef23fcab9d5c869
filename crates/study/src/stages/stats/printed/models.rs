//! The report of mixed models and of ordered answers.

use super::{
    Printed,
    cells::{degrees, interval, number, optional, p, table},
    factors::marginal,
    named_sentences,
};
use maveric_report::tables::{Cell, Table};
use maveric_stats::{
    FixedEffect, MarginalContrast, Named, Ordinal, OrdinalParameter, RandomIntercept, apa,
};

pub(in crate::stages::stats) fn mixed(found: &RandomIntercept) -> Printed {
    let who = format!(
        "Mixed model, random intercept of the subject, fixed {}: {} rows of {} subjects",
        found.formula, found.n_obs, found.n_subjects,
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
    terms.notes = named_sentences(found);
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
        apa::number(found.variance.subject, 3),
        apa::number(found.variance.residual, 3),
        apa::bounded(found.icc, 2)
    ));
    let mut printed = Printed::headed(who, 0, &[])
        .left_out(found.missing, "rows")
        .table(terms)
        .table(coefficients);
    for ((name, means), pairs) in found.emm.iter().zip(found.contrast.values()) {
        printed = printed
            .table(marginal(name, means))
            .table(contrasts(name, pairs));
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

fn contrasts(term: &str, pairs: &Named<MarginalContrast>) -> Table {
    let title = format!("Pairs of {term} (A minus B, Holm)");
    let header = [
        "",
        "Difference",
        "95% CI",
        "*t*",
        "*df*",
        "*p*",
        "*p*_{Holm}",
    ];
    let mut table = table(&title, &header);
    for (name, c) in pairs.iter() {
        table.rows.push(vec![
            Cell::text(name),
            number(c.estimate),
            interval(c.ci_low, c.ci_high, optional),
            number(c.t),
            degrees(c.df),
            p(c.p),
            p(c.p_holm),
        ]);
    }
    table
}

pub(in crate::stages::stats) fn ordinal(found: &Ordinal) -> Printed {
    let who = format!(
        "Ordered answers, cumulative logit with a random intercept: {} answers of {} subjects, {} categories",
        found.n_obs,
        found.n_subjects,
        found.answers.len()
    );
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
    coefficients.notes = named_sentences(found);
    let mut thresholds = rows("Thresholds between answers", &found.quadrature.threshold);
    if let Some(variance) = found.quadrature.variance.subject {
        let variance = apa::number(variance, 3);
        thresholds
            .notes
            .push(format!("variance of the subjects {variance}"));
    }
    Printed::headed(who, 0, &[])
        .left_out(found.missing, "rows")
        .table(coefficients)
        .table(thresholds)
        .undefined(&found.undefined)
}
