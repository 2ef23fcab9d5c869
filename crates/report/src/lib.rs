#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod card;
pub mod claims;
pub mod error;
pub mod figures;
pub mod html;
pub mod markup;
pub mod tables;

pub use card::{Card, CardNumber, Tone};
pub use error::ReportError;
pub use figures::{Context, Figure};
pub use html::{Report, render};
pub use maveric_stats::apa;
