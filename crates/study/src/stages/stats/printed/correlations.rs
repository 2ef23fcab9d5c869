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
    let rows = if missing == 1 { "row" } else { "rows" };
    Printed::headed(format!("{what}: {n} complete pairs{more}"), n, &[]).left_out(missing, rows)
}

fn sentences(result: &impl Statements) -> Vec<String> {
    let statements = result.statements().into_iter();
    statements.map(|(_, sentence)| sentence.markup().to_owned()).collect()
}

pub(in crate::stages::stats) fn correlation(result: &Correlation, x: &str, y: &str) -> Printed {
    let pearson = result.pearson.as_ref().map(|r| {
        let by = how(r.p.map(|_| PMethod::T));
        ("Pearson r", r.r, r.ci, r.p, by)
    });
    let spearman = result
        .spearman
        .as_ref()
        .map(|rho| ("Spearman rho", rho.rho, rho.ci_bw, rho.p, how(rho.p_method)));
    let kendall = result
        .kendall
        .as_ref()
        .map(|tau| ("Kendall tau-b", tau.tau_b, tau.ci, tau.p, how(tau.p_method)));
    let rows = [pearson, spearman, kendall].into_iter().flatten();
    let mut table = table("Coefficients", rows)
        .text("", |row| row.0)
        .right("Coefficient", |row| share(row.1))
        .right("95% CI", |row| interval(row.2, share))
        .right("*p*", |row| p(row.3))
        .right("By", |row| row.4.clone())
        .done();
    table.notes = sentences(result);
    let reasons = result.reasons.iter().map(|reason| markup::literal(reason));
    who(&format!("Correlation of {x} and {y}"), result.n, result.missing, "")
        .table(table)
        .lines("Why this coefficient", reasons.collect())
        .undefined(&result.undefined)
}

pub(in crate::stages::stats) fn rm_correlation(
    result: &RmCorrelationAnalysis,
    x: &str,
    y: &str,
) -> Printed {
    let more = format!(" of {} subjects", result.subjects);
    let what = format!("Correlation of {x} and {y} within subjects");
    let r = &result.rm_corr;
    let mut lines = sentences(result);
    let ci = interval(r.ci, share);
    lines.push(format!("95% CI {}", shown(&ci)));
    if let Some(slope) = r.slope {
        let (slope, x, y) = (shown(&number(slope)), markup::literal(x), markup::literal(y));
        lines.push(format!("common slope of {y} on {x}: {slope}"));
    }
    who(&what, result.n, result.missing, &more)
        .lines("Within subjects", lines)
        .undefined(&result.undefined)
}
