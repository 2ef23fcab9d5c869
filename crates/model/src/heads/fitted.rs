//! A head with its numbers: what training finds, and what a style makes of it.

use super::{
    family::{Family, Loss},
    head::Event,
    list::HEADS,
};
use crate::error::ModelError;
use serde::{Deserialize, Serialize};

/// A head's numbers.
///
/// `η = common·z + slopes·w + u`, `u` a drive's own deviation that the style does not explain.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FittedHead {
    /// Its code name.
    pub name: String,
    /// What η means.
    pub family: Family,
    /// a: weights of the constant and of what is read, shape `(1 + reads,)`.
    pub common: Vec<f64>,
    /// B: how far the style moves η, shape `(d,)`.
    pub slopes: Vec<f64>,
    /// SD of a drive's own deviation from what its style says, in η's unit: between people and days.
    pub between_sd: f64,
    /// SD of one event around its drive's η; 0 for a probability, which needs none.
    pub within_sd: f64,
    /// Events learned from; 0: nothing was learned.
    pub events: usize,
    /// Drives among them.
    pub drives: usize,
}

impl FittedHead {
    /// η without a drive's own deviation, for a style and a situation.
    pub(crate) fn eta(&self, w: &[f64], z: impl Iterator<Item = f64>) -> f64 {
        let common: f64 = self.common.iter().zip(z).map(|(a, z)| a * z).sum();
        common + self.slopes.iter().zip(w).map(|(b, w)| b * w).sum::<f64>()
    }

    /// The loss of a drive's events, for a style and a deviation of its own.
    pub(super) fn loss(&self, w: &[f64], deviation: f64, events: &[Event]) -> Loss {
        let mut sum = Loss::default();
        for event in events {
            let eta = self.eta(w, event.z()) + deviation;
            let loss = self.family.loss(event.outcome, eta, self.within_sd);
            sum.value += loss.value;
            sum.slope += loss.slope;
            sum.curvature += loss.curvature;
        }
        sum
    }

    /// Whether there was anything to learn from.
    pub fn learned(&self) -> bool {
        self.events > 0
    }
}

/// Checks heads that were read from a file: all of [`HEADS`], in their order, of one size.
pub(crate) fn check(heads: &[FittedHead], d: usize) -> Result<(), ModelError> {
    let bad = |problem: String| Err(ModelError::bad_file(problem));
    if heads.len() != HEADS.len() {
        return bad(format!("{} heads, expected {}", heads.len(), HEADS.len()));
    }
    for (head, known) in heads.iter().zip(&HEADS) {
        if head.name != known.name || head.family != known.family {
            return bad(format!("head `{}`, expected `{}`", head.name, known.name));
        }
        let sizes = (head.common.len(), head.slopes.len());
        if sizes != (1 + known.reads.len(), d) {
            return bad(format!("head `{}` is of another size", head.name));
        }
        let numbers = head.common.iter().chain(&head.slopes);
        let sds = [head.between_sd, head.within_sd];
        if !numbers.chain(&sds).all(|x| x.is_finite()) || sds.iter().any(|s| *s < 0.0) {
            return bad(format!("head `{}` holds no usable numbers", head.name));
        }
    }
    Ok(())
}

/// What a head says of one driver: `η = common·z` with the style folded in.
#[derive(Debug, Clone)]
pub(crate) struct OwnHead {
    family: Family,
    common: Vec<f64>,
    within_sd: f64,
}

impl OwnHead {
    /// `None` where nothing was learned.
    pub(crate) fn new(fitted: &FittedHead, w: &[f64]) -> Option<Self> {
        if !fitted.learned() {
            return None;
        }
        let mut common = fitted.common.clone();
        common[0] = fitted.eta(w, std::iter::once(1.0));
        Some(Self { family: fitted.family, common, within_sd: fitted.within_sd })
    }

    /// The mean of what this driver does in the situation `reads`, in the head's unit; of one habit, a probability.
    pub(crate) fn expected(&self, reads: &[f64]) -> f64 {
        let z = std::iter::once(&1.0).chain(reads);
        let eta = self.common.iter().zip(z).map(|(a, z)| a * z).sum();
        self.family.mean(eta, self.within_sd)
    }

    /// The mean for the situation of an event.
    pub(crate) fn expected_for(&self, event: &Event) -> f64 {
        self.expected(&event.reads)
    }
}
