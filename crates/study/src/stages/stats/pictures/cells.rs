//! Groups, conditions or cells of both: rainclouds with brackets, or a forest of what differs.

use super::Picture;
use maveric_report::figures::{
    comparison::{ComparedCell, ComparisonPanel, Contrast},
    forest::{Forest, ForestRow},
};
use maveric_stats::{ConditionSummary, Named, Posthoc, WithinSubjects, apa};

/// Above this many contrasts a forest is clearer than brackets.
const MOST_BRACKETS: usize = 6;
const WITHIN_INTERVALS: &str = "within-subject 95% intervals (Cousineau–Morey)";
pub(super) const HOLM: &str = "*p* values after Holm";

/// Conditions of the same people; `p` are those of the pairs in their order, if any.
pub(in crate::stages::stats) fn conditions(
    data: &WithinSubjects,
    outcome: &str,
    test: String,
    desc: &Named<ConditionSummary>,
    p: impl Iterator<Item = Option<f64>>,
) -> Picture {
    let cells = desc.iter().map(|(name, c)| ComparedCell {
        name: name.to_owned(),
        mean: (|| Some([c.mean, c.within_ci.low?, c.within_ci.high?]))(),
    });
    let panel = ComparisonPanel {
        outcome: outcome.to_owned(),
        test,
        cells: cells.collect(),
        rows: data.rows().map(|row| row.iter().copied().map(Some).collect()).collect(),
        contrasts: in_order(data.k(), p),
    };
    Picture::Panel(panel, WITHIN_INTERVALS, HOLM)
}

/// Pairs: brackets over rainclouds while they are few, a forest of effect sizes beyond.
pub(in crate::stages::stats) fn pairs(
    data: &WithinSubjects,
    outcome: &str,
    desc: &Named<ConditionSummary>,
    result: &Posthoc,
) -> Picture {
    if result.pairs.len() <= MOST_BRACKETS {
        let p = result.pairs.values().map(|pair| pair.p_adjusted);
        return conditions(data, outcome, String::new(), desc, p);
    }
    let symbol = apa::p_symbol(result.adjust);
    let rows = result.pairs.iter().map(|(name, pair)| {
        let effect = &pair.effect;
        ForestRow {
            name: name.to_owned(),
            estimate: (|| Some([effect.value?, effect.ci.low?, effect.ci.high?]))(),
            said: p_text(symbol, pair.p_adjusted),
        }
    });
    let axis = match result.pairs.values().next().map(|pair| pair.effect.name) {
        Some(maveric_stats::EffectName::RankBiserial) => "*r*_{rb} (A minus B, 95% CI)",
        _ => "*d*_{z} (A minus B, 95% CI)",
    };
    Picture::Forest(Forest {
        title: format!("Differences of {outcome}"),
        axis: axis.to_owned(),
        rows: rows.collect(),
        bounds: None,
        n: result.n,
    })
}

/// `*p* = .012`, `*p* < .001`, or a dash.
pub(super) fn p_text(symbol: &str, p: Option<f64>) -> String {
    match p.map(apa::p_cell) {
        Some(cell) if cell.starts_with('<') => format!("{symbol} {cell}"),
        Some(cell) => format!("{symbol} = {cell}"),
        None => "–".to_owned(),
    }
}

/// Pairs of `k` cells in their order.
fn in_order(k: usize, p: impl Iterator<Item = Option<f64>>) -> Vec<Contrast> {
    let pairs = (0..k).flat_map(|a| (a + 1..k).map(move |b| (a, b)));
    let one = |((first, second), p): ((usize, usize), Option<f64>)| {
        let p = p?;
        Some(Contrast { first, second, p })
    };
    pairs.zip(p).filter_map(one).collect()
}
