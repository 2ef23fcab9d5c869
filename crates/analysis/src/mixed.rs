//! How a rating changes with the shift of the dial, in people who differ.

use crate::{
    AnalysisError,
    data::StudyData,
    homophily::{cells, ratings},
    result::MixedRow,
};
use maveric_domain::design::Condition;
use maveric_stats::{MixedMethod, StatsError, mixed_model};

/// Each rating on the shift and its square, with intercept and slope of the shift random over participants; nothing without a dial that
/// turns both ways.
///
/// A rating that cannot be fitted (too few answers, a constant) has no model and says why.
pub(crate) fn mixed(data: &StudyData) -> Result<Vec<MixedRow>, AnalysisError> {
    let dials = data.design.conditions().iter().filter_map(Condition::dial);
    let furthest = dials.clone().fold(0.0, |far: f64, d| far.max(d.abs()));
    let (low, high) = dials.fold((0.0_f64, 0.0_f64), |(l, h), d| (l.min(d), h.max(d)));
    if low >= 0.0 || high <= 0.0 {
        return Ok(Vec::new());
    }
    // A round unit of about the size of the shifts.
    let unit_points = 10_f64.powi(libm::log10(furthest).floor() as i32);
    let cells = cells(data);
    let subjects: Vec<String> = cells.iter().map(|(p, _)| p.to_string()).collect();
    let shift: Vec<Option<f64>> = cells
        .iter()
        .map(|(p, c)| {
            let moved = data.condition(p, *c)?.moved_points?;
            Some(moved / unit_points)
        })
        .collect();
    let square: Vec<Option<f64>> = shift.iter().map(|s| s.map(|s| s * s)).collect();
    let one = |name: &_| {
        let y: Vec<Option<f64>> = cells.iter().map(|(p, c)| data.rated(p, *c, name)).collect();
        let fixed: [(&str, &[Option<f64>]); 2] = [("shift", &shift), ("shift_squared", &square)];
        let (model, why) = match mixed_model(&subjects, &y, &fixed, &["shift"], MixedMethod::Reml) {
            Ok(model) => (Some(model), None),
            Err(e @ (StatsError::TooFew { .. } | StatsError::BadParameter { .. })) => {
                (None, Some(e.to_string()))
            }
            Err(e) => return Err(e.into()),
        };
        Ok(MixedRow {
            rating: name.clone(),
            title: data.score_title(name),
            unit_points,
            model,
            why_not: why,
        })
    };
    ratings(data).iter().map(one).collect()
}
