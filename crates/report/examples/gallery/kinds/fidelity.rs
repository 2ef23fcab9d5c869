//! Accuracies over training seeds, beside the paper's.

use super::PARTICIPANTS;
use maveric_report::figures::fidelity::{Accuracy, Fidelity, FidelityRow};

pub(crate) fn input() -> Fidelity {
    let names = [
        "Mean velocity",
        "Mean headway time",
        "Distance headway merge back",
        "Number of lane changes",
        "Time headway merge back",
    ];
    let around = |mean: f64| Accuracy { mean, low: mean - 0.012, high: mean + 0.01 };
    Fidelity {
        measures: names
            .iter()
            .enumerate()
            .map(|(k, name)| FidelityRow {
                measure: (*name).to_owned(),
                car: around(0.98 - 0.04 * k as f64),
                test_retest: Some(around(0.985 - 0.03 * k as f64)),
                population: Some(around(0.92 - 0.07 * k as f64)),
                paper: (k != 3).then_some(0.9 - 0.02 * k as f64),
            })
            .collect(),
        drivers: PARTICIPANTS,
        seeds: 5,
    }
}
