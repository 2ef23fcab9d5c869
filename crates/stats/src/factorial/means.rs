//! Marginal means, their differences, and simple effects, from the multivariate model.

use serde::{Deserialize, Serialize};

use super::{
    Effect,
    cells::{Cells, Rows, average, contrasts, difference, level, products},
};
use crate::{
    Interval, Named, Reasons,
    numerics::{
        distributions::{f_upper, t_quantile_two_sided, t_two_sided},
        matrix::Matrix,
        moments::dot,
    },
    within_subjects::pairs,
};

/// A mean over cells with equal weight.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MarginalMean {
    /// In the unit of the values.
    pub mean: f64,
    /// Its standard error.
    pub se: f64,
    /// Its 95 % interval.
    #[serde(flatten, with = "crate::interval::ci")]
    pub ci: Interval,
}

/// The difference of two marginal means, A minus B.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CellContrast {
    /// The difference.
    pub estimate: f64,
    /// Its standard error.
    pub se: f64,
    /// estimate / se, with n - groups degrees of freedom.
    pub t: Option<f64>,
    /// Two-sided.
    pub p: Option<f64>,
    /// Holm's correction over the pairs beside it.
    pub p_holm: Option<f64>,
    /// Its 95 % interval, not adjusted.
    #[serde(flatten, with = "crate::interval::ci")]
    pub ci: Interval,
}

/// The effect of one factor at one level of another, averaged over all others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SimpleEffect {
    /// Wald's statistic over `df1`. Within subjects, of more than two levels, it follows F only approximately.
    #[serde(rename = "F")]
    pub f: Option<f64>,
    /// Levels less 1.
    pub df1: usize,
    /// n - groups.
    pub df2: usize,
    /// P(F' ≥ F), as emmeans' `joint_tests`.
    pub p: Option<f64>,
    /// Hotelling's test, of a factor within subjects of more than two levels.
    #[serde(flatten)]
    pub exact: Option<ExactTest>,
    /// Its pairs of levels.
    #[serde(flatten)]
    pub pairs: Named<CellContrast>,
}

/// Hotelling's exact test of the same hypothesis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ExactTest {
    /// F (N - df1 + 1) / N, N = n - groups.
    #[serde(rename = "F_exact")]
    pub f: Option<f64>,
    /// N - df1 + 1; 0 if there are none.
    #[serde(rename = "df2_exact")]
    pub df2: usize,
    /// P(F' ≥ F_exact).
    #[serde(rename = "p_exact")]
    pub p: Option<f64>,
}

const NO_ERROR: &str = "the combination does not vary between subjects, so it has no error";
const NO_QUANTILE: &str = "t has no quantile at these degrees of freedom";

/// Weights of each factor, those between subjects first.
type Parts = Vec<Rows>;

pub(super) struct Means<'a> {
    cells: &'a Cells<'a>,
    /// Levels of each factor.
    counts: Vec<usize>,
    t95: Option<f64>,
}

impl<'a> Means<'a> {
    pub(super) fn new(cells: &'a Cells<'a>) -> Self {
        let factors = cells.design.factors();
        Self {
            cells,
            counts: factors.iter().map(|f| f.levels.len()).collect(),
            t95: t_quantile_two_sided(0.05, cells.freedom as f64),
        }
    }

    /// Weights of groups and of cells.
    fn split(&self, parts: &Parts) -> (Rows, Rows) {
        let (between, within) = parts.split_at(self.cells.design.between.len());
        (products(between), products(within))
    }

    fn averages(&self) -> Parts {
        self.counts.iter().map(|&k| average(k)).collect()
    }

    /// A single combination and its standard error.
    fn estimate(&self, parts: &Parts) -> (f64, f64) {
        let (groups, cells) = self.split(parts);
        let variance = self.cells.error_square(&cells[0]) / self.cells.freedom as f64;
        let mean = self.cells.mean(&groups[0], &cells[0]);
        (mean, (variance * self.cells.spread(&groups[0])).sqrt())
    }

    pub(super) fn marginal(&self, undefined: &mut Reasons) -> Named<Named<MarginalMean>> {
        if self.t95.is_none() {
            undefined.note("emm", NO_QUANTILE);
        }
        let design = self.cells.design;
        let factors = design.factors();
        let of_effect = |effect: Effect| {
            let inside: Vec<usize> = effect.factors().collect();
            let count = inside.iter().map(|f| self.counts[*f]).product();
            let of_cell = |cell: usize| {
                let mut parts = self.averages();
                let mut names = Vec::new();
                let mut rest = cell;
                for &f in inside.iter().rev() {
                    let position = rest % self.counts[f];
                    rest /= self.counts[f];
                    parts[f] = level(self.counts[f], position);
                    names.push(factors[f].levels[position].as_str());
                }
                names.reverse();
                let (mean, se) = self.estimate(&parts);
                let mean = self.cells.pivot + mean;
                let half = self.t95.map(|t| t * se);
                let marginal = MarginalMean { mean, se, ci: Interval::around(mean, half) };
                (names.join(":"), marginal)
            };
            (effect.name(design), (0..count).map(of_cell).collect())
        };
        Effect::all(design).into_iter().map(of_effect).collect()
    }

    pub(super) fn contrasts(&self, undefined: &mut Reasons) -> Named<Named<CellContrast>> {
        let design = self.cells.design;
        let of_factor = |(f, factor): (usize, &&super::Factor)| {
            let name = format!("contrast.{}", factor.name);
            let pairs = self.pairs(f, &self.averages(), &name, undefined);
            (factor.name.clone(), pairs)
        };
        design.factors().iter().enumerate().map(of_factor).collect()
    }

    /// All pairs of levels of factor `f`, the others weighted by `parts`.
    fn pairs(
        &self,
        f: usize,
        parts: &Parts,
        prefix: &str,
        undefined: &mut Reasons,
    ) -> Named<CellContrast> {
        let levels = &self.cells.design.factors()[f].levels;
        let mut parts = parts.clone();
        let of_pair = |(a, b, name): (usize, usize, String)| {
            parts[f] = difference(levels.len(), a, b);
            let (estimate, se) = self.estimate(&parts);
            let some = se > 0.0;
            if !some {
                let parts = ["t", "p", "p_holm"];
                undefined.note_below(&format!("{prefix}.{name}"), &parts, NO_ERROR);
            }
            if self.t95.is_none() {
                undefined.note(&format!("{prefix}.{name}"), NO_QUANTILE);
            }
            let t = some.then(|| estimate / se);
            let half = self.t95.map(|t| t * se);
            let contrast = CellContrast {
                estimate,
                se,
                t,
                p: t.map(|t| t_two_sided(t, self.cells.freedom as f64)),
                p_holm: None,
                ci: Interval::around(estimate, half),
            };
            (name, contrast)
        };
        let pairs: Named<CellContrast> = pairs(levels).into_iter().map(of_pair).collect();
        pairs.with_holm(|c| c.p, |c, p| c.p_holm = p)
    }

    pub(super) fn simple(&self, undefined: &mut Reasons) -> Named<Named<SimpleEffect>> {
        let design = self.cells.design;
        let factors = design.factors();
        let two: Vec<(Effect, usize, usize)> = Effect::all(design)
            .into_iter()
            .filter(|effect| effect.0.count_ones() == 2)
            .map(|effect| {
                let first = effect.0.trailing_zeros() as usize;
                let last = usize::BITS as usize - 1 - effect.0.leading_zeros() as usize;
                (effect, first, last)
            })
            .collect();
        let mut by_term = Vec::new();
        for (effect, first, last) in two {
            let name = effect.name(design);
            let mut effects = Vec::new();
            for (target, held) in [(first, last), (last, first)] {
                for (i, held_level) in factors[held].levels.iter().enumerate() {
                    let key = format!("{}@{held_level}", factors[target].name);
                    let mut parts = self.averages();
                    parts[held] = level(self.counts[held], i);
                    let prefix = format!("simple.{name}.{key}");
                    effects.push((key, self.simple_effect(target, &parts, &prefix, undefined)));
                }
            }
            by_term.push((name, effects.into_iter().collect()));
        }
        by_term.into_iter().collect()
    }

    fn simple_effect(
        &self,
        target: usize,
        parts: &Parts,
        prefix: &str,
        undefined: &mut Reasons,
    ) -> SimpleEffect {
        let pairs = self.pairs(target, parts, prefix, undefined);
        let mut parts = parts.clone();
        parts[target] = contrasts(self.counts[target]);
        let is_within = target >= self.cells.design.between.len();
        let (df1, df2) = (self.counts[target] - 1, self.cells.freedom);
        let f = if is_within { self.wald_within(&parts) } else { self.wald_between(&parts) };
        if f.is_none() {
            let reason = if df2 < df1 && is_within {
                "fewer degrees of freedom than contrasts: their covariance is singular"
            } else {
                "the contrasts do not vary between subjects, or one determines the others"
            };
            undefined.note_below(prefix, &["F", "p", "F_exact", "p_exact"], reason);
        }
        let p = f.map(|f| f_upper(f, df1 as f64, df2 as f64));
        let exact = (is_within && df1 > 1).then(|| {
            let left = (df2 + 1).saturating_sub(df1);
            let f = f.map(|f| f * left as f64 / df2 as f64);
            let p = f.map(|f| f_upper(f, df1 as f64, left as f64));
            ExactTest { f, df2: left, p }
        });
        SimpleEffect { f, df1, df2, p, exact, pairs }
    }

    /// Contrasts of groups at one combination of cells.
    fn wald_between(&self, parts: &Parts) -> Option<f64> {
        let (groups, cells) = self.split(parts);
        let variance = self.cells.error_square(&cells[0]) / self.cells.freedom as f64;
        let square = self.cells.hypothesis(&groups, &cells);
        (variance > 0.0).then(|| square / (groups.len() as f64 * variance))
    }

    /// Contrasts of cells at one combination of groups.
    fn wald_within(&self, parts: &Parts) -> Option<f64> {
        let (groups, cells) = self.split(parts);
        let (d, freedom) = (cells.len(), self.cells.freedom);
        if freedom < d {
            return None;
        }
        let errors: Rows = cells.iter().map(|row| self.cells.error(row)).collect();
        let square = Matrix::from(d, d, |i, j| dot(&errors[i], &errors[j]));
        let factor = square.cholesky()?;
        let theta = Matrix::from(d, 1, |i, _| self.cells.mean(&groups[0], &cells[i]));
        let half = factor.half_solve(&theta);
        let length: f64 = (0..d).map(|i| half[(i, 0)].powi(2)).sum();
        Some(length * freedom as f64 / (d as f64 * self.cells.spread(&groups[0])))
    }
}
