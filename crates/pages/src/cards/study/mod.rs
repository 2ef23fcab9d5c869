//! The answers that a study's page opens with.

mod car;
mod conditions;
mod data;
mod people;
mod presses;
mod results;
mod retest;
mod style;

pub use data::Study;
pub use results::{against_the_paper, cards};
