//! The report of `correlate` and `rmcorr`.

use super::{
    section,
    table::{Columns, interval, number, p, share},
    undefined,
};
use maveric_stats::{Correlation, PMethod, RmCorrelationAnalysis};
use serde_json::{Map, Value};

fn how(method: Option<PMethod>) -> String {
    match method {
        Some(PMethod::Exact) => "exact",
        Some(PMethod::T) => "t",
        Some(_) => "normal",
        None => "",
    }
    .to_owned()
}

fn said(apa: &Map<String, Value>) -> Vec<String> {
    let texts = apa.values().filter_map(Value::as_str);
    texts.map(|text| format!("  {text}")).collect()
}

fn who(what: &str, n: usize, missing: usize, more: &str) -> Vec<String> {
    let mut lines = vec![format!("{what}: {n} complete pairs{more}")];
    if missing > 0 {
        let rows = if missing == 1 { "row" } else { "rows" };
        lines.push(format!("left out for a missing value: {missing} {rows}"));
    }
    lines
}

pub(in crate::stages::stats) fn correlation(
    found: &Correlation,
    x: &str,
    y: &str,
    apa: &Map<String, Value>,
) -> Vec<String> {
    let mut lines = who(
        &format!("Correlation of {x} and {y}"),
        found.n,
        found.missing,
        "",
    );
    lines.extend(said(apa));
    let mut table = Columns::new(&["", "coefficient", "95% CI", "p", "by"]);
    if let Some(r) = &found.pearson {
        let ci = interval(r.ci_low, r.ci_high, share);
        let by = how(r.p.map(|_| PMethod::T));
        table.row(["Pearson r".to_owned(), share(r.r), ci, p(r.p), by]);
    }
    if let Some(rho) = &found.spearman {
        let ci = interval(rho.ci_bw_low, rho.ci_bw_high, share);
        table.row([
            "Spearman rho".to_owned(),
            share(rho.rho),
            ci,
            p(rho.p),
            how(rho.p_method),
        ]);
    }
    if let Some(tau) = &found.kendall {
        let ci = interval(tau.ci_low, tau.ci_high, share);
        table.row([
            "Kendall tau-b".to_owned(),
            share(tau.tau_b),
            ci,
            p(tau.p),
            how(tau.p_method),
        ]);
    }
    section(&mut lines, "Coefficients", table.lines());
    let reasons = found.reasons.iter().map(|reason| format!("  {reason}"));
    section(&mut lines, "Why this coefficient", reasons.collect());
    undefined(&mut lines, &found.undefined);
    lines
}

pub(in crate::stages::stats) fn rm_correlation(
    found: &RmCorrelationAnalysis,
    x: &str,
    y: &str,
    apa: &Map<String, Value>,
) -> Vec<String> {
    let more = format!(" of {} subjects", found.subjects);
    let what = format!("Correlation of {x} and {y} within subjects");
    let mut lines = who(&what, found.n, found.missing, &more);
    lines.extend(said(apa));
    let r = &found.rm_corr;
    let ci = interval(r.ci_low, r.ci_high, share);
    lines.push(format!("  95% CI {ci}"));
    if let Some(slope) = r.slope {
        lines.push(format!("  common slope of {y} on {x}: {}", number(slope)));
    }
    undefined(&mut lines, &found.undefined);
    lines
}
