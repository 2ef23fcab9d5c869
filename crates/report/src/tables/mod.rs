//! Tables: one shape, four ways to write it, and a builder for each table of the report.

mod accuracy;
mod correlations;
mod embedding_line;
mod exclusions;
mod following;
mod participants;
mod reliabilities;
mod table;
mod write;

pub use accuracy::{AccuracyRow, accuracy};
pub use correlations::{Coefficient, Correlation, CorrelationRow, correlations};
pub use embedding_line::{LineCorrelation, embedding_line};
pub use exclusions::{Exclusion, exclusions};
pub use following::{FollowingRow, following_errors};
pub use participants::{ParticipantGroup, participants};
pub use reliabilities::{Reliability, reliabilities};
pub use table::{Align, Cell, Column, Table};
pub(crate) use write::{latex, markdown};
