//! `export`: a study without the people's names, to give away.

mod declared;
mod dictionary;
mod drives;
mod left_out;
mod material;
mod options;
mod outcomes;
mod own;
mod people;
mod pipeline;
mod place;
mod pseudonym;
mod readme;
mod ro_crate;
mod seat;
mod sources;
mod surveys;
mod writing;

pub use options::{DriveTables, ExportOptions, Exported};
pub(crate) use ro_crate::METADATA;
pub use ro_crate::{About, PipelineRun, Step};
pub use writing::export;
