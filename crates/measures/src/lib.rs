//! The yardsticks: functions of a [`Drive`](maveric_domain::Drive), or of questionnaire answers.
//!
//! [`objective`] measures drives, [`accuracy`] compares a drive with the participant's own one, [`likeness`] as distributions,
//! [`survey`] scores questionnaires. Nothing here knows what drove or what answered.

pub mod accuracy;
pub mod error;
pub mod likeness;
pub mod objective;
pub mod survey;

pub use accuracy::{Accuracy, difference_from_own, drive_accuracy, mean_accuracy};
pub use error::MeasureError;
pub use objective::Measure;
pub use survey::{ItemMatrix, ScoreWarning, Scored, parse_scale, score};
