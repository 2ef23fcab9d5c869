//! Declared contrasts of the levels of factors.

use serde::{Deserialize, Serialize};

use super::{
    Chosen, DesignColumns, DesignTable, EffectMethod, FactorialFinding, factors::shaped,
    parts::unknown,
};
use crate::{
    FactorialDesign, Interval, StatsError, WithinSubjects,
    factorial::{SubjectCovariate, level_weights},
    groups,
    numerics::{
        distributions::{t_quantile_two_sided, t_two_sided},
        matrix::Matrix,
        moments::{centred, dot, is_rounding, mean_and_square_sum},
    },
    within,
};

/// What a contrast takes of a factor; what it does not name is averaged with equal weight.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum LevelChoice {
    /// One level less another.
    Pair([String; 2]),
    /// One level alone.
    At(String),
}

/// A contrast of levels: of one factor a difference, of two a difference of differences.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LevelContrast {
    /// Subjects in it.
    pub n: usize,
    /// The method of the effect that it is a part of, which it follows.
    pub method: EffectMethod,
    /// The contrast of the means.
    pub estimate: f64,
    /// Its standard error; none where values count by their order alone.
    pub se: Option<f64>,
    /// t; W+ of signed ranks, U of the ranks of two groups.
    pub statistic: Option<f64>,
    /// Degrees of freedom of t.
    pub df: Option<f64>,
    /// Two-sided.
    pub p: Option<f64>,
    /// The 95 % interval of the contrast, not adjusted.
    #[serde(flatten, with = "crate::interval::ci")]
    pub ci: Interval,
}

/// A contrast of levels, tested as the effect that it is a part of was: signed ranks or the ranks of two groups where ranks decided, a
/// regression where covariates entered, else a t test of each subject's contrast in which groups keep their own variances (Welch,
/// Satterthwaite); without groups that is the paired t test.
///
/// # Errors
/// [`StatsError::UnknownLevel`] for a factor or a level that the design lacks, or no pair; those of [`FactorialDesign::from_columns`].
pub fn level_contrast(
    data: &DesignColumns<'_>,
    whole: &Chosen<FactorialFinding>,
    parts: &[(&str, LevelChoice)],
) -> Result<LevelContrast, StatsError> {
    let levels = &whole.found.anova.levels;
    for (factor, choice) in parts {
        let factors = || levels.iter().map(|(name, _)| name);
        let known = levels.get(factor);
        let known = known.ok_or_else(|| unknown("a factor", factor, factors()))?;
        let wanted: &[String] = match choice {
            LevelChoice::Pair(pair) => pair,
            LevelChoice::At(level) => std::slice::from_ref(level),
        };
        if let Some(level) = wanted.iter().find(|level| !known.contains(level)) {
            let what = format!("a level of `{factor}`");
            return Err(unknown(&what, level, known.iter().map(String::as_str)));
        }
    }
    let pair = |name: &str| {
        parts.iter().find_map(|(factor, choice)| match choice {
            LevelChoice::Pair(pair) if *factor == name => Some(pair),
            _ => None,
        })
    };
    let names = levels.iter().map(|(name, _)| name);
    let effect = names.filter(|name| pair(name).is_some());
    let effect = effect.collect::<Vec<_>>().join(":");
    let test = whole.found.tests.get(&effect);
    let effects = || whole.found.tests.iter().map(|(name, _)| name);
    let method = test.ok_or_else(|| unknown("an effect", &effect, effects()))?.method;
    let held = parts.iter().filter_map(|(factor, choice)| match choice {
        LevelChoice::At(level) => Some((*factor, level)),
        LevelChoice::Pair(_) => None,
    });
    let everybody: Vec<usize> = (0..data.values.len()).collect();
    let mut part = DesignTable::rows(data, &everybody, None);
    for (factor, level) in held {
        part = DesignTable::at_level(&part.columns(), factor, level);
    }
    let columns = part.columns();
    let (design, shape, mut covariates) = shaped(&columns)?;
    let inside = shape.within.iter().enumerate();
    let inside = inside.filter(|(_, (name, _))| pair(name).is_some());
    let inside = inside.fold(0, |mask, (f, _)| mask | 1 << f);
    covariates.retain(|covariate| shape.has_covariate(inside, covariate.name));
    let (groups, cells) = level_weights(&design, &pair);
    let scores = Scores { design: &design, sides: design.weighted_sides(&cells), weights: groups };
    Ok(match method {
        EffectMethod::SignedRanks
        | EffectMethod::Friedman
        | EffectMethod::FriedmanOfDifferences => scores.by_signed_ranks(method)?,
        EffectMethod::GroupRanks => scores.by_group_ranks(method)?,
        EffectMethod::Regression => scores.by_regression(method, &covariates),
        _ => scores.by_welch(method),
    })
}

/// What the contrast is of each subject, and how the groups are weighted.
pub(super) struct Scores<'a> {
    pub(super) design: &'a FactorialDesign,
    /// Of each subject what the contrast adds, and what it takes away.
    pub(super) sides: Vec<[f64; 2]>,
    pub(super) weights: Vec<f64>,
}

/// Least squares of subjects' scores.
struct Fit {
    estimate: f64,
    /// By how much the estimate goes up with each subject's score.
    shares: Vec<f64>,
    /// What is left of each score.
    left: Vec<f64>,
    df: f64,
}

impl Scores<'_> {
    fn of_people(&self) -> Vec<f64> {
        self.sides.iter().map(|[plus, minus]| plus - minus).collect()
    }

    fn of_group(&self, group: usize) -> Vec<f64> {
        let people = self.of_people().into_iter().zip(self.design.group());
        people.filter(|(_, g)| **g == group).map(|(s, _)| s).collect()
    }

    /// Without a test.
    fn plain(&self, method: EffectMethod) -> LevelContrast {
        let means = (0..self.weights.len()).map(|g| {
            let scores = self.of_group(g);
            self.weights[g] * mean_and_square_sum(scores.iter().copied()).0
        });
        let counted = self.design.group().iter();
        LevelContrast {
            n: counted.filter(|g| self.weights[**g].abs() > 0.0).count(),
            method,
            estimate: means.sum(),
            se: None,
            statistic: None,
            df: None,
            p: None,
            ci: Interval::default(),
        }
    }

    fn by_t(&self, method: EffectMethod, estimate: f64, se: f64, df: f64) -> LevelContrast {
        let plain = self.plain(method);
        let scale = self.sides.iter().flatten().fold(0.0, |m: f64, v| m.max(v.abs()));
        if !(df > 0.0 && df.is_finite()) || is_rounding(se, scale) {
            return LevelContrast { estimate, ..plain };
        }
        let half = t_quantile_two_sided(0.05, df).map(|t| t * se);
        LevelContrast {
            estimate,
            se: Some(se),
            statistic: Some(estimate / se),
            df: Some(df),
            p: Some(t_two_sided(estimate / se, df)),
            ci: Interval::around(estimate, half),
            ..plain
        }
    }

    pub(super) fn by_welch(&self, method: EffectMethod) -> LevelContrast {
        let (mut variance, mut below, mut alone) = (0.0, 0.0, false);
        for (group, weight) in self.weights.iter().enumerate() {
            let scores = self.of_group(group);
            let (_, square) = mean_and_square_sum(scores.iter().copied());
            let n = scores.len() as f64;
            if weight.abs() > 0.0 {
                alone |= n < 2.0;
                let part = weight * weight * square / (n - 1.0) / n;
                variance += part;
                below += part * part / (n - 1.0);
            }
        }
        let estimate = self.plain(method).estimate;
        let df = if alone { 0.0 } else { variance * variance / below };
        self.by_t(method, estimate, variance.sqrt(), df)
    }

    /// Least squares on the groups and the covariates less their means.
    pub(super) fn by_regression(
        &self,
        method: EffectMethod,
        covariates: &[SubjectCovariate],
    ) -> LevelContrast {
        self.by_regressions(method, &[(self.of_people(), covariates.to_vec())])
    }

    /// The same of parts that add up to the subjects' scores, each on covariates of its own. The error is that of the sum: what one part
    /// leaves goes with what another leaves of the same subject, over the degrees of freedom of the part that has the fewest.
    pub(super) fn by_regressions(
        &self,
        method: EffectMethod,
        parts: &[(Vec<f64>, Vec<SubjectCovariate>)],
    ) -> LevelContrast {
        let fits = parts.iter().map(|(scores, on)| self.regress(scores, on));
        let Some(fits) = fits.collect::<Option<Vec<Fit>>>() else {
            return self.plain(method);
        };
        let covariance = |a: &Fit, b: &Fit| dot(&a.shares, &b.shares) * dot(&a.left, &b.left);
        let pairs = fits.iter().flat_map(|a| fits.iter().map(move |b| (a, b)));
        let variance: f64 = pairs.map(|(a, b)| covariance(a, b)).sum();
        let df = fits.iter().map(|fit| fit.df).fold(f64::INFINITY, f64::min);
        let estimate = fits.iter().map(|fit| fit.estimate).sum();
        self.by_t(method, estimate, (variance / df.max(1.0)).sqrt(), df)
    }

    fn regress(&self, scores: &[f64], covariates: &[SubjectCovariate]) -> Option<Fit> {
        let group = self.design.group();
        let (n, k) = (group.len(), self.weights.len());
        let covariates: Vec<Vec<f64>> = covariates.iter().map(|c| centred(&c.values)).collect();
        let width = k + covariates.len();
        let x = Matrix::from(n, width, |i, j| match j.checked_sub(k) {
            Some(covariate) => covariates[covariate][i],
            None => f64::from(u8::from(group[i] == j)),
        });
        let y = Matrix::from(n, 1, |i, _| scores[i]);
        let factor = x.transposed_times(&x).cholesky()?;
        let fitted = factor.solve(&x.transposed_times(&y));
        let weights = Matrix::from(width, 1, |j, _| self.weights.get(j).copied().unwrap_or(0.0));
        let of_columns = factor.solve(&weights);
        let along = |i: usize, column: &Matrix| -> f64 {
            (0..width).map(|j| x[(i, j)] * column[(j, 0)]).sum()
        };
        Some(Fit {
            estimate: (0..k).map(|j| self.weights[j] * fitted[(j, 0)]).sum(),
            shares: (0..n).map(|i| along(i, &of_columns)).collect(),
            left: (0..n).map(|i| scores[i] - along(i, &fitted)).collect(),
            df: n as f64 - width as f64,
        })
    }

    fn by_signed_ranks(&self, method: EffectMethod) -> Result<LevelContrast, StatsError> {
        let names = ["plus", "minus"].map(str::to_owned);
        let rows: Vec<Vec<f64>> = self.sides.iter().map(|sides| sides.to_vec()).collect();
        let table = WithinSubjects::from_rows(&names, self.design.subjects(), &rows)?;
        let tests = within(&table);
        let ranks = tests.wilcoxon.values().next();
        let scores = self.of_people();
        Ok(LevelContrast {
            // Ranks know no groups: everybody counts alike.
            estimate: mean_and_square_sum(scores.iter().copied()).0,
            statistic: ranks.and_then(|w| w.w_plus),
            p: ranks.and_then(|w| w.p),
            ..self.plain(method)
        })
    }

    fn by_group_ranks(&self, method: EffectMethod) -> Result<LevelContrast, StatsError> {
        let people = self.of_people().into_iter().zip(self.design.group());
        let two = people.filter(|(_, g)| self.weights[**g].abs() > 0.0);
        // The first of the pair counts as the first group.
        let mut two: Vec<(bool, f64)> = two.map(|(s, g)| (self.weights[*g] < 0.0, s)).collect();
        two.sort_by_key(|(second, _)| *second);
        let names: Vec<String> = two.iter().map(|(second, _)| second.to_string()).collect();
        let values: Vec<Option<f64>> = two.into_iter().map(|(_, score)| Some(score)).collect();
        let comparison = groups(&names, &values)?;
        let test = comparison.mann_whitney.values().next();
        Ok(LevelContrast {
            statistic: test.map(|t| t.u),
            p: test.and_then(|t| t.p),
            ..self.plain(method)
        })
    }
}
