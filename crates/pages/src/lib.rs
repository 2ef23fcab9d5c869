#![doc = include_str!("../README.md")]

mod card;
pub mod cards;
mod preregistration;
mod texts;
pub mod words;

pub use preregistration::preregistration;
