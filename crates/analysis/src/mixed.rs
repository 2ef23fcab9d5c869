//! 9.5: how a rating changes with the shift of the dial, in people who differ.

use crate::{
    AnalysisError,
    data::StudyData,
    homophily::{RATINGS, rating},
    result::MixedRow,
};
use maveric_domain::ConditionId;
use maveric_stats::{MixedMethod, StatsError, mixed_model};

/// ADB points in one unit of the shift.
const UNIT_POINTS: f64 = 10.0;

/// Each rating on the shift and its square, with intercept and slope of the shift random over participants.
///
/// A rating that cannot be fitted (too few answers, a constant) has no model and says why.
pub(crate) fn mixed(data: &StudyData) -> Result<Vec<MixedRow>, AnalysisError> {
    let cells: Vec<_> = data
        .participants
        .iter()
        .flat_map(|p| ConditionId::AV.map(|c| (p, c)))
        .collect();
    let subjects: Vec<String> = cells.iter().map(|(p, _)| p.to_string()).collect();
    let shift: Vec<Option<f64>> = cells
        .iter()
        .map(|(p, c)| {
            data.condition(p, *c)
                .map(|row| row.moved_points / UNIT_POINTS)
        })
        .collect();
    let square: Vec<Option<f64>> = shift.iter().map(|s| s.map(|s| s * s)).collect();
    let one = |name: &str| {
        let y: Vec<Option<f64>> = cells
            .iter()
            .map(|(p, c)| rating(data, p, *c, name))
            .collect();
        let fixed: [(&str, &[Option<f64>]); 2] = [("shift", &shift), ("shift_squared", &square)];
        let (model, why) = match mixed_model(&subjects, &y, &fixed, &["shift"], MixedMethod::Reml) {
            Ok(model) => (Some(model), None),
            Err(e @ (StatsError::TooFew { .. } | StatsError::BadParameter { .. })) => {
                (None, Some(e.to_string()))
            }
            Err(e) => return Err(e.into()),
        };
        Ok(MixedRow {
            rating: name.to_owned(),
            unit_points: UNIT_POINTS,
            model,
            why_not: why,
        })
    };
    RATINGS.iter().map(|(name, ..)| one(name)).collect()
}
