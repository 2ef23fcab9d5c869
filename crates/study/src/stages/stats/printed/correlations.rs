//! The report of `correlate` and `rmcorr`.

use super::{
    Printed,
    cells::{interval, number, p, share, shown, table},
};
use maveric_report::{markup, tables::Cell};
use maveric_stats::{Correlation, PMethod, RmCorrelationAnalysis, apa::Statements};

fn how(method: Option<PMethod>) -> Cell {
    Cell::text(match method {
        Some(PMethod::Exact) => "exact",
        Some(PMethod::T) => "t",
        Some(_) => "normal",
        None => "",
    })
}

fn who(what: &str, n: usize, missing: usize, more: &str) -> Printed {
    let mut heading = vec![format!("{what}: {n} complete pairs{more}")];
    if missing > 0 {
        let rows = if missing == 1 { "row" } else { "rows" };
        heading.push(format!("left out for a missing value: {missing} {rows}"));
    }
    Printed {
        heading,
        ..Printed::default()
    }
}

fn sentences(found: &impl Statements) -> Vec<String> {
    let all = found.statements().into_iter();
    all.map(|(_, said)| said.markup().to_owned()).collect()
}

pub(in crate::stages::stats) fn correlation(found: &Correlation, x: &str, y: &str) -> Printed {
    let mut table = table("Coefficients", &["", "Coefficient", "95% CI", "*p*", "By"]);
    if let Some(r) = &found.pearson {
        let ci = interval(r.ci_low, r.ci_high, share);
        let by = how(r.p.map(|_| PMethod::T));
        table
            .rows
            .push(vec![Cell::text("Pearson r"), share(r.r), ci, p(r.p), by]);
    }
    if let Some(rho) = &found.spearman {
        let ci = interval(rho.ci_bw_low, rho.ci_bw_high, share);
        let name = Cell::text("Spearman rho");
        table
            .rows
            .push(vec![name, share(rho.rho), ci, p(rho.p), how(rho.p_method)]);
    }
    if let Some(tau) = &found.kendall {
        let ci = interval(tau.ci_low, tau.ci_high, share);
        let name = Cell::text("Kendall tau-b");
        table.rows.push(vec![
            name,
            share(tau.tau_b),
            ci,
            p(tau.p),
            how(tau.p_method),
        ]);
    }
    table.notes = sentences(found);
    let reasons = found.reasons.iter().map(|reason| markup::literal(reason));
    who(
        &format!("Correlation of {x} and {y}"),
        found.n,
        found.missing,
        "",
    )
    .table(table)
    .lines("Why this coefficient", reasons.collect())
    .undefined(&found.undefined)
}

pub(in crate::stages::stats) fn rm_correlation(
    found: &RmCorrelationAnalysis,
    x: &str,
    y: &str,
) -> Printed {
    let more = format!(" of {} subjects", found.subjects);
    let what = format!("Correlation of {x} and {y} within subjects");
    let r = &found.rm_corr;
    let mut lines = sentences(found);
    let ci = interval(r.ci_low, r.ci_high, share);
    lines.push(format!("95% CI {}", shown(&ci)));
    if let Some(slope) = r.slope {
        let (slope, x, y) = (
            shown(&number(slope)),
            markup::literal(x),
            markup::literal(y),
        );
        lines.push(format!("common slope of {y} on {x}: {slope}"));
    }
    who(&what, found.n, found.missing, &more)
        .lines("Within subjects", lines)
        .undefined(&found.undefined)
}
