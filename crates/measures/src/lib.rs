#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

pub mod accuracy;
mod before_press;
pub mod error;
pub mod likeness;
pub mod objective;
pub mod survey;

pub use accuracy::{Accuracy, difference_from_own, drive_accuracy, mean_accuracy};
pub use before_press::{press_moments, seconds_of};
pub use error::MeasureError;
pub use objective::Measure;
pub use survey::{ItemMatrix, ScoreWarning, Scored, score};
