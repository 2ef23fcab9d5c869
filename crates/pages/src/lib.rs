#![doc = include_str!("../README.md")]

mod card;
pub mod cards;
mod orders;
mod preregistration;
mod texts;
pub mod words;

pub use orders::orders;
pub use preregistration::preregistration;
