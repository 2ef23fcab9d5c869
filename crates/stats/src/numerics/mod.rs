//! Distributions and linear algebra that the tests need, accurate in the tails.

mod beta_mixture;
pub(crate) mod decimal;
pub(crate) mod distributions;
pub(crate) mod matrix;
pub(crate) mod minimise;
pub(crate) mod moments;
pub(crate) mod noncentral;
mod normal_scale;
pub(crate) mod projection;
pub(crate) mod roots;
pub(crate) mod special;
pub(crate) mod spectrum;
pub(crate) mod studentized_range;
