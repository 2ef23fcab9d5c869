//! Minimising a function of a few bounded numbers, without derivatives.

pub(super) mod differential_evolution;
pub(super) mod nelder_mead;

/// A point and the cost there.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Minimum {
    pub(super) point: Vec<f64>,
    pub(super) cost: f64,
}

/// What is minimised: the cost of a point, or infinity as soon as the cost must exceed the limit beside it.
pub(super) trait Cost: Fn(&[f64], f64) -> f64 {}
impl<T: Fn(&[f64], f64) -> f64> Cost for T {}
