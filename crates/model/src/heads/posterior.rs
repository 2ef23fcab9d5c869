//! What a drive's events say of its driver: the posterior of the style, and of each habit's own deviation.
//!
//! The unknowns are `w`, with the prior N(0, I), and for each head the drive's own deviation `u`, with the prior N(0, τ²): a habit
//! shown often says little more than one shown a few times, since the drive as a whole may deviate. Solved together by Newton's method,
//! damped by halving: −ln posterior is convex, and with nothing but normal, uncensored events one step is the answer.

use super::{
    family::{Family, Loss, Outcome},
    fitted::FittedHead,
    head::Event,
    style::{Posterior, StyleHead},
};
use nalgebra::{Cholesky, DMatrix, DVector};

/// The unknowns of one drive: the style, then the own deviation of every head.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Latent {
    /// Shape `(d + heads,)`.
    pub(crate) mean: DVector<f64>,
    /// Shape `(d + heads, d + heads)`.
    pub(crate) covariance: DMatrix<f64>,
    /// Newton steps that it took.
    pub(crate) steps: usize,
}

impl Latent {
    /// The mean of the style.
    pub(crate) fn w(&self, d: usize) -> &[f64] {
        &self.mean.as_slice()[..d]
    }

    pub(crate) fn style(&self, d: usize) -> Posterior {
        let block = self.covariance.view((0, 0), (d, d));
        Posterior {
            mean: self.w(d).to_vec(),
            // Symmetric, so by columns is by rows.
            covariance: block.iter().copied().collect(),
        }
    }

    /// Mean and variance of η of an event of head `k`.
    pub(crate) fn eta(&self, head: &FittedHead, k: usize, event: &Event) -> (f64, f64) {
        let d = head.slopes.len();
        let index = d + k;
        let mean = head.eta(self.w(d), event.z()) + self.mean[index];
        let mut variance = self.covariance[(index, index)];
        for (i, a) in head.slopes.iter().enumerate() {
            variance += 2.0 * a * self.covariance[(i, index)];
            for (j, b) in head.slopes.iter().enumerate() {
                variance += a * b * self.covariance[(i, j)];
            }
        }
        (mean, variance.max(0.0))
    }
}

/// Newton steps at most.
const STEPS: usize = 100;
/// Promised gain, as a share of the value, at which they end.
const TOLERANCE: f64 = 1e-10;
/// Share of the promised gain that a step must bring, and the shortest one tried.
const SUFFICIENT: f64 = 1e-4;
const SHORTEST: f64 = 1e-6;

/// −ln posterior at a point.
#[derive(Debug, Clone)]
pub(crate) struct Evaluated {
    pub(crate) value: f64,
    pub(crate) gradient: DVector<f64>,
    pub(crate) curvature: DMatrix<f64>,
}

/// −ln posterior of the unknowns `x`, up to a constant, with its slope and curvature.
pub(crate) fn evaluate(
    heads: &[FittedHead],
    events: &[Vec<Event>],
    score: Option<(f64, &StyleHead)>,
    d: usize,
    x: &DVector<f64>,
) -> Evaluated {
    let n = x.len();
    let w = &x.as_slice()[..d];
    let mut there =
        Evaluated { value: 0.0, gradient: DVector::zeros(n), curvature: DMatrix::zeros(n, n) };
    let mut prior = |i: usize, sd: f64| {
        let precision = 1.0 / (sd * sd);
        there.value += 0.5 * precision * x[i] * x[i];
        there.gradient[i] += precision * x[i];
        there.curvature[(i, i)] += precision;
    };
    (0..d).for_each(|i| prior(i, 1.0));
    for (k, head) in heads.iter().enumerate() {
        prior(d + k, head.between_sd.max(LEAST_SD));
    }
    let mut add = |loss: Loss, slopes: &[f64], own_index: Option<usize>| {
        there.value += loss.value;
        let of_style = slopes.iter().copied().enumerate();
        let reads = of_style.chain(own_index.map(|o| (o, 1.0)));
        for (i, a) in reads.clone() {
            there.gradient[i] += loss.slope * a;
            for (j, b) in reads.clone() {
                there.curvature[(i, j)] += loss.curvature * a * b;
            }
        }
    };
    for (k, (head, events)) in heads.iter().zip(events).enumerate() {
        if !head.learned() {
            continue;
        }
        // w and u move every event's η alike, so one sum a head is enough.
        add(head.loss(w, x[d + k], events), &head.slopes, Some(d + k));
    }
    if let Some((points, style)) = score {
        let eta = style.points(w);
        let loss = Family::Gaussian.loss(Outcome::Value(points), eta, style.reading_sd);
        add(loss, &style.gradient, None);
    }
    there
}

/// SD below which a deviation is taken as that, so that its prior can be written down.
pub(crate) const LEAST_SD: f64 = 1e-3;

/// The posterior of a drive's unknowns, from `start` or, without, from the prior's mean.
pub(crate) fn solve(
    heads: &[FittedHead],
    events: &[Vec<Event>],
    score: Option<(f64, &StyleHead)>,
    d: usize,
    start: Option<&DVector<f64>>,
) -> Latent {
    let n = d + heads.len();
    let evaluate = |x: &DVector<f64>| evaluate(heads, events, score, d, x);
    let mut mean = start.map_or_else(|| DVector::zeros(n), DVector::clone);
    let mut current = evaluate(&mean);
    let mut steps = 0;
    // The prior alone makes the curvature positive definite.
    while let Some(curvature) = Cholesky::new(current.curvature.clone()) {
        let step = -curvature.solve(&current.gradient);
        let promised = -step.dot(&current.gradient);
        let mut share = 1.0;
        let enough = promised > TOLERANCE * (1.0 + current.value.abs()) && steps < STEPS;
        while enough && share > SHORTEST {
            let candidate = &mean + share * &step;
            let there = evaluate(&candidate);
            if there.value <= current.value - SUFFICIENT * share * promised {
                (mean, current) = (candidate, there);
                break;
            }
            share *= 0.5;
        }
        if !enough || share <= SHORTEST {
            return Latent { mean, covariance: curvature.inverse(), steps };
        }
        steps += 1;
    }
    // Numbers that are none: nothing is known.
    Latent { mean: DVector::zeros(n), covariance: DMatrix::identity(n, n), steps }
}
