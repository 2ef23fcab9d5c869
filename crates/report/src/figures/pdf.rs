//! An SVG of ours as PDF: lines stay lines, letters are outlines.
//!
//! Fonts are not embedded: the library writes them in the order of a hash map, and the same figure would not be the same bytes.

use super::font::{FAMILY, Face};
use super::style;
use crate::error::ReportError;
use std::sync::{Arc, OnceLock};
use svg2pdf::usvg;

/// Renders an SVG as a PDF of one page, of the figure's size. The library reads SVG by an older parser than the one that makes PNG, so it has
/// options of its own.
pub(crate) fn render(figure: &str, svg: &str) -> Result<Vec<u8>, ReportError> {
    static FONTS: OnceLock<Arc<usvg::fontdb::Database>> = OnceLock::new();
    let fonts = FONTS.get_or_init(|| {
        let mut fonts = usvg::fontdb::Database::new();
        for face in Face::ALL {
            fonts.load_font_data(face.ttf().to_vec());
        }
        for font in style::current().into_iter().flat_map(|s| &s.fonts) {
            fonts.load_font_data(font.clone());
        }
        Arc::new(fonts)
    });
    let options = usvg::Options {
        fontdb: Arc::clone(fonts),
        font_family: FAMILY.to_owned(),
        ..usvg::Options::default()
    };
    let failed = |reason: String| ReportError::Pdf {
        figure: figure.to_owned(),
        reason,
    };
    let tree = usvg::Tree::from_str(svg, &options).map_err(|error| failed(error.to_string()))?;
    // Our sizes are in millimetres, which the parser turns into pixels of 1/96 inch; a PDF counts 72 points an inch.
    let page = svg2pdf::PageOptions { dpi: 96.0 };
    let conversion = svg2pdf::ConversionOptions {
        embed_text: false,
        ..svg2pdf::ConversionOptions::default()
    };
    svg2pdf::to_pdf(&tree, conversion, page).map_err(|error| failed(error.to_string()))
}
