//! How figures are to look, from a file.

use crate::{atomic_write::read_text, error::StudyError};
use maveric_report::figures::{Style, use_style};
use std::path::Path;

/// Reads a style file with the fonts that it names, and has every figure of this process drawn like that: to be called before the first.
///
/// # Errors
/// [`StudyError`] if the file or a font cannot be read, or says what no figure can look like.
pub fn style_figures(path: &Path) -> Result<(), StudyError> {
    let failed = |error: maveric_report::ReportError| StudyError::file(path, error.to_string());
    let mut style = Style::from_toml(&read_text(path)?).map_err(failed)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    for name in style.font_files().to_vec() {
        let file = folder.join(name);
        style
            .fonts
            .push(std::fs::read(&file).map_err(StudyError::read(&file))?);
    }
    use_style(style).map_err(failed)
}
