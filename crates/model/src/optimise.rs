//! Minimising a smooth function of a few numbers, for those who train networks of their own.

pub use crate::{
    adam::cosine,
    damped_newton::{Evaluated, Minimum},
    quasi_newton::polish,
};
