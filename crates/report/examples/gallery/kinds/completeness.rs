//! What is there of what a study awaits.

use super::PARTICIPANTS;
use maveric_report::figures::completeness::{Completeness, CompletenessPanel};

pub(crate) fn input() -> Completeness {
    let n = PARTICIPANTS;
    let panel = |title: &str, counts: [(usize, usize); 4]| CompletenessPanel {
        title: title.into(),
        counts: counts.to_vec(),
    };
    Completeness {
        rows: ["Before the drives", "Own", "Calm", "Sporty"].map(String::from).to_vec(),
        panels: vec![
            panel("Logs", [(0, 0), (n, n), (n - 3, n), (n - 9, n)]),
            panel("Drives", [(0, 0), (n, n), (n - 4, n), (n - 9, n)]),
            panel("Answers", [(n - 1, n), (0, 0), (n - 3, n), (n - 10, n)]),
            panel("Own measures", [(0, 0), (0, 0), (n - 3, n), (0, n)]),
        ],
    }
}
