//! Variants of a model on the same unseen drives.

use super::wobble;
use maveric_report::figures::ablation::{Ablation, AblationVariant};

pub(crate) fn input() -> Ablation {
    let names =
        ["size 3", "size 1", "size 2", "size 5", "size 8", "without M", "without S", "Gaussian L5"];
    let variants = names.iter().enumerate().map(|(v, name)| AblationVariant {
        name: (*name).to_owned(),
        losses: (0..3)
            .map(|loss| {
                let value = |i: usize| {
                    0.4 + 0.05 * wobble(i, 7) + 0.01 * v as f64 * (1.0 + wobble(i + v, loss))
                };
                (0..38).map(|i| (i % 9 != loss).then(|| value(i))).collect()
            })
            .collect(),
    });
    Ablation {
        losses: ["following", "lane change", "speed"]
            .iter()
            .enumerate()
            .map(|(k, name)| format!("*L*_{{{}}} {name}", k + 1))
            .collect(),
        variants: variants.collect(),
        folds: 5,
    }
}
