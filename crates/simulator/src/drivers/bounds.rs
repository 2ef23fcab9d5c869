//! Between what a person's numbers may lie that both kinds of people have.

use std::ops::RangeInclusive;

type Bounds = RangeInclusive<f64>;

/// Shortest time gap that is followed with, whatever is given up of the own one, in s.
pub(super) const SHORTEST_TIME_GAP_S: f64 = 0.4;

pub(super) const FOLLOWING_TIME_GAP_S: Bounds = 0.7..=10.0;
pub(super) const ACCELERATION_MPS2: Bounds = 0.3..=3.0;
pub(super) const PASSING_SPEED_ADDED_MPS: Bounds = -5.0..=10.0;
pub(super) const PASSING_SPEED_OVER_LEAD_MPS: Bounds = 0.5..=10.0;
pub(super) const LANE_CHANGE_S: Bounds = 3.0..=10.0;
pub(super) const STANDSTILL_M: Bounds = 1.0..=20.0;
pub(super) const BRAKING_MPS2: Bounds = 0.5..=6.0;
pub(super) const DELAY_S: Bounds = 0.0..=0.8;
pub(super) const GAP_ERROR_SD: Bounds = 0.0..=0.15;
