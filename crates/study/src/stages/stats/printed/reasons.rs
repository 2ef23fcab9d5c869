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
    numbered.map(|(i, reason)| markup::literal(&format!("{}. {reason}", i + 1))).collect()
}

/// The assumptions that were looked at.
pub(super) fn checks(assumptions: &[AssumptionCheck]) -> Table {
    table("Checks", assumptions)
        .text("Assumption", |check| &check.name)
        .right("*W*", |check| share(check.statistic))
        .right("*p*", |check| p(check.p))
        .right("Stands", |check| Cell::word(check.passed, "yes", "no"))
        .done()
}
