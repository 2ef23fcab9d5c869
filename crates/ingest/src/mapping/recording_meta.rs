//! The columns of a file beside a table.

use serde::{Deserialize, Serialize};

/// A file beside the table that says how it was recorded, one row (layout `long`).
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordingMeta {
    /// What to replace in the table's name to find it, and by what: `["_tracks", "_recordingMeta"]`.
    pub replace: [String; 2],
    /// Column of the frames a second.
    pub frames_per_s: Option<String>,
    /// Column of the posted speed, in the table's unit of speed; not above 0 means none.
    pub posted_speed: Option<String>,
    /// Column of the lane markings' positions across the road of those who drive along x, separated by semicolons.
    pub markings_along_x: Option<String>,
    /// The same for those who drive against x.
    pub markings_against_x: Option<String>,
}
