//! Three controllers as damped oscillators.

use maveric_report::figures::step_responses::{StepPanel, StepResponses};

pub(crate) fn input() -> StepResponses {
    let panel = |title: &str, what: &str, unit: &str, (from, to): (f64, f64), slow: f64| {
        let time_s: Vec<f64> = (0..400).map(|k| 0.1 * f64::from(k)).collect();
        let step_at_s = 5.0;
        let since = |t: f64| (t - step_at_s).max(0.0) / slow;
        let value = |t: &f64| to + (from - to) * (-since(*t)).exp() * (1.4 * since(*t)).cos();
        let target = |t: &f64| if *t < step_at_s { from } else { to };
        let reached: Vec<f64> = time_s.iter().map(value).collect();
        let band = 0.05 * (to - from).abs();
        let beyond = |v: &f64| (v - to) * (to - from).signum();
        let outside = time_s
            .iter()
            .zip(&reached)
            .filter(|(_, v)| (*v - to).abs() > band);
        let settled = outside.map(|(t, _)| *t).fold(step_at_s, f64::max);
        let after: Vec<f64> = time_s
            .iter()
            .zip(&reached)
            .filter(|(t, _)| **t > settled)
            .map(|(_, v)| v - to)
            .collect();
        StepPanel {
            title: title.into(),
            axis: format!("{what} ({unit})"),
            unit: unit.into(),
            target: time_s.iter().map(target).collect(),
            time_s,
            end: None,
            overshoot: reached.iter().map(beyond).fold(0.0, f64::max),
            settling_s: Some(settled - step_at_s),
            step_at_s,
            band,
            steady_state_error: Some(after.iter().sum::<f64>() / after.len() as f64),
            value: reached,
        }
    };
    StepResponses {
        panels: vec![
            panel("Velocity", "Speed", "m/s", (25.0, 30.0), 2.4),
            panel("Gap", "Gap", "m", (60.0, 40.0), 4.0),
            panel("Lane change", "Lateral position", "m", (0.0, 3.66), 1.3),
        ],
    }
}
