//! Lane changes at sixteen speeds.

use super::wobble;
use maveric_report::figures::lane_change_quality::{LaneChangeQuality, QualityPanel};

pub(crate) fn input() -> LaneChangeQuality {
    let speed_mps: Vec<f64> = (0..16).map(|k| 15.0 + 1.5 * f64::from(k)).collect();
    let panel = |title: &str, axis: &str, at_30: f64, limit: f64| QualityPanel {
        title: title.into(),
        axis: axis.into(),
        values: speed_mps
            .iter()
            .enumerate()
            .map(|(k, v)| at_30 * (v / 30.0).powi(2) * (1.0 + 0.08 * wobble(k, 4)))
            .collect(),
        limit: Some((limit, "comfort".into())),
    };
    LaneChangeQuality {
        panels: vec![
            panel("Lateral error", "Largest (m)", 0.11, 0.3),
            panel("Lateral acceleration", "Largest (m/s²)", 1.5, 2.0),
            panel("Lateral jerk", "Largest (m/s³)", 1.9, 2.5),
        ],
        speed_mps,
        manoeuvre: "Changes of 4.8 s to the left.".into(),
    }
}
