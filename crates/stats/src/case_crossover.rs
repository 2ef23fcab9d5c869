//! What came before an event: the moment of each event against other moments of the same stretch of time of the same person.

use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

use crate::{
    Interval,
    numerics::{
        distributions::{t_quantile_two_sided, t_two_sided},
        moments::mean_and_square_sum,
        roots::brent,
    },
    reasons::Reasons,
};

/// A stretch of time of one person: the exposure at each event, and at each other moment at which one could have come.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseStratum {
    /// Who it is of.
    pub person: String,
    /// The exposure at each event.
    pub events: Vec<f64>,
    /// The exposure at each other moment.
    pub others: Vec<f64>,
}

/// A conditional logistic regression of events on one exposure.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CaseCrossover {
    /// People with a stretch that tells: with an event, with another moment, and of more than one exposure.
    pub people: usize,
    /// Such stretches.
    pub strata: usize,
    /// Events in them.
    pub events: usize,
    /// Moments in them, events among these.
    pub moments: usize,
    /// Standard deviation of the exposure over these moments, over n − 1.
    pub sd: Option<f64>,
    /// Log odds of an event for one standard deviation more of the exposure.
    pub estimate: Option<f64>,
    /// exp(estimate).
    pub odds_ratio: Option<f64>,
    /// The 95 % interval of the odds ratio: the odds at which t of the people's scores would be as large as it may be.
    #[serde(flatten, with = "crate::interval::odds_ratio_ci")]
    pub odds_ratio_ci: Interval,
    /// Standard error of the estimate as the likelihood has it, as if moments of one person knew nothing of each other.
    pub se_model: Option<f64>,
    /// t of the people's scores (slopes of their log likelihoods) at odds of 1.
    pub t: Option<f64>,
    /// people − 1.
    pub df: Option<usize>,
    /// Two-sided p of t.
    pub p: Option<f64>,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

const MOST_STEPS: usize = 60;
/// Log odds for a standard deviation above which events are told from other moments entirely: e^15 is no odds that a study can see.
const SEPARATED: f64 = 15.0;
/// What needs an estimate, and what needs a second person.
const ESTIMATES: [&str; 3] = ["estimate", "odds_ratio", "se_model"];
const TESTS: [&str; 5] = ["odds_ratio_ci_low", "odds_ratio_ci_high", "t", "df", "p"];
const CONFIDENCE: f64 = 0.95;

/// Conditional logistic regression on one exposure: each event against the other moments of its stretch. Where a stretch has several
/// events, the likelihood is the exact one, over all sets of as many moments.
///
/// p and interval have people as what is drawn: each person's slope of the log likelihood is one number, and these are held against 0 by
/// Student's t, at odds of 1 for the p, and at the odds for which t is as large as it may be for the ends of the interval. The sandwich
/// estimate of a standard error is too small with few people. How often this finds a cause where there is none:
/// `examples/false_positives_of_events.rs`.
///
/// # Source
/// Maclure (1991) for the design; Gail, Lubin and Rubinstein (1981) for the exact likelihood; ours: the t of the people's scores.
///
/// # Example
/// ```
/// # use maveric_stats::{CaseStratum, case_crossover};
/// let stratum = |person: &str, event: f64, other: f64| CaseStratum {
///     person: person.to_owned(),
///     events: vec![event],
///     others: vec![other],
/// };
/// // Of ten pairs the event has the exposure alone in six, the other moment alone in four: the odds ratio is 6 / 4.
/// let mut strata: Vec<_> = (0..6).map(|i| stratum(&i.to_string(), 1.0, 0.0)).collect();
/// strata.extend((6..10).map(|i| stratum(&i.to_string(), 0.0, 1.0)));
/// let found = case_crossover(&strata);
/// let of_one = (found.estimate.unwrap() / found.sd.unwrap()).exp();
/// assert!((of_one - 1.5).abs() < 1e-9);
/// ```
pub fn case_crossover(strata: &[CaseStratum]) -> CaseCrossover {
    let tells = |s: &&CaseStratum| {
        let mut exposures = s.events.iter().chain(&s.others);
        let first = exposures.next();
        !s.events.is_empty() && !s.others.is_empty() && exposures.any(|x| Some(x) != first)
    };
    let strata: Vec<&CaseStratum> = strata.iter().filter(tells).collect();
    let exposures = || strata.iter().flat_map(|s| s.events.iter().chain(&s.others));
    let people: BTreeSet<&str> = strata.iter().map(|s| s.person.as_str()).collect();
    let moments = exposures().count();
    let mut result = CaseCrossover {
        people: people.len(),
        strata: strata.len(),
        events: strata.iter().map(|s| s.events.len()).sum(),
        moments,
        ..CaseCrossover::default()
    };
    if strata.is_empty() {
        let reason = "no event has another moment beside it at which the exposure was another";
        result.undefined.note_all(&ESTIMATES, reason);
        result.undefined.note_all(&TESTS, reason);
        result.undefined.note("sd", reason);
        return result;
    }
    let (_, squares) = mean_and_square_sum(exposures().copied());
    let sd = (squares / (moments - 1) as f64).sqrt();
    result.sd = Some(sd);
    let estimate = fitted(&strata, sd);
    match estimate {
        Some((estimate, information)) => {
            result.estimate = Some(estimate);
            result.odds_ratio = Some(libm::exp(estimate));
            result.se_model = Some(1.0 / information.sqrt());
        }
        None => result.undefined.note_all(
            &ESTIMATES,
            "the exposure tells every event from the other moments: no odds ratio is large enough",
        ),
    }
    let t_at = |beta: f64| t_of_scores(&strata, beta, sd);
    let Some(t) = t_at(0.0) else {
        let reason = "fewer than two people whose scores differ: nothing is known of others";
        result.undefined.note_all(&TESTS, reason);
        return result;
    };
    let df = people.len() - 1;
    result.t = Some(t);
    result.df = Some(df);
    result.p = Some(t_two_sided(t, df as f64));
    let most = t_quantile_two_sided(1.0 - CONFIDENCE, df as f64);
    // t falls as the odds rise; an end that is not found is none.
    let end = |sign: f64| {
        let (middle, _) = estimate?;
        let past = |beta: f64| t_at(beta).map_or(f64::NAN, |t| t + sign * most.unwrap_or(f64::NAN));
        let far = middle + sign * SEPARATED;
        let (low, high) = if sign > 0.0 { (middle, far) } else { (far, middle) };
        brent(past, low, high).map(libm::exp)
    };
    let (low, high) = (end(-1.0), end(1.0));
    result.odds_ratio_ci = Interval { low, high };
    let ends = [low, high];
    for (name, _) in TESTS.iter().zip(ends).filter(|(_, end)| end.is_none()) {
        let reason = "the interval has no end on this side";
        result.undefined.note(name, reason);
    }
    result
}

/// Student's t of the people's slopes at these odds; none for fewer than two people, or slopes that do not differ.
fn t_of_scores(strata: &[&CaseStratum], beta: f64, sd: f64) -> Option<f64> {
    let mut people: BTreeMap<&str, f64> = BTreeMap::new();
    for stratum in strata {
        let (slope, _) = score(stratum, beta, sd);
        *people.entry(&stratum.person).or_default() += slope;
    }
    let n = people.len() as f64;
    let (mean, squares) = mean_and_square_sum(people.values().copied());
    let error = (squares / (n - 1.0) / n).sqrt();
    Some(mean / error).filter(|t| t.is_finite())
}

/// The estimate for one standard deviation, and the information there; none where it grows without end.
fn fitted(strata: &[&CaseStratum], sd: f64) -> Option<(f64, f64)> {
    let slope_and_information = |beta: f64| {
        let both = strata.iter().map(|s| score(s, beta, sd));
        both.fold((0.0, 0.0), |(u, v), (a, b)| (u + a, v + b))
    };
    let mut beta = 0.0;
    let (mut slope, mut information) = slope_and_information(beta);
    for _ in 0..MOST_STEPS {
        // The log likelihood is concave: a step that passes the top is halved.
        let mut step = (slope / information).clamp(-1.0, 1.0);
        let (mut next_slope, mut next_information) = slope_and_information(beta + step);
        while next_slope * slope < 0.0 && step.abs() > 1e-10 && next_slope.abs() > slope.abs() {
            step *= 0.5;
            (next_slope, next_information) = slope_and_information(beta + step);
        }
        beta += step;
        (slope, information) = (next_slope, next_information);
        if beta.abs() > SEPARATED || information <= 0.0 {
            return None;
        }
        if step.abs() < 1e-12 {
            break;
        }
    }
    Some((beta, information))
}

/// Slope and information of a stretch's log likelihood: elementary symmetric sums of exp(β x) over as many moments as there are events,
/// with their first two derivatives.
fn score(stratum: &CaseStratum, beta: f64, sd: f64) -> (f64, f64) {
    let exposures = || stratum.events.iter().chain(&stratum.others);
    let mean = exposures().sum::<f64>() / exposures().count() as f64;
    let standard = |x: &f64| (x - mean) / sd;
    let cases = stratum.events.len();
    let mut sums = vec![[0.0; 3]; cases + 1];
    sums[0][0] = 1.0;
    for x in exposures().map(standard) {
        let weight = libm::exp(beta * x);
        for chosen in (1..=cases).rev() {
            let [e, first, second] = sums[chosen - 1];
            sums[chosen][0] += weight * e;
            sums[chosen][1] += weight * (first + x * e);
            sums[chosen][2] += weight * (second + 2.0 * x * first + x * x * e);
        }
    }
    let [e, first, second] = sums[cases];
    let expected = first / e;
    let seen: f64 = stratum.events.iter().map(standard).sum();
    (seen - expected, second / e - expected * expected)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stratum(person: &str, events: &[f64], others: &[f64]) -> CaseStratum {
        CaseStratum { person: person.to_owned(), events: events.to_vec(), others: others.to_vec() }
    }

    fn close(found: Option<f64>, expected: f64) {
        let found = found.unwrap();
        assert!(
            (found - expected).abs() < 1e-8 * expected.abs().max(1.0),
            "{found}, not {expected}"
        );
    }

    #[test]
    fn of_pairs_it_is_mcnemars_odds_ratio_and_its_t_that_of_people_who_lean_one_way_or_the_other() {
        let mut strata: Vec<CaseStratum> =
            (0..12).map(|i| stratum(&format!("a{i}"), &[1.0], &[0.0])).collect();
        strata.extend((0..5).map(|i| stratum(&format!("b{i}"), &[0.0], &[1.0])));
        // Who was exposed at both moments, or at none, tells nothing.
        strata.push(stratum("c", &[1.0], &[1.0]));
        let found = case_crossover(&strata);
        assert_eq!((found.people, found.events, found.moments), (17, 17, 34));
        let sd = found.sd.unwrap();
        close(found.estimate, sd * (12.0_f64 / 5.0).ln());
        // By hand: the information of a share p of n is n p (1 − p).
        let information = 17.0 * (12.0 / 17.0) * (5.0 / 17.0);
        close(found.se_model, sd / f64::sqrt(information));
        // A pair's slope at odds of 1 is a half either way: t of twelve +1 and five −1.
        let (mean, n) = (7.0 / 17.0, 17.0_f64);
        let squares = n * (1.0 - mean * mean);
        close(found.t, mean / (squares / 16.0 / n).sqrt());
        assert_eq!(found.df, Some(16));
        let ends = (found.odds_ratio_ci.low.unwrap(), found.odds_ratio_ci.high.unwrap());
        let odds = found.odds_ratio.unwrap();
        assert!(ends.0 < 1.0 && 1.0 < odds && odds < ends.1, "{found:?}");
    }

    #[test]
    fn several_events_of_a_stretch_are_judged_over_all_sets_of_as_many() {
        let strata =
            [stratum("a", &[2.0, 0.5], &[0.0, 1.0, 1.5]), stratum("b", &[1.0], &[0.2, 0.1])];
        let found = case_crossover(&strata);
        // The same by listing the ten sets of two of five, and the three of one of three.
        let sd = found.sd.unwrap();
        let slope = |beta: f64| {
            let all = [2.0, 0.5, 0.0, 1.0, 1.5];
            let (mut top, mut bottom) = (0.0, 0.0);
            for i in 0..5 {
                for j in i + 1..5 {
                    let x = (all[i] + all[j]) / sd;
                    top += x * (beta * x).exp();
                    bottom += (beta * x).exp();
                }
            }
            let three = [1.0, 0.2, 0.1].map(|x| x / sd);
            let weights: f64 = three.iter().map(|x| (beta * x).exp()).sum();
            let mean: f64 = three.iter().map(|x| x * (beta * x).exp()).sum::<f64>() / weights;
            2.5 / sd - top / bottom + 1.0 / sd - mean
        };
        let at = found.estimate.unwrap();
        assert!(slope(at).abs() < 1e-9, "{}", slope(at));
        assert!(slope(at - 0.1) > 0.0 && slope(at + 0.1) < 0.0);
    }

    #[test]
    fn a_unit_and_an_offset_of_the_exposure_change_nothing() {
        let strata: Vec<CaseStratum> = (0..9)
            .map(|i| {
                let i = f64::from(i);
                let others = [(i * 1.3).sin(), (i * 2.1).cos(), 0.2 * i];
                stratum(&i.to_string(), &[(i * 0.7).sin() + 0.4], &others)
            })
            .collect();
        let other = |x: &f64| 1000.0 - 3.6 * x;
        let turned: Vec<CaseStratum> = strata
            .iter()
            .map(|s| {
                let [events, others] =
                    [&s.events, &s.others].map(|v| v.iter().map(other).collect::<Vec<f64>>());
                stratum(&s.person, &events, &others)
            })
            .collect();
        let (a, b) = (case_crossover(&strata), case_crossover(&turned));
        close(b.estimate, -a.estimate.unwrap());
        close(b.p, a.p.unwrap());
        close(b.odds_ratio_ci.low.map(|low| 1.0 / low), a.odds_ratio_ci.high.unwrap());
    }

    #[test]
    fn the_interval_ends_where_the_p_would_be_a_twentieth() {
        let strata: Vec<CaseStratum> = (0..12)
            .map(|i| {
                let i = f64::from(i);
                let others = [(i * 1.3).sin(), (i * 2.1).cos(), (i * 0.4).sin()];
                stratum(&(i as u32 % 8).to_string(), &[(i * 0.7).sin() + 0.6], &others)
            })
            .collect();
        let found = case_crossover(&strata);
        let all: Vec<&CaseStratum> = strata.iter().collect();
        let (low, high) = found.odds_ratio_ci.ends().unwrap();
        for end in [low, high] {
            let t = t_of_scores(&all, end.ln(), found.sd.unwrap()).unwrap();
            assert!((t_two_sided(t, 7.0) - 0.05).abs() < 1e-6);
        }
        let low = found.odds_ratio_ci.low.unwrap();
        assert_eq!(found.p.unwrap() < 0.05, low > 1.0);
    }

    #[test]
    fn what_cannot_be_told_is_none_with_its_reason() {
        let nothing = case_crossover(&[stratum("a", &[1.0], &[])]);
        assert_eq!((nothing.people, nothing.p), (0, None));
        assert!(nothing.undefined.get("p").unwrap().contains("no event"));
        let always: Vec<CaseStratum> =
            (0..8).map(|i| stratum(&i.to_string(), &[1.0, 1.0][..=i % 2], &[0.0, 0.0])).collect();
        let always = case_crossover(&always);
        assert_eq!((always.people, always.estimate), (8, None));
        assert!(always.undefined.get("estimate").unwrap().contains("every event"));
        assert!(always.p.unwrap() < 0.001);
        assert_eq!(always.odds_ratio_ci.low, None);
        assert!(always.undefined.get("odds_ratio_ci_low").is_some());
        let one =
            case_crossover(&[stratum("a", &[1.0], &[0.0, 2.0]), stratum("a", &[0.5], &[0.0, 2.0])]);
        assert!(one.estimate.is_some() && one.p.is_none() && one.undefined.get("p").is_some());
    }
}
