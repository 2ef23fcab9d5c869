//! How well the people learned from explain a drive: how surprising its habits are *before* a style is fitted.
//!
//! A check after the fit would pass the very drives that matter, because a few numbers explain an extreme drive well.

use super::{fitted::FittedHead, head::Event, list::HEADS, posterior::LEAST_SD};
use crate::error::ModelError;
use maveric_domain::BeyondWhy;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

/// p below which a drive is beyond what a model has learned from.
///
/// A convention, not chosen on any recording: of drives of the people learned from one in a hundred is told so wrongly.
pub const BEYOND_P: f64 = 0.01;
/// People for each habit that a drive shows, below which the spread between people is not known well enough to say anything.
const PEOPLE_A_HABIT: usize = 3;

/// How well the people learned from explain one drive.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Support {
    /// Habits that the drive shows, q.
    pub habits: usize,
    /// People learned from, N.
    pub people: usize,
    /// D²: squared distance of the drive's habits from those of the mean person, in the spread of people, days and readings.
    pub distance: f64,
    /// Part of [`Support::distance`] that a style explains: |w|² of the most probable one. The rest no style explains.
    pub by_style: f64,
    /// Its mean over drives of the people learned from.
    pub by_style_expected: f64,
    /// Probability of a drive at least as surprising, by one of the people learned from; none with too few people to say.
    pub p: Option<f64>,
    /// Code name of the habit that stands furthest from what the drive's others let expect.
    pub strangest: &'static str,
    /// How far that is, in SD.
    pub strangest_sd: f64,
}

impl Support {
    /// Why the drive is beyond what was learned from; none where it is not, or where too few people were learned from to say.
    pub fn beyond(&self) -> Option<BeyondWhy> {
        self.p.filter(|p| *p < BEYOND_P)?;
        let habit = self.strangest.to_owned();
        // Each part beside what it is in the mean.
        let style = self.by_style / self.by_style_expected.max(f64::MIN_POSITIVE);
        let rest = (self.distance - self.by_style)
            / (self.habits as f64 - self.by_style_expected).max(f64::MIN_POSITIVE);
        Some(if style > rest { BeyondWhy::Style { habit } } else { BeyondWhy::Habits { habit } })
    }
}

/// What a drive shows of one habit: how far its events lie from those of the mean person in the same situations.
struct Reading {
    head: usize,
    deviation: f64,
    /// Squared sampling error.
    variance: f64,
}

/// Newton steps at most; a convex function of one number needs few.
const STEPS: usize = 50;

/// The events of one head as a single normal reading: exact for normal events, for others the normal reading that has the same
/// slope and curvature at the most probable deviation.
fn reading(which: usize, head: &FittedHead, events: &[Event]) -> Option<Reading> {
    if !head.learned() || events.is_empty() {
        return None;
    }
    let none = vec![0.0; head.slopes.len()];
    let prior = 1.0 / total_variance(head);
    let loss_at = |deviation: f64| head.loss(&none, deviation, events);
    let mut deviation = 0.0;
    for _ in 0..STEPS {
        let loss = loss_at(deviation);
        let gradient = loss.slope + prior * deviation;
        let step = -gradient / (loss.curvature + prior);
        // Newton's next error is the square of this one; nearer, rounding alone decides whether a step helps.
        if step.abs() < 1e-8 * (1.0 + deviation.abs()) {
            deviation += step;
            break;
        }
        let total = |value: f64, x: f64| value + 0.5 * prior * x * x;
        let current = total(loss.value, deviation);
        let mut share = 1.0;
        let at = |x: f64| total(loss_at(x).value, x);
        while share > 1e-6 && at(deviation + share * step) > current {
            share *= 0.5;
        }
        deviation += share * step;
    }
    let loss = loss_at(deviation);
    (loss.curvature > 1e-9 * prior).then(|| Reading {
        head: which,
        deviation: deviation - loss.slope / loss.curvature,
        variance: 1.0 / loss.curvature,
    })
}

/// Variance of a drive's deviation from the mean person: what the style says and what it leaves.
fn total_variance(head: &FittedHead) -> f64 {
    let between_sd = head.between_sd.max(LEAST_SD);
    head.slopes.iter().map(|b| b * b).sum::<f64>() + between_sd * between_sd
}

/// How the habits of the people learned from differ, as a whole and before any style: what a drive's readings are held against.
///
/// Unlike what the heads say of a style it leaves nothing open and ties nothing together: with a few numbers a style cannot carry
/// every habit, and a drive that differs in one that it leaves aside is no stranger for that.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Population {
    /// People learned from, N.
    pub(crate) people: usize,
    /// Mean deviation of the drives from their heads, shape `(habits,)`.
    mean: Vec<f64>,
    /// Covariance of the drives' deviations, the error of their readings aside, shape `(habits, habits)`, row by row.
    covariance: Vec<f64>,
}

/// Rounds at most, and the largest change of a variance, as a share of it, at which they end.
const ROUNDS: usize = 500;
const TOLERANCE: f64 = 1e-5;

impl Population {
    /// The normal population whose drives are most probable, readings missing and uncertain as they are (EM).
    pub(crate) fn learn(heads: &[FittedHead], drives: &[Vec<Vec<Event>>], people: usize) -> Self {
        let h = heads.len();
        let shown: Vec<Vec<Reading>> =
            drives.iter().map(|events| readings(heads, events)).collect();
        let n = shown.len() as f64;
        let mut mean = DVector::zeros(h);
        let variances = DVector::from_iterator(h, heads.iter().map(total_variance));
        let mut covariance = DMatrix::from_diagonal(&variances);
        // Drives that show no habit leave the population as the heads expect it.
        let rounds = if shown.is_empty() { 0 } else { ROUNDS };
        for _ in 0..rounds {
            let (mut sum, mut second) = (DVector::zeros(h), DMatrix::zeros(h, h));
            for readings in &shown {
                let (there, left) = known(&mean, &covariance, readings);
                second += &there * there.transpose() + left;
                sum += there;
            }
            let next = &sum / n;
            let spread = second / n - &next * next.transpose();
            let moved = (0..h).map(|k| (spread[(k, k)] / covariance[(k, k)] - 1.0).abs());
            let largest = moved.fold(0.0, f64::max);
            (mean, covariance) = (next, spread);
            // A variance that goes to nothing must not take the inverse with it.
            for k in 0..h {
                covariance[(k, k)] = covariance[(k, k)].max(LEAST_SD * LEAST_SD);
            }
            if largest < TOLERANCE {
                break;
            }
        }
        // Of a sample: the mean is its own.
        if !shown.is_empty() {
            covariance *= n / (n - 1.0).max(1.0);
        }
        Self {
            people,
            mean: mean.iter().copied().collect(),
            covariance: covariance.iter().copied().collect(),
        }
    }

    /// Checks what was read from a file.
    pub(crate) fn check(&self, heads: usize) -> Result<(), ModelError> {
        let numbers = || self.mean.iter().chain(&self.covariance);
        let sizes = self.mean.len() == heads && self.covariance.len() == heads * heads;
        if sizes && numbers().all(|x| x.is_finite()) {
            return Ok(());
        }
        Err(ModelError::bad_file("its population is of another size or no number"))
    }

    /// How well the people learned from explain what a drive shows; `None` where it shows nothing.
    ///
    /// With y the q habits shown: `D² = (y − μ)ᵀ C⁻¹ (y − μ)`, `C` the covariance of the population and the error of the readings,
    /// and `p = P(F(q, N − q) > D² N (N − q) / (q (N² − 1)))`.
    pub(crate) fn support(&self, heads: &[FittedHead], events: &[Vec<Event>]) -> Option<Support> {
        let h = heads.len();
        let mut readings = readings(heads, events);
        // A reading that says less than is known of everybody says nothing of this drive.
        readings.retain(|r| r.variance <= self.covariance[r.head * (h + 1)]);
        let q = readings.len();
        let covariance = DMatrix::from_fn(q, q, |i, j| {
            let between = self.covariance[readings[i].head * h + readings[j].head];
            between + if i == j { readings[i].variance } else { 0.0 }
        });
        let inverse = covariance.cholesky().filter(|_| q > 0)?.inverse();
        let y = readings.iter().map(|r| r.deviation - self.mean[r.head]);
        let y = DVector::from_iterator(q, y);
        let weighted = &inverse * &y;
        let distance = y.dot(&weighted);
        let d = heads.first().map_or(0, |h| h.slopes.len());
        let b = DMatrix::from_fn(q, d, |i, j| heads[readings[i].head].slopes[j]);
        let away = |i: usize| weighted[i] / inverse[(i, i)].sqrt();
        let strangest = (0..q).max_by(|i, j| away(*i).abs().total_cmp(&away(*j).abs()))?;
        Some(Support {
            habits: q,
            people: self.people,
            distance,
            by_style: (b.transpose() * &weighted).norm_squared(),
            by_style_expected: (b.transpose() * &inverse * &b).trace(),
            p: probability(distance, q, self.people),
            strangest: HEADS[readings[strangest].head].name,
            strangest_sd: away(strangest),
        })
    }
}

fn readings(heads: &[FittedHead], events: &[Vec<Event>]) -> Vec<Reading> {
    let pairs = heads.iter().zip(events).enumerate();
    let one = |(k, (head, events)): (usize, (&FittedHead, &Vec<Event>))| reading(k, head, events);
    pairs.filter_map(one).collect()
}

/// Mean and covariance of a drive's deviations, given its readings.
fn known(
    mean: &DVector<f64>,
    covariance: &DMatrix<f64>,
    readings: &[Reading],
) -> (DVector<f64>, DMatrix<f64>) {
    let (mut there, mut left) = (mean.clone(), covariance.clone());
    // One reading after the other: their errors are independent.
    for reading in readings {
        let column = left.column(reading.head).into_owned();
        let variance = column[reading.head] + reading.variance;
        let surprise = reading.deviation - there[reading.head];
        there.axpy(surprise / variance, &column, 1.0);
        left.ger(-1.0 / variance, &column, &column, 1.0);
    }
    (there, left)
}

fn probability(distance: f64, q: usize, people: usize) -> Option<f64> {
    if people < PEOPLE_A_HABIT * q || people <= q {
        return None;
    }
    let (q, n) = (q as f64, people as f64);
    let f = FisherSnedecor::new(q, n - q).ok()?;
    let p = f.sf(distance * n * (n - q) / (q * (n * n - 1.0)));
    p.is_finite().then_some(p)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::heads::{DriveEvents, Outcome, Shape, family::Family, fit};
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64Mcg;

    /// Three habits of two hidden numbers each, five events a drive.
    fn drives(n: usize, seed: u64, shift: [f64; 3]) -> Vec<DriveEvents> {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let drive = |_| {
            let (a, b) = (normal(), normal());
            let means = [30.0 + 3.0 * a, 1.0 - 0.5 * a + 0.4 * b, 4.0 + b];
            let habit = |k: usize, normal: &mut dyn FnMut() -> f64| -> Vec<Event> {
                let own = means[k] + shift[k] + 0.2 * normal();
                let event = |_| Event {
                    time_s: 0.0,
                    reads: Vec::new(),
                    outcome: Outcome::Value(own + 0.5 * normal()),
                };
                (0..5).map(event).collect()
            };
            (0..3).map(|k| habit(k, &mut normal)).collect()
        };
        (0..n).map(drive).collect()
    }

    fn learned(n: usize, seed: u64) -> (Vec<FittedHead>, Population) {
        let shape = Shape {
            name: "free_speed_mps",
            family: Family::Gaussian,
            left_open: 0.1,
            reads: 0,
            ridge: 1e-3,
        };
        let drives = drives(n, seed, [0.0; 3]);
        let heads = fit(&[shape, shape, shape], &drives, 2).heads;
        let population = Population::learn(&heads, &drives, n);
        (heads, population)
    }

    #[test]
    fn people_like_those_learned_from_are_seldom_beyond_and_strangers_are() {
        let mut p: Vec<f64> = Vec::new();
        for training in 0..25 {
            let (heads, population) = learned(30, training);
            for events in drives(20, 100 + training, [0.0; 3]) {
                p.push(population.support(&heads, &events).unwrap().p.unwrap());
            }
        }
        p.sort_by(f64::total_cmp);
        let n = p.len() as f64;
        let apart =
            |(i, p): (usize, &f64)| (p - i as f64 / n).abs().max((p - (i + 1) as f64 / n).abs());
        let largest = p.iter().enumerate().map(apart).fold(0.0, f64::max);
        assert!(largest < 0.06, "Kolmogorov's D = {largest} of 500");
        assert!(p.iter().filter(|p| **p < BEYOND_P).count() <= 10);

        let (heads, population) = learned(30, 1);
        let beyond = |shift: [f64; 3]| {
            let strangers = drives(20, 7, shift);
            let of = |events: &DriveEvents| population.support(&heads, events).unwrap();
            strangers.iter().map(of).filter(|s| s.beyond().is_some()).count()
        };
        assert!(beyond([0.0; 3]) <= 1);
        assert!(beyond([30.0, -5.0, 0.0]) == 20, "{}", beyond([30.0, -5.0, 0.0]));
        // Both habits are usual, not together.
        assert!(beyond([6.0, 1.6, 0.0]) >= 15, "{}", beyond([6.0, 1.6, 0.0]));
    }

    #[test]
    fn along_a_style_and_against_every_style_are_told_apart() {
        let (heads, population) = learned(60, 2);
        let drive = |values: [f64; 3]| -> DriveEvents {
            let event =
                |value| Event { time_s: 0.0, reads: Vec::new(), outcome: Outcome::Value(value) };
            values.map(|v| vec![event(v); 5]).to_vec()
        };
        let why = |values| population.support(&heads, &drive(values)).unwrap().beyond();
        assert_eq!(why([30.0, 1.0, 4.0]), None);
        assert!(matches!(why([48.0, -2.0, 4.0]), Some(BeyondWhy::Style { .. })));
        assert!(matches!(why([34.0, 3.0, 4.0]), Some(BeyondWhy::Habits { .. })));
    }

    #[test]
    fn too_few_people_say_nothing_and_a_drive_that_shows_nothing_has_no_support() {
        let (heads, population) = learned(8, 3);
        let shown = &drives(1, 9, [0.0; 3])[0];
        let support = population.support(&heads, shown).unwrap();
        assert_eq!((support.habits, support.people, support.p), (3, 8, None));
        assert_eq!(support.beyond(), None);
        // Two habits of eight people are few enough.
        let mut fewer = shown.clone();
        fewer[0].clear();
        assert!(population.support(&heads, &fewer).unwrap().p.is_some());
        assert_eq!(population.support(&heads, &vec![Vec::new(); 3]), None);
        assert!(population.check(3).is_ok() && population.check(4).is_err());
    }
}
