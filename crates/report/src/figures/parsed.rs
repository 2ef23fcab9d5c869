//! An SVG of ours, parsed: what its pictures in other formats are made of.

use super::font::{FAMILY, Face};
use super::style;
use std::sync::{Arc, OnceLock};

/// Parses with our fonts and nothing of the machine's.
pub(crate) fn parsed(svg: &str) -> Result<usvg::Tree, usvg::Error> {
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
    usvg::Tree::from_str(svg, &options)
}
