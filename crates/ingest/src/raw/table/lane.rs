//! Lanes that a table numbers, and places in them.

use crate::{
    error::IngestError,
    mapping::{RoadMapping, Side, TableMapping},
    plausible::refuse_many,
    quality::{Warning, WarningKind, report},
};
use maveric_domain::Road;
use std::path::Path;

/// Numbers that are nearer to a whole one, and places that are nearer to the edge of their lane, are rounded, in lanes and m.
const ROUNDED: f64 = 1e-6;

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

    /// Position across the road, to the left, in m, as far from the centre of a lane: no place in a lane that the road does not have leads
    /// onto it, so that this lane's centre stands in.
    pub(super) fn at_m(&self, number: f64, from_centre_m: f64) -> f64 {
        let lanes = 0..i64::from(self.road.lanes);
        let is_on_road = lanes.contains(&self.counted_from_right(number));
        if is_on_road || from_centre_m.is_nan() {
            self.centre_m(number) + from_centre_m
        } else {
            self.centre_m(number)
        }
    }

    /// How far left of its lane's centre a vehicle is, in m, by the place that the table says: no place leads out of the lane.
    pub(super) fn within_m(&self, place: f64) -> f64 {
        self.kept_m(place * self.offset_m)
    }

    /// A distance from a lane's centre that stays in the lane, in m.
    pub(super) fn kept_m(&self, distance_m: f64) -> f64 {
        let most_m = Road::WITHIN_LANE * self.road.lane_width_m;
        distance_m.clamp(-most_m, most_m)
    }

    /// Says of numbers of lanes that the nearest whole one stands in, and of places in lanes that they are beyond them: those end at the
    /// lane's edge.
    ///
    /// # Errors
    /// [`IngestError::Implausible`] where too many places are beyond their lanes for chance: another unit is likely.
    pub(super) fn doubts(
        &self,
        path: &Path,
        numbers: impl IntoIterator<Item = f64>,
        places: impl IntoIterator<Item = f64>,
    ) -> Result<Vec<Warning>, IngestError> {
        let mut doubts = Vec::new();
        let mut broken = numbers.into_iter().filter(|n| (n - n.round()).abs() > ROUNDED);
        if let Some(first) = broken.next() {
            let what = format!(
                "numbers of lanes are not whole, the first of them {first}: the nearest whole one stands in"
            );
            let count = 1 + broken.count();
            doubts.push(Warning::new(path, WarningKind::Unit, count, what));
        }
        let places = places.into_iter().filter(|p| p.is_finite());
        let places_m: Vec<f64> = places.map(|p| p * self.offset_m).collect();
        let width_m = self.road.lane_width_m;
        let is_beyond = |m: &&f64| m.abs() > 0.5 * width_m + ROUNDED;
        let beyond = places_m.iter().filter(is_beyond).count();
        let what = format!(
            "a place in the lane is further from its centre than half a lane of {width_m} m: it ends at the lane's edge. Are its \
             unit and `lane_width_m` right?"
        );
        refuse_many(path, beyond, places_m.len(), &what)?;
        report(&mut doubts, path, WarningKind::Unit, beyond, &what);
        Ok(doubts)
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
                Some(rows.map(|(n, p)| self.at_m(*n, self.within_m(*p))).collect())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lane_and_a_half_and_places_beyond_the_lane_are_told_and_many_of_them_refused() {
        let lanes = Lanes {
            from: Side::Right,
            first: 1,
            offset_m: 1.0,
            road: RoadMapping { lane_width_m: 3.5, ..RoadMapping::UNKNOWN },
        };
        let told = |number: f64, place: f64, rows: usize| {
            let numbers = (0..100).map(|row| if row < rows { number } else { 2.0 });
            let places = (0..100).map(|row| if row < rows { place } else { 0.3 });
            let doubts = lanes.doubts(Path::new("t.csv"), numbers, places);
            doubts.map(|doubts| doubts.into_iter().map(|d| (d.count, d.what)).collect::<Vec<_>>())
        };
        // The edge itself, an empty cell, and a rounded number.
        assert_eq!(told(1.0 + 1e-9, 1.75, 100).unwrap(), []);
        assert_eq!(told(f64::NAN, f64::NAN, 10).unwrap(), []);
        let broken = told(1.5, 0.0, 3).unwrap();
        assert_eq!((broken.len(), broken[0].0), (1, 3));
        assert!(broken[0].1.contains("the first of them 1.5"), "{broken:?}");
        let beyond = told(1.0, -1.8, 25).unwrap();
        assert_eq!((beyond.len(), beyond[0].0), (1, 25));
        assert!(beyond[0].1.contains("half a lane of 3.5 m"), "{beyond:?}");
        let refused = told(1.0, 9.0, 26).unwrap_err().to_string();
        assert!(refused.contains("in 26 of 100 samples a place"), "{refused}");
    }
}
