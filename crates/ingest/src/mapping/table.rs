//! What the columns of a table mean.

use serde::Deserialize;

/// Columns of a table, their units and what its gap is measured between.
///
/// Units and the kind of gap have no defaults: a table that does not say them must be asked about.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableMapping {
    /// What a row and a file are.
    pub layout: Layout,
    /// Character between cells.
    #[serde(default = "comma")]
    pub separator: char,
    /// What the gap is measured between.
    pub gap_kind: GapKind,
    /// Ego's length, in m; tables of pairs do not say it.
    #[serde(default = "car_length")]
    pub ego_length_m: f64,
    /// Length of the vehicle ahead where no column says it, in m.
    #[serde(default = "car_length")]
    pub lead_length_m: f64,
    /// Units of the columns.
    pub units: Units,
    /// Names of the columns.
    pub columns: Columns,
}

fn comma() -> char {
    ','
}

fn car_length() -> f64 {
    TableMapping::CAR_LENGTH_M
}

impl TableMapping {
    /// A middle-sized car, bumper to bumper, in m.
    pub const CAR_LENGTH_M: f64 = 4.7;
}

/// What a row and a file are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Layout {
    /// A file is one follower (ego) behind one leader, a row is one time.
    Pair,
}

/// What a gap is measured between.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GapKind {
    /// From ego's front bumper to the leader's rear bumper.
    BumperToBumper,
    /// From front bumper to front bumper: the leader's length is taken off.
    FrontToFront,
}

/// Units of the columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Units {
    /// Of the time.
    pub time: TimeUnit,
    /// Of positions, gaps and lengths.
    pub length: LengthUnit,
    /// Of speeds.
    pub speed: SpeedUnit,
}

/// A unit of time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum TimeUnit {
    /// Seconds.
    #[serde(rename = "s")]
    Seconds,
    /// Milliseconds.
    #[serde(rename = "ms")]
    Milliseconds,
}

/// A unit of length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum LengthUnit {
    /// Metres.
    #[serde(rename = "m")]
    Metres,
    /// International feet, 0.3048 m.
    #[serde(rename = "ft")]
    Feet,
}

/// A unit of speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum SpeedUnit {
    /// Metres per second.
    #[serde(rename = "m/s")]
    MetresPerSecond,
    /// Kilometres per hour.
    #[serde(rename = "km/h")]
    KilometresPerHour,
    /// Miles per hour.
    #[serde(rename = "mph")]
    MilesPerHour,
    /// Feet per second.
    #[serde(rename = "ft/s")]
    FeetPerSecond,
}

impl TimeUnit {
    /// Nanoseconds in one.
    pub fn nanoseconds(self) -> f64 {
        match self {
            Self::Seconds => 1e9,
            Self::Milliseconds => 1e6,
        }
    }
}

impl LengthUnit {
    /// Metres in one, exactly.
    pub fn metres(self) -> f64 {
        match self {
            Self::Metres => 1.0,
            Self::Feet => 0.3048,
        }
    }
}

impl SpeedUnit {
    /// Metres per second in one.
    pub fn metres_per_second(self) -> f64 {
        match self {
            Self::MetresPerSecond => 1.0,
            Self::KilometresPerHour => 1.0 / 3.6,
            Self::MilesPerHour => maveric_domain::units::MPS_PER_MPH,
            Self::FeetPerSecond => 0.3048,
        }
    }
}

/// Names of the columns.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Columns {
    /// Time.
    pub time: String,
    /// Ego's position along the road.
    pub ego_x: String,
    /// Ego's speed.
    pub ego_speed: String,
    /// The leader's speed.
    pub lead_speed: String,
    /// Distance to the leader, of the mapping's kind.
    pub gap: String,
    /// The leader's length; 0 means that it is not known.
    pub lead_length: Option<String>,
}
