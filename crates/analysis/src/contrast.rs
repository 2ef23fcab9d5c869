//! Two conditions held against each other.

use crate::{
    AnalysisError,
    result::{Contrast, ContrastTest, Odds},
    verdict::ALPHA,
};
use maveric_domain::{ConditionId, design::Sign};
use maveric_stats::{
    Interval, MarginalContrast, Named, Posthoc, PosthocTest, SmallSample, WithinSubjects, compare,
};

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
            se: None,
            interval: None,
            effect: None,
            p: None,
            p_holm: None,
            odds: None,
            unbounded: false,
        }
    }

    /// First minus second, whichever way round the test looked at them.
    pub(crate) fn from_posthoc(
        tested: &Posthoc,
        [first, second]: [ConditionId; 2],
        expected: Option<Sign>,
    ) -> Self {
        let (pair, sign) = match tested.pairs.get(&format!("{first}|{second}")) {
            Some(pair) => (Some(pair), 1.0),
            None => (tested.pairs.get(&format!("{second}|{first}")), -1.0),
        };
        let untested = Self::untested([first, second], expected);
        let Some(pair) = pair else {
            return untested;
        };
        let mut effect = pair.effect.clone();
        if sign < 0.0 {
            effect.value = effect.value.map(|v| -v);
            effect.ci = effect.ci.negated();
        }
        // Wilcoxon's sum of positive ranks turns into that of the negative ones.
        let statistic = pair.statistic.map(|s| match (tested.test, sign < 0.0) {
            (PosthocTest::Wilcoxon, true) => (pair.n_used * (pair.n_used + 1)) as f64 / 2.0 - s,
            (_, true) => -s,
            (_, false) => s,
        });
        Self {
            mean_difference: Some(sign * pair.mean_diff).filter(|d| d.is_finite()),
            statistic,
            df: pair.df.map(|df| df as f64),
            effect: Some(effect),
            p: pair.p,
            ..untested
        }
    }

    /// The same tested by its likelihood ratio of one degree of freedom: F is the square of t.
    fn by_ratio(self, ratio: &SmallSample) -> Self {
        let root = |difference: f64| ratio.f.sqrt().copysign(difference);
        Self {
            statistic: self.mean_difference.map(root),
            df: Some(ratio.df2 as f64),
            p: Some(ratio.p),
            unbounded: true,
            ..self
        }
    }
}

/// The pairs of conditions of a model, and what each condition is called in it.
pub(crate) struct ModelPairs<'a> {
    pub(crate) test: ContrastTest,
    pub(crate) pairs: &'a Named<MarginalContrast>,
    /// The likelihood ratios of pairs that have no finite difference.
    pub(crate) ratios: Option<&'a Named<SmallSample>>,
    pub(crate) names: Vec<(ConditionId, String)>,
}

impl ModelPairs<'_> {
    /// First minus second with the period taken out; `raw` is the mean difference as it was measured, which stands where the model's is on
    /// another scale.
    pub(crate) fn contrast(
        &self,
        [first, second]: [ConditionId; 2],
        raw: Option<f64>,
        expected: Option<Sign>,
    ) -> Contrast {
        let name = |id| self.names.iter().find(|(c, _)| *c == id).map_or("", |(_, n)| n);
        let pair = |a, b| self.pairs.get(&format!("{}|{}", name(a), name(b)));
        let known = pair(first, second).map(|pair| (pair, 1.0));
        let known = known.or_else(|| Some((pair(second, first)?, -1.0)));
        let untested =
            Contrast { mean_difference: raw, ..Contrast::untested([first, second], expected) };
        let Some((pair, sign)) = known else {
            let ratio = |a, b| self.ratios?.get(&format!("{}|{}", name(a), name(b)));
            return match ratio(first, second).or_else(|| ratio(second, first)) {
                Some(ratio) => untested.by_ratio(ratio),
                None => untested,
            };
        };
        let estimate = sign * pair.estimate;
        let turned = |ci: Interval| if sign < 0.0 { ci.negated() } else { ci };
        let ends = turned(pair.ci).ends();
        let (mean, se, interval, odds) = if self.test == ContrastTest::Ordinal {
            (raw, None, None, Odds::of_logits(estimate, ends))
        } else {
            (Some(estimate), Some(pair.se), ends, None)
        };
        Contrast {
            odds,
            mean_difference: mean,
            statistic: Some(sign * pair.t),
            df: pair.df,
            se,
            interval,
            p: pair.p,
            ..untested
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
    let Some(column) = conditions.iter().position(|c| *c == other) else {
        return Ok(Contrast::untested(pair, expected));
    };
    let rows: Vec<Vec<f64>> = values.iter().map(|row| vec![row[column], 0.0]).collect();
    let subjects: Vec<String> = (0..rows.len()).map(|i| i.to_string()).collect();
    let names = [other.to_string(), baseline.to_string()];
    let tested = WithinSubjects::from_rows(&names, &subjects, &rows)?;
    let comparison = compare(&tested, ALPHA)?;
    Ok(Contrast::from_posthoc(&comparison.posthoc, pair, expected))
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_stats::{Adjustment, posthoc};

    #[test]
    fn turned_round_a_contrast_has_the_same_p_and_everything_else_negated() {
        let names = ["calm", "sporty"].map(str::to_owned);
        let [calm, sporty] = names.clone().map(|n| n.parse().unwrap());
        let subjects: Vec<String> = (0..6).map(|i| i.to_string()).collect();
        let above = [1.0, 2.5, -0.5, 3.0, 2.0, 0.25];
        let rows: Vec<Vec<f64>> = above.iter().map(|d| vec![10.0 + d, 10.0]).collect();
        let data = WithinSubjects::from_rows(&names, &subjects, &rows).unwrap();
        for test in [PosthocTest::T, PosthocTest::Wilcoxon] {
            let tested = posthoc(&data, test, Adjustment::None, ALPHA).unwrap();
            let one = Contrast::from_posthoc(&tested, [calm, sporty], None);
            let other = Contrast::from_posthoc(&tested, [sporty, calm], Some(Sign::Minus));
            let difference = above.iter().sum::<f64>() / 6.0;
            assert!((one.mean_difference.unwrap() - difference).abs() < 1e-12);
            assert!((other.mean_difference.unwrap() + difference).abs() < 1e-12);
            assert_eq!((one.p, one.df), (other.p, other.df));
            assert_eq!((one.expected, other.expected), (None, Some(Sign::Minus)));
            let sum = one.statistic.unwrap() + other.statistic.unwrap();
            // The sums of positive and of negative ranks are 1 + 2 + … + 6; two values of t add up to nothing.
            let expected = if test == PosthocTest::Wilcoxon { 21.0 } else { 0.0 };
            assert!((sum - expected).abs() < 1e-12, "{sum}");
            let (one, other) = (one.effect.unwrap(), other.effect.unwrap());
            let negated = |v: Option<f64>| v.map(|v| -v);
            assert!(one.value.unwrap() > 0.0);
            assert_eq!(other.value, negated(one.value));
            assert_eq!(other.ci, one.ci.negated());
        }
        let tested = posthoc(&data, PosthocTest::T, Adjustment::None, ALPHA).unwrap();
        let unknown = Contrast::from_posthoc(&tested, [calm, "own".parse().unwrap()], None);
        assert!(unknown.p.is_none() && unknown.effect.is_none());
        let rows: Vec<Vec<f64>> = above.iter().map(|d| vec![0.0, *d]).collect();
        let zero = from_zero(
            &[calm, sporty],
            &rows,
            "own".parse().unwrap(),
            ["own".parse().unwrap(), sporty],
            None,
        );
        let difference = above.iter().sum::<f64>() / 6.0;
        assert!((zero.unwrap().mean_difference.unwrap() + difference).abs() < 1e-12);
    }
}
