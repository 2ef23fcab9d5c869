//! People who differ in their level: a mixed model with a random intercept, tested term by term.

use serde::{Deserialize, Serialize};

use super::{
    FixedEffect,
    columns::{FactorRows, Predictor, Weight},
    components::{AtZero, Components},
    described::{Described, Estimates},
    formula::Formula,
    marginal::{MarginalContrast, NO_FREEDOM, PairsByTerm},
    model_rows::{ModelRows, no_fit},
    own_errors::OwnErrors,
};
use crate::{
    MarginalMean, Named, Reasons, StatsError,
    factorial::contrasts,
    numerics::{
        distributions::f_upper,
        matrix::Matrix,
        moments::{dot, largest},
        spectrum::principal_axes,
    },
};

/// Variances of a model with a random intercept.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct InterceptVariance {
    /// Of the subjects' levels; exactly 0 if they differ less than chance would have them, none where each subject has a single row.
    pub subject: Option<f64>,
    /// Within a subject.
    pub residual: f64,
}

/// The test of one term of the formula.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TermTest {
    /// Wald's statistic over `df1`.
    #[serde(rename = "F")]
    pub f: f64,
    /// Coefficients of the term.
    pub df1: usize,
    /// Satterthwaite's degrees of freedom.
    pub df2: Option<f64>,
    /// P(F' ≥ F).
    pub p: Option<f64>,
}

/// A linear model with a random intercept of the subject, and where asked one of the subject at each level of some factors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RandomIntercept {
    /// The fixed effects, written out.
    pub formula: String,
    /// Rows with all values.
    pub n_obs: usize,
    /// How many subjects have at least one of those rows.
    pub n_subjects: usize,
    /// Rows left out because a value is missing.
    pub missing: usize,
    /// Both variances.
    pub variance: InterceptVariance,
    /// Of the subjects at each level of a factor, by factor: none with a random intercept alone.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub variance_by: Named<f64>,
    /// Share of the subjects in the sum of both: the correlation of two values of one subject; none where nobody has two.
    pub icc: Option<f64>,
    /// -2 ln of the restricted likelihood at its top.
    pub reml_criterion: f64,
    /// ln of the restricted likelihood.
    pub log_likelihood: f64,
    /// Coefficients: `(Intercept)`, `x`, `a[a2]`, `a[a2]:x`; the first level of a factor is the reference.
    pub coef: Named<FixedEffect>,
    /// Type III tests of each term: at the mean of the covariates, as `emm` and `contrast`, averaged over the levels of the other factors.
    /// Where a factor stands in a product with a covariate, lmerTest tests it at a covariate of 0 unless that is centred.
    pub anova: Named<TermTest>,
    /// Marginal means of each term of factors alone, by cell: covariates at their mean, other factors averaged.
    pub emm: Named<Named<MarginalMean>>,
    /// Pairwise differences of the same means; of an interaction those of cells that differ in one factor.
    pub contrast: Named<Named<MarginalContrast>>,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// Fits y = X β + u + ε with u ~ N(0, τ²) a subject and ε ~ N(0, σ²) a row, by restricted maximum likelihood.
///
/// `subjects`, `y` and each predictor have shape `(rows,)`; rows with a missing value are left out, the subject's others stay.
/// Coefficients and terms are tested with Satterthwaite's degrees of freedom from the observed information of the variances, as
/// lmerTest; where the likelihood has its top at τ² = 0 those are n - p. Where every subject has a single row, u and ε cannot be told
/// apart: the fit is that of least squares (with a factor and a covariate an analysis of covariance).
///
/// # Errors
/// [`StatsError::Formula`] if the formula asks for a predictor that is not there; [`StatsError::LengthMismatch`];
/// [`StatsError::NotFinite`]; [`StatsError::OneLevel`]; [`StatsError::Collinear`] with the name of the column;
/// [`StatsError::TooFew`] unless there are two subjects and more rows than columns, and than subjects if one has several; [`StatsError::NoFit`] if the
/// predictors explain y whole.
///
/// # Source
/// Bates, Mächler, Bolker and Walker (2015); Kuznetsova, Brockhoff and Christensen (2017), section 2 (Fai and Cornelius for terms of several coefficients).
///
/// # Example
/// ```
/// use maveric_stats::{Predictor, random_intercept};
/// let people: Vec<String> = (0..12).map(|i| (i / 4).to_string()).collect();
/// let day: Vec<_> = (0..12).map(|i| Some(f64::from(i % 4))).collect();
/// let y = [1.0, 2.1, 2.9, 4.2, 2.0, 3.4, 4.9, 6.6, 0.5, 1.2, 2.2, 2.7].map(Some);
/// let fit = random_intercept(&people, &"day".parse()?, &[("day", Predictor::Covariate(&day))], &y)?;
/// let slope = fit.coef.get("day").unwrap();
/// assert!((slope.estimate - 1.11).abs() < 1e-6 && (slope.df.unwrap() - 8.0).abs() < 1e-4);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn random_intercept(
    subjects: &[String],
    formula: &Formula,
    predictors: &[(&str, Predictor)],
    y: &[Option<f64>],
) -> Result<RandomIntercept, StatsError> {
    let (model, _) =
        restricted(subjects, formula, &[], predictors, y, (AtZero::Pooled, PairErrors::Model))?;
    Ok(model)
}

/// The same with a variance of the subjects at each level of some factors too: y = X β + u + Σ u_f + ε, all uncorrelated.
///
/// `by` names factors of the formula that change within subjects: each has a variance of subject × factor, so that a factor is tested
/// over the spread of its own effect between people. A factor of which no subject has two rows at one level has none: it is the residual.
/// No variance is dropped: one whose top is at 0 is 0 in the result, and then degrees of freedom come from the expected information of
/// all variances, which in complete data is that of the strata. In complete data without a variance at 0, F, degrees of freedom and p
/// are those of the analysis of variance by strata.
///
/// # Errors
/// Those of [`random_intercept`]; [`StatsError::Formula`] if a name of `by` is not that of a factor of the formula.
///
/// # Source
/// Barr, Levy, Scheepers and Tily (2013) on slopes by person; Giesbrecht and Burns (1985) with the information of Searle, Casella and
/// McCulloch (1992), section 6.6, for the degrees of freedom.
///
/// # Example
/// ```
/// use maveric_stats::{Predictor, random_by_factor};
/// let people: Vec<String> = (0..24).map(|i| (i / 4).to_string()).collect();
/// let label = |names: [&str; 2], of: fn(usize) -> usize| -> Vec<_> { (0..24).map(|i| Some(names[of(i) % 2].to_owned())).collect() };
/// let (style, light) = (label(["calm", "sporty"], |i| i), label(["day", "night"], |i| i / 2));
/// let y: Vec<_> = (0..24).map(|i| Some(((i * 7) % 5 + i / 4 + 2 * (i % 2) + (i / 4) * (i % 2)) as f64)).collect();
/// let predictors = [("style", Predictor::Factor(&style)), ("light", Predictor::Factor(&light))];
/// let fit = random_by_factor(&people, &"style*light".parse()?, &["style", "light"], &predictors, &y)?;
/// assert!((fit.anova.get("style").unwrap().df2.unwrap() - 5.0).abs() < 1e-6);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn random_by_factor(
    subjects: &[String],
    formula: &Formula,
    by: &[&str],
    predictors: &[(&str, Predictor)],
    y: &[Option<f64>],
) -> Result<RandomIntercept, StatsError> {
    let (model, _) =
        restricted(subjects, formula, by, predictors, y, (AtZero::Strata, PairErrors::Model))?;
    Ok(model)
}

/// The same, and the pairs of each term over errors of their own; none where each subject has a single row. Whatever pair has none is
/// noted below `own_error`.
pub(crate) fn random_with_own_errors(
    subjects: &[String],
    formula: &Formula,
    by: &[&str],
    predictors: &[(&str, Predictor)],
    y: &[Option<f64>],
) -> Result<(RandomIntercept, PairsByTerm), StatsError> {
    restricted(subjects, formula, by, predictors, y, (AtZero::Strata, PairErrors::Own))
}

/// Which errors pairs have beside those of the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum PairErrors {
    /// None.
    Model,
    /// One of their own each.
    Own,
}

fn restricted(
    subjects: &[String],
    formula: &Formula,
    by: &[&str],
    predictors: &[(&str, Predictor)],
    y: &[Option<f64>],
    (at_zero, pair_errors): (AtZero, PairErrors),
) -> Result<(RandomIntercept, PairsByTerm), StatsError> {
    let rows = ModelRows::new(subjects, formula, predictors, y, 2)?;
    rows.independent()?;
    let ModelRows { columns, people, .. } = &rows;
    let alone = people.len() == rows.values.len();
    let by: Vec<(&str, FactorRows)> = by
        .iter()
        .map(|name| {
            let factor = columns.factor(name).map(|rows| (*name, rows));
            let expected = "the name of a factor of the formula";
            factor.ok_or_else(|| StatsError::formula(*name, expected))
        })
        .filter(|factor| !factor.as_ref().is_ok_and(|(_, rows)| rows.is_residual(people)))
        .collect::<Result<_, StatsError>>()?;
    let sizes: Vec<usize> =
        std::iter::once(1).chain(by.iter().map(|(_, rows)| rows.levels)).collect();
    let places: Vec<(usize, usize)> =
        (0..by.len()).flat_map(|f| (0..by[f].1.levels).map(move |level| (f, level))).collect();
    // The intercept, then each level of each factor.
    let random = |row: usize, j: usize| {
        let in_level = |(f, level): (usize, usize)| by[f].1.of_row[row] == level;
        f64::from(u8::from(j == 0 || in_level(places[j - 1])))
    };
    let blocks = rows.blocks(1 + places.len(), random);
    let components = Components::of_sizes(&sizes);
    let fit = if alone {
        components.at(&blocks, &vec![0.0; sizes.len()])
    } else {
        components.top(&blocks)
    };
    let fit = fit.filter(|fit| !fit.leaves_rounding(&rows.values));
    let fit = fit.ok_or_else(no_fit)?;
    // With a single row of each subject nothing is within subjects.
    let at_zero = if alone { AtZero::Pooled } else { at_zero };
    let described = Described::new(&blocks, &fit, columns, rows.offset, &components, at_zero);
    let mut undefined = Reasons::default();
    let residual = fit.variance;
    let ratios = components.ratios(&fit.l);
    let subject = (!alone).then(|| residual * ratios[0]);
    if alone {
        let reason = "each subject has a single row: its level cannot be told from the residual";
        undefined.note_all(&["variance.subject", "icc"], reason);
    }
    let errors = (!alone && pair_errors == PairErrors::Own)
        .then(|| OwnErrors::new(&blocks, &fit, largest(&rows.values)))
        .flatten();
    let own_pairs = errors.map_or_else(Named::default, |errors| {
        described.own_contrasts(formula, &errors, &mut undefined)
    });
    let variance_by = by.iter().zip(&ratios[1..]);
    let model = RandomIntercept {
        formula: formula.to_string(),
        n_obs: rows.values.len(),
        n_subjects: people.len(),
        missing: rows.missing,
        variance: InterceptVariance { subject, residual },
        variance_by: variance_by
            .map(|((name, _), ratio)| ((*name).to_owned(), residual * ratio))
            .collect(),
        icc: subject.map(|subject| subject / (subject + residual)),
        reml_criterion: fit.deviance,
        log_likelihood: -0.5 * fit.deviance,
        coef: described.coefficients(&mut undefined),
        anova: described.terms(formula, &mut undefined),
        emm: described.means(formula, &mut undefined),
        contrast: described.contrasts(formula, &mut undefined),
        undefined,
    };
    Ok((model, own_pairs))
}

impl Described<'_> {
    fn coefficients(&self, undefined: &mut Reasons) -> Named<FixedEffect> {
        let one = |(name, weights): (String, Vec<f64>)| {
            let effect = self.estimates.effect(&weights);
            if effect.ci.low.is_none() {
                let parts = ["df", "p", "ci_low", "ci_high"];
                undefined.note_below(&format!("coef.{name}"), &parts, NO_FREEDOM);
            }
            (name, effect)
        };
        self.columns.coefficients().into_iter().map(one).collect()
    }

    fn terms(&self, formula: &Formula, undefined: &mut Reasons) -> Named<TermTest> {
        let one = |term: &Vec<usize>| {
            let name = formula.name(term);
            let test = self.wald(&self.hypothesis(term));
            if test.p.is_none() {
                undefined.note_below(&format!("anova.{name}"), &["df2", "p"], NO_FREEDOM);
            }
            (name, test)
        };
        formula.terms().iter().map(one).collect()
    }

    /// Contrasts of the levels of the term's factors, in the slope of its covariates, other covariates at their mean; orthonormal, so that
    /// the principal axes of several do not depend on which level comes first.
    fn hypothesis(&self, term: &[usize]) -> Vec<Vec<f64>> {
        let mut rows = vec![self.columns.at_means()];
        for &p in term {
            let choices: Vec<Weight> = match self.columns.levels(p) {
                None => vec![Weight::Slope],
                Some(levels) => {
                    let rows = contrasts(levels.len());
                    rows.into_iter().map(Weight::Levels).collect()
                }
            };
            rows = choices
                .iter()
                .flat_map(|choice| {
                    rows.iter().map(|row| {
                        let mut row = row.clone();
                        row[p] = choice.clone();
                        row
                    })
                })
                .collect();
        }
        rows.iter().map(|row| self.columns.combination(row)).collect()
    }

    /// F of several combinations at once, along the principal axes of their covariance.
    fn wald(&self, rows: &[Vec<f64>]) -> TermTest {
        let q = rows.len();
        let covariance = Matrix::from(q, q, |i, j| self.estimates.covariance(&rows[i], &rows[j]));
        let Estimates { fit, offset, .. } = self.estimates;
        let estimates: Vec<f64> = rows
            .iter()
            .map(|row| {
                let products = (0..row.len()).map(|j| row[j] * fit.beta[(j, 0)]);
                products.sum::<f64>() + row[0] * offset
            })
            .collect();
        // Independent combinations of independent columns have a covariance of full rank.
        let axes = principal_axes(&covariance).unwrap_or_default();
        let (mut sum, mut freedoms) = (0.0, Vec::new());
        for axis in &axes {
            // Of length √variance along the axis.
            let variance = dot(axis, axis);
            sum += (dot(axis, &estimates) / variance).powi(2);
            let weights: Vec<f64> = (0..self.columns.count())
                .map(|j| rows.iter().zip(axis).map(|(row, a)| a * row[j]).sum())
                .collect();
            freedoms.push(self.estimates.estimate(&weights).2);
        }
        let freedoms: Option<Vec<f64>> = freedoms.into_iter().collect();
        let f = sum / q as f64;
        let df2 = freedoms.and_then(|f| of_several(&f));
        TermTest { f, df1: q, df2, p: df2.map(|df2| f_upper(f, q as f64, df2)) }
    }
}

/// Degrees of freedom of an F from those of its axes.
///
/// # Source
/// Fai and Cornelius (1996): E = Σ ν / (ν - 2) is the mean of q F, so that the degrees of freedom are 2 E / (E - q).
fn of_several(freedoms: &[f64]) -> Option<f64> {
    let q = freedoms.len() as f64;
    let first = *freedoms.first()?;
    if freedoms.iter().all(|df| (df - first).abs() < 1e-8 * first) {
        return Some(first);
    }
    if freedoms.iter().any(|df| *df <= 2.0) {
        return Some(2.0);
    }
    let mean: f64 = freedoms.iter().map(|df| df / (df - 2.0)).sum();
    Some(2.0 * mean / (mean - q)).filter(|df| df.is_finite() && *df > 0.0)
}

#[cfg(test)]
mod tests;
