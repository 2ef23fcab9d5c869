//! What a rig sees, where its layout does not show it.

use maveric_domain::Sees;
use serde::{Deserialize, Serialize};

/// What the mapping says of the rig's sight; what it leaves out is as the layout and its columns show it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeesMapping {
    /// Whether it sees who is ahead in ego's lane.
    pub ahead: Option<bool>,
    /// Whether it sees who is beside ego, or ahead in the lanes beside its own.
    pub beside: Option<bool>,
    /// Whether it sees who is behind ego.
    pub behind: Option<bool>,
    /// Whether it sees in which lane ego is.
    pub lanes: Option<bool>,
}

impl SeesMapping {
    /// What the rig sees, of which the log `shows` this.
    pub(crate) fn or_shown(self, shows: Sees) -> Sees {
        Sees {
            ahead: self.ahead.unwrap_or(shows.ahead),
            beside: self.beside.unwrap_or(shows.beside),
            behind: self.behind.unwrap_or(shows.behind),
            lanes: self.lanes.unwrap_or(shows.lanes),
        }
    }
}
