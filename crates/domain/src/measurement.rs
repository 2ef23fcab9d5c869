//! What was measured of drives.

use crate::{condition::ConditionId, drive::DriveMeta, ids::ParticipantId};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// One of the study's own measures of a person in a condition.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OwnMeasurement {
    /// Of whom.
    pub participant: ParticipantId,
    /// In which condition, or in the baseline.
    pub condition: ConditionId,
    /// Id of the measure.
    pub measure: String,
    /// Mean over the sessions and trials that have a value, in the unit that the measure declares.
    pub value: f64,
    /// How many these are.
    pub n: usize,
}

/// The objective measures of one drive by code name; `None` where the drive has none.
pub type MeasureValues = BTreeMap<String, Option<f64>>;

/// What was measured of one drive: a row of the measurements.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeasuredDrive {
    /// Whose drive it is.
    pub meta: DriveMeta,
    /// Code name of the measure → value.
    pub values: MeasureValues,
    /// Time from the start over which counts and extremes were taken, in s, where the person's drives differ in length; else the whole.
    pub counted_s: Option<f64>,
}

/// Standard deviation of each measure over drives (n − 1): the unit in which people perceive differences.
///
/// A measure with fewer than two values, or with all of them equal, has none.
pub fn spread(drives: &[&MeasureValues]) -> BTreeMap<String, f64> {
    let names: BTreeSet<&String> = drives.iter().flat_map(|d| d.keys()).collect();
    let sd = |name: &String| {
        let values: Vec<f64> =
            drives.iter().filter_map(|d| d.get(name).copied().flatten()).collect();
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        Some((squares / (n - 1.0)).sqrt()).filter(|sd| sd.is_finite() && *sd > 0.0)
    };
    names.into_iter().filter_map(|name| Some((name.clone(), sd(name)?))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measures_that_do_not_vary_have_no_unit() {
        let drive = |v: Option<f64>| {
            MeasureValues::from([("x".to_owned(), Some(1.0)), ("y".to_owned(), v)])
        };
        let drives = [drive(Some(1.0)), drive(Some(3.0)), drive(None)];
        let found = spread(&drives.iter().collect::<Vec<_>>());
        assert_eq!(found, BTreeMap::from([("y".to_owned(), 2_f64.sqrt())]));
        assert!(spread(&[]).is_empty());
    }
}
