//! One factor between subjects: independent groups.

use super::{
    ByDesign, Chosen, ChosenTest, DesignChoice, DesignColumns, OutcomeScale, judged,
    said_of_ordinal,
};
use crate::{AssumptionCheck, StatsError, groups, normality::shapiro_wilk, within_subjects::Index};

pub(super) fn independent(
    data: &DesignColumns<'_>,
    group: &[Option<String>],
    choice: &DesignChoice,
    mut reasons: Vec<String>,
) -> Result<ByDesign, StatsError> {
    Index::from_labels(data.subjects).distinct("subject")?;
    let rows = group.iter().zip(data.values);
    let (names, values): (Vec<String>, Vec<Option<f64>>) =
        rows.filter_map(|(group, value)| Some((group.clone()?, *value))).unzip();
    let comparison = groups(&names, &values)?;
    let (test, _) = shapiro_wilk(&standardised(&Index::from_labels(&names).rows, &values));
    let checks = vec![AssumptionCheck::of_normality("the standardised residuals", &test)];
    let (normal, mut words) = judged(&checks);
    let ranked = said_of_ordinal(choice, "their ranks are compared");
    let normal = normal && choice.scale != OutcomeScale::Ordinal;
    if let Some(ranked) = ranked {
        words = ranked;
    }
    let (chosen, name) = match (normal, comparison.several.is_some()) {
        (true, false) => (ChosenTest::WelchT, "Welch's t"),
        (false, false) => (ChosenTest::MannWhitney, "Mann-Whitney"),
        (true, true) => {
            (ChosenTest::WelchAnova, "Welch's analysis of variance, pairs after Games and Howell")
        }
        (false, true) => (ChosenTest::KruskalWallis, "Kruskal-Wallis, pairs after Dunn"),
    };
    reasons.push(format!("independent groups; {words}: {name}"));
    Ok(ByDesign::Groups(Box::new(Chosen { chosen, reasons, checks, found: comparison })))
}

/// Values less their group's mean, over its root mean square; 0 where a group does not vary.
fn standardised(group: &[usize], values: &[Option<f64>]) -> Vec<f64> {
    let most = group.iter().max().map_or(0, |g| g + 1);
    let mut out = Vec::new();
    for g in 0..most {
        let members = group.iter().zip(values).filter(|(of_row, _)| **of_row == g);
        let sample: Vec<f64> = members.filter_map(|(_, value)| *value).collect();
        let n = sample.len() as f64;
        let pivot = sample.first().copied().unwrap_or_default();
        let mean = sample.iter().map(|v| v - pivot).sum::<f64>() / n;
        let residuals: Vec<f64> = sample.iter().map(|v| v - pivot - mean).collect();
        let size = (residuals.iter().map(|r| r * r).sum::<f64>() / n).sqrt();
        let scaled = |r: f64| if size > 0.0 { r / size } else { 0.0 };
        out.extend(residuals.into_iter().map(scaled));
    }
    out
}
