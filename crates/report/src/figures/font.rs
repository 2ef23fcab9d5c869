//! The bundled font, in the formats that drawing, rendering and the page need.

use ab_glyph::{Font, FontRef};
use base64::Engine as _;
use std::sync::OnceLock;

/// Family name in SVG, CSS and the drawing library.
pub(crate) const FAMILY: &str = "Maveric Sans";

/// Height of a capital, in em.
pub(crate) const CAP_HEIGHT_EM: f64 = 0.66;

/// Ascent minus descent, in em: what `ab_glyph`, and so plotters, takes for "size".
pub(crate) const LINE_EM: f64 = 1.326;

/// One of the three faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Face {
    /// Text.
    Regular,
    /// Symbols for statistics and variables.
    Italic,
    /// Titles.
    Semibold,
}

impl Face {
    /// All faces.
    pub(crate) const ALL: [Self; 3] = [Self::Regular, Self::Italic, Self::Semibold];

    /// The face as TrueType.
    pub(crate) fn ttf(self) -> &'static [u8] {
        match self {
            Self::Regular => include_bytes!("font/MavericSans-Regular.ttf"),
            Self::Italic => include_bytes!("font/MavericSans-Italic.ttf"),
            Self::Semibold => include_bytes!("font/MavericSans-Semibold.ttf"),
        }
    }

    fn woff2(self) -> &'static [u8] {
        match self {
            Self::Regular => include_bytes!("font/MavericSans-Regular.woff2"),
            Self::Italic => include_bytes!("font/MavericSans-Italic.woff2"),
            Self::Semibold => include_bytes!("font/MavericSans-Semibold.woff2"),
        }
    }

    fn parsed(self) -> &'static FontRef<'static> {
        static FACES: OnceLock<[FontRef<'static>; 3]> = OnceLock::new();
        let faces = FACES.get_or_init(|| {
            Self::ALL.map(|face| {
                FontRef::try_from_slice(face.ttf()).expect("the bundled fonts are valid TrueType")
            })
        });
        &faces[self as usize]
    }

    /// Whether the face has a glyph for `sign`.
    pub(crate) fn has(self, sign: char) -> bool {
        self.parsed().glyph_id(sign).0 != 0
    }

    /// Advance width of `text` without kerning, in em.
    pub(crate) fn width_em(self, text: &str) -> f64 {
        let font = self.parsed();
        let units = font.units_per_em().unwrap_or(1000.0);
        let advance: f32 =
            text.chars().map(|sign| font.h_advance_unscaled(font.glyph_id(sign))).sum();
        f64::from(advance / units)
    }
}

/// `@font-face` rules with the three faces inside, for the page and for an SVG on its own.
pub(crate) fn font_face_css() -> &'static str {
    static CSS: OnceLock<String> = OnceLock::new();
    CSS.get_or_init(|| {
        let rule = |face: Face| {
            let (style, weight) = match face {
                Face::Regular => ("normal", 400),
                Face::Italic => ("italic", 400),
                Face::Semibold => ("normal", 600),
            };
            let data = base64::engine::general_purpose::STANDARD.encode(face.woff2());
            format!(
                "@font-face{{font-family:\"{FAMILY}\";font-style:{style};font-weight:{weight};\
                 src:url(data:font/woff2;base64,{data}) format(\"woff2\")}}\n"
            )
        };
        Face::ALL.map(rule).concat()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_face_has_the_signs_that_statistics_need() {
        for face in Face::ALL {
            for sign in "aZ09−ηχρεφψβθα²₂≤≥±×·→°ŵ".chars() {
                assert!(face.has(sign), "{face:?} lacks {sign}");
            }
        }
    }

    #[test]
    fn figures_are_of_even_width() {
        let widths: Vec<f64> =
            ["0", "1", "7", "8"].map(|digit| Face::Regular.width_em(digit)).to_vec();
        assert!(widths.windows(2).all(|pair| (pair[0] - pair[1]).abs() < 1e-6));
    }
}
