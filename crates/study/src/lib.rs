//! The library behind every command: stages, tables and files.
//!
//! Each function of [`stages`] is one command of the `maveric` program; the program parses, calls it and prints.

pub mod atomic_write;
pub mod design;
pub mod error;
pub mod outcome;
pub mod stages;
pub mod tables;
pub mod watching;

pub use design::DesignFile;
pub use error::StudyError;
pub use outcome::{Outcome, Progress, Watch};
