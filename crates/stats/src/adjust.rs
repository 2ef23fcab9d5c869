//! Corrections for testing several hypotheses at once.

use serde::{Deserialize, Serialize};

use crate::StatsError;

/// How p values of one family are corrected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Adjustment {
    /// Holm (1979): step-down Bonferroni, valid whatever the dependence.
    #[default]
    Holm,
    /// Bonferroni: p times the number of tests.
    Bonferroni,
    /// Hochberg (1988): step-up, valid for independent or positively dependent tests.
    Hochberg,
    /// Benjamini and Hochberg (1995): the false discovery rate.
    Bh,
    /// As they are.
    None,
}

/// The four corrections of one family, each of shape `(m,)` in the order given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Adjusted {
    /// Holm's step-down correction.
    pub holm: Vec<f64>,
    /// Bonferroni's.
    pub bonferroni: Vec<f64>,
    /// Hochberg's step-up correction.
    pub hochberg: Vec<f64>,
    /// Benjamini and Hochberg's false discovery rate.
    pub bh: Vec<f64>,
}

/// Corrects a family of p values in all four ways.
///
/// # Errors
/// [`StatsError::BadParameter`] if a p value is outside 0 to 1.
///
/// # Source
/// Holm (1979), Hochberg (1988), Benjamini and Hochberg (1995); as R's `p.adjust`.
///
/// # Example
/// ```
/// let all = maveric_stats::adjust(&[0.01, 0.04, 0.03])?;
/// assert_eq!(all.holm, [0.03, 0.06, 0.06]);
/// assert_eq!(all.bh, [0.03, 0.04, 0.04]);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn adjust(p: &[f64]) -> Result<Adjusted, StatsError> {
    if let Some(&found) = p.iter().find(|p| !(0.0..=1.0).contains(*p)) {
        return Err(StatsError::parameter("p", "from 0 to 1", found));
    }
    Ok(Adjusted {
        holm: Adjustment::Holm.apply(p),
        bonferroni: Adjustment::Bonferroni.apply(p),
        hochberg: Adjustment::Hochberg.apply(p),
        bh: Adjustment::Bh.apply(p),
    })
}

impl Adjustment {
    /// The corrected p values, in the order given, each from 0 to 1.
    pub fn apply(self, p: &[f64]) -> Vec<f64> {
        let m = p.len();
        let mut order: Vec<usize> = (0..m).collect();
        order.sort_by(|&a, &b| p[a].total_cmp(&p[b]));
        let mut adjusted = p.to_vec();
        let factor = |position: usize| match self {
            Self::Holm | Self::Hochberg => (m - position) as f64,
            Self::Bonferroni => m as f64,
            Self::Bh => m as f64 / (position + 1) as f64,
            Self::None => 1.0,
        };
        let mut running = if matches!(self, Self::Hochberg | Self::Bh) { 1.0 } else { 0.0 };
        for step in 0..m {
            let position = match self {
                Self::Hochberg | Self::Bh => m - 1 - step,
                _ => step,
            };
            let i = order[position];
            let scaled = (p[i] * factor(position)).min(1.0);
            adjusted[i] = match self {
                Self::Holm => {
                    running = scaled.max(running);
                    running
                }
                Self::Hochberg | Self::Bh => {
                    running = scaled.min(running);
                    running
                }
                Self::Bonferroni | Self::None => scaled,
            };
        }
        adjusted
    }

    /// Corrects the p values of one family of tests in their places.
    pub(crate) fn correct<'t, T: 't>(
        self,
        tests: impl IntoIterator<Item = &'t mut T>,
        p: impl Fn(&T) -> Option<f64>,
        write: impl Fn(&mut T, Option<f64>),
    ) {
        let tests: Vec<&mut T> = tests.into_iter().collect();
        let raw: Vec<Option<f64>> = tests.iter().map(|test| p(test)).collect();
        for (test, p) in tests.into_iter().zip(self.apply_defined(&raw)) {
            write(test, p);
        }
    }

    /// Corrects those p values that exist; the others are no part of the family.
    pub fn apply_defined(self, p: &[Option<f64>]) -> Vec<Option<f64>> {
        let defined: Vec<f64> = p.iter().copied().flatten().collect();
        let mut adjusted = self.apply(&defined).into_iter();
        p.iter().map(|p| p.and_then(|_| adjusted.next())).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_p_is_no_part_of_the_family() {
        let adjusted = Adjustment::Holm.apply_defined(&[Some(0.01), None, Some(0.02)]);
        assert_eq!(adjusted, [Some(0.02), None, Some(0.02)]);
    }
}
