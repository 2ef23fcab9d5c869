//! Whether groups vary alike.

use serde::{Deserialize, Serialize};

use crate::{
    Reasons, StatsError, complete,
    normality::quantile,
    numerics::{
        distributions::{chi2_upper, f_upper},
        moments::{is_rounding, largest, mean_and_square_sum},
    },
    within_subjects::Index,
};

/// An analysis of variance of distances from the centre of each group.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Levene {
    /// F of the distances.
    #[serde(rename = "F")]
    pub f: Option<f64>,
    /// P(F' ≥ F).
    pub p: Option<f64>,
    /// Groups less 1.
    pub df1: usize,
    /// Values less groups.
    pub df2: usize,
}

/// Bartlett's test; it mistakes heavy tails for unequal variances.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Bartlett {
    /// Bartlett's corrected statistic, χ² with `df`.
    #[serde(rename = "K2")]
    pub k2: Option<f64>,
    /// P(χ² ≥ K²).
    pub p: Option<f64>,
    /// Groups less 1.
    pub df: usize,
}

/// Three tests of equal variances.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct VarianceTests {
    /// Values.
    pub n: usize,
    /// Groups.
    pub k: usize,
    /// Rows left out because the value is missing.
    pub missing: usize,
    /// Levene (1960): distances from the mean.
    pub levene_mean: Levene,
    /// Brown and Forsythe (1974): distances from the median.
    pub levene_median: Levene,
    /// Bartlett (1937).
    pub bartlett: Bartlett,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// Tests whether the groups named beside the values (both of shape `(rows,)`) vary alike.
///
/// # Errors
/// [`StatsError::LengthMismatch`]; [`StatsError::NotFinite`]; [`StatsError::TooFew`] below
/// two groups or if no group has two values.
///
/// # Source
/// Levene (1960), Brown and Forsythe (1974), Bartlett (1937); as R's `car::leveneTest` and
/// `bartlett.test`.
///
/// # Example
/// Weights of plants under three treatments (Dobson, 1983; R's `PlantGrowth`):
/// ```
/// let weights = [
///     [4.17, 5.58, 5.18, 6.11, 4.50, 4.61, 5.17, 4.53, 5.33, 5.14],
///     [4.81, 4.17, 4.41, 3.59, 5.87, 3.83, 6.03, 4.89, 4.32, 4.69],
///     [6.31, 5.12, 5.54, 5.50, 5.37, 5.29, 4.92, 6.15, 5.80, 5.26],
/// ];
/// let groups: Vec<String> = (0..30).map(|i| format!("treatment {}", i / 10)).collect();
/// let values: Vec<_> = weights.concat().into_iter().map(Some).collect();
/// let tests = maveric_stats::levene(&groups, &values)?;
/// assert!((tests.levene_median.f.unwrap() - 1.1192).abs() < 5e-5);
/// assert!((tests.bartlett.k2.unwrap() - 2.8786).abs() < 5e-5);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn levene(groups: &[String], values: &[Option<f64>]) -> Result<VarianceTests, StatsError> {
    StatsError::same_length("group", groups.len(), values.len())?;
    let complete = complete::rows(&[("value", values)], "value", 2)?;
    let index = Index::from_labels(complete.kept.iter().map(|&row| &groups[row]));
    // From the first value on, so that an offset costs no digits of the distances.
    let pivot = complete.columns[0][0];
    let mut samples = vec![Vec::new(); index.names.len()];
    for (&group, &value) in index.rows.iter().zip(&complete.columns[0]) {
        samples[group].push(value - pivot);
    }
    complete::enough("group", samples.len(), 0, 2)?;
    let largest = samples.iter().map(Vec::len).max().unwrap_or(0);
    complete::enough("value in the largest group", largest, complete.missing, 2)?;
    let mut undefined = Reasons::default();
    let median = |sample: &[f64]| {
        let mut sorted = sample.to_vec();
        sorted.sort_by(f64::total_cmp);
        quantile(&sorted, 0.5)
    };
    let mean = |sample: &[f64]| mean_and_square_sum(sample.iter().copied()).0;
    let levene_mean = distances(&samples, mean);
    let levene_median = distances(&samples, median);
    for (name, test) in [("levene_mean", &levene_mean), ("levene_median", &levene_median)] {
        if test.f.is_none() {
            let reason = "the distances do not vary within groups";
            undefined.note_below(name, &["F", "p"], reason);
        }
    }
    let bartlett = bartlett(&samples);
    if bartlett.k2.is_none() {
        undefined.note_all(&["bartlett.K2", "bartlett.p"], "a group has no variance");
    }
    Ok(VarianceTests {
        n: complete.kept.len(),
        k: samples.len(),
        missing: complete.missing,
        levene_mean,
        levene_median,
        bartlett,
        undefined,
    })
}

fn distances(samples: &[Vec<f64>], centre: impl Fn(&[f64]) -> f64) -> Levene {
    let groups: Vec<Vec<f64>> = samples
        .iter()
        .map(|sample| {
            let centre = centre(sample);
            sample.iter().map(|v| (v - centre).abs()).collect()
        })
        .collect();
    let n: usize = groups.iter().map(Vec::len).sum();
    let (df1, df2) = (groups.len() - 1, n - groups.len());
    let (grand, _) = mean_and_square_sum(groups.iter().flatten().copied());
    let scale = largest(&samples.concat());
    let alike = |group: &Vec<f64>| group.iter().all(|z| is_rounding(z - group[0], scale));
    let varies = !groups.iter().all(alike);
    let (mut between, mut within) = (0.0, 0.0);
    for group in &groups {
        let (mean, squares) = mean_and_square_sum(group.iter().copied());
        between += group.len() as f64 * (mean - grand) * (mean - grand);
        within += squares;
    }
    let f = varies.then(|| (between / df1 as f64) / (within / df2 as f64));
    Levene { f, p: f.map(|f| f_upper(f, df1 as f64, df2 as f64)), df1, df2 }
}

fn bartlett(samples: &[Vec<f64>]) -> Bartlett {
    let groups = samples.len() as f64;
    let (mut pooled, mut logs, mut inverse, mut total) = (0.0, 0.0, 0.0, 0.0);
    let mut varied = true;
    for sample in samples {
        let freedom = sample.len() as f64 - 1.0;
        let (_, squares) = mean_and_square_sum(sample.iter().copied());
        varied &= freedom > 0.0 && squares > 0.0;
        pooled += squares;
        logs += freedom * libm::log(squares / freedom);
        inverse += 1.0 / freedom;
        total += freedom;
    }
    let k2 = varied.then(|| {
        let correction = 1.0 + (inverse - 1.0 / total) / (3.0 * (groups - 1.0));
        (total * libm::log(pooled / total) - logs) / correction
    });
    Bartlett { k2, p: k2.map(|k2| chi2_upper(k2, groups - 1.0)), df: samples.len() - 1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_offset_moves_none_of_the_three_tests() {
        let groups: Vec<String> = (0..12).map(|i| format!("g{}", i % 3)).collect();
        let at = |offset: f64| {
            let values: Vec<_> =
                (0..12).map(|i| Some(offset + f64::from(i * i % 17) * 0.25)).collect();
            levene(&groups, &values).unwrap()
        };
        let (near, far) = (at(0.0), at(1e12));
        for (a, b) in [
            (near.levene_mean.f, far.levene_mean.f),
            (near.levene_median.f, far.levene_median.f),
            (near.bartlett.k2, far.bartlett.k2),
        ] {
            assert!((a.unwrap() / b.unwrap() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn distances_that_do_not_vary_have_no_f() {
        let groups = ["a", "a", "b", "b"].map(str::to_owned);
        let tests = levene(&groups, &[0.1, 0.3, 0.2, 0.7].map(Some)).unwrap();
        assert_eq!(tests.levene_mean.f, None);
        assert!(tests.undefined.get("levene_mean.F").is_some());
    }
}
