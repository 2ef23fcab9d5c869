//! Which transform is ego's pose.

use super::slots::{EGO_SLOTS, OBJECT_SLOTS};
use maveric_bag::name_number;
use std::sync::LazyLock;

/// Frames that stand still, the better first: `odom` drifts.
const FIXED: [&str; 4] = ["map", "world", "earth", "odom"];
/// Frames that are ego, the better first.
const EGO: [&str; 7] =
    ["base_link", "base_footprint", "ego_vehicle", "hero", "ego", "vehicle", "base"];

static NUMBERS: LazyLock<(Vec<f64>, Vec<f64>)> = LazyLock::new(|| {
    let numbers = |names: &[&str]| names.iter().map(|n| name_number(n.as_bytes())).collect();
    (numbers(&FIXED), numbers(&EGO))
});

/// Whose frame the others' places are in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Whose {
    /// That of ego's poses, or nothing is said.
    #[default]
    Fixed,
    /// Another one that stands still.
    Another,
    /// Ego's own.
    Ego,
    /// Nobody knows.
    Unknown,
}

/// Names of frames, as numbers: that of positions and, for ego, its own.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct FrameNames {
    of_positions: Option<f64>,
    own: Option<f64>,
}

impl FrameNames {
    /// Of a row of ego.
    pub(crate) fn of_ego(row: &[f64]) -> Self {
        let names = row.get(EGO_SLOTS.len()..).unwrap_or_default();
        Self { of_positions: Self::named(names.first()), own: Self::named(names.get(1)) }
    }

    /// Of a row of an object.
    pub(crate) fn of_object(row: &[f64]) -> Self {
        Self { of_positions: Self::named(row.get(OBJECT_SLOTS.len())), own: None }
    }

    /// An empty name says nothing.
    fn named(name: Option<&f64>) -> Option<f64> {
        name.copied().filter(|n| !n.is_nan() && n.to_bits() != name_number(b"").to_bits())
    }

    /// Whether these are the frames of positions so far; the first that are named are.
    pub(crate) fn is_of(&mut self, now: Self) -> bool {
        let first = self.of_positions.is_none();
        if first {
            *self = now;
        }
        first || now.of_positions.is_none() || now.of_positions == self.of_positions
    }

    /// Whose frame these positions of others are in, beside those of ego.
    pub(crate) fn beside(self, ego: Self) -> Whose {
        let is = |names: &[f64], name: f64| names.iter().any(|n| n.to_bits() == name.to_bits());
        match self.of_positions {
            None => Whose::Fixed,
            Some(name) if ego.of_positions == Some(name) => Whose::Fixed,
            Some(name) if ego.own == Some(name) || is(&NUMBERS.1, name) => Whose::Ego,
            Some(name) if is(&NUMBERS.0, name) && ego.of_positions.is_none() => Whose::Fixed,
            Some(name) if is(&NUMBERS.0, name) => Whose::Another,
            Some(_) => Whose::Unknown,
        }
    }
}

/// The frames of a transform that is ego's pose; the least is the best.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Frames {
    fixed: usize,
    ego: usize,
}

impl Frames {
    /// The frames of a row of a transform; none where it is not ego's pose.
    pub(crate) fn from_row(row: &[f64]) -> Option<Self> {
        let [parent, child] = *row.get(EGO_SLOTS.len()..)?.first_chunk()?;
        let place =
            |names: &[f64], name: f64| names.iter().position(|n| n.to_bits() == name.to_bits());
        Some(Self { fixed: place(&NUMBERS.0, parent)?, ego: place(&NUMBERS.1, child)? })
    }

    /// Their names: the frame that stands still, and ego's.
    pub(crate) fn names(self) -> (&'static str, &'static str) {
        (FIXED[self.fixed], EGO[self.ego])
    }
}
