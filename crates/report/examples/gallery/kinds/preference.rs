//! Who rated another style better than their own, scale by scale.

use super::PARTICIPANTS;
use maveric_report::{
    Context, Figure, ReportError,
    figures::preference::{Preferences, ScalePreference, preference},
};

pub(crate) fn draw(context: &Context) -> Result<Figure, ReportError> {
    preference(&input(), context)
}

pub(crate) fn input() -> Preferences {
    let scale = |scale: &str, aggressive_above, cautious_above| ScalePreference {
        scale: scale.into(),
        n: PARTICIPANTS,
        aggressive_above,
        cautious_above,
    };
    Preferences {
        scales: vec![
            scale("Trust", 6, 12),
            scale("Competence", 7, 13),
            scale("Intelligence", 5, 9),
            scale("Discomfort", 9, 11),
            scale("Similarity", 3, 0),
        ],
    }
}
