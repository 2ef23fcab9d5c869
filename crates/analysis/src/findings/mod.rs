//! The findings of a study, a file a group of questions: which rows answer a question, and by which rule.

mod car;
mod conditions;
mod congruence;
mod declared;
mod people;
mod presses;
mod retest;
mod sensitivity;
mod study;
mod style;

pub use study::{against_the_paper, of_study};
