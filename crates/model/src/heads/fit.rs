//! Fitting heads and styles together: a mixed factor model of habits, alternating to convergence.
//!
//! Given the heads, every drive's posterior is solved as for a new driver ([`super::posterior`]); given the posteriors, each
//! head is a weighted regression of its events on the situation and the style, with the style's uncertainty in it. Events that
//! are not normal enter as the normal events that have the same slope and curvature there. The same likelihood, [`Family::loss`],
//! serves both halves.

use super::{
    family::{Family, Outcome, tail_ratio},
    fitted::FittedHead,
    head::{Event, Shape},
    posterior::{LEAST_SD, Latent, solve},
};
use crate::linear_algebra::symmetric_eigen;
use nalgebra::{DMatrix, DVector};

/// Rounds at most.
const ROUNDS: usize = 200;
/// Largest change of a number, in its head's scatter between drives, at which the rounds end.
const TOLERANCE: f64 = 1e-3;
/// Scatter of an event that a single drive starts with, as a share of the scatter over all.
const FIRST_WITHIN: f64 = 0.5;

/// What one drive showed, head by head.
pub(crate) type DriveEvents = Vec<Vec<Event>>;

/// Heads and the posteriors of the drives that they were learned from.
pub(crate) struct Fitted {
    pub(crate) heads: Vec<FittedHead>,
    pub(crate) latents: Vec<Latent>,
    /// Rounds that it took.
    #[cfg(test)]
    pub(crate) rounds: usize,
}

/// Learns heads of those shapes, with `d` numbers a style, or none: then there are own deviations alone.
pub(crate) fn fit(shapes: &[Shape], drives: &[DriveEvents], d: usize) -> Fitted {
    let mut heads: Vec<FittedHead> = shapes
        .iter()
        .enumerate()
        .map(|(k, head)| first(head, drives.iter().map(|e| e[k].as_slice()), d))
        .collect();
    first_slopes(&mut heads, shapes, drives, d);
    let mut latents: Vec<Latent> = Vec::new();
    let mut rounds = 0;
    while rounds < ROUNDS {
        rounds += 1;
        let before = heads.clone();
        latents = posteriors(&heads, drives, &latents, d);
        for (k, head) in heads.iter_mut().enumerate() {
            if head.learned() {
                refit(head, &shapes[k], k, drives, &latents, d);
            }
        }
        share_out(&mut heads, shapes);
        standardise(&mut heads, &latents, d);
        if heads.iter().zip(&before).all(|(a, b)| same(a, b)) {
            break;
        }
    }
    turn(&mut heads, d);
    latents = posteriors(&heads, drives, &[], d);
    Fitted {
        heads,
        latents,
        #[cfg(test)]
        rounds,
    }
}

fn posteriors(
    heads: &[FittedHead],
    drives: &[DriveEvents],
    last: &[Latent],
    d: usize,
) -> Vec<Latent> {
    let one = |(i, events): (usize, &DriveEvents)| {
        solve(heads, events, None, d, last.get(i).map(|l| &l.mean))
    };
    drives.iter().enumerate().map(one).collect()
}

/// A head that knows no style: the mean over all drives.
fn first<'a>(
    head: &Shape,
    drives: impl Iterator<Item = &'a [Event]> + Clone,
    d: usize,
) -> FittedHead {
    let events = || drives.clone().flatten();
    let n = events().count();
    let value = |e: &Event| match e.outcome {
        Outcome::Value(v) | Outcome::AtLeast(v) => head.family.linked(v),
    };
    let mean = events().map(value).sum::<f64>() / n.max(1) as f64;
    let square = events().map(|e| (value(e) - mean).powi(2)).sum::<f64>();
    let sd = (square / n.max(1) as f64).sqrt();
    let mut common = vec![0.0; 1 + head.reads];
    let normal = head.family != Family::Logistic;
    if normal {
        common[0] = mean;
    }
    FittedHead {
        name: head.name.to_owned(),
        family: head.family,
        common,
        slopes: vec![0.0; d],
        between_sd: if normal { sd.max(LEAST_SD) } else { 1.0 },
        within_sd: if normal { (FIRST_WITHIN * sd).max(LEAST_SD) } else { 0.0 },
        events: n,
        drives: drives.filter(|e| !e.is_empty()).count(),
    }
}

/// Starts the slopes along the principal components of the drives' own deviations.
fn first_slopes(heads: &mut [FittedHead], shapes: &[Shape], drives: &[DriveEvents], d: usize) {
    let (n, k) = (drives.len(), heads.len());
    for (which, head) in heads.iter_mut().enumerate() {
        // Two rounds without a style: levels, and weights of what is read.
        for _ in 0..2 {
            if head.learned() {
                let alone = posteriors_of_one(head, which, drives, d, k);
                refit(head, &shapes[which], which, drives, &alone, d);
                head.slopes.fill(0.0);
            }
        }
    }
    let latents = posteriors(heads, drives, &[], d);
    let deviations = DMatrix::from_fn(n, k, |i, j| latents[i].mean[d + j] / heads[j].between_sd);
    let (values, vectors) = symmetric_eigen(&(deviations.tr_mul(&deviations) / n.max(1) as f64));
    for (number, value) in values.iter().take(d).enumerate() {
        let size = value.max(0.0).sqrt();
        for (j, head) in heads.iter_mut().enumerate() {
            if head.learned() {
                head.slopes[number] = head.between_sd * size * vectors[(j, number)];
            }
        }
    }
    for head in heads.iter_mut() {
        head.between_sd *= std::f64::consts::FRAC_1_SQRT_2;
    }
}

/// Posteriors as if there were no other head.
fn posteriors_of_one(
    head: &FittedHead,
    which: usize,
    drives: &[DriveEvents],
    d: usize,
    k: usize,
) -> Vec<Latent> {
    let silent = FittedHead { events: 0, between_sd: 1.0, ..head.clone() };
    let mut heads = vec![silent; k];
    heads[which] = head.clone();
    posteriors(&heads, drives, &[], d)
}

/// The numbers of one head, given what is known of every drive: a weighted regression on `[z, w]`.
fn refit(
    head: &mut FittedHead,
    shape: &Shape,
    k: usize,
    drives: &[DriveEvents],
    latents: &[Latent],
    d: usize,
) {
    let family = head.family;
    let p = head.common.len();
    let size = p + d;
    let index = d + k;
    let mut normal = DMatrix::zeros(size, size);
    let mut right = DVector::zeros(size);
    for (events, latent) in drives.iter().zip(latents) {
        let mut weights = 0.0;
        for event in &events[k] {
            let eta = head.eta(latent.w(d), event.z()) + latent.mean[index];
            let loss = family.loss(event.outcome, eta, head.within_sd);
            let weight = loss.curvature.max(1e-6);
            let seen = eta - loss.slope / weight;
            let x = DVector::from_iterator(size, event.z().chain(latent.w(d).iter().copied()));
            normal.syger(weight, &x, &x, 1.0);
            right.axpy(weight * (seen - latent.mean[index]), &x, 1.0);
            weights += weight;
        }
        // What is not known of w and of its own deviation.
        let mut block = normal.view_mut((p, p), (d, d));
        block += weights * latent.covariance.view((0, 0), (d, d));
        let mut part = right.rows_mut(p, d);
        part -= weights * latent.covariance.view((0, index), (d, 1));
    }
    normal.fill_upper_triangle_with_lower_triangle();
    let ridge = shape.ridge * normal.trace() / size as f64 / head.events.max(1) as f64;
    for i in 1..size {
        normal[(i, i)] += ridge.max(1e-12);
    }
    if let Some(solved) = normal.cholesky().map(|c| c.solve(&right)) {
        head.common.copy_from_slice(&solved.as_slice()[..p]);
        head.slopes.copy_from_slice(&solved.as_slice()[p..]);
    }
    let shown = || drives.iter().zip(latents).filter(|(e, _)| !e[k].is_empty());
    let square = |l: &Latent| l.mean[index] * l.mean[index] + l.covariance[(index, index)];
    let between = shown().map(|(_, l)| square(l)).sum::<f64>() / head.drives.max(1) as f64;
    head.between_sd = between.sqrt().max(LEAST_SD);
    if family != Family::Logistic {
        let events = shown().flat_map(|(e, l)| e[k].iter().map(move |e| (e, l)));
        let within = events.map(|(event, latent)| {
            let (eta, variance) = latent.eta(head, k, event);
            variance + expected_square(family, event.outcome, eta, head.within_sd)
        });
        let within = within.sum::<f64>() / head.events.max(1) as f64;
        head.within_sd = within.sqrt().max(LEAST_SD);
    }
}

/// Mean square distance from η of what was done, where that is known to be above a bound as well as where it is known.
fn expected_square(family: Family, outcome: Outcome, eta: f64, sd: f64) -> f64 {
    match outcome {
        Outcome::Value(value) => (family.linked(value) - eta).powi(2),
        Outcome::AtLeast(value) => {
            let z = (family.linked(value) - eta) / sd;
            sd * sd * (1.0 + z * tail_ratio(z)).max(0.0)
        }
    }
}

/// Leaves open what [`Shape::left_open`] says: it is the style that has to explain the rest.
fn share_out(heads: &mut [FittedHead], shapes: &[Shape]) {
    for (head, known) in heads.iter_mut().zip(shapes).filter(|(h, _)| h.learned()) {
        let square = head.slopes.iter().map(|b| b * b).sum::<f64>();
        let variance = head.between_sd * head.between_sd + square;
        head.between_sd = (known.left_open * variance).sqrt().max(LEAST_SD);
    }
}

/// Moves and scales the styles so that over the drives they have mean 0 and covariance I, and the heads with them.
fn standardise(heads: &mut [FittedHead], latents: &[Latent], d: usize) {
    let n = latents.len().max(1) as f64;
    let mut mean = DVector::zeros(d);
    let mut second = DMatrix::zeros(d, d);
    for latent in latents {
        let w = latent.mean.rows(0, d).into_owned();
        second += (&w * w.transpose() + latent.covariance.view((0, 0), (d, d))) / n;
        mean += w / n;
    }
    second -= &mean * mean.transpose();
    let Some(root) = second.cholesky().map(|c| c.l()) else {
        return;
    };
    for head in heads.iter_mut() {
        let slopes = DVector::from_column_slice(&head.slopes);
        head.common[0] += slopes.dot(&mean);
        let scaled = root.transpose() * slopes;
        head.slopes.copy_from_slice(scaled.as_slice());
    }
}

/// Turns the styles so that the numbers are the principal directions of the heads, the largest first, each pointing where
/// the first head that it moves most rises.
fn turn(heads: &mut [FittedHead], d: usize) {
    let rows: Vec<&FittedHead> = heads.iter().filter(|h| h.learned()).collect();
    let slopes = DMatrix::from_fn(rows.len(), d, |i, j| {
        let between = rows[i].between_sd;
        let variance = rows[i].slopes.iter().map(|b| b * b).sum::<f64>() + between * between;
        rows[i].slopes[j] / variance.sqrt()
    });
    let (_, vectors) = symmetric_eigen(&slopes.tr_mul(&slopes));
    let columns: Vec<DVector<f64>> = vectors
        .column_iter()
        .map(|column| {
            let moved = &slopes * column;
            column * if moved.is_empty() { 1.0 } else { moved[moved.iamax()].signum() }
        })
        .collect();
    for head in heads.iter_mut() {
        let old = DVector::from_column_slice(&head.slopes);
        for (to, column) in head.slopes.iter_mut().zip(&columns) {
            *to = old.dot(column);
        }
    }
}

/// Whether a round changed nothing that matters.
fn same(a: &FittedHead, b: &FittedHead) -> bool {
    let scale = TOLERANCE * a.between_sd.max(LEAST_SD);
    // Slopes may turn together without moving anything: their length is compared.
    let length = |h: &FittedHead| h.slopes.iter().map(|b| b * b).sum::<f64>().sqrt();
    (a.common[0] - b.common[0]).abs() < scale
        && (length(a) - length(b)).abs() < scale
        && (a.between_sd - b.between_sd).abs() < scale
        && (a.within_sd - b.within_sd).abs() < scale
}

#[cfg(test)]
mod tests;
