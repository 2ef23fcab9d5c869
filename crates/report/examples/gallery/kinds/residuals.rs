//! Quantiles of what two networks leave over.

use maveric_report::figures::residuals::{ResidualPanel, Residuals};

pub(crate) fn input() -> Residuals {
    let normal = [-2.33, -1.64, -1.28, -0.67, 0.0, 0.67, 1.28, 1.64, 2.33];
    let shares = [0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 0.99];
    let panel = |title: &str, unit: &str, width: f64| ResidualPanel {
        title: title.into(),
        axis: format!("Predicted − recorded ({unit})"),
        unit: unit.into(),
        quantiles: shares
            .iter()
            .zip(normal)
            .map(|(share, z)| (*share, width * (z + 0.1)))
            .collect(),
        mean: 0.1 * width,
        rms: width,
        rows: 9000,
    };
    Residuals {
        panels: vec![panel("Following distance (F)", "m", 5.0), panel("Ego speed (V)", "m/s", 1.1)],
        drives: 38,
        held_out: true,
    }
}
