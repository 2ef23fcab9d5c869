//! Why a test was chosen: the reasons, and the checks behind them.

use super::cells::{p, share, table};
use maveric_report::{
    markup,
    tables::{Cell, Table},
};
use maveric_stats::AssumptionCheck;

/// The reasons, numbered, with marks.
pub(super) fn why(reasons: &[String]) -> Vec<String> {
    let numbered = reasons.iter().enumerate();
    numbered
        .map(|(i, reason)| markup::literal(&format!("{}. {reason}", i + 1)))
        .collect()
}

/// The assumptions that were looked at.
pub(super) fn checks(all: &[AssumptionCheck]) -> Table {
    let mut table = table("Checks", &["Assumption", "*W*", "*p*", "Stands"]);
    for check in all {
        let stands = check.passed.map_or(Cell::Missing, |passed| {
            Cell::text(if passed { "yes" } else { "no" })
        });
        table.rows.push(vec![
            Cell::text(&check.name),
            share(check.statistic),
            p(check.p),
            stands,
        ]);
    }
    table
}
