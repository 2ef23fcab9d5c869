//! Does turning the dial up make the car drive more aggressively, for each driver and all the way?

use super::{MEASURES, Values, mean};
use crate::error::RehearsalError;
use maveric_measures::objective;
use maveric_stats::{CorrelationMethod, StatsError, correlate};
use serde::Serialize;

/// Lane changes of twelve possible from which a driver hardly has room for more.
pub const FULL: f64 = 10.0;

/// Share of drivers for whom one setting of the dial did what it should.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Right {
    /// Drivers with a value there and at 0.
    pub n: usize,
    /// Drivers whose measure moved the right way; no move at all counts as wrong.
    pub right: usize,
    /// Drivers whose measure did not move at all.
    pub tied: usize,
    /// Drivers among `n` who had room to move: all, but for more lane changes, where it is those who make fewer than
    /// [`FULL`] at 0.
    pub with_room: usize,
    /// Drivers among those whose measure moved the right way.
    pub right_with_room: usize,
    /// `right` / `n`.
    pub share: Option<f64>,
    /// Mean change from 0, in the measure's unit.
    pub mean_change: Option<f64>,
}

/// One measure over the dial.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Dial {
    pub measure: &'static str,
    pub title: &'static str,
    /// Unit of `curve` and `drivers`, as measured.
    pub unit: &'static str,
    /// At plus the points of the conditions.
    pub aggressive: Right,
    pub cautious: Right,
    /// Mean over drivers of Kendall's τ-b of setting and measure, signed so that 1 is a perfect dial.
    pub mean_tau: Option<f64>,
    /// Share of drivers whose Spearman's ρ has the right sign.
    pub rising: Option<f64>,
    /// Drivers with a value at no fewer than four settings.
    pub n: usize,
    /// Mean over the drivers that have a value at every setting.
    pub curve: Vec<Option<f64>>,
    /// Whether that mean never turns back from one setting to the next.
    pub monotone: Option<bool>,
    /// Every driver's value at every setting, shape `(drivers, settings)`.
    pub drivers: Vec<Vec<Option<f64>>>,
}

fn right(drivers: &[Vec<Values>], k: usize, setting: usize, zero: usize, sign: f64) -> Right {
    let more_changes = MEASURES[k] == "lane_changes" && sign > 0.0;
    // The change from 0, and whether there was room for it.
    let changes: Vec<(f64, bool)> = drivers
        .iter()
        .filter_map(|d| {
            let (at_setting, at_zero) = (d[setting][k]?, d[zero][k]?);
            Some((at_setting - at_zero, !more_changes || at_zero < FULL))
        })
        .collect();
    let is_right = |c: &&(f64, bool)| sign * c.0 > 0.0;
    let right = changes.iter().filter(is_right).count();
    let n = changes.len();
    let moved: Vec<f64> = changes.iter().map(|c| c.0).collect();
    Right {
        n,
        right,
        tied: moved.iter().filter(|c| c.abs() < 1e-12).count(),
        with_room: changes.iter().filter(|c| c.1).count(),
        right_with_room: changes.iter().filter(|c| c.1).filter(is_right).count(),
        share: (n > 0).then(|| right as f64 / n as f64),
        mean_change: mean(&moved),
    }
}

/// The measures that aggression moves, over the dial; `drivers` has shape `(drivers, settings)`, and `steps` (in points, rising)
/// holds 0 and ± `points`.
///
/// # Errors
/// [`RehearsalError::Stats`] if a measure is not finite.
pub fn dial(
    steps: &[f64],
    points: f64,
    drivers: &[Vec<Values>],
) -> Result<Vec<Dial>, RehearsalError> {
    let index = |wanted: f64| {
        let distance = |i: &usize| (steps[*i] - wanted).abs();
        (0..steps.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
    };
    let (zero, up, down) = (index(0.0), index(points), index(-points));
    let one = |(k, sign): (usize, f64)| {
        let mut taus = Vec::new();
        let mut rising = Vec::new();
        for driver in drivers {
            let settings: Vec<Option<f64>> = steps.iter().copied().map(Some).collect();
            let values: Vec<Option<f64>> = driver.iter().map(|v| v[k]).collect();
            if values.iter().flatten().count() < 4 {
                continue;
            }
            let correlation = match correlate(&settings, &values, CorrelationMethod::All, None) {
                Ok(correlation) => correlation,
                Err(StatsError::TooFew { .. }) => continue,
                Err(error) => return Err(error.into()),
            };
            // A measure that never moves has no coefficient: the dial does nothing for this driver.
            taus.push(sign * correlation.kendall.and_then(|c| c.tau_b).unwrap_or(0.0));
            let rho = sign * correlation.spearman.and_then(|c| c.rho).unwrap_or(0.0);
            rising.push(f64::from(u8::from(rho > 0.0)));
        }
        let complete: Vec<&Vec<Values>> =
            drivers.iter().filter(|d| d.iter().all(|v| v[k].is_some())).collect();
        let mean_at = |i: usize| {
            let values: Vec<f64> = complete.iter().filter_map(|d| d[i][k]).collect();
            mean(&values)
        };
        let curve: Vec<Option<f64>> = (0..steps.len()).map(mean_at).collect();
        let moves: Option<Vec<f64>> =
            curve.windows(2).map(|w| Some(sign * (w[1]? - w[0]?))).collect();
        let measure = objective::find(MEASURES[k]);
        Ok(Dial {
            measure: MEASURES[k],
            title: measure.map_or(MEASURES[k], |m| m.title),
            unit: measure.map_or("", |m| m.unit),
            aggressive: right(drivers, k, up, zero, sign),
            cautious: right(drivers, k, down, zero, -sign),
            mean_tau: mean(&taus),
            rising: mean(&rising),
            n: taus.len(),
            curve,
            monotone: moves.map(|m| m.iter().all(|m| *m >= 0.0)),
            drivers: drivers.iter().map(|d| d.iter().map(|v| v[k]).collect()).collect(),
        })
    };
    let signed = |(k, name): (usize, &&str)| Some((k, objective::find(name)?.aggression?.factor()));
    MEASURES.iter().enumerate().filter_map(signed).map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn driver(velocity: [f64; 5], headway: [Option<f64>; 5]) -> Vec<Values> {
        let setting = |(v, h): (&f64, &Option<f64>)| {
            let mut values = Values::default();
            (values[0], values[1]) = (Some(*v), *h);
            values
        };
        velocity.iter().zip(&headway).map(setting).collect()
    }

    #[test]
    fn a_dial_that_works_one_that_sticks_and_one_that_is_missing() {
        let steps = [-20.0, -15.0, 0.0, 15.0, 20.0];
        let falling = [3.0, 2.5, 2.0, 1.5, 1.4].map(Some);
        let sticks = [2.0; 5].map(Some);
        let drivers = [
            driver([20.0, 21.0, 22.0, 23.0, 24.0], falling),
            driver([20.0, 21.0, 22.0, 21.5, 24.0], sticks),
            driver([20.0, 23.0, 22.0, 23.0, 24.0], [None; 5]),
        ];
        let rows = dial(&steps, 15.0, &drivers).unwrap();
        let (velocity, headway) = (&rows[0], &rows[1]);
        assert_eq!((velocity.aggressive.right, velocity.aggressive.n), (2, 3));
        assert_eq!((velocity.cautious.right, velocity.cautious.n), (2, 3));
        assert_eq!(velocity.rising, Some(1.0));
        assert_eq!(velocity.monotone, Some(true));
        assert_eq!((headway.aggressive.right, headway.aggressive.n), (1, 2));
        assert!((headway.mean_tau.unwrap() - 0.5).abs() < 1e-12);
        assert_eq!((headway.n, headway.monotone), (2, Some(true)));
        assert_eq!(rows[2].aggressive.share, None);
    }
}
