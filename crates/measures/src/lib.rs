#![doc = include_str!("../README.md")]

pub mod accuracy;
pub mod error;
pub mod likeness;
pub mod objective;
pub mod survey;

pub use accuracy::{Accuracy, difference_from_own, drive_accuracy, mean_accuracy};
pub use error::MeasureError;
pub use objective::Measure;
pub use survey::{ItemMatrix, ScoreWarning, Scored, score};
