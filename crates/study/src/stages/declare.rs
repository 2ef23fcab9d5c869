//! `design describe`: the design as the text of a preregistration.

use super::sample_size::sample_size;
use crate::{design::DesignFile, error::StudyError, outcome::Outcome};
use maveric_pages::preregistration;
use serde::Serialize;
use std::path::Path;

/// A design in plain English.
#[derive(Debug, Clone, Serialize)]
pub struct Described {
    /// Markdown, a section a heading.
    pub text: String,
}

/// The design in plain English, under the headings of a preregistration. The power of its tests is what a rehearsal found: `power`, or
/// `rehearsal/rehearsal.json` beside the design.
///
/// # Errors
/// [`StudyError`] if the design or the rehearsal cannot be read, the rehearsal is of other outcomes or conditions, or the test of a primary
/// outcome can never be run.
///
/// # Source
/// Headings: the OSF Preregistration template and AsPredicted.
pub fn describe(
    design: Option<&Path>,
    power: Option<&Path>,
) -> Result<Outcome<Described>, StudyError> {
    let study = DesignFile::find(design)?;
    study.declarable()?;
    let text = preregistration(&study.design, &sample_size(&study, power)?)?;
    let summary = text.lines().map(str::to_owned).collect();
    Ok(Outcome::new(Described { text }, summary, Vec::new()))
}
