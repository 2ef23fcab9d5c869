//! Recommended shifts of the dial beside the preferred ones.

use super::{PARTICIPANTS, wobble};
use maveric_report::figures::recommendation::Recommendations;

pub(crate) fn input() -> Recommendations {
    let person = |i: usize| {
        let preferred = 12.0 * wobble(i, 2);
        let recommended = 0.8 * preferred + 3.0 * wobble(i, 3);
        [preferred, recommended, recommended - 5.5, recommended + 5.5]
    };
    Recommendations {
        unit: "ADB points".to_owned(),
        people: (0..PARTICIPANTS).map(person).collect(),
        learned_from: 48,
    }
}
