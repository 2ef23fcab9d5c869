//! How likely a test is to find an effect.

use serde::{Deserialize, Serialize};

use crate::{
    Reasons, StatsError,
    numerics::{
        distributions::{f_quantile_upper, normal_quantile, normal_upper, t_quantile_two_sided},
        noncentral::{f_lower, t_lower},
    },
};

/// The test that is planned, with the effect expected.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "test")]
#[non_exhaustive]
pub enum PlannedTest {
    /// A paired t test; `effect` is dz.
    PairedT {
        /// Mean difference over the standard deviation of the differences.
        effect: f64,
    },
    /// A test of Pearson's r; `effect` is r.
    Pearson {
        /// The correlation expected.
        effect: f64,
    },
    /// A one-way repeated-measures analysis of variance by the spread of the population means beside that of people: not the partial eta
    /// squared that an analysis of variance prints, which is several times larger where a person's values go together.
    RmAnova {
        /// Eta squared in the metric between subjects, as G*Power's default: η² / (1 - η²) = f², the variance of the k means (over k) over
        /// that of people in one condition.
        effect: f64,
        /// Conditions.
        k: usize,
        /// Correlation of two conditions over subjects.
        corr: f64,
        /// Greenhouse and Geisser's ε, from 1/(k-1) to 1.
        epsilon: f64,
    },
    /// The same by the partial eta squared that [`rm_anova`](crate::rm_anova()) prints, SSc / (SSc + SSe).
    ///
    /// η² / (1 - η²) · (1 - corr) (k-1) (n-1) / (n k) is the f² of [`PlannedTest::RmAnova`]. A sample's is larger than the population's
    /// by chance, the more the smaller the sample.
    RmAnovaPartial {
        /// Partial eta squared.
        eta2_partial: f64,
        /// Conditions.
        k: usize,
        /// Greenhouse and Geisser's ε, from 1/(k-1) to 1.
        epsilon: f64,
    },
}

/// One question about power.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PowerQuestion {
    /// The test and its effect.
    #[serde(flatten)]
    pub test: PlannedTest,
    /// Subjects (pairs, for a correlation).
    pub n: usize,
    /// Two-sided level of significance.
    pub alpha: f64,
}

/// The answer to one [`PowerQuestion`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PowerAnswer {
    /// Probability of p < alpha.
    pub power: Option<f64>,
    /// The smallest n with a power of at least 80 %.
    pub n_for_80: Option<usize>,
}

/// Answers in the order of the questions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PowerAnalysis {
    /// One answer a question.
    pub row: Vec<PowerAnswer>,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// Sample sizes looked at for `n_for_80`.
const MOST_SUBJECTS: usize = 1_000_000;

/// Power of planned tests.
///
/// # Errors
/// [`StatsError::BadParameter`] for an effect, level or correlation outside its range.
///
/// # Source
/// Noncentral t with ncp = dz √n; Fisher's z with its bias term r/(2(n-1)), as R's `pwr`;
/// noncentral F with ncp = f² n k ε / (1 - corr), as pingouin's `power_rm_anova`, or with ncp = η² / (1 - η²) (n-1) (k-1) ε of a
/// partial eta squared.
///
/// # Example
/// ```
/// use maveric_stats::{PlannedTest, PowerQuestion, power};
/// let question = PowerQuestion { test: PlannedTest::PairedT { effect: 0.5 }, n: 24, alpha: 0.05 };
/// let answer = &power(&[question])?.row[0];
/// assert!((answer.power.unwrap() - 0.650_392).abs() < 1e-6); // pwr.t.test
/// assert_eq!(answer.n_for_80, Some(34));
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn power(questions: &[PowerQuestion]) -> Result<PowerAnalysis, StatsError> {
    let mut undefined = Reasons::default();
    let mut row = Vec::with_capacity(questions.len());
    for (i, question) in questions.iter().enumerate() {
        check(question)?;
        let power = power_at(question, question.n);
        if power.is_none() {
            let reason = "too few subjects for the test to have degrees of freedom";
            undefined.note(&format!("row.{i}.power"), reason);
        }
        let n_for_80 = smallest_n(question);
        if n_for_80.is_none() {
            let reason = format!("no sample of up to {MOST_SUBJECTS} reaches a power of 80 %");
            undefined.note(&format!("row.{i}.n_for_80"), reason);
        }
        row.push(PowerAnswer { power, n_for_80 });
    }
    Ok(PowerAnalysis { row, undefined })
}

fn check(question: &PowerQuestion) -> Result<(), StatsError> {
    let inside = |name: &str, found: f64, low: f64, high: f64| {
        let fine = found > low && found < high;
        fine.then_some(())
            .ok_or_else(|| StatsError::parameter(name, &format!("between {low} and {high}"), found))
    };
    inside("alpha", question.alpha, 0.0, 1.0)?;
    let of_conditions = |k: usize, epsilon: f64| {
        StatsError::two_conditions(k)?;
        let least = 1.0 / (k as f64 - 1.0);
        // What was rounded where it was printed is let through.
        let fine = epsilon > least - 1e-9 && epsilon < 1.0 + 1e-9;
        let expected = format!("from {least:.3} to 1");
        fine.then_some(()).ok_or_else(|| StatsError::parameter("epsilon", &expected, epsilon))
    };
    match question.test {
        PlannedTest::PairedT { effect } => inside("effect", effect, -1e6, 1e6),
        PlannedTest::Pearson { effect } => inside("effect", effect, -1.0, 1.0),
        PlannedTest::RmAnova { effect, k, corr, epsilon } => {
            of_conditions(k, epsilon)?;
            inside("effect", effect, -f64::MIN_POSITIVE, 1.0)?;
            // Less is no correlation that all pairs of so many conditions can have.
            inside("corr", corr, -1.0 / (k as f64 - 1.0), 1.0)
        }
        PlannedTest::RmAnovaPartial { eta2_partial, k, epsilon } => {
            of_conditions(k, epsilon)?;
            inside("eta2_partial", eta2_partial, -f64::MIN_POSITIVE, 1.0)
        }
    }
}

/// Power of an F test of `k` conditions in `size` people, degrees of freedom times `epsilon`; `ncp` from those of the error.
fn f_power(
    (size, k, epsilon): (f64, usize, f64),
    alpha: f64,
    ncp: impl Fn(f64) -> f64,
) -> Option<f64> {
    let d1 = (k as f64 - 1.0) * epsilon;
    let d2 = d1 * (size - 1.0);
    let critical = f_quantile_upper(alpha, d1, d2)?;
    Some(1.0 - f_lower(critical, d1, d2, ncp(d2)))
}

fn power_at(question: &PowerQuestion, n: usize) -> Option<f64> {
    let (size, alpha) = (n as f64, question.alpha);
    let least = match question.test {
        PlannedTest::Pearson { .. } => 4,
        _ => 2,
    };
    if n < least {
        return None;
    }
    match question.test {
        PlannedTest::PairedT { effect } => {
            let df = size - 1.0;
            let critical = t_quantile_two_sided(alpha, df)?;
            let ncp = effect.abs() * size.sqrt();
            Some(1.0 - t_lower(critical, df, ncp) + t_lower(-critical, df, ncp))
        }
        PlannedTest::Pearson { effect } => {
            let critical = t_quantile_two_sided(alpha, size - 2.0)?;
            let limit = libm::atanh(critical / (critical * critical + size - 2.0).sqrt());
            let r = effect.abs();
            let z = libm::atanh(r) + r / (2.0 * (size - 1.0));
            let scale = (size - 3.0).sqrt();
            Some(normal_upper((limit - z) * scale) + normal_upper((limit + z) * scale))
        }
        PlannedTest::RmAnova { effect, k, corr, epsilon } => {
            let people = size * k as f64 * epsilon / (1.0 - corr);
            f_power((size, k, epsilon), alpha, |_| effect / (1.0 - effect) * people)
        }
        PlannedTest::RmAnovaPartial { eta2_partial, k, epsilon } => {
            f_power((size, k, epsilon), alpha, |d2| eta2_partial / (1.0 - eta2_partial) * d2)
        }
    }
}

fn smallest_n(question: &PowerQuestion) -> Option<usize> {
    let enough = |n: usize| power_at(question, n).is_some_and(|power| power >= 0.8);
    let mut high = 4;
    while !enough(high) {
        high *= 2;
        if high > MOST_SUBJECTS {
            return None;
        }
    }
    // Power grows with n, so halving finds the first.
    let mut low = if high == 4 { 1 } else { high / 2 };
    while high - low > 1 {
        let middle = low.midpoint(high);
        if enough(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    Some(high)
}

/// z for a two-sided interval of that confidence.
pub(crate) fn z_for(confidence: f64) -> f64 {
    normal_quantile(0.5 + 0.5 * confidence)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(test: PlannedTest, n: usize) -> PowerAnswer {
        let question = PowerQuestion { test, n, alpha: 0.05 };
        power(&[question]).unwrap().row.remove(0)
    }

    #[test]
    fn a_printed_partial_eta_squared_is_not_that_of_the_means_between_people() {
        let (k, epsilon, corr) = (4, 1.0, 0.5);
        let partial = |eta2_partial: f64, n: usize, epsilon: f64| {
            let test = PlannedTest::RmAnovaPartial { eta2_partial, k, epsilon };
            of(test, n)
        };
        let between = |effect: f64| {
            let test = PlannedTest::RmAnova { effect, k, corr, epsilon };
            of(test, 24)
        };
        // scipy.stats: ncf.sf(f.isf(.05, d1, d2), d1, d2, eta2 / (1 - eta2) * d2), d1 = 3 eps, d2 = d1 (n - 1).
        let printed = partial(0.08, 24, 1.0);
        assert!((printed.power.unwrap() - 0.493_150_534_980).abs() < 1e-9);
        assert_eq!(printed.n_for_80, Some(45));
        let few = partial(0.1, 12, 0.7).power.unwrap();
        assert!((few - 0.244_519_440_562).abs() < 1e-9);
        // Means of -.25, 0, 0 and .25 standard deviations of people; the f² of .08 by the formula at the variant.
        let f2: f64 = 0.031_25;
        let same = between(f2 / (1.0 + f2)).power.unwrap();
        assert!((same - printed.power.unwrap()).abs() < 1e-9);
        let converted = 0.08 / 0.92 * (1.0 - corr) * 3.0 * 23.0 / (24.0 * 4.0);
        assert!((converted - f2).abs() < 1e-12);
        assert!((between(0.08).power.unwrap() - 0.930_476_397_717).abs() < 1e-9);
    }

    #[test]
    fn a_correlation_that_so_many_conditions_cannot_share_is_refused() {
        let of_corr = |corr: f64| {
            let test = PlannedTest::RmAnova { effect: 0.1, k: 4, corr, epsilon: 1.0 };
            let question = PowerQuestion { test, n: 24, alpha: 0.05 };
            power(&[question])
        };
        assert!(of_corr(-0.3).is_ok());
        let refused = of_corr(-0.4).unwrap_err().to_string();
        assert!(refused.starts_with("`corr`"), "{refused}");
    }

    #[test]
    fn a_partial_eta_squared_outside_its_range_is_refused_by_name() {
        let refused = |eta2_partial: f64, epsilon: f64| {
            let test = PlannedTest::RmAnovaPartial { eta2_partial, k: 4, epsilon };
            let question = PowerQuestion { test, n: 24, alpha: 0.05 };
            power(&[question]).unwrap_err().to_string()
        };
        assert!(refused(1.0, 1.0).starts_with("`eta2_partial`"));
        assert!(refused(0.1, 0.2).starts_with("`epsilon`"));
    }
}
