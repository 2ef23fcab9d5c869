//! Lanes that a table numbers, and places in them.

use crate::{
    lane_centres::WITHIN_LANE,
    mapping::{RoadMapping, Side, TableMapping},
};

/// How a table numbers lanes, and where they lie.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lanes {
    from: Side,
    first: i64,
    /// Metres to the left in a unit of a place in a lane.
    offset_m: f64,
    road: RoadMapping,
}

impl Lanes {
    /// As a mapping says; places in lanes grow to this side.
    pub(super) fn new(
        mapping: &TableMapping,
        road: &RoadMapping,
        offset_grows: Option<Side>,
    ) -> Self {
        Self {
            from: mapping.lanes_from.unwrap_or(Side::Right),
            first: mapping.first_lane,
            offset_m: offset_grows.map_or(1.0, Side::to_left) * mapping.units.length.metres(),
            road: *road,
        }
    }

    /// A lane's number as one from the right, where 0 is the right lane.
    pub(super) fn counted_from_right(&self, number: f64) -> i64 {
        let nth = number.round() as i64 - self.first;
        match self.from {
            Side::Left => i64::from(self.road.lanes) - 1 - nth,
            Side::Right => nth,
        }
    }

    /// Position of the centre of a lane across the road, to the left, in m; NaN where the number is.
    pub(super) fn centre_m(&self, number: f64) -> f64 {
        if number.is_nan() {
            return f64::NAN;
        }
        self.road.right_lane_centre_y_m
            + self.counted_from_right(number) as f64 * self.road.lane_width_m
    }

    /// How far left of its lane's centre a vehicle is, in m, by the place that the table says: no place leads out of the lane.
    pub(super) fn within_m(&self, place: f64) -> f64 {
        self.kept_m(place * self.offset_m)
    }

    /// A distance from a lane's centre that stays in the lane, in m.
    pub(super) fn kept_m(&self, distance_m: f64) -> f64 {
        let most_m = WITHIN_LANE * self.road.lane_width_m;
        distance_m.clamp(-most_m, most_m)
    }

    /// Positions across the road, to the left, in m, by columns of numbers and of places; without numbers all are in the right lane. None
    /// without either column.
    pub(super) fn across_m(
        &self,
        numbers: Option<&[f64]>,
        places: Option<&[f64]>,
    ) -> Option<Vec<f64>> {
        let right_m = self.road.right_lane_centre_y_m;
        match (numbers, places) {
            (None, None) => None,
            (Some(numbers), None) => Some(numbers.iter().map(|n| self.centre_m(*n)).collect()),
            (None, Some(places)) => {
                Some(places.iter().map(|p| right_m + self.within_m(*p)).collect())
            }
            (Some(numbers), Some(places)) => {
                let rows = numbers.iter().zip(places);
                Some(
                    rows.map(|(n, p)| self.centre_m(*n) + self.within_m(*p))
                        .collect(),
                )
            }
        }
    }
}
