//! Drives of the same drivers at nine shifts.

use super::{PARTICIPANTS, wobble};
use maveric_report::figures::dial_sweep::{DialPanel, DialSweep};

pub(crate) fn input() -> DialSweep {
    let points: Vec<f64> = (-4..=4).map(|k| 5.0 * f64::from(k)).collect();
    let panel = |title: &str, axis: &str, mean: f64, slope: f64| DialPanel {
        title: title.into(),
        axis: axis.into(),
        drivers: (0..PARTICIPANTS)
            .map(|i| {
                let undialled = mean * (1.0 + 0.1 * wobble(i, 31));
                let value = |k: usize| undialled + slope * points[k] + 0.01 * mean * wobble(i, k);
                (0..points.len()).map(|k| ((i + k) % 37 != 0).then(|| value(k))).collect()
            })
            .collect(),
        statistic: "right way: 92% at +15, 88% at −15".into(),
    };
    DialSweep {
        unit: "ADB points".to_owned(),
        panels: vec![
            panel("Mean velocity", "mph", 65.0, 0.3),
            panel("Mean headway time", "s", 1.8, -0.012),
            panel("Distance headway merge back", "m", 46.0, -0.7),
            panel("Number of lane changes", "count", 9.0, 0.1),
            panel("Time headway merge back", "s", 1.5, -0.02),
        ],
        points,
    }
}
