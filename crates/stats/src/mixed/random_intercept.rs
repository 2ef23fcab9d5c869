//! People who differ in their level: a mixed model with a random intercept, tested term by term.

use serde::{Deserialize, Serialize};

use super::{
    FixedEffect,
    columns::{FactorRows, Predictor, Weight},
    components::{AtZero, Components},
    described::{Described, Estimates},
    formula::Formula,
    marginal::{MarginalContrast, NO_FREEDOM},
    model_rows::{ModelRows, no_fit},
};
use crate::{
    MarginalMean, Named, Reasons, StatsError,
    factorial::contrasts,
    numerics::{distributions::f_upper, matrix::Matrix, moments::dot, spectrum::principal_axes},
};

/// Variances of a model with a random intercept.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct InterceptVariance {
    /// Of the subjects' levels; exactly 0 if they differ less than chance would have them, or each subject has a single row.
    pub subject: f64,
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
    /// Share of the subjects in the sum of both: the correlation of two values of one subject.
    pub icc: f64,
    /// -2 ln of the restricted likelihood at its top.
    pub reml_criterion: f64,
    /// ln of the restricted likelihood.
    pub log_likelihood: f64,
    /// Coefficients: `(Intercept)`, `x`, `a[a2]`, `a[a2]:x`; the first level of a factor is the reference.
    pub coef: Named<FixedEffect>,
    /// Type III tests of each term: at covariates of 0, averaged over the levels of the other factors.
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
    restricted(subjects, formula, &[], predictors, y, AtZero::Pooled)
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
    restricted(subjects, formula, by, predictors, y, AtZero::Strata)
}

fn restricted(
    subjects: &[String],
    formula: &Formula,
    by: &[&str],
    predictors: &[(&str, Predictor)],
    y: &[Option<f64>],
    at_zero: AtZero,
) -> Result<RandomIntercept, StatsError> {
    let rows = ModelRows::new(subjects, formula, predictors, y, 2)?;
    rows.independent()?;
    let ModelRows {
        columns, people, ..
    } = &rows;
    let alone = people.len() == rows.values.len();
    let by: Vec<(&str, FactorRows)> = by
        .iter()
        .map(|name| {
            let factor = columns.factor(name).map(|rows| (*name, rows));
            let expected = "the name of a factor of the formula";
            factor.ok_or_else(|| StatsError::formula(*name, expected))
        })
        .filter(|factor| {
            !factor
                .as_ref()
                .is_ok_and(|(_, rows)| rows.is_residual(people))
        })
        .collect::<Result<_, StatsError>>()?;
    let sizes: Vec<usize> = std::iter::once(1)
        .chain(by.iter().map(|(_, rows)| rows.levels))
        .collect();
    let places: Vec<(usize, usize)> = (0..by.len())
        .flat_map(|f| (0..by[f].1.levels).map(move |level| (f, level)))
        .collect();
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
    let fit = fit.ok_or_else(no_fit)?;
    // With a single row of each subject nothing is within subjects.
    let at_zero = if alone { AtZero::Pooled } else { at_zero };
    let described = Described::new(&blocks, &fit, columns, rows.offset, &components, at_zero);
    let mut undefined = Reasons::default();
    let residual = fit.variance;
    let ratios = components.ratios(&fit.l);
    let subject = residual * ratios[0];
    let variance_by = by.iter().zip(&ratios[1..]);
    Ok(RandomIntercept {
        formula: formula.to_string(),
        n_obs: rows.values.len(),
        n_subjects: people.len(),
        missing: rows.missing,
        variance: InterceptVariance { subject, residual },
        variance_by: variance_by
            .map(|((name, _), ratio)| ((*name).to_owned(), residual * ratio))
            .collect(),
        icc: subject / (subject + residual),
        reml_criterion: fit.deviance,
        log_likelihood: -0.5 * fit.deviance,
        coef: described.coefficients(&mut undefined),
        anova: described.terms(formula, &mut undefined),
        emm: described.means(formula, &mut undefined),
        contrast: described.contrasts(formula, &mut undefined),
        undefined,
    })
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

    /// Contrasts of the levels of the term's factors, in the slope of its covariates; orthonormal, so that the principal axes of several
    /// do not depend on which level comes first.
    fn hypothesis(&self, term: &[usize]) -> Vec<Vec<f64>> {
        let mut rows = vec![self.columns.at_zero()];
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
        rows.iter()
            .map(|row| self.columns.combination(row))
            .collect()
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
        TermTest {
            f,
            df1: q,
            df2,
            p: df2.map(|df2| f_upper(f, q as f64, df2)),
        }
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
mod tests {
    use super::*;

    struct Made {
        people: Vec<String>,
        mode: Vec<Option<String>>,
        speed: Vec<Option<f64>>,
        y: Vec<Option<f64>>,
    }

    /// Six people, three modes, a speed.
    fn made() -> Made {
        let row = |i: usize| (i * 37 % 11) as f64;
        Made {
            people: (0..18).map(|i| (i / 3).to_string()).collect(),
            mode: (0..18)
                .map(|i| Some(["calm", "mean", "sporty"][i % 3].to_owned()))
                .collect(),
            speed: (0..18)
                .map(|i| Some(row(i) + 0.5 * (i % 4) as f64))
                .collect(),
            y: (0..18)
                .map(|i| Some(row(i + 5) * 0.3 + (i / 3) as f64 + (i % 3) as f64))
                .collect(),
        }
    }

    fn run(made: &Made, formula: &str) -> Result<RandomIntercept, StatsError> {
        let predictors = [
            ("mode", Predictor::Factor(&made.mode)),
            ("speed", Predictor::Covariate(&made.speed)),
            ("again", Predictor::Covariate(&made.speed)),
        ];
        random_intercept(&made.people, &formula.parse()?, &predictors, &made.y)
    }

    #[test]
    fn one_factor_without_gaps_is_the_analysis_of_variance() {
        let made = made();
        let fit = run(&made, "mode").unwrap();
        let mode: Vec<String> = made.mode.iter().flatten().cloned().collect();
        let data = crate::WithinSubjects::from_long(&made.people, &mode, &made.y).unwrap();
        let anova = crate::rm_anova(&data).rm_anova;
        let term = fit.anova.get("mode").unwrap();
        assert!((term.f / anova.f.unwrap() - 1.0).abs() < 1e-6);
        assert!((term.df2.unwrap() - anova.df2 as f64).abs() < 1e-4);
        assert_eq!(fit.emm.get("mode").unwrap().len(), 3);
        // Without gaps a pair over the pooled error is the t test of the analysis of variance.
        let pooled = crate::within(&data).pooled;
        for (name, pair) in fit.contrast.get("mode").unwrap().iter() {
            let known = pooled.get(name).unwrap();
            assert!((pair.t / known.t.unwrap() - 1.0).abs() < 1e-6, "{name}");
            assert!((pair.p_holm.unwrap() / known.p_holm.unwrap() - 1.0).abs() < 1e-4);
        }
    }

    #[test]
    fn pairs_of_an_interaction_differ_in_one_factor() {
        let made = made();
        let side = (0..18).map(|i| Some(["left", "right"][i / 9].to_owned()));
        let side: Vec<Option<String>> = side.collect();
        let predictors = [
            ("mode", Predictor::Factor(&made.mode)),
            ("side", Predictor::Factor(&side)),
        ];
        let formula = "mode*side".parse().unwrap();
        let fit = random_intercept(&made.people, &formula, &predictors, &made.y).unwrap();
        let pairs = fit.contrast.get("mode:side").unwrap();
        // Three of the sides at each mode, three of the modes at each side.
        assert_eq!(pairs.len(), 3 + 2 * 3);
        let means = fit.emm.get("mode:side").unwrap();
        let pair = pairs.get("calm:left|calm:right").unwrap();
        let [a, b] = ["calm:left", "calm:right"].map(|cell| means.get(cell).unwrap().mean);
        assert!((pair.estimate - (a - b)).abs() < 1e-12);
    }

    #[test]
    fn single_rows_are_an_analysis_of_covariance() {
        // y = 1 + 2 x + 3 (group b), and residuals of +-1/4 that are orthogonal to all columns.
        let people: Vec<String> = (0..8).map(|i| i.to_string()).collect();
        let group: Vec<_> = (0..8).map(|i| Some(["a", "b"][i / 4].to_owned())).collect();
        let x = [1.0, 2.0, 3.0, 4.0, 1.0, 2.0, 3.0, 4.0];
        let rest = [1.0, -1.0, -1.0, 1.0, -1.0, 1.0, 1.0, -1.0];
        let y: Vec<_> = (0..8)
            .map(|i| Some(1.0 + 2.0 * x[i] + 3.0 * (i / 4) as f64 + 0.25 * rest[i]))
            .collect();
        let x = x.map(Some);
        let predictors = [
            ("group", Predictor::Factor(&group)),
            ("x", Predictor::Covariate(&x)),
        ];
        let fit =
            random_intercept(&people, &"group + x".parse().unwrap(), &predictors, &y).unwrap();
        let group = fit.coef.get("group[b]").unwrap();
        // s² = 8/16 / (8 - 3) = .1; var = s² (1/4 + 1/4).
        assert!((group.estimate - 3.0).abs() < 1e-12 && (group.df.unwrap() - 5.0).abs() < 1e-9);
        assert!((group.se.unwrap() - 0.05_f64.sqrt()).abs() < 1e-12);
        assert!(fit.variance.subject.abs() < 1e-300);
    }

    #[test]
    fn offsets_of_value_and_covariate_move_the_intercept_alone() {
        let near = made();
        let mut far = made();
        far.y = far.y.iter().map(|v| v.map(|v| v + 1e8)).collect();
        far.speed = far.speed.iter().map(|v| v.map(|v| v + 1e6)).collect();
        let (near, far) = (
            run(&near, "mode + speed").unwrap(),
            run(&far, "mode + speed").unwrap(),
        );
        for name in ["mode[mean]", "mode[sporty]", "speed"] {
            let (a, b) = (near.coef.get(name).unwrap(), far.coef.get(name).unwrap());
            assert!((a.estimate - b.estimate).abs() < 1e-6, "{name}");
            assert!((a.df.unwrap() / b.df.unwrap() - 1.0).abs() < 1e-4, "{name}");
        }
        let slope = far.coef.get("speed").unwrap().estimate;
        let moved = far.coef.get("(Intercept)").unwrap().estimate - 1e8 + slope * 1e6;
        assert!((moved - near.coef.get("(Intercept)").unwrap().estimate).abs() < 1e-5);
    }

    #[test]
    fn what_cannot_be_fitted_is_refused_by_name() {
        let said = |formula: &str| run(&made(), formula).unwrap_err();
        assert!(matches!(said("speed + again"), StatsError::Collinear { name } if name == "again"));
        assert!(matches!(said("week"), StatsError::Formula { text, .. } if text == "week"));
        let mut flat = made();
        flat.y = vec![Some(3.0); 18];
        assert!(matches!(run(&flat, "mode"), Err(StatsError::NoFit { .. })));
        let mut one = made();
        one.mode = vec![Some("calm".to_owned()); 18];
        assert!(matches!(
            run(&one, "mode"),
            Err(StatsError::OneLevel { .. })
        ));
    }
}
