//! What describes values without a test: means with their intervals, quantiles.

use crate::{
    WithinSubjects,
    analysis::summaries,
    normality,
    numerics::{distributions::t_quantile_two_sided, moments::mean_and_square_sum},
    rm_anova::decompose,
};

/// The mean; `None` without a value.
pub fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| mean_and_square_sum(values.iter().copied()).0)
}

/// The standard deviation, over n - 1; `None` below two values.
pub fn standard_deviation(values: &[f64]) -> Option<f64> {
    let rest = values.len().checked_sub(1).filter(|&rest| rest > 0)?;
    let (_, squares) = mean_and_square_sum(values.iter().copied());
    Some((squares / rest as f64).sqrt())
}

/// The `share` quantile of ascending values by linear interpolation (R's type 7); `None` without a value.
///
/// # Example
/// ```
/// assert_eq!(maveric_stats::quantile(&[1.0, 2.0, 4.0, 8.0], 0.25), Some(1.75));
/// ```
pub fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    (!sorted.is_empty()).then(|| normality::quantile(sorted, share))
}

/// Mean, lower and upper end of its interval by Student's t, with the given confidence (0.95); `None` below two values.
///
/// # Example
/// ```
/// let [mean, low, high] = maveric_stats::mean_interval(&[1.0, 2.0, 3.0], 0.95).unwrap();
/// assert!(mean == 2.0 && (high - mean - 2.484_137_7).abs() < 1e-6 && (mean - low - 2.484_137_7).abs() < 1e-6);
/// ```
pub fn mean_interval(values: &[f64], confidence: f64) -> Option<[f64; 3]> {
    let n = values.len() as f64;
    let (mean, sd) = (mean(values)?, standard_deviation(values)?);
    let half = t_quantile_two_sided(1.0 - confidence, n - 1.0)? * sd / n.sqrt();
    Some([mean, mean - half, mean + half])
}

/// The mean of the means of groups, each of equal weight, with its interval by the variance of each group on its own; `None` where a group
/// has fewer than two values, or nothing varies. Of one group it is [`mean_interval`].
///
/// # Source
/// Satterthwaite (1946) for the degrees of freedom, as in Welch's test.
///
/// # Example
/// ```
/// let groups = [vec![1.0, 2.0, 3.0], vec![5.0, 7.0, 9.0, 7.0]];
/// let [mean, low, high] = maveric_stats::mean_of_groups_interval(&groups, 0.95).unwrap();
/// assert!(mean == 4.5 && low < 3.4 && high > 5.6);
/// ```
pub fn mean_of_groups_interval(groups: &[Vec<f64>], confidence: f64) -> Option<[f64; 3]> {
    let count = groups.len() as f64;
    let (mut sum, mut square, mut uncertain) = (0.0, 0.0, 0.0);
    for values in groups {
        let n = values.len() as f64;
        let error = standard_deviation(values)?.powi(2) / n;
        sum += mean(values)?;
        square += error;
        uncertain += error * error / (n - 1.0);
    }
    let df = Some(square * square / uncertain).filter(|df| df.is_finite())?;
    let (mean, se) = (sum / count, square.sqrt() / count);
    let half = t_quantile_two_sided(1.0 - confidence, df)? * se;
    Some([mean, mean - half, mean + half])
}

/// Means of k conditions with the ends of their 95 % within-subject intervals, from one complete row a subject;
/// `None` below two subjects or two conditions.
///
/// # Source
/// Cousineau (2005) with the correction of Morey (2008): see [`ConditionSummary`](crate::ConditionSummary).
pub fn within_subject_intervals(rows: &[Vec<f64>]) -> Option<Vec<[f64; 3]>> {
    let names = |count: usize| (0..count).map(|i| i.to_string()).collect::<Vec<_>>();
    let data = WithinSubjects::from_rows(&names(rows.first()?.len()), &names(rows.len()), rows);
    let data = data.ok()?;
    let intervals = summaries(&data, &decompose(&data));
    let ends =
        |(_, s): (_, &crate::ConditionSummary)| Some([s.mean, s.within_ci.low?, s.within_ci.high?]);
    intervals.iter().map(ends).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(value: f64, expected: f64) {
        assert!((value - expected).abs() < 1e-12, "{value}, not {expected}");
    }

    #[test]
    fn spread_and_quantiles_are_those_by_hand() {
        let values = [2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0];
        close(standard_deviation(&values).unwrap(), (32.0_f64 / 7.0).sqrt());
        close(mean(&values).unwrap(), 5.0);
        assert_eq!((mean(&[]), standard_deviation(&[3.0])), (None, None));
        let sorted = [1.0, 2.0, 4.0, 8.0];
        for (share, expected) in [(0.0, 1.0), (0.25, 1.75), (0.5, 3.0), (0.9, 6.8), (1.0, 8.0)] {
            close(quantile(&sorted, share).unwrap(), expected);
        }
        assert_eq!(quantile(&[], 0.5), None);
    }

    #[test]
    fn an_interval_of_a_mean_has_the_t_of_the_tables() {
        for (n, t) in [(2, 12.706_205), (3, 4.302_653), (11, 2.228_139), (101, 1.983_972)] {
            let values: Vec<f64> = (0..n).map(f64::from).collect();
            let [middle, low, high] = mean_interval(&values, 0.95).unwrap();
            let error = standard_deviation(&values).unwrap() / f64::from(n).sqrt();
            assert!(((high - middle) / error / t - 1.0).abs() < 1e-6, "{n}");
            close(middle - low, high - middle);
        }
        assert_eq!(mean_interval(&[1.0], 0.95), None);
    }

    #[test]
    fn groups_are_not_pooled_in_the_interval_of_their_mean() {
        let wide = vec![1.0, 9.0, 4.0, 12.0, -3.0];
        let narrow = vec![5.0, 5.2, 4.9, 5.1, 5.0, 5.3, 4.8];
        let alone = mean_of_groups_interval(std::slice::from_ref(&wide), 0.95).unwrap();
        let one = mean_interval(&wide, 0.95).unwrap();
        for (end, expected) in alone.into_iter().zip(one) {
            close(end, expected);
        }
        // In numpy and scipy: v = [a.var(ddof=1) / len(a)] of each, sqrt(sum(v)) / 2 * t.ppf(.975, sum(v)**2 / sum(v**2 / (n - 1))).
        let [mean, low, high] = mean_of_groups_interval(&[wide, narrow], 0.95).unwrap();
        assert!(
            (mean - 4.821_428_571_428).abs() < 1e-9 && (high - mean - 3.739_854_901).abs() < 1e-6
        );
        close(mean - low, high - mean);
        let none = |groups: &[Vec<f64>]| mean_of_groups_interval(groups, 0.95).is_none();
        assert!(none(&[vec![1.0, 2.0], vec![3.0]]) && none(&[vec![2.0, 2.0]]) && none(&[]));
    }

    #[test]
    fn within_subject_intervals_are_those_by_hand() {
        // Centred on their own means the first column is -1, 0, 1 and the second the reverse: each with a deviation of 1.
        let rows = vec![vec![1.0, 3.0], vec![10.0, 10.0], vec![6.0, 4.0]];
        let intervals = within_subject_intervals(&rows).unwrap();
        let half = 4.302_652_729_749_464 * 2.0_f64.sqrt() / 3.0_f64.sqrt();
        for ([middle, low, high], expected) in intervals.into_iter().zip([17.0 / 3.0; 2]) {
            close(middle, expected);
            assert!((middle - low - half).abs() < 1e-9 && (high - middle - half).abs() < 1e-9);
        }
        // A constant shift between conditions leaves no within-subject interval.
        let shifted = [vec![1.0, 2.0], vec![5.0, 6.0], vec![9.0, 10.0]];
        for [middle, low, high] in within_subject_intervals(&shifted).unwrap() {
            assert!(high - middle < 1e-12 && middle - low < 1e-12);
        }
        assert!(within_subject_intervals(&rows[..1]).is_none());
        assert!(within_subject_intervals(&[vec![1.0], vec![2.0]]).is_none());
        assert!(within_subject_intervals(&[]).is_none());
    }
}
