//! Where a recommendation lies on the scale of the score, with what one drive leaves open of the own style.

use super::learned::Preferred;
use crate::StudyData;
use maveric_domain::{EmbeddingRow, ParticipantId};
use maveric_stats::HALF_95;
use serde::Serialize;

/// The own style and the recommended one, in points of the score.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OnTheScale {
    /// What S reads of the own style.
    pub own: f64,
    /// SD of that: the posterior of the style, along the direction of S.
    pub own_sd: f64,
    /// The recommended setting.
    pub at: f64,
    /// Low end of its 95 % interval, both uncertainties together.
    pub low: f64,
    /// High end.
    pub high: f64,
}

/// `None` without a model that reads a score and knows how sure it is, and where the scale has no score for what is recommended.
pub(super) fn on_the_scale(
    data: &StudyData,
    p: &ParticipantId,
    preferred: &Preferred,
) -> Option<OnTheScale> {
    let row = data.embedding(p, true).or_else(|| data.embedding(p, false))?;
    let own_score = row.adb_hat?;
    let own_sd = row.line_position_se? * points_a_step(&data.embeddings)?;
    let (lowest, highest) = data.style_range().unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
    let score = own_score + preferred.points;
    let reach = |end: f64| libm::hypot(end - preferred.points, HALF_95 * own_sd);
    // A setting that ends where the scale does may be rounded past it.
    let rounding = 1e-9 * score.abs().max(1.0);
    let scores = lowest - rounding..=highest + rounding;
    // No score lies outside the scale, so no interval need hold one.
    scores.contains(&score).then(|| OnTheScale {
        own: own_score,
        own_sd,
        at: score.clamp(lowest, highest),
        low: (score - reach(preferred.low)).clamp(lowest, highest),
        high: (score + reach(preferred.high)).clamp(lowest, highest),
    })
}

/// Between which settings, in points from somebody's own style, the scale has a score: `furthest` where it is not known.
pub(super) fn settings_within(
    data: &StudyData,
    own: Option<&EmbeddingRow>,
    [from, to]: [f64; 2],
) -> [f64; 2] {
    let reading = own.and_then(|row| row.adb_hat);
    match data.style_range().zip(reading) {
        None => [from, to],
        Some(((lowest, highest), own)) => {
            [(lowest - own).clamp(from, 0.0), (highest - own).clamp(0.0, to)]
        }
    }
}

/// Points of the score for each step along the aggression line: S is linear, so any two embeddings tell.
fn points_a_step(rows: &[EmbeddingRow]) -> Option<f64> {
    let mut known = rows.iter().filter_map(|r| r.line_position.zip(r.adb_hat)).collect::<Vec<_>>();
    known.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (first, last) = (known.first()?, known.last()?);
    let points = (last.1 - first.1) / (last.0 - first.0);
    points.is_finite().then_some(points.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_embeddings_tell_what_a_step_is_worth_and_one_does_not() {
        let row = |position: f64| EmbeddingRow {
            adb_hat: Some(30.0 + 9.0 * position),
            line_position_se: Some(0.3),
            ..crate::testing::position(0, position)
        };
        let found = points_a_step(&[row(0.5), row(-1.0)]).unwrap();
        assert!((found - 9.0).abs() < 1e-9);
        assert_eq!(points_a_step(&[row(0.5)]), None);
    }
}
