//! What the player is given.

use maveric_domain::{ConditionId, drive::Direction};

/// Drives to watch side by side: one participant's conditions, usually.
#[derive(Debug, Clone, PartialEq)]
pub struct WatchPlayer {
    /// Anchor of the fragment, unique on its page: lower-case letters, digits, hyphens.
    pub name: String,
    /// Heading, plain text: whose drives these are.
    pub title: String,
    /// The drives, in the order of the rows.
    pub drives: Vec<PlayerDrive>,
}

/// One drive. Every column has shape `(n,)`, a value for each of `time_s`.
#[derive(Debug, Clone, PartialEq)]
pub struct PlayerDrive {
    /// What the row is called, plain text.
    pub label: String,
    /// Who drove, in a word or two, plain text: "by hand", "automated".
    pub note: String,
    /// Whose style: gives the colour.
    pub condition: ConditionId,
    /// Lanes of the road; lane 0 is the right one, its centre at y = 0.
    pub lanes: u8,
    /// From line to line, in m.
    pub lane_width_m: f64,
    /// Where the road lies, if it is not straight.
    pub centre_line: Option<CentreLine>,
    /// Time since the start of the drive, in s, rising.
    pub time_s: Vec<f64>,
    /// Rises by one after each hole in the recording; nothing is shown within a hole.
    pub segment: Vec<u32>,
    /// Ego; `first_row` is 0.
    pub ego: Track,
    /// Ego's speed, in m/s.
    pub speed_mps: Vec<f64>,
    /// Bumper-to-bumper distance to the reference vehicle, in m: negative when it is behind, none without one.
    pub gap_m: Vec<Option<f64>>,
    /// Which of `others` (by its `id`) is the reference vehicle.
    pub reference: Vec<Option<u32>>,
    /// Everybody else.
    pub others: Vec<Track>,
    /// Ego's lane changes.
    pub lane_changes: Vec<ChangeSpan>,
    /// When the safety layer stepped in; none where there is no safety layer, or no record of it.
    pub interventions: Option<Vec<InterventionSpan>>,
}

/// A vehicle over consecutive rows of its drive, in the road frame: x along the road, y to the left.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// Which vehicle; one that vanishes and returns has two tracks with one id.
    pub id: u32,
    /// Bumper to bumper, in m.
    pub length_m: f64,
    /// Side to side, in m.
    pub width_m: f64,
    /// Row at which the columns start.
    pub first_row: usize,
    /// Centre along the road, in m; shape `(m,)`.
    pub x_m: Vec<f64>,
    /// Centre across the road, in m; shape `(m,)`.
    pub y_m: Vec<f64>,
}

/// A lane change of ego.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChangeSpan {
    /// When it begins, in s since the start of the drive.
    pub start_s: f64,
    /// When it ends, in s since the start of the drive.
    pub end_s: f64,
    /// Which way.
    pub direction: Direction,
}

/// The safety layer stepping in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InterventionSpan {
    /// When it begins, in s since the start of the drive.
    pub start_s: f64,
    /// When it ends, in s since the start of the drive.
    pub end_s: f64,
}

/// Where the line y = 0 of a curved road runs on the map.
///
/// `map_m[i]` is the place (m, east and north, say) of x = `start_m` + i · `step_m` along the road.
#[derive(Debug, Clone, PartialEq)]
pub struct CentreLine {
    /// x of the first place, in m.
    pub start_m: f64,
    /// Distance along the road between two places, in m.
    pub step_m: f64,
    /// The places, in m; at least three.
    pub map_m: Vec<(f64, f64)>,
}
