//! One piece of road: a straight, an arc or a clothoid.

use crate::{
    error::SimulatorError,
    scenario::setting::{Range, Value, check},
};
use serde::{Deserialize, Serialize};

/// One piece of the centre line of lane 0, as the scenario file has it.
///
/// Radii are positive for a bend to the left, negative for one to the right.
///
/// # Example
/// ```
/// # use maveric_simulator::Segment;
/// #[derive(serde::Deserialize)]
/// struct File {
///     segments: Vec<Segment>,
/// }
/// let file: File = toml::from_str(
///     r#"segments = [
///         { kind = "straight", length_m = 500.0 },
///         { kind = "clothoid", length_m = 120.0, to_radius_m = 600.0 },
///         { kind = "arc", length_m = 300.0, radius_m = 600.0 },
///         { kind = "clothoid", length_m = 120.0 },
///     ]"#,
/// )?;
/// assert_eq!(file.segments[3], Segment::Clothoid { length_m: 120.0, to_radius_m: None });
/// # Ok::<(), toml::de::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub enum Segment {
    /// Curvature 0.
    Straight {
        /// Along the centre line of lane 0, in m.
        length_m: f64,
    },
    /// A constant curvature.
    Arc {
        /// Along the centre line of lane 0, in m.
        length_m: f64,
        /// Radius, in m, signed.
        radius_m: f64,
    },
    /// A curvature that changes evenly from that of the segment before (of the last one, for the first).
    Clothoid {
        /// Along the centre line of lane 0, in m.
        length_m: f64,
        /// Radius at its end, in m, signed; without, it ends straight.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        to_radius_m: Option<f64>,
    },
}

/// The tightest bend, in m: where lanes on its inside still have room to turn.
const TIGHTEST_M: f64 = 50.0;
const RADIUS: Range = Range::Because(TIGHTEST_M, 1e6, "50 to 1000000 m, or the same negative");

impl Segment {
    pub(crate) fn length_m(&self) -> f64 {
        match *self {
            Self::Straight { length_m }
            | Self::Arc { length_m, .. }
            | Self::Clothoid { length_m, .. } => length_m,
        }
    }

    /// Curvature at its end, in 1/m.
    pub(crate) fn ends_per_m(&self) -> f64 {
        match *self {
            Self::Straight { .. } | Self::Clothoid { to_radius_m: None, .. } => 0.0,
            Self::Arc { radius_m, .. } | Self::Clothoid { to_radius_m: Some(radius_m), .. } => {
                1.0 / radius_m
            }
        }
    }

    /// Curvature at its start, in 1/m, after a segment that ends with `before_per_m`.
    pub(crate) fn starts_per_m(&self, before_per_m: f64) -> f64 {
        match self {
            Self::Clothoid { .. } => before_per_m,
            _ => self.ends_per_m(),
        }
    }
}

impl Value for Segment {
    fn check(&self, name: &str, _range: Range) -> Result<(), SimulatorError> {
        check(&format!("{name}.length_m"), self.length_m(), 1.0..=1e5)?;
        let (key, radius_m) = match *self {
            Self::Arc { radius_m, .. } => ("radius_m", radius_m),
            Self::Clothoid { to_radius_m: Some(radius_m), .. } => ("to_radius_m", radius_m),
            _ => return Ok(()),
        };
        check(&format!("{name}.{key}"), radius_m.abs(), RADIUS)
    }
}
