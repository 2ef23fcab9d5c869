//! Figures, tables and the page: numbers in; SVG, PNG, HTML, CSV, Markdown and LaTeX out.
//!
//! Each figure is a function from exactly the plain numbers that it draws to a
//! [`figures::Figure`]; [`html::render`] turns a [`html::Report`] into files, as bytes. Nothing
//! here reads or writes a file, or computes a test: a test's result comes in as a sentence of [`apa`].

pub mod claims;
pub mod error;
pub mod figures;
pub mod html;
pub mod markup;
pub mod tables;

pub use error::ReportError;
pub use figures::{Context, Figure};
pub use html::{Report, render};
pub use maveric_stats::apa;
