//! Tables: one shape, four ways to write it, and a builder for each table of the report.

mod accuracy;
mod columns;
mod correlations;
mod exclusions;
mod participants;
mod reliabilities;
mod table;
mod write;

pub use accuracy::{AccuracyRow, accuracy};
pub use columns::TableOf;
pub use correlations::{Coefficient, Correlation, CorrelationRow, correlations};
pub use exclusions::{Exclusion, exclusions};
pub use participants::{ParticipantGroup, participants};
pub use reliabilities::{Reliability, reliabilities};
pub use table::{Align, Cell, Column, Table};
pub(crate) use write::{latex, markdown};
