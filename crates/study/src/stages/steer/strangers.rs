//! People beyond what a model has learned from: the dial has no place to turn from, so it is not turned for them unless asked.

use super::Steer;
use crate::once::told_once;
use maveric_domain::{BeyondWhy, Design, ParticipantId, design::BeyondRule};

/// Who they are, and whether they are left out where the dial is turned.
pub(super) struct Strangers {
    pub(super) people: Vec<ParticipantId>,
    pub(super) left_out: bool,
}

impl Strangers {
    pub(super) fn new(options: &Steer, design: &Design) -> Self {
        Self {
            people: Vec::new(),
            left_out: !options.beyond && design.beyond() == BeyondRule::LeaveOut,
        }
    }

    /// Whether the dial may be turned for somebody; who is beyond is noted, where it is `turned` for anybody.
    pub(super) fn may_turn(
        &mut self,
        who: &ParticipantId,
        why: Option<&BeyondWhy>,
        turned: bool,
    ) -> bool {
        if why.is_some() && turned {
            self.people.push(who.clone());
        }
        why.is_none() || !self.left_out
    }

    /// A sentence that names them.
    pub(super) fn warnings(&self) -> Vec<String> {
        let why = if self.left_out {
            "drives beyond what the model has learned from, so the dial has no place to turn from: left out where it is turned \
             (--beyond drives them)"
        } else {
            "drives beyond what the model has learned from: the dial is turned all the same, as asked"
        };
        let named = self.people.iter().map(|p| (p.to_string(), why.to_owned()));
        told_once("participant", named)
    }
}
