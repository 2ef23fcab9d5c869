#![doc = include_str!("../README.md")]

mod card;
pub mod cards;
mod texts;
pub mod words;
