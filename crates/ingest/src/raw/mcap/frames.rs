//! Which transform is ego's pose.

use super::slots::EGO_SLOTS;
use maveric_bag::name_number;
use std::sync::LazyLock;

/// Frames that stand still, the better first: `odom` drifts.
const FIXED: [&str; 4] = ["map", "world", "earth", "odom"];
/// Frames that are ego, the better first.
const EGO: [&str; 7] = [
    "base_link",
    "base_footprint",
    "ego_vehicle",
    "hero",
    "ego",
    "vehicle",
    "base",
];

static NUMBERS: LazyLock<(Vec<f64>, Vec<f64>)> = LazyLock::new(|| {
    let numbers = |names: &[&str]| names.iter().map(|n| name_number(n.as_bytes())).collect();
    (numbers(&FIXED), numbers(&EGO))
});

/// The frames of a transform that is ego's pose; the least is the best.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Frames {
    fixed: usize,
    ego: usize,
}

impl Frames {
    /// The frames of a row of a transform; none where it is not ego's pose.
    pub(crate) fn of(row: &[f64]) -> Option<Self> {
        let [parent, child] = *row.get(EGO_SLOTS.len()..)?.first_chunk()?;
        let place = |all: &[f64], name: f64| all.iter().position(|n| n.to_bits() == name.to_bits());
        Some(Self {
            fixed: place(&NUMBERS.0, parent)?,
            ego: place(&NUMBERS.1, child)?,
        })
    }

    /// Their names: the frame that stands still, and ego's.
    pub(crate) fn names(self) -> (&'static str, &'static str) {
        (FIXED[self.fixed], EGO[self.ego])
    }
}
