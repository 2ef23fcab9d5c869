//! Two columns of a table.

use super::{pearson, wobble};
use maveric_report::figures::scatter::Scatter;

pub(crate) fn input() -> Scatter {
    let point = |i: usize| {
        let age = 22.0 + 1.9 * i as f64;
        (age, 31.0 - 0.06 * age + 1.2 * wobble(i, 3))
    };
    let points: Vec<(f64, f64)> = (0..24).map(point).collect();
    Scatter {
        x: "age (years)".into(),
        y: "speed (m/s)".into(),
        test: pearson(&points),
        points,
        people: Vec::new(),
    }
}
