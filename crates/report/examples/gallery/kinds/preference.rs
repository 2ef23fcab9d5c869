//! Who rated another style better than their own, scale by scale.

use super::{PARTICIPANTS, conditions};
use maveric_report::figures::preference::{Preferences, ScalePreference};

pub(crate) fn input() -> Preferences {
    let scale = |scale: &str, up, down| ScalePreference {
        scale: scale.into(),
        n: PARTICIPANTS,
        less_is_better: scale == "Discomfort",
        above: vec![up, down],
    };
    Preferences {
        own: conditions()[0],
        others: conditions()[1..3].to_vec(),
        scales: vec![
            scale("Trust", 6, 12),
            scale("Competence", 7, 13),
            scale("Intelligence", 5, 9),
            scale("Discomfort", 9, 11),
            scale("Similarity", 3, 0),
        ],
    }
}
