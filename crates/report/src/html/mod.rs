//! The page and the files around it, as bytes: whoever calls writes them.

mod files;
mod page;
mod report;

pub use files::{RenderedFile, render};
pub use report::{Input, Provenance, Report, Section};
