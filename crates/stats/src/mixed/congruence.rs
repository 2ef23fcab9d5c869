//! Do people like best what is near their own? A surface over what is their own and how far from it something lies.

use serde::{Deserialize, Serialize};

use super::{
    FixedEffect, MixedMethod,
    columns::Predictor,
    described::Estimates,
    fit,
    formula::Formula,
    marginal::NO_FREEDOM,
    model_rows::{ModelRows, no_fit},
    ratio::{Ratio, RatioTest},
};
use crate::{Named, Reasons, StatsError, complete, mean, standard_deviation};

/// Level, slope and bend over what is people's own, and one more to vary around them.
const FEWEST_PEOPLE: usize = 4;
/// Distances nearer to each other than this share of their span are one.
const SAME_PLACE: f64 = 1e-3;

/// The columns of the model, in their order after the intercept.
const COLUMNS: [&str; 5] = ["moved", "own", "moved^2", "moved:own", "own^2"];
const MOVED: usize = 1;
const OWN: usize = 2;
const MOVED_SQUARED: usize = 3;
const PRODUCT: usize = 4;
const OWN_SQUARED: usize = 5;

/// What a model of congruence is fitted to: a value a row, several rows a person.
#[derive(Debug, Clone, Copy)]
pub struct CongruenceData<'a> {
    /// Whose each row is.
    pub subjects: &'a [String],
    /// How much it was liked: higher is better.
    pub liking: &'a [Option<f64>],
    /// How far what was met lies from the person's own, in points.
    pub moved: &'a [Option<f64>],
    /// The person's own in points, less a middle that is the same for everybody: the slopes of the surface are those at this middle.
    pub own: &'a [Option<f64>],
    /// Further predictors by name, such as the period.
    pub beside: &'a [(&'a str, Predictor<'a>)],
}

/// Which way the parabola over the distance bends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Bend {
    /// Its turning point is what is liked best.
    Top,
    /// Its turning point is what is liked least.
    Bottom,
}

/// How liking depends on the distance from one's own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Congruence {
    /// Rows with all values.
    pub n_obs: usize,
    /// People.
    pub n_subjects: usize,
    /// Rows left out because a value is missing.
    pub missing: usize,
    /// How many points from 0 count as near.
    pub bound: f64,
    /// Mean of people's own.
    pub own_mean: f64,
    /// Its standard deviation over people.
    pub own_sd: f64,
    /// Coefficients: `(Intercept)`, `moved`, `own`, `moved^2`, `moved:own`, `own^2`, and those of further predictors.
    pub coef: Named<FixedEffect>,
    /// Standard deviation over people of the slope of `moved`.
    pub slope_sd: f64,
    /// Standard deviation within a person.
    pub residual_sd: f64,
    /// Whether the covariance of people's levels and slopes is on the edge of what is possible.
    pub singular: bool,
    /// Which way the estimated parabola bends.
    pub bend: Bend,
    /// Where it turns for somebody whose own is the mean, in points from it.
    pub turn: RatioTest,
    /// How far that place moves from people one standard deviation below the mean own to those one above, in points.
    pub movement: RatioTest,
    /// The same as a surface over one's own (x) and what was met (y): b1 x + b2 y + b3 x² + b4 x y + b5 y²; a1 and a2 are slope and
    /// curvature where both are the same, a3 and a4 those across.
    pub surface: Named<FixedEffect>,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// Fits liking ~ moved + own + moved² + moved·own + own² with level and slope of `moved` random over people, by restricted maximum
/// likelihood, and asks whether the top lies within ± `bound` points of one's own, and moves by no more than that over ± 1 SD of own.
///
/// The slope over the distance x of somebody whose own is o is β₁ + β₄ o + 2 β₃ x. There is a top within the bounds where it is positive
/// at -`bound` and negative at `bound`: two one-sided tests of combinations of coefficients, which need no division. So have those of the
/// movement, -SD β₄/β₃. Degrees of freedom are Satterthwaite's, as in [`mixed_model`](crate::mixed_model).
///
/// # Errors
/// Those of [`random_intercept`](crate::random_intercept); [`StatsError::TooFew`] below four people or with one row each;
/// [`StatsError::BadParameter`] if `moved` has fewer than three values or `bound` is not above 0.
///
/// # Source
/// Edwards and Parry (1993) for the surface; Nestler, Humberg and Schönbrodt (2019) for people who have several rows; Schuirmann (1987) and
/// Berger and Hsu (1996) for the tests, Fieller (1954) for what is not excluded.
///
/// # Example
/// ```
/// use maveric_stats::{Bend, CongruenceData, Region, congruence};
/// let subjects: Vec<String> = (0..40).map(|row| (row / 5).to_string()).collect();
/// let moved: Vec<_> = (0..40).map(|row| Some(f64::from(row % 5) * 5.0 - 10.0)).collect();
/// let own: Vec<_> = (0..40).map(|row| Some(f64::from(row / 5) - 3.5)).collect();
/// // Best at 1 point above one's own.
/// let liking: Vec<_> = (0..40)
///     .map(|row| moved[row].map(|m| -0.01 * (m - 1.0) * (m - 1.0) + 0.1 * ((row * 7) % 11) as f64))
///     .collect();
/// let data = CongruenceData { subjects: &subjects, liking: &liking, moved: &moved, own: &own, beside: &[] };
/// let result = congruence(&data, 5.0)?;
/// assert_eq!(result.bend, Bend::Top);
/// assert!(result.turn.p_lower.unwrap() < 0.05 && result.turn.p_upper.unwrap() < 0.05);
/// assert!(matches!(result.turn.region, Some(Region::Between { low, high }) if low > -5.0 && high < 5.0));
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn congruence(data: &CongruenceData, bound: f64) -> Result<Congruence, StatsError> {
    if !(bound.is_finite() && bound > 0.0) {
        let above = "a finite number of points above 0";
        return Err(StatsError::parameter("bound", above, bound));
    }
    let product = |a: &[Option<f64>], b: &[Option<f64>]| -> Vec<Option<f64>> {
        a.iter().zip(b).map(|(a, b)| Some((*a)? * (*b)?)).collect()
    };
    let (moved, own) = (data.moved, data.own);
    let squares = [(moved, moved), (moved, own), (own, own)].map(|(a, b)| product(a, b));
    let columns = [moved, own, &squares[0], &squares[1], &squares[2]];
    let columns = COLUMNS.into_iter().zip(columns.map(Predictor::Covariate));
    let predictors: Vec<(&str, Predictor)> = columns.chain(data.beside.iter().copied()).collect();
    let names: Vec<&str> = predictors.iter().map(|(name, _)| *name).collect();
    let formula = Formula::crossed(&[], &names)?;
    let rows = ModelRows::new(data.subjects, &formula, &predictors, data.liking, FEWEST_PEOPLE)?;
    enough(&rows, moved)?;
    rows.independent()?;
    let random = |row: usize, j: usize| rows.columns.value(row, if j == 0 { 0 } else { MOVED });
    let blocks = rows.blocks(2, random);
    let fit = fit(&blocks, MixedMethod::Reml).filter(|fit| !fit.leaves_rounding(&rows.values));
    let fit = fit.ok_or_else(no_fit)?;
    let estimates = Estimates::unrestricted(&blocks, &fit, rows.offset);
    let of_person = |person: &Vec<usize>| {
        let values = person.iter().filter_map(|&row| own[rows.kept[row]]);
        values.sum::<f64>() / person.len() as f64
    };
    let of_people: Vec<f64> = rows.people.iter().map(of_person).collect();
    let own_mean = mean(&of_people).unwrap_or_default();
    let own_sd = standard_deviation(&of_people).unwrap_or_default();
    let mut undefined = Reasons::default();
    let mut effect = |(name, weights): (String, Vec<f64>)| {
        let effect = estimates.effect(&weights);
        if effect.p.is_none() {
            undefined.note(&name, NO_FREEDOM);
        }
        (name, effect)
    };
    let weights = |parts: &[(usize, f64)]| {
        let mut weights = vec![0.0; rows.columns.count()];
        for (column, weight) in parts {
            weights[*column] = *weight;
        }
        weights
    };
    let coef = rows.columns.coefficients().into_iter().map(&mut effect);
    let coef = coef.collect();
    let surface = SURFACE.iter().map(|(name, parts)| effect(((*name).to_owned(), weights(parts))));
    let surface = surface.collect();
    let ratio = |a: &[(usize, f64)], b: f64| Ratio {
        estimates: &estimates,
        a: weights(a),
        b: weights(&[(MOVED_SQUARED, b)]),
    };
    let turn = ratio(&[(MOVED, 1.0), (PRODUCT, own_mean)], 2.0).test(bound);
    let movement = ratio(&[(PRODUCT, own_sd)], 1.0).test(bound);
    for (name, test) in [("turn", &turn), ("movement", &movement)] {
        if test.estimate.is_none() {
            undefined.note(name, "the curvature is 0");
        } else if test.region.is_none() {
            undefined.note(name, NO_FREEDOM);
        }
    }
    Ok(Congruence {
        n_obs: rows.values.len(),
        n_subjects: rows.people.len(),
        missing: rows.missing,
        bound,
        own_mean,
        own_sd,
        coef,
        slope_sd: fit.random_sd(1),
        residual_sd: fit.variance.sqrt(),
        singular: fit.is_singular(&blocks),
        bend: if fit.beta[(MOVED_SQUARED, 0)] < 0.0 { Bend::Top } else { Bend::Bottom },
        turn,
        movement,
        surface,
        undefined,
    })
}

/// Refuses one row a person, and distances that have no curvature.
fn enough(rows: &ModelRows, moved: &[Option<f64>]) -> Result<(), StatsError> {
    let (n_obs, n_subjects) = (rows.values.len(), rows.people.len());
    complete::enough("row", n_obs, rows.missing, n_subjects + 1)?;
    let places = distinct(rows.kept.iter().filter_map(|&row| moved[row]).collect());
    if places < 3 {
        let three = "at least 3 different distances, as two have no curvature";
        return Err(StatsError::parameter("moved", three, places as f64));
    }
    Ok(())
}

/// Edwards and Parry's numbers, with what was met = own + moved.
const SURFACE: [(&str, &[(usize, f64)]); 9] = [
    ("b1", &[(OWN, 1.0), (MOVED, -1.0)]),
    ("b2", &[(MOVED, 1.0)]),
    ("b3", &[(OWN_SQUARED, 1.0), (PRODUCT, -1.0), (MOVED_SQUARED, 1.0)]),
    ("b4", &[(PRODUCT, 1.0), (MOVED_SQUARED, -2.0)]),
    ("b5", &[(MOVED_SQUARED, 1.0)]),
    ("a1", &[(OWN, 1.0)]),
    ("a2", &[(OWN_SQUARED, 1.0)]),
    ("a3", &[(OWN, 1.0), (MOVED, -2.0)]),
    ("a4", &[(OWN_SQUARED, 1.0), (MOVED_SQUARED, 4.0), (PRODUCT, -2.0)]),
];

/// How many values there are, where those that differ by less than a thousandth of their span are one.
fn distinct(mut values: Vec<f64>) -> usize {
    values.sort_by(f64::total_cmp);
    let span = values.last().zip(values.first()).map_or(0.0, |(high, low)| high - low);
    let apart = values.windows(2).filter(|pair| pair[1] - pair[0] > SAME_PLACE * span);
    apart.count() + 1
}

#[cfg(test)]
mod tests;
