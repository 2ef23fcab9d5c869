//! Linear mixed models: several answers of one person, and people who differ.

pub(crate) mod blocks;
mod columns;
mod components;
mod congruence;
mod described;
mod formula;
mod marginal;
mod model_rows;
mod own_errors;
mod random_intercept;
mod ratio;
mod satterthwaite;

pub use columns::Predictor;
pub use congruence::{Bend, Congruence, CongruenceData, congruence};
pub use formula::Formula;
pub use marginal::MarginalContrast;
pub(crate) use random_intercept::random_with_own_errors;
pub use random_intercept::{
    InterceptVariance, RandomIntercept, TermTest, random_by_factor, random_intercept,
};
pub use ratio::{RatioTest, Region};

use serde::{Deserialize, Serialize};

use crate::{
    Interval, Named, Reasons, StatsError, complete,
    numerics::{
        matrix::Matrix,
        minimise::{decades, minimise},
        moments::{is_rounding, largest},
    },
    within_subjects::Index,
};
use blocks::Blocks;
use described::Estimates;

/// Which likelihood is made largest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum MixedMethod {
    /// Restricted: variances are not biased by the fixed effects estimated beside them.
    #[default]
    Reml,
    /// Full: for comparing models that differ in their fixed effects.
    Ml,
}

/// One coefficient that holds for everybody.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FixedEffect {
    /// The coefficient.
    pub estimate: f64,
    /// Its standard error.
    pub se: Option<f64>,
    /// Satterthwaite's degrees of freedom.
    pub df: Option<f64>,
    /// estimate / se.
    pub t: Option<f64>,
    /// Two-sided, by t with `df` degrees of freedom.
    pub p: Option<f64>,
    /// The 95 % interval.
    #[serde(flatten, with = "crate::interval::ci")]
    pub ci: Interval,
}

/// A fitted linear mixed model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MixedModel {
    /// Rows with all values.
    pub n: usize,
    /// Rows left out because a value is missing.
    pub missing: usize,
    /// People.
    pub subjects: usize,
    /// Which likelihood was made largest.
    pub method: MixedMethod,
    /// The coefficients, `intercept` first.
    pub fixed: Named<FixedEffect>,
    /// Standard deviation over people of the intercept and of each random slope.
    pub random_sd: Named<f64>,
    /// Correlation of intercept and slope over people, a pair each; 0 where one does not vary.
    pub random_correlation: Named<f64>,
    /// Standard deviation within a person.
    pub residual_sd: f64,
    /// −2 ln of the (restricted) likelihood at its top.
    pub deviance: f64,
    /// Whether the covariance of intercepts and slopes is on the edge of what is possible: an SD of 0 or a correlation of ±1.
    pub singular: bool,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// Fits y = X β + Z u + ε with u ~ N(0, Ψ) for each subject and ε ~ N(0, σ²).
///
/// `y` and each column of `fixed` have shape `(rows,)`, `subjects` says whose each row is; rows with a missing value are left out.
/// An intercept is always there, for everybody and at random; `random` names those columns of `fixed` whose slope differs between
/// people. Ψ is unrestricted. Its Cholesky factor relative to σ is found by Nelder and Mead on the profiled deviance.
///
/// The test of a coefficient is t with Satterthwaite's degrees of freedom (Giesbrecht and Burns, 1985), from the *expected*
/// information of the variances: lmerTest takes the observed one, which is the same in balanced designs away from the edge and is not
/// positive definite at it.
///
/// # Errors
/// [`StatsError::LengthMismatch`], [`StatsError::NotFinite`]; [`StatsError::TooFew`] unless there are at least two subjects and more rows
/// than coefficients, columns or rows within people; [`StatsError::BadParameter`] if the columns are collinear, y does not vary, or `random` names no column.
///
/// # Source
/// Laird and Ware (1982); Bates, Mächler, Bolker and Walker (2015), sections 3.4 to 3.6. Agrees with lme4 (and lmerTest's degrees of
/// freedom) on `sleepstudy`, and with statsmodels' `MixedLM`.
///
/// # Example
/// ```
/// use maveric_stats::{MixedMethod, mixed_model};
/// let subjects: Vec<String> = (0..12).map(|i| (i / 4).to_string()).collect();
/// let day: Vec<_> = (0..12).map(|i| Some(f64::from(i % 4))).collect();
/// let y = [1.0, 2.1, 2.9, 4.2, 2.0, 3.4, 4.9, 6.6, 0.5, 1.2, 2.2, 2.7].map(Some);
/// let fit = mixed_model(&subjects, &y, &[("day", &day)], &["day"], MixedMethod::Reml)?;
/// let slope = fit.fixed.get("day").unwrap();
/// assert!((slope.estimate - 1.11).abs() < 1e-4 && (slope.df.unwrap() - 2.0).abs() < 0.01);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn mixed_model(
    subjects: &[String],
    y: &[Option<f64>],
    fixed: &[(&str, &[Option<f64>])],
    random: &[&str],
    method: MixedMethod,
) -> Result<MixedModel, StatsError> {
    let mut columns = vec![("y", y)];
    columns.extend_from_slice(fixed);
    StatsError::same_length("subject", subjects.len(), y.len())?;
    let complete = complete::rows(&columns, "row", fixed.len() + 2)?;
    let places = random
        .iter()
        .map(|name| place_of(name, fixed))
        .collect::<Result<Vec<usize>, StatsError>>()?;
    let groups = Index::from_labels(complete.kept.iter().map(|&row| &subjects[row])).members();
    complete::enough("subject", groups.len(), complete.missing, 2)?;
    let (n, p, q) = (complete.kept.len(), fixed.len() + 1, places.len() + 1);
    complete::enough("row", n, complete.missing, p.max(groups.len()) + 1)?;
    // The intercept takes the mean of y: an offset costs no digits.
    let values = &complete.columns[0];
    let offset = values.iter().sum::<f64>() / n as f64;
    let x = |row: usize, j: usize| {
        if j == 0 { 1.0 } else { complete.columns[j][row] }
    };
    let random_column = |row: usize, j: usize| x(row, if j == 0 { 0 } else { places[j - 1] });
    let blocks = Blocks::of_rows(&groups, (p, q), x, random_column, |row| values[row] - offset);
    let fit = fit(&blocks, method).filter(|fit| !fit.leaves_rounding(values));
    let fit = fit.ok_or_else(|| {
        StatsError::parameter(
            "fixed",
            "columns that are not sums of each other, and a y that varies beyond them",
            p as f64,
        )
    })?;
    let mut names = vec!["intercept"];
    names.extend(fixed.iter().map(|(name, _)| *name));
    let mut random_names = vec!["intercept"];
    random_names.extend_from_slice(random);
    Ok(MixedModel {
        missing: complete.missing,
        ..describe(&blocks, &fit, method, &names, &random_names, offset)
    })
}

fn place_of(name: &str, fixed: &[(&str, &[Option<f64>])]) -> Result<usize, StatsError> {
    let position = fixed.iter().position(|(column, _)| *column == name);
    position.map(|at| at + 1).ok_or_else(|| {
        StatsError::parameter(
            &format!("random slope of {name}"),
            "the name of one of the fixed columns",
            f64::NAN,
        )
    })
}

/// The top of the likelihood.
struct Fit {
    /// Cholesky factor of Ψ relative to σ.
    l: Matrix,
    beta: Matrix,
    /// (XᵀW⁻¹X)⁻¹.
    xx_inverse: Matrix,
    variance: f64,
    deviance: f64,
}

/// An SD, in residual SDs of a row of ordinary size, that is called zero.
const NO_SPREAD: f64 = 1e-4;

impl Fit {
    fn psi(&self) -> Matrix {
        self.l.times(&self.l.transposed())
    }

    /// Standard deviation over people of a random column.
    fn random_sd(&self, j: usize) -> f64 {
        (self.variance * self.psi()[(j, j)]).max(0.0).sqrt()
    }

    /// Whether what is left of a row is no more than rounding of values as large as these: then the top is where the digits end.
    fn leaves_rounding(&self, values: &[f64]) -> bool {
        // Values may come with fifteen digits.
        is_rounding(self.variance.sqrt() / 16.0, largest(values))
    }

    /// Whether Ψ is on the edge of what is possible.
    fn is_singular(&self, blocks: &Blocks) -> bool {
        (0..blocks.q).any(|j| self.l[(j, j)].abs() * blocks.size(j) < NO_SPREAD)
    }
}

/// β, residual variance and deviance for given relative covariances.
fn profile(blocks: &Blocks, l: Matrix, method: MixedMethod) -> Option<Fit> {
    let sums = blocks.weighted(&l)?;
    let factor = sums.xx.cholesky()?;
    let beta = factor.solve(&sums.xy);
    let rest = blocks.rest(&sums, &beta);
    let n = blocks.rows as f64;
    let (freedom, restricted) = match method {
        MixedMethod::Reml => (n - blocks.p as f64, factor.ln_determinant()),
        MixedMethod::Ml => (n, 0.0),
    };
    // Where all of y is explained the likelihood has no top.
    if rest.is_nan() || rest <= f64::MIN_POSITIVE {
        return None;
    }
    let variance = rest / freedom;
    let deviance = sums.ln_determinant
        + restricted
        + freedom * (1.0 + libm::log(std::f64::consts::TAU * variance));
    Some(Fit { l, beta, xx_inverse: factor.inverse(), variance, deviance })
}

fn fit(blocks: &Blocks, method: MixedMethod) -> Option<Fit> {
    let q = blocks.q;
    // The natural size of a slope's factor is one over the size of its column.
    let sizes: Vec<f64> = (0..q).map(|j| blocks.size(j).max(1e-300)).collect();
    let scaled = |theta: &[f64]| {
        let mut l = Matrix::zeros(q, q);
        let mut next = theta.iter();
        for i in 0..q {
            for j in 0..=i {
                l[(i, j)] = next.next().copied().unwrap_or(0.0) / sizes[i];
            }
        }
        l
    };
    let value =
        |theta: &[f64]| profile(blocks, scaled(theta), method).map_or(f64::MAX, |fit| fit.deviance);
    let mut start = Vec::new();
    for i in 0..q {
        start.extend((0..=i).map(|j| if i == j { 0.7 } else { 0.0 }));
    }
    let times =
        |theta: &[f64], factor: f64| -> Vec<f64> { theta.iter().map(|t| t * factor).collect() };
    let factor = decades(|factor| value(&times(&start, factor)));
    let (theta, _) = minimise(&start, 0.4, 1e-10, |theta| value(&times(theta, factor)));
    profile(blocks, scaled(&times(&theta, factor)), method)
}

fn describe(
    blocks: &Blocks,
    fit: &Fit,
    method: MixedMethod,
    names: &[&str],
    random: &[&str],
    offset: f64,
) -> MixedModel {
    let mut undefined = Reasons::default();
    let psi = fit.psi();
    let estimates = Estimates::unrestricted(blocks, fit, offset);
    let mut effect = |j: usize, name: &str| {
        let unit: Vec<f64> = (0..names.len()).map(|i| f64::from(u8::from(i == j))).collect();
        let effect = estimates.effect(&unit);
        if effect.ci.low.is_none() {
            undefined.note(
                &format!("fixed.{name}"),
                "the variances are not determined, so neither are their degrees of freedom",
            );
        }
        effect
    };
    let fixed: Named<FixedEffect> =
        names.iter().enumerate().map(|(j, name)| ((*name).to_owned(), effect(j, name))).collect();
    let mut correlations = Vec::new();
    for i in 0..random.len() {
        for j in 0..i {
            let size = (psi[(i, i)] * psi[(j, j)]).sqrt();
            let r = if size > 0.0 { psi[(i, j)] / size } else { 0.0 };
            correlations.push((format!("{}|{}", random[j], random[i]), r.clamp(-1.0, 1.0)));
        }
    }
    MixedModel {
        n: blocks.rows,
        missing: 0,
        subjects: blocks.subjects.len(),
        method,
        fixed,
        random_sd: random
            .iter()
            .enumerate()
            .map(|(i, name)| ((*name).to_owned(), fit.random_sd(i)))
            .collect(),
        random_correlation: correlations.into_iter().collect(),
        residual_sd: fit.variance.sqrt(),
        deviance: fit.deviance,
        singular: fit.is_singular(blocks),
        undefined,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four people, three days; ann is missing a day.
    fn made_up() -> (Vec<String>, Vec<Option<f64>>, Vec<Option<f64>>) {
        let people = ["ann", "ben", "cem", "dee"];
        let subjects = people.iter().flat_map(|p| vec![(*p).to_owned(); 3]).collect();
        let day = [0.0, 1.0, 2.0].repeat(4).into_iter().map(Some).collect();
        let mut y: Vec<Option<f64>> =
            [3.1, 4.0, 5.3, 2.0, 3.5, 4.2, 5.1, 5.9, 7.2, 4.0, 4.9, 6.1].map(Some).to_vec();
        y[1] = None;
        (subjects, day, y)
    }

    #[test]
    fn rows_with_a_missing_value_are_counted_out() {
        let (subjects, day, y) = made_up();
        let fit =
            mixed_model(&subjects, &y, &[("day", &day)], &["day"], MixedMethod::Reml).unwrap();
        assert_eq!((fit.n, fit.missing, fit.subjects), (11, 1, 4));
    }

    #[test]
    fn an_offset_moves_the_intercept_alone() {
        let (subjects, day, y) = made_up();
        let run = |offset: f64| {
            let y: Vec<_> = y.iter().map(|v| v.map(|v| v + offset)).collect();
            mixed_model(&subjects, &y, &[("day", &day)], &["day"], MixedMethod::Reml).unwrap()
        };
        let (plain, moved) = (run(0.0), run(1e6));
        let of = |fit: &MixedModel, name: &str| fit.fixed.get(name).unwrap().estimate;
        assert!((of(&moved, "intercept") - of(&plain, "intercept") - 1e6).abs() < 1e-6);
        assert!((of(&moved, "day") - of(&plain, "day")).abs() < 1e-6);
    }

    #[test]
    fn what_cannot_be_fitted_is_refused() {
        let (subjects, day, y) = made_up();
        let said = |fixed: &[(&str, &[Option<f64>])], random: &[&str], y: &[Option<f64>]| {
            mixed_model(&subjects, y, fixed, random, MixedMethod::Reml).unwrap_err().to_string()
        };
        let twice: [(&str, &[Option<f64>]); 2] = [("day", &day), ("again", &day)];
        assert!(said(&twice, &[], &y).contains("not sums of each other"));
        assert!(said(&twice[..1], &["week"], &y).contains("random slope of week"));
        assert!(said(&twice[..1], &[], &[Some(2.0); 12]).contains("y that varies"));
        let one = vec!["ann".to_owned(); 12];
        let alone = mixed_model(&one, &y, &[("day", &day)], &[], MixedMethod::Ml);
        assert!(matches!(alone, Err(StatsError::TooFew { .. })));
    }

    #[test]
    fn people_without_differences_give_a_singular_fit_and_still_a_test() {
        let subjects: Vec<String> = (0..24).map(|i| (i / 4).to_string()).collect();
        let day: Vec<_> = (0..24).map(|i| Some(f64::from(i % 4))).collect();
        // Every person's mean is the same: less spread between people than chance gives.
        let y: Vec<_> =
            (0..24).map(|i| Some([0.3, -0.3, -0.2, 0.2][(i % 4 + i / 4) % 4])).collect();
        let fit =
            mixed_model(&subjects, &y, &[("day", &day)], &["day"], MixedMethod::Reml).unwrap();
        assert!(fit.singular);
        let day = fit.fixed.get("day").unwrap();
        assert!(day.p.unwrap() > 0.0 && day.df.unwrap() > 1.0);
    }
}
