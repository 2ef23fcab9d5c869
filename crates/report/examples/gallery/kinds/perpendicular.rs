//! What changes on the way round the perpendicular ellipse.

use super::{PARTICIPANTS, conditions, wobble};
use maveric_report::apa;
use maveric_report::figures::perpendicular::{
    AngleChange, PerpendicularChanges, PerpendicularPanel,
};
use std::f64::consts::TAU;

pub(crate) fn input() -> PerpendicularChanges {
    let panel =
        |index: usize, title: &str, axis: &str, size: f64, (r, p): (f64, f64)| PerpendicularPanel {
            title: title.into(),
            axis: axis.into(),
            points: (0..PARTICIPANTS)
                .map(|i| {
                    let angle_rad = TAU * f64::midpoint(wobble(i, 3), 1.0);
                    let change =
                        size * ((angle_rad + index as f64).sin() + 0.7 * wobble(i, 60 + index));
                    AngleChange { angle_rad, change }
                })
                .collect(),
            statistic: format!("*R* = {}, {}", apa::bounded(r, 2), apa::p(p).markup()),
        };
    PerpendicularChanges {
        across: conditions()[3],
        from: conditions()[0],
        panels: vec![
            panel(0, "Minimum headway distance", "Change (m)", 6.0, (0.61, 0.008)),
            panel(
                1,
                "Fraction of time in the left lane",
                "Change from Mimic (share)",
                0.11,
                (0.4, 0.157),
            ),
        ],
    }
}
