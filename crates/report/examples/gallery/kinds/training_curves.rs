//! Five terms of a loss over forty epochs.

use super::wobble;
use maveric_report::figures::training_curves::{LossTerm, TrainingCurves};

pub(crate) fn input() -> TrainingCurves {
    let term = |index: usize, title: &str, from: f64, to: f64| {
        let curve = |lag: f64, noise: usize| {
            (0..40)
                .map(|e| {
                    to + (from - to) * (-f64::from(e) / lag).exp()
                        + 0.02 * to * wobble(e as usize, noise + index)
                })
                .collect()
        };
        LossTerm { title: title.into(), train: curve(6.0, 5), validation: curve(7.5, 25) }
    };
    TrainingCurves {
        terms: vec![
            term(0, "*L*_{1}  following distance", 1.1, 0.3),
            term(1, "*L*_{2}  lane change", 0.69, 0.35),
            term(2, "*L*_{3}  velocity", 1.0, 0.06),
            term(3, "*L*_{4}  style", 1.0, 0.04),
            term(4, "*L*_{5}  mutual information", 1.3, 0.2),
        ],
        drives: 38,
    }
}
