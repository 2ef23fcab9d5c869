//! Rates of false positives in four parts of a report, and of two families.

use super::{PARTICIPANTS, wobble};
use maveric_report::figures::false_positives::{FalsePositives, PartRates};

pub(crate) fn input() -> FalsePositives {
    let part = |(k, name): (usize, &str)| PartRates {
        name: name.into(),
        rates: (0..6 + 4 * k).map(|i| 0.05 + 0.012 * wobble(i, k)).collect(),
    };
    let parts = ["Panels, omnibus", "Panels, pairs", "Aggression line", "Homophily"];
    FalsePositives {
        parts: parts.into_iter().enumerate().map(part).collect(),
        families: vec![
            ("a panel’s pairs".into(), 0.043, (0.031, 0.058)),
            ("homophily".into(), 0.05, (0.037, 0.066)),
        ],
        studies: 1000,
        participants: PARTICIPANTS,
    }
}
