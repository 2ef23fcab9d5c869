//! How figures are to look, from a file.

use crate::{atomic_write::read_text, error::StudyError};
use maveric_report::figures::{Style, use_style};
use std::path::Path;

/// Reads a style file with the fonts that it names, and has every figure of this process drawn like that: to be called before the first.
/// Returns the hash of all that it read.
///
/// # Errors
/// [`StudyError`] if the file or a font cannot be read, or says what no figure can look like.
pub fn style_figures(path: &Path) -> Result<String, StudyError> {
    let failed = |error: maveric_report::ReportError| StudyError::file(path, error.to_string());
    let text = read_text(path)?;
    let mut style = Style::from_toml(&text).map_err(failed)?;
    let mut hash = blake3::Hasher::new();
    hash.update(text.as_bytes());
    let folder = path.parent().unwrap_or(Path::new(""));
    for name in style.font_files().to_vec() {
        let file = folder.join(name);
        let bytes = std::fs::read(&file).map_err(StudyError::read(&file))?;
        hash.update(&bytes);
        style.fonts.push(bytes);
    }
    use_style(style).map_err(failed)?;
    Ok(hash.finalize().to_hex().to_string())
}
