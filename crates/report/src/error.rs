//! What can go wrong when numbers become figures, tables and pages.

/// Everything this crate refuses to do, and why.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// A number that a figure was to show is not a number, or infinite.
    #[error("figure `{figure}` cannot show {field} = {value}: expected a finite number")]
    NotFinite {
        /// Name of the figure.
        figure: String,
        /// Which of its numbers.
        field: String,
        /// What was found.
        value: f64,
    },
    /// There is nothing, or too little, to draw.
    #[error("figure `{figure}` needs at least {expected} {what}, got {found}")]
    TooFew {
        /// Name of the figure.
        figure: String,
        /// What it needs more of.
        what: String,
        /// How many there were.
        found: usize,
        /// How many it needs.
        expected: usize,
    },
    /// Two lists that belong together differ in length.
    #[error("figure `{figure}`: {what} has {found} values, expected {expected}")]
    LengthMismatch {
        /// Name of the figure.
        figure: String,
        /// Which list.
        what: String,
        /// Its length.
        found: usize,
        /// The length it should have.
        expected: usize,
    },
    /// A number lies outside what it can mean.
    #[error("figure `{figure}`: {field} = {value}, expected {expected}")]
    OutOfRange {
        /// Name of the figure.
        figure: String,
        /// Which number.
        field: String,
        /// What was found.
        value: f64,
        /// What was expected, in words.
        expected: String,
    },
    /// The drawing library failed.
    #[error("could not draw figure `{figure}`: {reason}")]
    Drawing {
        /// Name of the figure.
        figure: String,
        /// What it said.
        reason: String,
    },
    /// A style file says what no figure can look like.
    #[error("the style cannot be used: {reason}")]
    Style {
        /// What is wrong with it.
        reason: String,
    },
    /// An SVG could not be turned into a PDF.
    #[error("could not render figure `{figure}` as PDF: {reason}")]
    Pdf {
        /// Name of the figure.
        figure: String,
        /// What the renderer said.
        reason: String,
    },
    /// An SVG could not be turned into a PNG.
    #[error("could not render figure `{figure}` as PNG: {reason}")]
    Png {
        /// Name of the figure.
        figure: String,
        /// What the renderer said.
        reason: String,
    },
    /// A row of a table has another number of cells than the table has columns.
    #[error("table `{table}`, row {row}: {found} cells, expected {expected}")]
    TableShape {
        /// Name of the table.
        table: String,
        /// Row, from 0.
        row: usize,
        /// Cells in that row.
        found: usize,
        /// Columns of the table.
        expected: usize,
    },
    /// A number in a table is not finite.
    #[error("table `{table}`, row {row}, column {column}: {value} is not a finite number")]
    TableNumber {
        /// Name of the table.
        table: String,
        /// Row, from 0.
        row: usize,
        /// Column, from 0.
        column: usize,
        /// What was found.
        value: f64,
    },
    /// The claims file is not what it should be.
    #[error("could not read the claims: {reason}")]
    Claims {
        /// What the parser said.
        reason: String,
    },
    /// A claim contradicts itself or lacks what its rule needs.
    #[error("claim `{id}`: {reason}")]
    Claim {
        /// The claim.
        id: String,
        /// What is wrong.
        reason: String,
    },
    /// Two figures, tables or claims share a name.
    #[error("the name `{name}` is used twice: files and anchors would collide")]
    DuplicateName {
        /// The name that both have.
        name: String,
    },
    /// A name cannot be a file name or an anchor.
    #[error("`{name}` is not a usable name: expected lower-case letters, digits and hyphens")]
    BadName {
        /// The name as it was given.
        name: String,
    },
    /// A part of the page that moves cannot be made.
    #[error("the live part below figure `{below}`: {reason}")]
    Live {
        /// The figure below which it stands.
        below: String,
        /// What was found, and what was expected.
        reason: String,
    },
    /// The page could not be filled in.
    #[error("could not fill in the page: {reason}")]
    Template {
        /// What the template engine said.
        reason: String,
    },
}
