//! What a reader should take away, a line each.

use super::{Line, Run, conditions::omnibus, percent, said};
use maveric_domain::ConditionId;
use maveric_report::claims::{LedgerRow, verdict_counts};

/// The findings in the order of the questions.
pub(super) fn summary(run: &Run, ledger: &[LedgerRow]) -> Vec<String> {
    let a = &run.analysis;
    let along = |line: &Line, measure: &str| {
        let row = line.rows.iter().find(|r| r.measure == measure);
        row.map_or_else(|| "not computed".to_owned(), |r| said(&r.correlation))
    };
    let accuracy: Vec<String> = a
        .accuracy
        .iter()
        .map(|r| format!("{} {}", r.title.to_lowercase(), percent(r.mean)))
        .collect();
    let mut lines = vec![
        format!(
            "*Style in the embedding.* Position on the aggression line goes with mean velocity ({}) and with the ADB score ({}; fitted \
             without the score, {}).",
            along(&a.line, "mean_velocity_mps"),
            along(&a.line, "adb"),
            along(&a.line_without_adb, "adb")
        ),
        format!(
            "*Mimic accuracy.* {}.",
            super::capital(&accuracy.join(", "))
        ),
    ];
    let clear = |p: Option<f64>| p.is_some_and(|p| p < 0.05);
    let nearer = a
        .nearer
        .iter()
        .filter(|r| clear(r.p_holm) && r.share.is_some_and(|s| s > 0.5));
    lines.push(format!(
        "*Nearer than the others.* Mimic is nearer to the own drive than Aggressive or Cautious in {} of {} comparisons (Holm, .05).",
        nearer.count(),
        a.nearer.len()
    ));
    let driven = a.panels.iter().filter(|p| p.measure != "aggressiveness");
    let pairs: Vec<_> = driven
        .flat_map(|p| &p.pairs)
        .filter(|p| p.first == ConditionId::MIMIC && p.second != ConditionId::PERPENDICULAR)
        .collect();
    lines.push(format!(
        "*The dial.* Aggressive or Cautious differs from Mimic in {} of {} comparisons of what was driven (Holm, .05).",
        pairs.iter().filter(|p| clear(p.p_holm)).count(),
        pairs.len()
    ));
    if let Some(rated) = a.panels.iter().find(|p| p.measure == "aggressiveness") {
        lines.push(format!(
            "*Felt aggressiveness* over the conditions: {}.",
            omnibus(rated, false)
        ));
    }
    let tested = a
        .homophily
        .iter()
        .filter(|r| r.correlation.p.is_some())
        .count();
    let low = a
        .homophily
        .iter()
        .filter(|r| clear(r.correlation.p))
        .count();
    let kept = a.homophily.iter().filter(|r| clear(r.p_holm)).count();
    lines.push(format!(
        "*Homophily.* Of {tested} correlations of a factor with a rating difference, {low} are below .05 and {kept} after Holm."
    ));
    let counts = verdict_counts(ledger);
    let counted: Vec<String> = counts
        .iter()
        .map(|(v, n)| format!("{n} {}", v.of_several()))
        .collect();
    let odd = ledger
        .iter()
        .filter(|r| r.own_figures.is_some_and(|c| !c.agrees()))
        .count();
    lines.push(format!(
        "*Beside the paper.* Of {} numbers: {}. {odd} of the paper’s numbers disagree with its other numbers.",
        ledger.len(),
        counted.join(", ")
    ));
    lines
}
