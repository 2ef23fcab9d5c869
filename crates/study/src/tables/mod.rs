//! Tables as files: Parquet, or text with commas, semicolons or tabs between its cells, read with errors that name the row.

mod builder;
pub mod collected;
pub mod conditions;
pub mod dial;
pub mod dictionary;
pub mod drives;
pub mod embeddings;
pub(crate) mod keys;
pub mod measurements;
pub mod own_measures;
pub mod participants;
mod records;
mod reshape;
mod rows;
pub mod surveys;
mod table;

pub use builder::TableBuilder;
pub use dictionary::TableName;
pub use records::read_rows;
pub use rows::write_rows;
pub use table::Table;
