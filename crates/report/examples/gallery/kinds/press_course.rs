//! What rides were like before people pressed "uncomfortable".

use super::wobble;
use maveric_report::figures::press_course::{CoursePanel, PressCourses};

pub(crate) fn input() -> PressCourses {
    let panel = |(index, (title, axis, far, near)): (usize, (&str, &str, f64, f64))| CoursePanel {
        title: title.to_owned(),
        test: "*p* = .012 (Holm)".to_owned(),
        axis: axis.to_owned(),
        n: 24,
        points: (0..=10)
            .rev()
            .map(|second| {
                let before = f64::from(second);
                let share = (-before / 3.0).exp();
                let spread = 0.1 * (far - near).abs();
                let mean = far + (near - far) * share;
                let mean = mean + 0.2 * spread * wobble(second as usize, index);
                [before, mean, mean - spread, mean + spread]
            })
            .collect(),
        others: Some(far),
    };
    PressCourses {
        panels: [
            ("Smallest gap", "Value (m)", 42.0, 28.0),
            ("Largest inverse time to collision", "Value (1/s)", 0.05, 0.14),
            ("Strongest braking", "Value (m/s²)", 0.4, 1.9),
            ("A lane change", "Share of the time", 0.12, 0.2),
        ]
        .into_iter()
        .enumerate()
        .map(panel)
        .collect(),
        presses: 137,
    }
}
