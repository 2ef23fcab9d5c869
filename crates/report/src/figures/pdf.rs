//! An SVG of ours as PDF: lines stay lines, letters are outlines.
//!
//! Fonts are not embedded: the library writes them in the order of a hash map, and the same figure would not be the same bytes.

use super::parsed::parsed;
use crate::error::ReportError;

/// Renders an SVG as a PDF of one page, of the figure's size.
pub(crate) fn render(figure: &str, svg: &str) -> Result<Vec<u8>, ReportError> {
    let failed = |reason: String| ReportError::Pdf { figure: figure.to_owned(), reason };
    let tree = parsed(svg).map_err(|error| failed(error.to_string()))?;
    // Our sizes are in millimetres, which the parser turns into pixels of 1/96 inch; a PDF counts 72 points an inch.
    let page = svg2pdf::PageOptions { dpi: 96.0 };
    let conversion =
        svg2pdf::ConversionOptions { embed_text: false, ..svg2pdf::ConversionOptions::default() };
    let mut pdf =
        svg2pdf::to_pdf(&tree, conversion, page).map_err(|error| failed(error.to_string()))?;
    in_order(&mut pdf);
    Ok(pdf)
}

/// Puts the resources of each page and group, which the library writes in the order of a hash map, in the order of their names: the same
/// lines, so that nothing moves that the table at the end of the file points to.
fn in_order(pdf: &mut [u8]) {
    const BEGIN: &[u8] = b"/Resources <<\n";
    let mut start = 0;
    while let Some(offset) = pdf[start..].windows(BEGIN.len()).position(|w| w == BEGIN) {
        start += offset + BEGIN.len();
        let end = pdf[start..].windows(6).position(|w| w == b"endobj");
        let object = &mut pdf[start..start + end.unwrap_or(0)];
        let lines: Vec<Vec<u8>> =
            object.split_inclusive(|b| *b == b'\n').map(<[u8]>::to_vec).collect();
        let mut sorted = Vec::with_capacity(object.len());
        for run in lines.chunk_by(|a, b| is_reference(a) && is_reference(b)) {
            let mut run = run.to_vec();
            run.sort();
            sorted.extend(run.concat());
        }
        object.copy_from_slice(&sorted);
    }
}

/// Whether a line names one object: `/gs2 8 0 R`.
fn is_reference(line: &[u8]) -> bool {
    line.trim_ascii().starts_with(b"/") && line.trim_ascii().ends_with(b" 0 R")
}

#[cfg(test)]
mod tests {
    use crate::{Context, figures};

    #[test]
    fn a_figure_with_several_opacities_is_the_same_bytes_each_time() {
        let figure = figures::domain(&Context::real()).unwrap();
        let first = figure.pdf().unwrap();
        assert!(first.windows(10).any(|w| w == b"/ExtGState"));
        for _ in 0..8 {
            assert!(figure.pdf().unwrap() == first);
        }
    }
}
