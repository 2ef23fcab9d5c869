//! Two conditions held against each other.

use crate::{AnalysisError, result::Contrast, verdict::ALPHA};
use maveric_domain::{ConditionId, design::Sign};
use maveric_stats::{Posthoc, PosthocTest, WithinSubjects, compare};

impl Contrast {
    pub(crate) fn untested([first, second]: [ConditionId; 2], expected: Option<Sign>) -> Self {
        Self {
            first,
            second,
            expected,
            people: [0; 3],
            mean_difference: None,
            statistic: None,
            df: None,
            effect: None,
            p: None,
            p_holm: None,
        }
    }

    /// First minus second, whichever way round the test looked at them.
    pub(crate) fn of(
        tested: &Posthoc,
        [first, second]: [ConditionId; 2],
        expected: Option<Sign>,
    ) -> Self {
        let found = tested.pairs.get(&format!("{first}|{second}"));
        let (found, sign) = match found {
            Some(found) => (Some(found), 1.0),
            None => (tested.pairs.get(&format!("{second}|{first}")), -1.0),
        };
        let Some(found) = found else {
            return Self::untested([first, second], expected);
        };
        let mut effect = found.effect.clone();
        if sign < 0.0 {
            effect.value = effect.value.map(|v| -v);
            (effect.ci_low, effect.ci_high) =
                (effect.ci_high.map(|v| -v), effect.ci_low.map(|v| -v));
        }
        // Wilcoxon's sum of positive ranks turns into that of the negative ones.
        let statistic = found.statistic.map(|s| match (tested.test, sign < 0.0) {
            (PosthocTest::Wilcoxon, true) => (found.n_used * (found.n_used + 1)) as f64 / 2.0 - s,
            (_, true) => -s,
            (_, false) => s,
        });
        Self {
            first,
            second,
            expected,
            people: [0; 3],
            mean_difference: Some(sign * found.mean_diff).filter(|d| d.is_finite()),
            statistic,
            df: found.df,
            effect: Some(effect),
            p: found.p,
            p_holm: None,
        }
    }
}

/// A condition against the baseline, where the values are differences from it.
pub(crate) fn from_zero(
    conditions: &[ConditionId],
    values: &[Vec<f64>],
    baseline: ConditionId,
    pair: [ConditionId; 2],
    expected: Option<Sign>,
) -> Result<Contrast, AnalysisError> {
    let [first, second] = pair;
    let other = if first == baseline { second } else { first };
    let Some(at) = conditions.iter().position(|c| *c == other) else {
        return Ok(Contrast::untested(pair, expected));
    };
    let rows: Vec<Vec<f64>> = values.iter().map(|row| vec![row[at], 0.0]).collect();
    let subjects: Vec<String> = (0..rows.len()).map(|i| i.to_string()).collect();
    let names = [other.to_string(), baseline.to_string()];
    let tested = WithinSubjects::from_rows(&names, &subjects, &rows)?;
    let found = compare(&tested, ALPHA)?;
    Ok(Contrast::of(&found.posthoc, pair, expected))
}
