//! Do people like best a car near their own style?

use crate::{
    finding::{Finding, Part, Question, Rule},
    result::CongruenceRow,
    verdict::one_sided,
};
use maveric_stats::{Bend, RatioTest, Region};

/// By every rating the top has to be near, and to stay near whatever people's own style is; a bottom is no top. What people perceived
/// decides nothing.
pub(super) fn congruence(rows: &[CongruenceRow]) -> Option<Finding> {
    let rows = rows.iter().filter(|row| row.is_judged());
    let parts: Vec<Part> = rows.flat_map(parts).collect();
    (!parts.is_empty()).then(|| Finding::every(Question::Congruence, parts))
}

fn parts(row: &CongruenceRow) -> [Part; 2] {
    let model = row.model.as_ref();
    let is_top = model.is_some_and(|model| model.bend == Bend::Top);
    let part = |name: &str, test: Option<&RatioTest>| {
        let sides = test.and_then(|test| test.p_lower.zip(test.p_upper));
        let top = test.filter(|_| is_top);
        Part {
            of: format!("{}.{name}", row.rating),
            n: row.n,
            estimate: top.and_then(|test| test.estimate),
            interval: top.and_then(|test| match test.region? {
                Region::Between { low, high } => Some((low, high)),
                Region::Outside { .. } | Region::Everywhere => None,
            }),
            p: sides.map(|(lower, upper)| lower.max(upper)),
            rule: Rule::Same { low: -row.near_points, high: row.near_points },
            verdict: one_sided(row.n, sides),
        }
    };
    [
        part("top", model.map(|model| &model.turn)),
        part("movement", model.map(|model| &model.movement)),
    ]
}
