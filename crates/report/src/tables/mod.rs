//! Tables: one shape, told column by column, five ways to write it, and the two tables that pages of any study have.

mod columns;
mod exclusions;
mod table;
mod write;

pub use columns::TableOf;
pub use exclusions::{Exclusion, exclusions};
pub use table::{Align, Cell, Column, Data, Table};
pub use write::{latex, markdown};
