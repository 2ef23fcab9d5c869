//! How hard to steer to a predicted following distance.

use super::{
    calibrate::{Calibrated, SearchSettings, search_law},
    closed_loop::gap_rmse_within,
    error::FollowingError,
    evaluation::DistanceLaw,
    laws::{
        helly::Gains,
        keep_distance::{KeepDistance, SafetyBound},
    },
    method::FollowingMethod,
    run::FollowingRun,
};
use serde::{Deserialize, Serialize};

/// Where the gains that steer by F come from. Neither reads the driver's own rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SteeringGains {
    /// From Helly's law fitted to the other drivers. One line for several people fits best when it steers softly,
    /// and then follows a good F late.
    #[default]
    HellyPopulation,
    /// Fitted to the other drivers, each steered by the own F.
    OtherDrivers,
}

/// Natural logarithms of the bounds of k_v (0.01-2 1/s) and k_d (0.001-0.5 1/s²), as for Helly's law.
const LOG_BOUNDS: &[(f64, f64)] = &[(-4.6, 0.7), (-6.9, -0.7)];

/// A driver's fit rows and F at each of them.
pub(super) struct Steered<'a> {
    run: &'a FollowingRun,
    distance_m: Vec<f64>,
}

impl<'a> Steered<'a> {
    /// # Errors
    /// [`FollowingError::LawNotFinite`] if F is NaN or infinite at a fit row.
    pub(super) fn new(run: &'a FollowingRun, f: &DistanceLaw<'_>) -> Result<Self, FollowingError> {
        let speeds = &run.columns().lead_speed_mps[run.fit().rows()];
        let distance_m: Vec<f64> = speeds.iter().map(|&lead| f(lead)).collect();
        match distance_m.iter().position(|d| !d.is_finite()) {
            Some(row) => Err(FollowingError::LawNotFinite {
                driver: run.driver().to_owned(),
                law: FollowingMethod::FollowingDistanceOwn.as_str().to_owned(),
                row,
                found: distance_m[row],
            }),
            None => Ok(Self { run, distance_m }),
        }
    }
}

/// Fits the gains to the closed-loop RMSE of the gap over the fit rows of all `others`, each the same weight.
pub(super) fn calibrate_gains(
    others: &[&Steered<'_>],
    safety: SafetyBound,
    search: &SearchSettings,
    seed: u64,
) -> Calibrated<Gains> {
    let gains = |p: &[f64]| Gains {
        speed_per_s: p[0].exp(),
        gap_per_s2: p[1].exp(),
    };
    let rmse = |at: usize, gains: Gains, limit: f64| {
        let Steered { run, distance_m } = others[at];
        // The loop asks the law once a row, in order: F is looked up, as a network is slow to ask thousands of times.
        let mut row = 0;
        let law = |gap: f64, ego: f64, lead: f64| {
            let distance = distance_m[row];
            row += 1;
            let distance_m = |_| distance;
            KeepDistance {
                distance_m,
                gains,
                safety,
            }
            .accel_mps2(gap, ego, lead)
        };
        gap_rmse_within(&run.fit(), law, limit)
    };
    search_law(LOG_BOUNDS, search, seed, gains, others.len(), rmse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made_up;

    #[test]
    fn the_gains_that_made_a_drive_are_recovered() {
        let made = KeepDistance {
            distance_m: |lead: f64| 4.0 + 1.5 * lead,
            gains: Gains {
                speed_per_s: 0.5,
                gap_per_s2: 0.05,
            },
            safety: SafetyBound::default(),
        };
        let run = made_up::driven_by("P01", |g, v, l| made.accel_mps2(g, v, l));
        let f: DistanceLaw<'_> = Box::new(|lead| 4.0 + 1.5 * lead);
        let steered = Steered::new(&run, &f).unwrap();
        let search = SearchSettings::default();
        let found = calibrate_gains(&[&steered], SafetyBound::default(), &search, 1).law;
        assert!((found.speed_per_s - 0.5).abs() < 0.01, "{found:?}");
        assert!((found.gap_per_s2 - 0.05).abs() < 0.002, "{found:?}");
    }

    #[test]
    fn a_distance_that_is_no_number_is_an_error() {
        let run = made_up::behind("P01", 30, 20.0, 10.0, |_| 10.0);
        let f: DistanceLaw<'_> = Box::new(|_| f64::INFINITY);
        assert!(Steered::new(&run, &f).is_err());
    }
}
