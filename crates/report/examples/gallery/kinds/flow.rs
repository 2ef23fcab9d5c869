//! Who was recruited, left out and analysed.

use super::PARTICIPANTS;
use maveric_report::figures::flow::Flow;

pub(crate) fn input() -> Flow {
    Flow {
        not_admitted: Vec::new(),
        not_agreed: 0,
        recruited: PARTICIPANTS + 4,
        absent: vec![("no drive and no answer in any condition".into(), 1)],
        drove: PARTICIPANTS + 3,
        left_out: vec![
            ("withdrew consent".into(), 1),
            ("one answer to every item of `mdsi`, reversed ones too".into(), 2),
        ],
        analysed: PARTICIPANTS,
        drives_left_out: vec![("simulator sickness".into(), 1)],
        outcomes: vec![
            ("Mean velocity".into(), PARTICIPANTS),
            ("Distance headway merge back".into(), PARTICIPANTS - 2),
        ],
    }
}
