#![doc = include_str!("../README.md")]
#![allow(clippy::missing_errors_doc)] // a part of the program: its errors are read, not matched on

mod aside;
pub mod atomic_write;
mod beyond;
mod deciding;
pub mod design;
pub mod design_check;
pub mod design_pipeline;
pub mod error;
pub mod forget;
pub mod forgotten;
pub mod gate;
mod judged;
mod mean;
pub mod missing;
mod named;
mod named_files;
mod off_the_scale;
mod once;
pub mod outcome;
mod outputs;
mod presses;
mod recordings;
pub mod run_folder;
mod stage;
pub mod stages;
mod style;
mod style_scores;
pub mod tables;
mod texts;
pub mod watching;

pub use beyond::beyond_in_words;
pub use design::DesignFile;
pub use design_check::{check_design, study_notes};
pub use design_pipeline::design_pipeline;
pub use error::StudyError;
pub use missing::missing;
pub use named_files::{check_named_files, check_people};
pub use outcome::{Outcome, Progress, Watch};
pub use stage::{Files, Stage};
pub use style::style_figures;
pub use style_scores::style_range;
