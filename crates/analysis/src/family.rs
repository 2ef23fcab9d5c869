//! One family of tests, corrected after Holm.

use crate::AnalysisError;
use maveric_stats::adjust;

/// Writes beside the p of each test of a family what it is after Holm; a test without a p is not of the family.
pub(crate) fn holm<'a>(
    family: impl Iterator<Item = (Option<f64>, &'a mut Option<f64>)>,
) -> Result<(), AnalysisError> {
    let tested = family.filter_map(|(p, corrected)| Some((p?, corrected)));
    let (p, corrected): (Vec<f64>, Vec<&mut Option<f64>>) = tested.unzip();
    for (corrected, holm) in corrected.into_iter().zip(adjust(&p)?.holm) {
        *corrected = Some(holm);
    }
    Ok(())
}
