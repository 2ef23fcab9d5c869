//! Lanes that no number names: told by their edges, or by where everybody drove.

use crate::{error::IngestError, median::median, raw::RawDrive};
use maveric_domain::Road;
use std::{f64::consts::TAU, path::Path};

/// Share of all samples that makes a lane a driven one: fewer are changes between two others.
const LEAST_SHARE: f64 = 0.01;
/// How well positions must gather around lanes of the given width, from 0 (evenly anywhere) to 1 (all on centres).
const LEAST_GATHERED: f64 = 0.5;

/// How lanes lie across the road.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum LaneShape<'a> {
    /// As the road says: equally wide, the right one around y = 0.
    Even,
    /// Between edges, from the right one to the left one, in m.
    Edges(&'a [f64]),
    /// Around where vehicles drove, as many as the road has.
    Driven,
}

/// Moves everybody across the road, so that the lanes that they drive in are those of the road.
///
/// Offsets from lanes' centres stay as they are, up to the lane's edge; beside all lanes, without an end.
///
/// # Errors
/// [`IngestError::BadTable`] where [`LaneShape::Driven`] does not find the road's lanes.
pub(crate) fn into_lanes(
    path: &Path,
    drive: &mut RawDrive,
    road: &Road,
    shape: LaneShape<'_>,
) -> Result<(), IngestError> {
    let centres = match shape {
        LaneShape::Even => return Ok(()),
        LaneShape::Edges(edges) => edges.windows(2).map(|e| f64::midpoint(e[0], e[1])).collect(),
        LaneShape::Driven => {
            driven(drive, road).map_err(|why| IngestError::bad_table(path, why))?
        }
    };
    let edges: Vec<f64> = match shape {
        LaneShape::Edges(edges) => edges[1..edges.len() - 1].to_vec(),
        _ => centres.windows(2).map(|c| f64::midpoint(c[0], c[1])).collect(),
    };
    let most = Road::WITHIN_LANE * road.lane_width_m;
    let place = |y: f64| {
        let lane = edges.partition_point(|edge| *edge <= y);
        let offset = y - centres[lane];
        let right = if lane == 0 { f64::NEG_INFINITY } else { -most };
        let left = if lane == edges.len() { f64::INFINITY } else { most };
        lane as f64 * road.lane_width_m + offset.clamp(right, left)
    };
    drive.move_all(|x, y| (x, place(y)));
    Ok(())
}

/// The centres of the lanes, from the right one to the left one: the median of those who drove in each.
fn driven(drive: &RawDrive, road: &Road) -> Result<Vec<f64>, String> {
    let width = road.lane_width_m;
    let ys = || drive.ego.y_m.iter().chain(&drive.objects.y_m).copied();
    // Lanes are a width apart: their place within it is the mean of all directions on a circle of that width.
    let (mut sin, mut cos, mut count) = (0.0, 0.0, 0_usize);
    for y in ys() {
        let (s, c) = libm::sincos(TAU * y / width);
        (sin, cos, count) = (sin + s, cos + c, count + 1);
    }
    let gathered = libm::hypot(sin, cos) / count.max(1) as f64;
    if gathered < LEAST_GATHERED {
        return Err(format!(
            "lateral positions do not gather in lanes of {width} m: give `lane_edges_m` instead of `lanes_driven`"
        ));
    }
    let first = libm::atan2(sin, cos) / TAU * width;
    let mut lanes: std::collections::BTreeMap<i64, Vec<f64>> = std::collections::BTreeMap::new();
    for y in ys() {
        let lane = ((y - first) / width).round() as i64;
        lanes.entry(lane).or_default().push(y);
    }
    lanes.retain(|_, ys| ys.len() as f64 >= LEAST_SHARE * count as f64);
    let centres: Vec<f64> = lanes.into_values().filter_map(|mut ys| median(&mut ys)).collect();
    let expected = usize::from(road.lanes);
    if centres.len() == expected {
        return Ok(centres);
    }
    let rounded: Vec<String> = centres.iter().map(|c| format!("{c:.2}")).collect();
    Err(format!(
        "vehicles drove in {} lanes (around y = {} m), expected {expected} as in `road.lanes`: which of them they are is not \
         known, so give `lane_edges_m`",
        centres.len(),
        rounded.join(", ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raw::EgoSample;

    fn at(ys: &[f64]) -> RawDrive {
        let ego = (0..).zip(ys).map(|(i, &y_m)| EgoSample {
            stamp_ns: i,
            log_ns: i,
            nth: 0,
            x_m: 0.0,
            y_m,
            yaw_rad: None,
            speed_mps: Some(20.0),
        });
        RawDrive { ego: ego.collect(), ..RawDrive::default() }
    }

    fn placed(ys: &[f64], lanes: u8, shape: LaneShape<'_>) -> Result<Vec<f64>, String> {
        let road = Road { lanes, lane_width_m: 3.5, ..Road::PAPER };
        let mut drive = at(ys);
        into_lanes(Path::new("t.csv"), &mut drive, &road, shape).map_err(|e| e.to_string())?;
        Ok(drive.ego.y_m)
    }

    fn assert_near(found: &[f64], expected: &[f64]) {
        let near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-9;
        assert!(found.len() == expected.len() && found.iter().zip(expected).all(near), "{found:?}");
    }

    #[test]
    fn edges_make_lanes_of_any_width_the_roads_lanes() {
        // A right lane of 3 m, one of 4 m, and beside them on both sides.
        let edges = [10.0, 13.0, 17.0];
        let found = placed(&[11.5, 12.5, 15.0, 13.1, 8.0, 20.0], 2, LaneShape::Edges(&edges));
        assert_near(&found.unwrap(), &[0.0, 1.0, 3.5, 3.5 - 1.715, -3.5, 3.5 + 5.0]);
    }

    #[test]
    fn lanes_are_found_where_vehicles_drove_and_not_guessed_where_some_are_empty() {
        let mut ys: Vec<f64> =
            (0..300).map(|i| 101.0 + f64::from(i % 3) * 3.4 + f64::from(i % 7 - 3) * 0.1).collect();
        // A change between two lanes makes none.
        ys.push(102.7);
        let found = placed(&ys, 3, LaneShape::Driven).unwrap();
        for (y, road_y) in ys.iter().zip(&found).take(300) {
            let lane = ((y - 101.0) / 3.4).round();
            assert!(
                (road_y - 3.5 * lane - (y - 101.0 - 3.4 * lane)).abs() < 0.11,
                "{y} became {road_y}"
            );
        }
        let error = placed(&ys, 4, LaneShape::Driven).unwrap_err();
        assert!(
            error.contains("in 3 lanes")
                && error.contains("expected 4")
                && error.contains("lane_edges_m"),
            "{error}"
        );
        let evenly: Vec<f64> = (0..350).map(|i| f64::from(i) * 0.03).collect();
        let error = placed(&evenly, 3, LaneShape::Driven).unwrap_err();
        assert!(error.contains("do not gather"), "{error}");
    }
}
