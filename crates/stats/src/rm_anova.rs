//! One-way repeated-measures analysis of variance.

use serde::{Deserialize, Serialize};

use crate::{
    Interval, Reasons, WithinSubjects,
    numerics::{
        decimal,
        distributions::f_upper,
        moments::{is_rounding, largest, sum_of},
        noncentral::f_ncp_interval,
    },
};

/// The analysis of variance of one within-subject factor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RmAnova {
    /// F = MS of the conditions over MS of the error.
    #[serde(rename = "F")]
    pub f: Option<f64>,
    /// P(F' ≥ F) if sphericity holds; see [`Sphericity`](crate::Sphericity) for when not.
    pub p: Option<f64>,
    /// k - 1.
    pub df1: usize,
    /// (n - 1)(k - 1).
    pub df2: usize,
    /// n Σ (condition mean - grand mean)².
    pub ss_condition: f64,
    /// k Σ (subject mean - grand mean)².
    pub ss_subject: f64,
    /// Σ (value - subject mean - condition mean + grand mean)².
    pub ss_error: f64,
    /// SSc / (SSc + SSe).
    pub eta2_partial: Option<f64>,
    /// Its 90 % interval, by the noncentral F: ncp / (ncp + df2); from 0 to 0 where even the central F has less than 5 % below
    /// (Steiger 2004): that leaves the estimate out, which lies above the population's value on average.
    #[serde(flatten, with = "crate::interval::eta2_partial_ci90")]
    pub eta2_partial_ci90: Interval,
    /// SSc / (SSc + SSe + SSs).
    pub eta2_generalized: Option<f64>,
    /// Its 90 % interval: the limits ncp MSe of the noncentral F in the place
    /// of SSc, the other sums of squares as observed. Approximate, since SSs varies too;
    /// without differences of subjects it is the interval of partial eta squared.
    #[serde(flatten, with = "crate::interval::eta2_generalized_ci90")]
    pub eta2_generalized_ci90: Interval,
    /// (SSc - df1 MSe) / (SSc + SSe + SSs + MSs); it may be negative.
    pub omega2_partial: Option<f64>,
    /// Its 90 % interval: ncp MSe in the place of SSc - df1 MSe, above and
    /// below. Never negative, as the population's value: none where the estimate is.
    #[serde(flatten, with = "crate::interval::omega2_partial_ci90")]
    pub omega2_partial_ci90: Interval,
    /// What other programs print for the same data.
    #[serde(flatten)]
    pub compat: RmAnovaCompat,
}

/// Values that only other programs print, to compare with.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct RmAnovaCompat {
    /// The interval of partial eta squared mapped as Steiger (2004) and MBESS do: ncp / (ncp + df1 + df2 + 1).
    #[serde(flatten, with = "crate::interval::eta2_partial_ci90_mbess")]
    pub eta2_partial_ci90_mbess: Interval,
}

/// Residuals of the additive model and the sums of squares, from one pass over the data.
pub(crate) struct Decomposition {
    /// Condition means less the grand mean, so that an offset costs no digits.
    pub(crate) condition_effects: Vec<f64>,
    /// Row-major, shape `(n, k)`; all zero if the data are exactly additive.
    pub(crate) residuals: Vec<f64>,
    pub(crate) ss_condition: f64,
    pub(crate) ss_subject: f64,
    pub(crate) ss_error: f64,
}

/// Splits the values into grand mean, subject, condition and residual.
pub(crate) fn decompose(data: &WithinSubjects) -> Decomposition {
    let (n, k) = (data.n() as f64, data.k() as f64);
    let pivot = data.values()[0];
    let mut condition = vec![0.0; data.k()];
    let mut subject = Vec::with_capacity(data.n());
    for row in data.rows() {
        let mut sum = 0.0;
        for (total, value) in condition.iter_mut().zip(row) {
            let value = value - pivot;
            *total += value;
            sum += value;
        }
        subject.push(sum / k);
    }
    for total in &mut condition {
        *total /= n;
    }
    let grand = condition.iter().sum::<f64>() / k;
    let mut residuals = Vec::with_capacity(data.values().len());
    for (row, mean) in data.rows().zip(&subject) {
        for (value, column) in row.iter().zip(&condition) {
            residuals.push(((value - pivot) - mean) - (column - grand));
        }
    }
    if is_additive(data, &residuals) {
        residuals.fill(0.0);
    }
    let squares = |values: &[f64], centre: f64| sum_of(values, |v| (v - centre) * (v - centre));
    Decomposition {
        ss_condition: n * squares(&condition, grand),
        ss_subject: k * squares(&subject, grand),
        ss_error: squares(&residuals, 0.0),
        condition_effects: condition.iter().map(|m| m - grand).collect(),
        residuals,
    }
}

/// Whether each subject's values differ from another's by one constant, exactly as
/// written or up to rounding.
fn is_additive(data: &WithinSubjects, residuals: &[f64]) -> bool {
    let scale = largest(data.values());
    if residuals.iter().all(|&r| is_rounding(r, scale)) {
        return true;
    }
    // Only residuals near rounding make the exact comparison worth its time.
    if largest(residuals) > 1e-6 * scale {
        return false;
    }
    let (written, k) = (decimal::Written::from_values(data.values()), data.k());
    (0..data.values().len()).all(|i| {
        let (start, j) = (i - i % k, i % k);
        written.same_difference((i, j), (start, 0))
    })
}

pub(crate) fn test(data: &WithinSubjects, parts: &Decomposition) -> (RmAnova, Reasons) {
    let mut reasons = Reasons::default();
    let (n, k) = (data.n(), data.k());
    let (df1, df2) = (k - 1, (n - 1) * (k - 1));
    let (d1, d2) = (df1 as f64, df2 as f64);
    let (ss_condition, ss_subject, ss_error) =
        (parts.ss_condition, parts.ss_subject, parts.ss_error);
    let (ms_error, ms_subject) = (ss_error / d2, ss_subject / (n as f64 - 1.0));
    let f = (ss_error > 0.0).then(|| (ss_condition / d1) / ms_error).filter(|f| f.is_finite());
    let p = f.map(|f| f_upper(f, d1, d2));
    let effect = ss_condition + ss_error;
    let total = effect + ss_subject;
    let interval = f.and_then(|f| f_ncp_interval(f, d1, d2, 0.05));
    if f.is_none() {
        let reason = if ss_condition > 0.0 {
            "the error sum of squares is zero, so F has no finite value"
        } else {
            "conditions and error do not vary at all: F is 0/0"
        };
        reasons.note_all(&["F", "p"], reason);
    }
    if interval.is_none() {
        let intervals = [
            "eta2_partial_ci90",
            "eta2_partial_ci90_mbess",
            "eta2_generalized_ci90",
            "omega2_partial_ci90",
        ];
        reasons.note_ends(&intervals, "there is no F to invert");
    }
    let of_omega = interval.filter(|_| f.is_some_and(|f| f >= 1.0));
    if of_omega.is_none() {
        let reason =
            "the estimate is below 0, and an interval of what the population may have is not";
        reasons.note_ends(&["omega2_partial_ci90"], reason);
    }
    if effect <= 0.0 {
        let reason = "neither conditions nor error vary: it is 0/0";
        reasons.note("eta2_partial", reason);
    }
    if total <= 0.0 {
        let names = ["eta2_generalized", "omega2_partial"];
        reasons.note_all(&names, "the values do not vary at all: it is 0/0");
    }
    let share = |ncp: f64| ncp / (ncp + d2);
    let share_mbess = |ncp: f64| ncp / (ncp + d1 + d2 + 1.0);
    let share_of_all = |ncp: f64| {
        let effect = ncp * ms_error;
        effect / (effect + ss_error + ss_subject)
    };
    let share_less_error = |ncp: f64| {
        let effect = ncp * ms_error;
        effect / (effect + d1 * ms_error + ss_error + ss_subject + ms_subject)
    };
    let interval = Interval::from(interval);
    let anova = RmAnova {
        f,
        p,
        df1,
        df2,
        ss_condition,
        ss_subject,
        ss_error,
        eta2_partial: (effect > 0.0).then(|| ss_condition / effect),
        eta2_partial_ci90: interval.map(share),
        compat: RmAnovaCompat { eta2_partial_ci90_mbess: interval.map(share_mbess) },
        eta2_generalized: (total > 0.0).then(|| ss_condition / total),
        eta2_generalized_ci90: interval.map(share_of_all),
        omega2_partial: (total > 0.0)
            .then(|| (ss_condition - d1 * ms_error) / (total + ms_subject)),
        omega2_partial_ci90: Interval::from(of_omega).map(share_less_error),
    };
    (anova, reasons)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(rows: &[Vec<f64>]) -> (RmAnova, Reasons) {
        let names: Vec<String> =
            (0..rows.len().max(rows[0].len())).map(|i| i.to_string()).collect();
        let (conditions, subjects) = (&names[..rows[0].len()], &names[..rows.len()]);
        let data = WithinSubjects::from_rows(conditions, subjects, rows).unwrap();
        test(&data, &decompose(&data))
    }

    /// F, and whether omega squared has an interval, which then holds it.
    fn interval(rows: &[Vec<f64>]) -> (f64, bool) {
        let (anova, reasons) = of(rows);
        let ci = anova.omega2_partial_ci90;
        let reason = reasons.get("omega2_partial_ci90_high");
        assert_eq!(ci.high.is_none(), reason.is_some(), "{reason:?}");
        assert_eq!(ci.holding(anova.omega2_partial), ci);
        (anova.f.unwrap(), ci.ends().is_some())
    }

    #[test]
    fn an_interval_of_omega_squared_holds_it_or_does_not_exist() {
        let below_1 = [[1.0, 2.0, 4.0], [3.0, 2.0, 1.0], [2.0, 5.0, 3.0], [4.0, 4.0, 6.0]];
        let (f, omega) = interval(&below_1.map(Vec::from));
        assert!((f - 0.549_295_774_648).abs() < 1e-9 && !omega);
        let above_1 = [[1.0, 2.0, 4.0], [3.0, 2.0, 1.0], [2.0, 5.0, 6.0], [4.0, 4.0, 6.0]];
        let (f, omega) = interval(&above_1.map(Vec::from));
        assert!((f - 1.563_380_281_690).abs() < 1e-9 && omega);
    }

    #[test]
    fn an_f_near_0_has_an_interval_from_0_to_0_which_no_sentence_prints() {
        let kept = [
            vec![-0.45, -1.86, 1.47, 3.25],
            vec![1.51, 2.4, 2.41, 1.92],
            vec![2.91, 3.27, 1.73, 0.32],
        ];
        let (anova, _) = of(&kept);
        assert!((anova.f.unwrap() - 0.093_024_424_944).abs() < 1e-9);
        assert_eq!(anova.eta2_partial_ci90.ends(), Some((0.0, 0.0)));
        let holding = anova.eta2_partial_ci90.holding(anova.eta2_partial);
        assert_eq!(holding, Interval::default());
    }
}
