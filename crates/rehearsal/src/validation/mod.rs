//! Does a style recover what was put in? The scoring of drives that a program made, of people who drove twice.

mod across;
mod dial;
mod fidelity;
mod held;
mod identity;
mod likeness;
mod line;
mod retest;

pub use across::{Across, across};
pub use dial::{Dial, FULL, Right, dial};
pub use fidelity::{Fidelity, fidelity};
pub(crate) use held::standardised;
pub use held::{Held, ShareOfPeople, held};
pub(crate) use identity::distance;
pub use identity::{
    Identification, Known, Metric, WithinPerson, identify, identify_posteriors, within_person,
};
pub use likeness::{ByColumn, Driven, Likeness, Looking, likeness, likeness_by_column};
pub use line::{Agreement, Reading, agreement, regression};
pub use retest::{Retest, retest};

use maveric_domain::Drive;
use maveric_measures::objective;

/// The seven measures: the five that follow aggression, in the paper's order, then the two that do not.
pub const MEASURES: [&str; 7] = [
    "mean_velocity_mps",
    "mean_headway_time_s",
    "headway_merge_back_m",
    "lane_changes",
    "headway_merge_back_s",
    "min_headway_distance_m",
    "left_lane_fraction",
];

/// A drive's [`MEASURES`]; `None` where it has no value.
pub type Values = [Option<f64>; 7];

pub fn values(drive: &Drive) -> Values {
    MEASURES.map(|name| objective::find(name).and_then(|m| m.of(drive)))
}

pub fn title(k: usize) -> &'static str {
    objective::find(MEASURES[k]).map_or(MEASURES[k], |m| m.title)
}

/// Mean of the values; `None` without any.
pub fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Puts measures on one footing: minus mean, over SD, of the training drives; a missing one is 0, the mean.
pub fn standardiser(training: &[Values]) -> impl Fn(&Values) -> Vec<f64> + use<> {
    let scale: Vec<(f64, f64)> = (0..MEASURES.len())
        .map(|k| {
            let known: Vec<f64> = training.iter().filter_map(|v| v[k]).collect();
            let mean = mean(&known).unwrap_or(0.0);
            let square = known.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
            let sd = (square / (known.len() as f64 - 1.0).max(1.0)).sqrt();
            (mean, if sd > 0.0 { sd } else { 1.0 })
        })
        .collect();
    move |values| {
        values
            .iter()
            .zip(&scale)
            .map(|(value, (mean, sd))| value.map_or(0.0, |v| (v - mean) / sd))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standardised_measures_have_mean_0_and_sd_1_and_a_missing_one_is_the_mean() {
        let with = |x: f64| {
            let mut values = Values::default();
            values[0] = Some(x);
            values
        };
        let z = standardiser(&[with(1.0), with(2.0), with(3.0)]);
        assert!((z(&with(4.0))[0] - 2.0).abs() < 1e-12);
        assert!(z(&Values::default()).iter().all(|x| x.abs() < 1e-12));
    }
}
