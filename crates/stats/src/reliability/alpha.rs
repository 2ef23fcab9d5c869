//! Cronbach's alpha.

use serde::{Deserialize, Serialize};

use super::omega;
use crate::{
    BootstrapData, BootstrapSettings, Interval, Reasons, Statistic, StatsError, bootstrap,
    complete, correlation,
    numerics::{
        distributions::f_quantile_upper,
        moments::{centred, is_constant, mean_and_square_sum},
    },
};

/// Cronbach's alpha in its variants.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Alpha {
    /// k/(k-1) (1 - Σ item variances / variance of the sum), complete respondents.
    pub raw: Option<f64>,
    /// k r̄ / (1 + (k-1) r̄).
    pub standardized: Option<f64>,
    /// r̄, the mean correlation of two items.
    pub mean_r: Option<f64>,
    /// The 95 % interval of `raw`: Feldt's, or where people answered several sheets each the BCa
    /// interval of a bootstrap that draws whole people (percentiles where BCa does not exist).
    #[serde(flatten, with = "crate::interval::ci")]
    pub ci: Interval,
    /// `raw` from pairwise covariances, the default of psych and pingouin.
    pub raw_pairwise: Option<f64>,
    /// `standardized` from pairwise covariances.
    pub standardized_pairwise: Option<f64>,
    /// McDonald's ω of one factor (least-squares loadings of the correlations).
    pub omega: Option<f64>,
}

/// Alpha of the other items.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ItemDropped {
    /// The item left out.
    pub name: String,
    /// `raw` of the others.
    pub alpha: Option<f64>,
}

/// One item and the rest of the scale.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ItemStatistics {
    /// The item.
    pub name: String,
    /// Mean of complete respondents.
    pub mean: f64,
    /// Standard deviation of complete respondents.
    pub sd: f64,
    /// Correlation with the sum of the others.
    pub r_drop: Option<f64>,
}

/// Reliability of a scale, with each item's part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AlphaAnalysis {
    /// Complete respondents.
    pub n: usize,
    /// Items.
    pub k: usize,
    /// Respondents left out because an answer is missing.
    pub missing: usize,
    /// People, where some answered several sheets.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub people: Option<usize>,
    /// Alpha of all items.
    pub alpha: Alpha,
    /// Alpha without each item, in their order.
    pub drop: Vec<ItemDropped>,
    /// Each item, in order.
    pub item: Vec<ItemStatistics>,
    /// Items that do not vary or look reverse keyed.
    pub warnings: Vec<String>,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// Cronbach's alpha of items, each a column of shape `(respondents,)`; respondents with a
/// missing answer are left out.
///
/// Give `people` where the sheets belong to people: if one answered several, the sheets are not independent and the
/// interval is that of a bootstrap over people, 10,000 resamples from a fixed seed; Feldt's would be too narrow.
///
/// # Errors
/// [`StatsError::LengthMismatch`]; [`StatsError::DoubleName`]; [`StatsError::NotFinite`];
/// [`StatsError::TooFew`] below two items or two complete respondents.
///
/// # Source
/// Cronbach (1951); interval of Feldt, Woodruff and Salih (1987), which holds for independent sheets. psych and pingouin use
/// pairwise covariances by default: `raw_pairwise`.
///
/// # Example
/// ```
/// let items = [[2.0, 4.0, 3.0, 5.0].map(Some), [1.0, 5.0, 3.0, 4.0].map(Some)];
/// let columns: Vec<(&str, &[Option<f64>])> = vec![("a", &items[0]), ("b", &items[1])];
/// let result = maveric_stats::alpha(&columns, None)?;
/// assert!((result.alpha.raw.unwrap() - 8.0 / 9.0).abs() < 1e-12);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn alpha(
    items: &[(&str, &[Option<f64>])],
    people: Option<&[String]>,
) -> Result<AlphaAnalysis, StatsError> {
    complete::enough("item", items.len(), 0, 2)?;
    let names: Vec<&str> = items.iter().map(|(name, _)| *name).collect();
    StatsError::distinct("item", &names)?;
    let complete = complete::rows(items, "respondent", 2)?;
    let columns = &complete.columns;
    let (n, k) = (columns[0].len(), columns.len());
    let covariances = covariance_matrix(columns);
    let mut undefined = Reasons::default();
    let mut warnings = Vec::new();
    let all_items: Vec<usize> = (0..k).collect();
    let raw = raw_alpha(&covariances, &all_items);
    let item = item_statistics(items, columns, &mut undefined, &mut warnings);
    let drop = items
        .iter()
        .enumerate()
        .map(|(i, (name, _))| {
            let others: Vec<usize> = (0..k).filter(|&j| j != i).collect();
            let alpha = raw_alpha(&covariances, &others);
            if alpha.is_none() {
                let reason = "fewer than two items that vary are left";
                undefined.note(&format!("drop.{i}.alpha"), reason);
            }
            ItemDropped { name: (*name).to_owned(), alpha }
        })
        .collect();
    let mean_r = mean_correlation(&covariances);
    let several = several_sheets(people, &complete)?;
    let interval = match (several, people) {
        (Some(count), Some(people)) => {
            warnings.push(format!(
                "{n} sheets come from {count} people: the interval of alpha is a bootstrap over people"
            ));
            by_person(items, people)?
        }
        _ => raw.and_then(|raw| feldt(raw, n as f64, k as f64)),
    };
    let pairwise = pairwise_matrix(items);
    let omega = omega::total(&covariances);
    let standardized = |r: f64| k as f64 * r / (1.0 + (k as f64 - 1.0) * r);
    let alpha = Alpha {
        raw,
        standardized: mean_r.map(standardized).filter(|a| a.is_finite()),
        mean_r,
        ci: interval.into(),
        raw_pairwise: pairwise.as_ref().and_then(|m| raw_alpha(m, &all_items)),
        standardized_pairwise: pairwise
            .as_ref()
            .and_then(|m| mean_correlation(m))
            .map(standardized)
            .filter(|a| a.is_finite()),
        omega,
    };
    say_why(&alpha, k, &mut undefined);
    Ok(AlphaAnalysis {
        n,
        k,
        missing: complete.missing,
        people: several,
        alpha,
        drop,
        item,
        warnings,
        undefined,
    })
}

/// How many people there are, where one of them answered several complete sheets.
fn several_sheets(
    people: Option<&[String]>,
    complete: &complete::Complete,
) -> Result<Option<usize>, StatsError> {
    let Some(people) = people else {
        return Ok(None);
    };
    let expected = complete.kept.len() + complete.missing;
    StatsError::same_length("people", people.len(), expected)?;
    let distinct: std::collections::BTreeSet<_> =
        complete.kept.iter().map(|&row| &people[row]).collect();
    Ok((distinct.len() < complete.kept.len()).then_some(distinct.len()))
}

/// The bootstrap interval over people; `None` where most resamples have no alpha, or one person answered everything.
fn by_person(
    items: &[(&str, &[Option<f64>])],
    people: &[String],
) -> Result<Option<(f64, f64)>, StatsError> {
    let data = BootstrapData::Sheets { items, people };
    match bootstrap(Statistic::Alpha, data, &BootstrapSettings::default()) {
        Ok(resampled) => {
            let ends = |i: &Interval| i.low.zip(i.high);
            Ok(ends(&resampled.bca).or_else(|| ends(&resampled.percentile)))
        }
        Err(StatsError::TooFew { .. }) => Ok(None),
        Err(other) => Err(other),
    }
}

fn say_why(alpha: &Alpha, k: usize, undefined: &mut Reasons) {
    let constant = "an item does not vary, so it has no correlations";
    let standardized = if alpha.mean_r.is_some() {
        "the standardised items cancel each other: their sum does not vary"
    } else {
        constant
    };
    for (name, value, reason) in [
        ("alpha.raw", alpha.raw, "the sum of the items does not vary"),
        ("alpha.mean_r", alpha.mean_r, constant),
        ("alpha.standardized", alpha.standardized, standardized),
        (
            "alpha.raw_pairwise",
            alpha.raw_pairwise,
            "two items have fewer than two respondents in common, or nothing varies",
        ),
        (
            "alpha.standardized_pairwise",
            alpha.standardized_pairwise,
            "two items have fewer than two respondents in common, an item does not vary, or the items cancel each other",
        ),
    ] {
        if value.is_none() {
            undefined.note(name, reason);
        }
    }
    if alpha.ci.low.is_none() {
        let reason =
            "there is no alpha to put an interval around, or one person answered all sheets";
        undefined.note_ends(&["alpha.ci"], reason);
    }
    if alpha.omega.is_none() {
        let reason = if k < 3 {
            "one factor needs at least three items"
        } else {
            "the one-factor model has no proper solution for these items"
        };
        undefined.note("alpha.omega", reason);
    }
}

fn item_statistics(
    items: &[(&str, &[Option<f64>])],
    columns: &[Vec<f64>],
    undefined: &mut Reasons,
    warnings: &mut Vec<String>,
) -> Vec<ItemStatistics> {
    let n = columns[0].len();
    let mut statistics = Vec::with_capacity(items.len());
    // Sums of centred items, so that an offset costs no digits.
    let centred: Vec<Vec<f64>> = columns.iter().map(|c| centred(c)).collect();
    for (i, (name, _)) in items.iter().enumerate() {
        let rest: Vec<f64> = (0..n)
            .map(|row| {
                let others = centred.iter().enumerate().filter(|(j, _)| *j != i);
                others.map(|(_, column)| column[row]).sum()
            })
            .collect();
        let r_drop = correlation::coefficient(&columns[i], &rest);
        if r_drop.is_none() {
            let reason = "the item, or the sum of the others, does not vary";
            undefined.note(&format!("item.{i}.r_drop"), reason);
        }
        if is_constant(&columns[i]) {
            warnings.push(format!("item {name} does not vary"));
        }
        // What is written as -0.00 goes against nothing.
        if let Some(r) = r_drop.filter(|r| *r <= -0.005) {
            warnings.push(format!(
                "item {name} goes against the others (r = {r:.2}): is it reverse keyed?"
            ));
        }
        let (mean, squares) = mean_and_square_sum(columns[i].iter().copied());
        statistics.push(ItemStatistics {
            name: (*name).to_owned(),
            mean,
            sd: (squares / (n as f64 - 1.0)).sqrt(),
            r_drop,
        });
    }
    statistics
}

fn covariance(a: &[f64], b: &[f64]) -> f64 {
    let product: f64 = centred(a).iter().zip(centred(b)).map(|(x, y)| x * y).sum();
    product / (a.len() as f64 - 1.0)
}

fn covariance_matrix(columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
    columns.iter().map(|a| columns.iter().map(|b| covariance(a, b)).collect()).collect()
}

/// Covariances over the respondents who answered both items.
fn pairwise_matrix(items: &[(&str, &[Option<f64>])]) -> Option<Vec<Vec<f64>>> {
    let pair = |a: &[Option<f64>], b: &[Option<f64>]| {
        let both: Vec<(f64, f64)> =
            a.iter().zip(b).filter_map(|(a, b)| Some(((*a)?, (*b)?))).collect();
        let (a, b): (Vec<f64>, Vec<f64>) = both.into_iter().unzip();
        (a.len() > 1).then(|| covariance(&a, &b))
    };
    items.iter().map(|(_, a)| items.iter().map(|(_, b)| pair(a, b)).collect()).collect()
}

fn raw_alpha(covariances: &[Vec<f64>], items: &[usize]) -> Option<f64> {
    let k = items.len() as f64;
    let trace: f64 = items.iter().map(|&i| covariances[i][i]).sum();
    let total: f64 =
        items.iter().map(|&i| items.iter().map(|&j| covariances[i][j]).sum::<f64>()).sum();
    (items.len() > 1 && total > 1e-14 * trace && total > 0.0)
        .then(|| k / (k - 1.0) * (1.0 - trace / total))
}

fn mean_correlation(covariances: &[Vec<f64>]) -> Option<f64> {
    let k = covariances.len();
    let mut sum = 0.0;
    for i in 0..k {
        for j in 0..i {
            let scale = covariances[i][i].sqrt() * covariances[j][j].sqrt();
            if scale <= 0.0 {
                return None;
            }
            sum += covariances[i][j] / scale;
        }
    }
    Some(sum / (0.5 * (k * (k - 1)) as f64))
}

fn feldt(alpha: f64, n: f64, k: f64) -> Option<(f64, f64)> {
    let (d1, d2) = (n - 1.0, (n - 1.0) * (k - 1.0));
    let high = f_quantile_upper(0.025, d1, d2)?;
    let low = f_quantile_upper(0.975, d1, d2)?;
    Some((1.0 - (1.0 - alpha) * high, 1.0 - (1.0 - alpha) * low))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sheets of people who answer alike each time: four sheets of a person say little more than one.
    fn repeated(times: usize) -> (Vec<Vec<Option<f64>>>, Vec<String>) {
        let own = [
            [1.0, 2.0, 1.0],
            [4.0, 5.0, 5.0],
            [3.0, 2.0, 3.0],
            [5.0, 4.0, 5.0],
            [2.0, 2.0, 1.0],
            [3.0, 4.0, 2.0],
        ];
        let sheets = (0..times).flat_map(|_| own.iter().zip(0..));
        let people = sheets.clone().map(|(_, who): (_, i32)| who.to_string()).collect();
        let column = |j: usize| sheets.clone().map(|(row, _)| Some(row[j])).collect();
        ((0..3).map(column).collect(), people)
    }

    fn interval(times: usize, by_person: bool) -> (f64, f64) {
        let (columns, people) = repeated(times);
        let items: Vec<(&str, &[Option<f64>])> =
            ["a", "b", "c"].into_iter().zip(columns.iter().map(Vec::as_slice)).collect();
        let found = alpha(&items, by_person.then_some(&people[..])).unwrap();
        assert_eq!(found.people, (by_person && times > 1).then_some(6));
        (found.alpha.ci.low.unwrap(), found.alpha.ci.high.unwrap())
    }

    #[test]
    fn copies_of_a_sheet_do_not_narrow_the_interval_over_people() {
        let width = |(low, high): (f64, f64)| high - low;
        let (once, naive, people) = (interval(1, true), interval(8, false), interval(8, true));
        assert!(width(naive) < 0.5 * width(once), "{naive:?} {once:?}");
        assert!(width(people) > 1.5 * width(naive), "{people:?} {naive:?}");
        assert!(people.0 < 0.85 && people.1 > 0.92, "{people:?}");
    }

    #[test]
    fn an_item_that_goes_against_the_others_is_named_and_one_beside_them_is_not() {
        let warned = |b: [f64; 4]| {
            let columns = [[1.0, 2.0, 3.0, 4.0], b].map(|item| item.map(Some).to_vec());
            let items: Vec<(&str, &[Option<f64>])> =
                ["a", "b"].into_iter().zip(columns.iter().map(Vec::as_slice)).collect();
            alpha(&items, None).unwrap().warnings.len()
        };
        // Its covariance is exactly 0, and rounding may leave it below.
        assert_eq!(warned([0.1, 0.3, 0.3, 0.1]), 0);
        assert_eq!(warned([4.0, 3.0, 2.5, 1.0]), 2);
    }

    #[test]
    fn people_of_another_number_of_sheets_are_refused() {
        let (columns, people) = repeated(2);
        let items: Vec<(&str, &[Option<f64>])> =
            ["a", "b", "c"].into_iter().zip(columns.iter().map(Vec::as_slice)).collect();
        let error = alpha(&items, Some(&people[1..])).unwrap_err();
        assert!(matches!(error, StatsError::LengthMismatch { found: 11, expected: 12, .. }));
    }
}
