//! What pairs of conditions of a panel are tested by, and their values.

use crate::{
    contrast::ModelPairs,
    crossed::factors_within,
    data::StudyData,
    design_test::Period,
    outcomes::Asked,
    result::{Contrast, ContrastTest, Odds, Panel},
};
use maveric_domain::{ConditionId, design::DeclaredTest};
use maveric_stats::{ByDesign, ChosenTest, PosthocTest};

/// Values of both conditions of those whom the panel's tests are of: whoever lacks a value of any condition is in none of them. The
/// baseline of a panel of differences is 0.
pub(crate) fn values(panel: &Panel, first: ConditionId, second: ConditionId) -> Vec<[f64; 2]> {
    let column = |id| panel.conditions.iter().position(|c| *c == id);
    let value = |row: &[Option<f64>], id| match column(id) {
        Some(index) => row[index],
        None => (panel.differences_from == Some(id)).then_some(0.0),
    };
    let complete = panel.rows.iter().filter(|row| row.iter().all(Option::is_some));
    complete.filter_map(|row| Some([value(row, first)?, value(row, second)?])).collect()
}

/// The panel of everybody of an outcome.
pub(crate) fn panel_of_everybody<'a>(panels: &'a [Panel], outcome: &str) -> Option<&'a Panel> {
    let mut panels = panels.iter();
    panels.find(|panel| panel.outcome == outcome && panel.group.is_none())
}

/// The contrast, first minus second, whichever way round it was declared.
pub(crate) fn contrast(panel: &Panel, [first, second]: [ConditionId; 2]) -> Option<Contrast> {
    let turned = |c: &Contrast| Contrast {
        mean_difference: c.mean_difference.map(|d| -d),
        interval: c.interval.map(|(low, high)| (-high, -low)),
        odds: c.odds.map(Odds::turned),
        ..c.clone()
    };
    panel.contrasts.iter().find_map(|c| {
        if (c.first, c.second) == (first, second) {
            Some(c.clone())
        } else if (c.first, c.second) == (second, first) {
            Some(turned(c))
        } else {
            None
        }
    })
}

/// Mean of first less second as it was measured.
pub(crate) fn mean_difference(panel: &Panel, [first, second]: [ConditionId; 2]) -> Option<f64> {
    let pairs = values(panel, first, second);
    let sum: f64 = pairs.iter().map(|[a, b]| a - b).sum();
    Some(sum / pairs.len() as f64).filter(|mean| mean.is_finite())
}

/// The pairs of the model that the conditions were tested by: where it takes the period, and where it was declared.
pub(crate) fn model_pairs<'a>(
    data: &StudyData,
    asked: &Asked,
    panel: &'a Panel,
    period: Period,
) -> Option<ModelPairs<'a>> {
    let declared = matches!(asked.test, Some(DeclaredTest::Mixed | DeclaredTest::Ordinal));
    if period != Period::Taken && !declared {
        return None;
    }
    let within = factors_within(&data.design, &panel.conditions);
    let term: Vec<&str> = within.iter().map(|(name, _)| name.as_str()).collect();
    let name = |index: usize| {
        let levels = within.iter().map(|(_, levels)| levels[index].as_str());
        levels.collect::<Vec<_>>().join(":")
    };
    let names = panel.conditions.iter().enumerate();
    let names = names.map(|(index, c)| (*c, name(index))).collect();
    let (test, pairs, ratios) = match panel.comparison.as_ref()? {
        ByDesign::Mixed(mixed) => {
            let pairs = mixed.found.pairs(&term.join(":"));
            let pairs = pairs.filter(|pairs| !pairs.is_empty())?;
            (ContrastTest::Mixed, pairs, None)
        }
        ByDesign::Ordinal(ordinal) => {
            let analysis = &ordinal.found;
            let ratios = Some(&analysis.ratio);
            (ContrastTest::Ordinal, &analysis.contrast, ratios)
        }
        _ => return None,
    };
    Some(ModelPairs { test, pairs, ratios, names })
}

const NO_TEST: &str = "the test has no p for these data";
const NO_SPREAD: &str = "the difference is the same in everybody: it has no spread";

/// Why the contrast of two conditions has no p, where people enough have values.
pub(crate) fn why_no_p(panel: &Panel, [first, second]: [ConditionId; 2]) -> String {
    let Some(comparison) = &panel.comparison else {
        let reason = panel.reasons.first().cloned();
        return reason.unwrap_or_else(|| NO_TEST.to_owned());
    };
    let of_model = match comparison {
        ByDesign::Ordinal(ordinal) => ordinal.found.model.undefined.get("lr.p"),
        ByDesign::Mixed(mixed) => {
            let mut reasons = mixed.found.model.undefined.iter();
            let of_pair = reasons.find(|(name, _)| name.starts_with("own_error."));
            of_pair.map(|(_, why)| why)
        }
        _ => None,
    };
    let differences: Vec<f64> = values(panel, first, second).iter().map(|[a, b]| a - b).collect();
    let alike = differences.windows(2).all(|d| (d[0] - d[1]).abs() < 1e-12);
    let why = of_model.or_else(|| alike.then_some(NO_SPREAD));
    why.unwrap_or(NO_TEST).to_owned()
}

/// Ranks where ranks were compared, or the order of the answers alone counts.
pub(crate) fn test_of_pairs(comparison: Option<&ByDesign>) -> PosthocTest {
    let chosen = match comparison {
        Some(ByDesign::Factorial(factorial)) => factorial.chosen,
        Some(ByDesign::Ordinal(ordinal)) => ordinal.chosen,
        _ => return PosthocTest::T,
    };
    match chosen {
        ChosenTest::Ranks | ChosenTest::Ordinal => PosthocTest::Wilcoxon,
        _ => PosthocTest::T,
    }
}
