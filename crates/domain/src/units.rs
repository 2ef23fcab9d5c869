//! Units as types: what a public signature speaks in.

use serde::{Deserialize, Serialize};
use std::ops::{Add, Div, Mul, Neg, Sub};

macro_rules! unit {
    ($(#[$doc:meta])* $name:ident, $symbol:literal) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Default, Serialize, Deserialize)]
        #[serde(transparent)]
        pub struct $name(pub f64);

        impl Add for $name {
            type Output = Self;
            fn add(self, other: Self) -> Self {
                Self(self.0 + other.0)
            }
        }
        impl Sub for $name {
            type Output = Self;
            fn sub(self, other: Self) -> Self {
                Self(self.0 - other.0)
            }
        }
        impl Neg for $name {
            type Output = Self;
            fn neg(self) -> Self {
                Self(-self.0)
            }
        }
        impl Mul<f64> for $name {
            type Output = Self;
            fn mul(self, factor: f64) -> Self {
                Self(self.0 * factor)
            }
        }
        impl Div for $name {
            type Output = f64;
            fn div(self, other: Self) -> f64 {
                self.0 / other.0
            }
        }
        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                std::fmt::Display::fmt(&self.0, f)?;
                f.write_str(concat!(" ", $symbol))
            }
        }
    };
}

unit!(
    /// A length in metres.
    Metres, "m"
);
unit!(
    /// A speed in metres per second.
    MetresPerSecond, "m/s"
);
unit!(
    /// A duration in seconds.
    Seconds, "s"
);

impl Div<MetresPerSecond> for Metres {
    type Output = Seconds;
    fn div(self, speed: MetresPerSecond) -> Seconds {
        Seconds(self.0 / speed.0)
    }
}

impl Mul<Seconds> for MetresPerSecond {
    type Output = Metres;
    fn mul(self, time: Seconds) -> Metres {
        Metres(self.0 * time.0)
    }
}

/// Metres per second in one mile per hour, exactly.
pub const MPS_PER_MPH: f64 = 0.44704;

/// In which unit people read a speed.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum SpeedUnit {
    /// Kilometres an hour.
    #[default]
    #[serde(rename = "km/h")]
    Kmh,
    /// Miles an hour.
    #[serde(rename = "mph")]
    Mph,
}

impl SpeedUnit {
    /// As it is written behind a number.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kmh => "km/h",
            Self::Mph => "mph",
        }
    }

    /// How many of it make one metre per second.
    ///
    /// # Example
    /// ```
    /// # use maveric_domain::units::SpeedUnit;
    /// assert_eq!(10.0 * SpeedUnit::Kmh.per_mps(), 36.0);
    /// ```
    pub fn per_mps(self) -> f64 {
        match self {
            Self::Kmh => 3.6,
            Self::Mph => 1.0 / MPS_PER_MPH,
        }
    }
}

impl MetresPerSecond {
    /// A speed read in miles per hour.
    ///
    /// # Example
    /// ```
    /// # use maveric_domain::MetresPerSecond;
    /// assert!((MetresPerSecond::from_mph(55.0).0 - 24.5872).abs() < 1e-12);
    /// ```
    pub fn from_mph(mph: f64) -> Self {
        Self(mph * MPS_PER_MPH)
    }

    /// This speed in miles per hour, for a person to read.
    pub fn mph(self) -> f64 {
        self.0 / MPS_PER_MPH
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_over_a_speed_is_a_time() {
        assert_eq!(Metres(30.0) / MetresPerSecond(20.0), Seconds(1.5));
    }

    #[test]
    fn values_print_with_their_unit() {
        assert_eq!(format!("{:.1}", Metres(3.66)), "3.7 m");
    }
}
