//! Ordered answers: a cumulative logit model with a random intercept.

mod fit;
mod likelihood;
mod rows;

use serde::{Deserialize, Serialize};

use crate::{
    Interval, Named, Reasons, StatsError,
    numerics::distributions::{chi2_upper, normal_quantile, normal_two_sided},
    within_subjects::pairs,
};
use fit::{Errors, Top, top};
use likelihood::{Likelihood, Rule, Sample};
use rows::Answers;

/// A threshold or a coefficient, on the scale of the logit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OrdinalParameter {
    /// `None` where there is no finite one, or the fit did not settle.
    pub estimate: Option<f64>,
    /// Its standard error, from the observed information.
    pub se: Option<f64>,
    /// estimate / se.
    pub z: Option<f64>,
    /// Two-sided.
    pub p: Option<f64>,
    /// The 95 % interval.
    #[serde(flatten, with = "crate::interval::ci")]
    pub ci: Interval,
}

/// The variance of the subjects' intercepts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OrdinalVariance {
    /// On the scale of the logit.
    pub subject: Option<f64>,
}

/// The likelihood ratio test of the conditions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LikelihoodRatio {
    /// Twice the difference of the log likelihoods with and without conditions, of all rows.
    pub chi2: Option<f64>,
    /// Conditions less 1.
    pub df: usize,
    /// P(χ² ≥ chi2).
    pub p: Option<f64>,
}

/// What one way of taking the integral over subjects gives.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OrdinalFit {
    /// Thresholds `j|k` between neighbouring answers that occur.
    pub threshold: Named<OrdinalParameter>,
    /// Conditions, against the first: positive where answers are higher.
    pub coef: Named<OrdinalParameter>,
    /// Of the subjects.
    pub variance: OrdinalVariance,
    /// ln of the likelihood at its top, or its limit where a coefficient has no finite estimate.
    pub log_likelihood: Option<f64>,
    /// Against the model without conditions.
    pub lr: LikelihoodRatio,
}

/// A cumulative logit model of ordered answers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Ordinal {
    /// Answers.
    pub n_obs: usize,
    /// How many subjects gave an answer.
    pub n_subjects: usize,
    /// Rows left out because the answer is missing.
    pub missing: usize,
    /// Names of the conditions; the first is the reference.
    pub conditions: Vec<String>,
    /// The answers that occur.
    pub answers: Vec<i64>,
    /// By adaptive Gauss-Hermite quadrature with 10 nodes.
    #[serde(flatten)]
    pub quadrature: OrdinalFit,
    /// By Laplace's approximation, a single node: as other programs do by default.
    pub laplace: OrdinalFit,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// Fits logit P(answer ≤ j) = threshold j - coefficient of the condition - u, with u ~ N(0, τ²) a subject.
///
/// The three columns have shape `(rows,)`; answers are whole numbers of which the order alone counts; any number of rows a subject and
/// condition. The integral over u is taken around each subject's mode with its curvature there. A condition in which everybody gives
/// the lowest or highest answer has no finite coefficient: the others are the limit, which is the fit without its rows. Its likelihood
/// has a limit too, so that the likelihood ratio is there even where the conditions separate the answers whole.
///
/// # Errors
/// [`StatsError::LengthMismatch`]; [`StatsError::NotFinite`]; [`StatsError::NotWhole`]; [`StatsError::TooFewConditions`];
/// [`StatsError::EmptyCell`] for a condition without an answer; [`StatsError::TooFew`] below two subjects; [`StatsError::NoFit`] if
/// all answers are equal.
///
/// # Source
/// McCullagh (1980); Tutz and Hennevogl (1996); Pinheiro and Bates (1995) for the quadrature. Agrees with R's `ordinal::clmm`.
///
/// # Example
/// ```
/// let people: Vec<String> = (0..16).map(|i| (i / 2).to_string()).collect();
/// let mode: Vec<String> = (0..16).map(|i| ["calm", "sporty"][i % 2].to_owned()).collect();
/// let answer = [1, 3, 2, 3, 1, 2, 2, 4, 3, 3, 2, 1, 3, 4, 1, 3].map(|a| Some(f64::from(a)));
/// let found = maveric_stats::ordinal(&people, &mode, &answer)?;
/// assert!(found.quadrature.coef.get("sporty").unwrap().estimate.unwrap() > 0.0);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn ordinal(
    subjects: &[String],
    conditions: &[String],
    answers: &[Option<f64>],
) -> Result<Ordinal, StatsError> {
    Ok(by_period(subjects, conditions, &[], answers)?.0)
}

/// A row's subject, condition, period (or none of any row) and answer, as columns.
pub(crate) type Rows<'a> = (&'a [String], &'a [String], &'a [usize], &'a [Option<f64>]);

/// A difference of two conditions on the scale of the logit, and its standard error.
pub(crate) type Difference = (f64, f64);

/// The same with a coefficient of each period but the first, and every pair of conditions, `a|b`, that has a finite difference.
pub(crate) fn by_period(
    subjects: &[String],
    conditions: &[String],
    periods: &[usize],
    answers: &[Option<f64>],
) -> Result<(Ordinal, Vec<(String, Difference)>), StatsError> {
    let data = Answers::new(subjects, conditions, periods, answers)?;
    let reduced = data.without_separated();
    let (with, without) = (reduced.sample(), data.without_conditions().sample());
    let mut undefined = Reasons::default();
    let mut fit = |rule: &Rule, from: Option<&(Top, Top)>, prefix: &str| {
        let mut likelihood = Likelihood::new(&with, rule);
        let full = top(&mut likelihood, from.map(|(full, _)| full)).map(|top| {
            let errors = Errors::at(&mut likelihood, &top.parameters);
            (top, errors)
        });
        let mut likelihood = Likelihood::new(&without, rule);
        let flat = top(&mut likelihood, from.map(|(_, flat)| flat));
        let mut reasons = Reasons::default();
        let described = describe(&data, &reduced, full.as_ref(), flat.as_ref(), &mut reasons);
        undefined.absorb(prefix, reasons);
        let pairs = full.as_ref().map_or_else(Vec::new, |full| differences(&reduced, full));
        (described, full.map(|(top, _)| top).zip(flat), pairs)
    };
    let (laplace, from, _) = fit(&Rule::laplace(), None, "laplace");
    let (quadrature, _, pairs) = fit(&Rule::ten_nodes(), from.as_ref(), "");
    let ordinal = Ordinal {
        n_obs: data.rows.len(),
        n_subjects: data.subjects,
        missing: answers.len() - data.rows.len(),
        conditions: data.conditions.clone(),
        answers: data.categories.clone(),
        quadrature,
        laplace,
        undefined,
    };
    Ok((ordinal, pairs))
}

/// Twice what the log likelihood of a model by [`by_period`] loses where two conditions are one, of each pair, `a|b`, without a finite
/// difference: there the estimate has no error to be held against, and the ratio is what is left.
pub(crate) fn ratios_of_pairs(
    (subjects, conditions, periods, answers): Rows<'_>,
    model: &Ordinal,
    finite: &[(String, Difference)],
) -> Result<Vec<(String, f64)>, StatsError> {
    let Some(apart) = model.quadrature.log_likelihood else {
        return Ok(Vec::new());
    };
    let data = Answers::new(subjects, conditions, periods, answers)?;
    let ratio = |(first, second, name): (usize, usize, String)| {
        if finite.iter().any(|(known, _)| *known == name) {
            return None;
        }
        let one = highest(&data.with_one_of(first, second).without_separated())?;
        Some((name, (2.0 * (apart - one)).max(0.0)))
    };
    Ok(pairs(&data.conditions).into_iter().filter_map(ratio).collect())
}

/// ln of the likelihood at its top, by quadrature; `None` if that does not settle.
fn highest(data: &Answers) -> Option<f64> {
    let sample = data.sample();
    let (one, ten) = (Rule::laplace(), Rule::ten_nodes());
    let near = top(&mut Likelihood::new(&sample, &one), None);
    let there = top(&mut Likelihood::new(&sample, &ten), near.as_ref())?;
    Some(there.value)
}

/// Every pair of conditions that has a finite difference.
fn differences(reduced: &Answers, (top, errors): &(Top, Errors)) -> Vec<(String, Difference)> {
    let first = reduced.sample().thresholds();
    let coefficient = |condition: usize| condition.checked_sub(1).map(|place| first + place);
    let value = |parameter: Option<usize>| match parameter {
        None => Some(0.0),
        Some(parameter) => {
            top.finite(parameter, errors.of_parameter(parameter)).map(|(estimate, _)| estimate)
        }
    };
    pairs(&reduced.conditions)
        .into_iter()
        .filter_map(|(a, b, name)| {
            let (a_at, b_at) = (coefficient(a), coefficient(b));
            let difference = value(a_at)? - value(b_at)?;
            let se = errors.of_difference(a_at, b_at)?;
            Some((name, (difference, se)))
        })
        .collect()
}

const SEPARATED: &str =
    "the conditions separate the answers whole: nothing is left that subjects could differ in";
const NOT_CONVERGED: &str =
    "the model does not converge: answers hardly differ within people, or conditions separate them";

fn describe(
    data: &Answers,
    reduced: &Answers,
    with: Option<&(Top, Errors)>,
    without: Option<&Top>,
    undefined: &mut Reasons,
) -> OrdinalFit {
    let sample: Sample = reduced.sample();
    let mut parameter = |name: String, place: Result<usize, &str>| {
        let fitted = match (place, with) {
            (Ok(place), Some((top, errors))) => top
                .finite(place, errors.of_parameter(place))
                .ok_or("the answers leave it without a finite estimate"),
            (Ok(_), None) => Err(NOT_CONVERGED),
            (Err(reason), _) => Err(reason),
        };
        if let Err(reason) = fitted {
            undefined.note(&name, reason);
        }
        let fitted = fitted.ok();
        let se = fitted.and_then(|(_, se)| se);
        if fitted.is_some() && se.is_none() {
            let parts = ["se", "z", "p", "ci_low", "ci_high"];
            undefined.note_below(&name, &parts, "the likelihood is flat in this direction");
        }
        let estimate = fitted.map(|(estimate, _)| estimate);
        let z = estimate.zip(se).map(|(estimate, se)| estimate / se);
        let half = se.map(|se| se * normal_quantile(0.975));
        OrdinalParameter {
            estimate,
            se,
            z,
            p: z.map(normal_two_sided),
            ci: estimate.map_or_else(Interval::default, |e| Interval::around(e, half)),
        }
    };
    // With another reference thresholds and coefficients would mean something else.
    let reference = reduced.conditions.first() == data.conditions.first();
    let no_reference = "the reference condition has one extreme answer only, so nothing finite can be said against it";
    let mut threshold = Vec::new();
    for pair in data.categories.windows(2) {
        let name = format!("{}|{}", pair[0], pair[1]);
        let known = reduced.categories.windows(2).position(|known| known == pair);
        let place = if reference {
            known.ok_or("an answer beside it occurs only in conditions with one extreme answer")
        } else {
            Err(no_reference)
        };
        threshold.push((name.clone(), parameter(format!("threshold.{name}"), place)));
    }
    let mut coef = Vec::new();
    for name in &data.conditions[1..] {
        let known = reduced.conditions.iter().position(|known| known == name);
        let place = match known {
            _ if !reference => Err(no_reference),
            None => {
                Err("everybody gives the same extreme answer in this condition: no finite estimate")
            }
            Some(condition) => Ok(sample.thresholds() + condition - 1),
        };
        coef.push((name.clone(), parameter(format!("coef.{name}"), place)));
    }
    if with.is_none() {
        undefined.note_all(&["variance.subject", "log_likelihood"], NOT_CONVERGED);
    }
    let with = with.map(|(top, _)| top);
    let whole = reduced.categories.len() < 2;
    if whole && with.is_some() {
        undefined.note("variance.subject", SEPARATED);
    }
    let chi2 =
        with.zip(without).map(|(with, without)| (2.0 * (with.value - without.value)).max(0.0));
    if chi2.is_none() {
        undefined.note_all(&["lr.chi2", "lr.p"], NOT_CONVERGED);
    }
    let df = data.conditions.len() - 1;
    OrdinalFit {
        threshold: threshold.into_iter().collect(),
        coef: coef.into_iter().collect(),
        variance: OrdinalVariance {
            subject: with.filter(|_| !whole).map(|top| top.sd() * top.sd()),
        },
        log_likelihood: with.map(|top| top.value),
        lr: LikelihoodRatio { chi2, df, p: chi2.map(|chi2| chi2_upper(chi2, df as f64)) },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Answers of eight people in three conditions.
    fn made(third: [i32; 8]) -> (Vec<String>, Vec<String>, Vec<Option<f64>>) {
        let first = [1, 2, 2, 3, 1, 3, 2, 4];
        let second = [2, 2, 3, 4, 3, 2, 1, 4];
        let people = (0..24).map(|i| (i / 3).to_string()).collect();
        let conditions = (0..24).map(|i| ["a", "b", "c"][i % 3].to_owned()).collect();
        let answers = (0..8).flat_map(|i| [first[i], second[i], third[i]]);
        (people, conditions, answers.map(|a| Some(f64::from(a))).collect())
    }

    #[test]
    fn only_the_order_of_the_answers_counts() {
        let (people, conditions, answers) = made([1, 1, 2, 2, 1, 3, 1, 2]);
        let stretched: Vec<_> = answers.iter().map(|a| a.map(|a| a * a)).collect();
        let plain = ordinal(&people, &conditions, &answers).unwrap();
        let other = ordinal(&people, &conditions, &stretched).unwrap();
        assert_eq!(plain.quadrature.coef, other.quadrature.coef);
        assert_eq!(other.answers, [1, 4, 9, 16]);
        assert!(other.quadrature.threshold.get("4|9").is_some());
    }

    #[test]
    fn a_condition_of_highest_answers_leaves_the_others_as_without_it() {
        let (people, conditions, answers) = made([4; 8]);
        let all = ordinal(&people, &conditions, &answers).unwrap();
        let keep = |i: &usize| conditions[*i] != "c";
        let rows: Vec<usize> = (0..24).filter(keep).collect();
        let pick = |from: &[String]| rows.iter().map(|&i| from[i].clone()).collect::<Vec<_>>();
        let fewer: Vec<_> = rows.iter().map(|&i| answers[i]).collect();
        let fewer = ordinal(&pick(&people), &pick(&conditions), &fewer).unwrap();
        assert_eq!(all.quadrature.coef.get("b"), fewer.quadrature.coef.get("b"));
        assert!(all.quadrature.coef.get("c").unwrap().estimate.is_none());
        assert!(all.undefined.get("coef.c.p").is_some());
        assert!(all.quadrature.lr.p.unwrap() < 0.01);
    }

    #[test]
    fn conditions_that_separate_the_answers_whole_have_no_coefficient_and_still_a_ratio() {
        let people: Vec<String> = (0..16).map(|i| (i / 2).to_string()).collect();
        let conditions: Vec<String> = (0..16).map(|i| ["a", "b"][i % 2].to_owned()).collect();
        let answers: Vec<_> = (0..16).map(|i| Some([1.0, 0.0][i % 2])).collect();
        let found = ordinal(&people, &conditions, &answers).unwrap();
        let fit = &found.quadrature;
        assert!(fit.coef.get("b").unwrap().estimate.is_none() && fit.variance.subject.is_none());
        assert!(fit.log_likelihood.unwrap().abs() < 1e-9);
        // Without conditions each answer is a coin's: nobody differs, and every row costs ln 2.
        let coins = 2.0 * 16.0 * std::f64::consts::LN_2;
        assert!((fit.lr.chi2.unwrap() - coins).abs() < 1e-6, "{:?}", fit.lr);
    }

    #[test]
    fn a_pair_without_a_finite_difference_has_a_ratio_and_one_with_it_has_none() {
        let (people, conditions, answers) = made([4; 8]);
        let none: &[usize] = &[];
        let of = |answers: &[Option<f64>]| {
            let (model, finite) = by_period(&people, &conditions, none, answers).unwrap();
            let columns = (&people[..], &conditions[..], none, answers);
            ratios_of_pairs(columns, &model, &finite).unwrap()
        };
        let ratios = of(&answers);
        let names: Vec<&str> = ratios.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["a|c", "b|c"]);
        // Everybody answers 4 after c, and one or two of eight after a and b.
        assert!(ratios.iter().all(|(_, chi2)| *chi2 > 4.0), "{ratios:?}");
        // Of two conditions it is the ratio of all.
        let keep: Vec<usize> = (0..24).filter(|i| conditions[*i] != "b").collect();
        let pick = |from: &[String]| keep.iter().map(|&i| from[i].clone()).collect::<Vec<_>>();
        let (people, conditions) = (pick(&people), pick(&conditions));
        let two: Vec<_> = keep.iter().map(|&i| answers[i]).collect();
        let (model, finite) = by_period(&people, &conditions, &[], &two).unwrap();
        let columns = (&people[..], &conditions[..], none, &two[..]);
        let of_two = ratios_of_pairs(columns, &model, &finite).unwrap();
        let [(_, ratio)] = &of_two[..] else {
            panic!("one pair");
        };
        assert!((ratio - model.quadrature.lr.chi2.unwrap()).abs() < 1e-8);
        let (.., scattered) = made([1, 1, 2, 2, 1, 3, 1, 2]);
        let (people, conditions, _) = made([1; 8]);
        let (model, finite) = by_period(&people, &conditions, &[], &scattered).unwrap();
        let columns = (&people[..], &conditions[..], none, &scattered[..]);
        assert!(ratios_of_pairs(columns, &model, &finite).unwrap().is_empty());
    }

    #[test]
    fn people_who_do_not_differ_have_a_variance_of_zero_and_still_a_test() {
        // Everybody's answers are a permutation of the same three.
        let people: Vec<String> = (0..18).map(|i| (i / 3).to_string()).collect();
        let conditions: Vec<String> = (0..18).map(|i| ["a", "b", "c"][i % 3].to_owned()).collect();
        let answers: Vec<_> = (0..18).map(|i| Some([1.0, 2.0, 3.0][(i + i / 3) % 3])).collect();
        let found = ordinal(&people, &conditions, &answers).unwrap();
        assert!(found.quadrature.variance.subject.unwrap() < 1e-8);
        assert!(found.quadrature.coef.get("b").unwrap().p.unwrap() > 0.5);
    }

    #[test]
    fn what_is_no_ordered_answer_is_refused() {
        let (people, conditions, mut answers) = made([1; 8]);
        answers[5] = Some(2.5);
        let error = ordinal(&people, &conditions, &answers).unwrap_err();
        assert!(matches!(error, StatsError::NotWhole { row: 5, .. }));
        let equal = vec![Some(3.0); 24];
        let error = ordinal(&people, &conditions, &equal).unwrap_err();
        assert!(matches!(error, StatsError::NoFit { .. }));
    }
}
