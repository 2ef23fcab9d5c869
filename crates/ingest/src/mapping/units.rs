//! Units that a table may be in.

use serde::{Deserialize, Serialize};

/// Units of the columns; none has a default but the angle's, which few tables have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Units {
    /// Of the time.
    pub time: TimeUnit,
    /// Of positions, gaps and lengths.
    pub length: LengthUnit,
    /// Of speeds.
    pub speed: SpeedUnit,
    /// Of headings.
    #[serde(default)]
    pub angle: AngleUnit,
}

impl Units {
    /// These units; headings in the angle's default.
    pub fn new(time: TimeUnit, length: LengthUnit, speed: SpeedUnit) -> Self {
        Self {
            time,
            length,
            speed,
            angle: AngleUnit::default(),
        }
    }
}

/// A unit of time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum TimeUnit {
    /// Seconds.
    #[serde(rename = "s")]
    Seconds,
    /// Milliseconds.
    #[serde(rename = "ms")]
    Milliseconds,
    /// Microseconds.
    #[serde(rename = "us")]
    Microseconds,
    /// Nanoseconds.
    #[serde(rename = "ns")]
    Nanoseconds,
    /// Numbers of frames; the mapping or the recording's meta file says how many make a second.
    #[serde(rename = "frames")]
    Frames,
    /// A date and a time of day, such as `2019-07-04T10:21:33.1Z`.
    #[serde(rename = "iso8601")]
    Iso8601,
    /// Dates or times of day as the mapping's `time_pattern` writes them.
    #[serde(rename = "pattern")]
    Pattern,
}

/// A unit of length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum LengthUnit {
    /// Metres.
    #[serde(rename = "m")]
    Metres,
    /// International feet, 0.3048 m.
    #[serde(rename = "ft")]
    Feet,
}

/// A unit of speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
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

/// A unit of angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum AngleUnit {
    /// Radians.
    #[default]
    #[serde(rename = "rad")]
    Radians,
    /// Degrees.
    #[serde(rename = "deg")]
    Degrees,
    /// Degrees clockwise from y, as on a compass.
    #[serde(rename = "deg_from_north")]
    DegreesFromNorth,
}

impl TimeUnit {
    /// Nanoseconds in one; none for frames, which need a rate, and for dates.
    pub fn nanoseconds(self) -> Option<i64> {
        match self {
            Self::Seconds => Some(1_000_000_000),
            Self::Milliseconds => Some(1_000_000),
            Self::Microseconds => Some(1_000),
            Self::Nanoseconds => Some(1),
            Self::Frames | Self::Iso8601 | Self::Pattern => None,
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

impl AngleUnit {
    /// An angle in rad, counter-clockwise from x.
    pub fn radians(self, angle: f64) -> f64 {
        match self {
            Self::Radians => angle,
            Self::Degrees => angle.to_radians(),
            Self::DegreesFromNorth => std::f64::consts::FRAC_PI_2 - angle.to_radians(),
        }
    }
}
