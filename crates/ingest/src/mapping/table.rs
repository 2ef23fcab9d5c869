//! What a table's rows and files are, and how its cells are written.

use super::{layout::Layout, side::Side, units::Units};
use serde::{Deserialize, Serialize};

/// How a table is written, what its gap is measured between, how it numbers lanes, and its layout with the columns.
///
/// Units, the kind of gap and the side from which lanes are numbered have no defaults: a table that does not say them must be
/// asked about.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TableMapping {
    /// Character between cells; without it the most frequent of comma, semicolon and tab in the header. A blank stands for any
    /// number of blanks and tabs.
    pub separator: Option<char>,
    /// Whether a line of names stands above the cells; else columns are named by their numbers, from `1`.
    #[serde(default = "yes")]
    pub header: bool,
    /// Whether numbers are written 1,5 for one and a half.
    #[serde(default)]
    pub decimal_comma: bool,
    /// What the gap is measured between; needed where there is a gap.
    pub gap_kind: Option<GapKind>,
    /// The side from which lanes are numbered; needed where lanes have numbers.
    pub lanes_from: Option<Side>,
    /// Number of the first lane on that side.
    #[serde(default = "one")]
    pub first_lane: i64,
    /// How times are written, with `time = "pattern"`: `%Y%m%d %H:%M:%S:%f`, where `%f` at the end is a fraction of any width.
    pub time_pattern: Option<String>,
    /// Frames a second, where times are numbers of frames.
    pub frames_per_s: Option<f64>,
    /// Ego's length where no column says it, in m.
    #[serde(default = "car_length")]
    pub ego_length_m: f64,
    /// Length of the vehicle ahead where no column says it, in m.
    #[serde(default = "car_length")]
    pub lead_length_m: f64,
    /// Units of the columns.
    pub units: Units,
    /// What a row and a file are, with the keys that this layout alone has.
    #[serde(flatten)]
    pub layout: Layout,
}

fn one() -> i64 {
    TableMapping::FIRST_LANE
}

fn yes() -> bool {
    true
}

fn car_length() -> f64 {
    TableMapping::CAR_LENGTH_M
}

/// What a gap is measured between.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GapKind {
    /// From ego's front bumper to the leader's rear bumper.
    BumperToBumper,
    /// From front bumper to front bumper: the leader's length is taken off.
    FrontToFront,
    /// From centre to centre: half of both lengths is taken off.
    CentreToCentre,
    /// From bumper to bumper, negative where the other vehicle is behind: `lead_dx_m` of our own drives.
    Signed,
}

impl TableMapping {
    /// A middle-sized car, bumper to bumper, in m.
    pub const CAR_LENGTH_M: f64 = 4.7;
    /// Number of the first lane where a file does not say it.
    pub const FIRST_LANE: i64 = 1;
}
