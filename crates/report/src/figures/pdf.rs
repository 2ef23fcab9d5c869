//! An SVG of ours as PDF: lines stay lines, letters are outlines.
//!
//! Fonts are not embedded: the library writes them in the order of a hash map, and the same figure would not be the same bytes.

use super::parsed::parsed;
use crate::error::ReportError;

/// Renders an SVG as a PDF of one page, of the figure's size.
pub(crate) fn render(figure: &str, svg: &str) -> Result<Vec<u8>, ReportError> {
    let failed = |reason: String| ReportError::Pdf {
        figure: figure.to_owned(),
        reason,
    };
    let tree = parsed(svg).map_err(|error| failed(error.to_string()))?;
    // Our sizes are in millimetres, which the parser turns into pixels of 1/96 inch; a PDF counts 72 points an inch.
    let page = svg2pdf::PageOptions { dpi: 96.0 };
    let conversion = svg2pdf::ConversionOptions {
        embed_text: false,
        ..svg2pdf::ConversionOptions::default()
    };
    svg2pdf::to_pdf(&tree, conversion, page).map_err(|error| failed(error.to_string()))
}
