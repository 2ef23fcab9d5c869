//! Across the dial: other habits change, aggressiveness does not.

use super::{MEASURES, Values, mean, title};
use crate::error::RehearsalError;
use maveric_stats::{StatsError, circular_linear};
use serde::Serialize;

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Across {
    pub measure: &'static str,
    pub title: &'static str,
    pub n: usize,
    /// Mean of |across − own style|.
    pub mean_change: Option<f64>,
    /// Mean of |own style on another road − own style|: what chance does.
    pub by_chance: Option<f64>,
    /// Multiple R of the change on cosine and sine of the angle.
    pub angle_r: Option<f64>,
    /// p of the test of this R against 0.
    pub angle_p: Option<f64>,
}

/// The two habits that do not follow aggression, and velocity; all slices in the same order of drivers.
///
/// # Errors
/// [`RehearsalError::Stats`] if a number is not finite.
pub fn across(
    angles: &[f64],
    mimic: &[Values],
    sideways: &[Values],
    elsewhere: &[Values],
) -> Result<Vec<Across>, RehearsalError> {
    let mut rows = Vec::new();
    for k in [5, 6, 0] {
        let change = |to: &[Values]| -> Vec<Option<f64>> {
            to.iter().zip(mimic).map(|(t, m)| Some(t[k]? - m[k]?)).collect()
        };
        let size = |changes: &[Option<f64>]| {
            let known: Vec<f64> = changes.iter().flatten().map(|c| c.abs()).collect();
            mean(&known)
        };
        let changes = change(sideways);
        let angles: Vec<Option<f64>> = angles.iter().copied().map(Some).collect();
        let round = match circular_linear(&angles, &changes) {
            Ok(association) => (association.r, association.p),
            Err(StatsError::TooFew { .. }) => (None, None),
            Err(error) => return Err(error.into()),
        };
        rows.push(Across {
            measure: MEASURES[k],
            title: title(k),
            n: changes.iter().flatten().count(),
            mean_change: size(&changes),
            by_chance: size(&change(elsewhere)),
            angle_r: round.0,
            angle_p: round.1,
        });
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_habit_that_follows_the_angle_is_seen_to_and_chance_is_beside_it() {
        let lane = |share: f64| {
            let mut values = Values::default();
            values[6] = Some(share);
            values
        };
        let angles: Vec<f64> = (0..8).map(f64::from).collect();
        let mimic = vec![lane(0.4); 8];
        let sideways: Vec<Values> = angles.iter().map(|a| lane(0.4 + 0.2 * a.cos())).collect();
        let elsewhere = vec![lane(0.41); 8];
        let rows = across(&angles, &mimic, &sideways, &elsewhere).unwrap();
        assert_eq!((rows[0].n, rows[0].angle_r), (0, None));
        assert!((rows[1].by_chance.unwrap() - 0.01).abs() < 1e-12);
        assert!(rows[1].mean_change.unwrap() > 0.1 && rows[1].angle_r.unwrap() > 0.999);
    }
}
