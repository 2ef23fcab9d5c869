//! Positions on the aggression line against six measures.

use super::{PARTICIPANTS, pearson, wobble};
use maveric_report::figures::aggression_line::{AggressionLine, LinePanel};

pub(crate) fn input() -> AggressionLine {
    let panel = |index: usize, title: &str, axis: &str, centre: f64, slope: f64, noise: f64| {
        let point = |i: usize| {
            let x = 1.8 * wobble(i, 7);
            (x, centre + slope * x + noise * wobble(i, 40 + index))
        };
        let points: Vec<(f64, f64)> = (0..PARTICIPANTS).map(point).collect();
        LinePanel { title: title.into(), axis: axis.into(), statistic: pearson(&points), points }
    };
    AggressionLine {
        panels: vec![
            panel(0, "Mean velocity", "Mean velocity (mph)", 65.0, 2.6, 6.0),
            panel(1, "Mean headway time", "Mean headway time (s)", 1.8, -0.22, 0.7),
            panel(2, "Distance headway merge back", "Distance (m)", 46.0, -5.0, 16.0),
            panel(3, "Number of lane changes", "Lane changes (count)", 9.0, 1.1, 3.0),
            panel(4, "Time headway merge back", "Time (s)", 1.5, -0.2, 0.5),
            panel(5, "Self-reported aggression", "ADB score (points)", 29.0, 6.0, 5.0),
        ],
    }
}
