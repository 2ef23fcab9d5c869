//! Drivers in a style space, and one participant's conditions in it.

use super::{conditions, wobble};
use maveric_report::figures::embedding_space::{EmbeddingPoint, EmbeddingSpace, ExampleConditions};
use std::f64::consts::TAU;

pub(crate) fn input() -> EmbeddingSpace {
    let size = 3;
    let points = (0..38)
        .map(|i| {
            let embedding: Vec<f64> = (0..size).map(|k| 1.6 * wobble(i, k)).collect();
            let along = embedding.iter().sum::<f64>();
            EmbeddingPoint {
                score_points: (28.0 + 6.0 * along + 3.0 * wobble(i, 90)).clamp(11.0, 55.0),
                mean_velocity_mps: 28.5 + 1.2 * along + wobble(i, 91),
                embedding,
            }
        })
        .collect();
    let gradient = [0.9, 0.5, 0.6];
    let unit = gradient.map(|g: f64| g / 1.42_f64.sqrt());
    let centre = [0.2, -0.4, 0.1];
    let shifted = |t: f64| (0..3).map(|k| centre[k] + t * unit[k]).collect::<Vec<f64>>();
    let a = [unit[1], -unit[0], 0.0].map(|x| x / unit[0].hypot(unit[1]));
    let b = [
        unit[1] * a[2] - unit[2] * a[1],
        unit[2] * a[0] - unit[0] * a[2],
        unit[0] * a[1] - unit[1] * a[0],
    ];
    let round = |angle: f64| {
        (0..3).map(|k| centre[k] + 0.9 * angle.cos() * a[k] + 0.9 * angle.sin() * b[k]).collect()
    };
    EmbeddingSpace {
        points,
        gradient: gradient.to_vec(),
        score_range: (11.0, 55.0),
        score: "ADB score".into(),
        example: Some(ExampleConditions {
            participant: "P07".into(),
            conditions: conditions()
                .into_iter()
                .zip([centre.to_vec(), shifted(1.5), shifted(-1.5), round(3.6)])
                .collect(),
            ellipse: (0..48).map(|k| round(TAU * f64::from(k) / 48.0)).collect(),
        }),
    }
}
