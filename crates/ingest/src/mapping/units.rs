//! Units that a table may be in.

use serde::{Deserialize, Serialize};

/// Metres in an international foot.
const FOOT_M: f64 = 0.3048;

/// Units of the columns; none has a default but the angle's, which few tables have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Units {
    /// Of all times, or how dates are written.
    pub time: TimeUnit,
    /// Of positions, gaps and lengths.
    pub length: LengthUnit,
    /// Of speeds, velocities and posted speeds.
    pub speed: SpeedUnit,
    /// Of headings.
    #[serde(default)]
    pub angle: AngleUnit,
}

/// How a table writes its times.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum TimeUnit {
    /// `s` in a mapping.
    #[serde(rename = "s")]
    Seconds,
    /// `ms` in a mapping.
    #[serde(rename = "ms")]
    Milliseconds,
    /// `us` in a mapping.
    #[serde(rename = "us")]
    Microseconds,
    /// `ns` in a mapping.
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

/// The unit of a table's positions, gaps and lengths.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum LengthUnit {
    /// `m` in a mapping.
    #[serde(rename = "m")]
    Metres,
    /// International feet, 0.3048 m.
    #[serde(rename = "ft")]
    Feet,
}

/// The unit of a table's speeds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum SpeedUnit {
    /// `m/s` in a mapping.
    #[serde(rename = "m/s")]
    MetresPerSecond,
    /// `km/h` in a mapping.
    #[serde(rename = "km/h")]
    KilometresPerHour,
    /// `mph` in a mapping: international miles, 1.609344 km.
    #[serde(rename = "mph")]
    MilesPerHour,
    /// `ft/s` in a mapping: international feet, 0.3048 m.
    #[serde(rename = "ft/s")]
    FeetPerSecond,
}

/// The unit of a table's headings, and where they count from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum AngleUnit {
    /// Counter-clockwise from x; `rad` in a mapping.
    #[default]
    #[serde(rename = "rad")]
    Radians,
    /// Counter-clockwise from x; `deg` in a mapping.
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
            Self::Feet => FOOT_M,
        }
    }
}

impl SpeedUnit {
    /// In m/s, the factor that a number of the table is multiplied by.
    pub fn metres_per_second(self) -> f64 {
        match self {
            Self::MetresPerSecond => 1.0,
            Self::KilometresPerHour => 1.0 / 3.6,
            Self::MilesPerHour => maveric_domain::units::MPS_PER_MPH,
            Self::FeetPerSecond => FOOT_M,
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
