//! What personalising reaches after some minutes.

use super::PARTICIPANTS;
use maveric_report::figures::learning_curve::{LearningCurve, LearningPanel, LearningPoint};

pub(crate) fn input() -> LearningCurve {
    let panel = |title: &str, axis: &str, from: f64, to: f64| LearningPanel {
        title: title.into(),
        axis: axis.into(),
        points: [1.0, 2.0, 5.0, 10.0]
            .map(|minutes: f64| {
                let mean = to + (from - to) / (1.0 + minutes);
                LearningPoint { minutes, mean, low: 0.93 * mean, high: 1.07 * mean }
            })
            .to_vec(),
        before: Some(from),
    };
    LearningCurve {
        panels: vec![
            panel("*L*_{1} following", "loss", 0.9, 0.35),
            panel("*L*_{2} lane change", "loss", 0.42, 0.33),
            panel("*L*_{3} speed", "loss", 0.5, 0.21),
            panel("To the whole drive’s", "SD", 1.6, 0.0),
        ],
        drivers: PARTICIPANTS,
        judged_on: "Losses on the last third of each drive.".into(),
    }
}
