//! What counts as a lane change.

use super::Rows;
use crate::scene::Road;
use serde::{Deserialize, Serialize};

/// Which way a lane change goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Direction {
    /// To a passing lane.
    Left,
    /// Back to a slower lane: the paper's merge back.
    Right,
}

/// A stretch of rows in which ego moves from one lane to another.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LaneChange {
    /// Row at which it starts.
    pub start: usize,
    /// Row after its last one.
    pub end: usize,
    /// Which way it goes.
    pub direction: Direction,
    /// Whether ego arrived in the new lane before the drive or the segment ended.
    pub completed: bool,
    /// Gap at the start to the vehicle behind in the lane entered, in m; none within 200 m.
    pub gap_behind_m: Option<f64>,
}

/// Lateral speed above which ego is on its way to another lane, in m/s.
const LATERAL_SPEED_MPS: f64 = 0.15;
/// Distance to the new lane's centre within which a change may end, in m.
const CENTRE_M: f64 = 0.5;
/// A crossing undone within this time is a weave, in s.
const WEAVE_S: f64 = 3.0;
/// The label covers this long before a start, in s.
const LABEL_S: f64 = 1.0;
/// Half the span of the central difference that gives the lateral speed, in s.
const HALF_SPAN_S: f64 = 0.2;

/// Rows at which ego is in another lane than the row before, weaves left out.
fn crossings(rows: &Rows) -> Vec<usize> {
    let mut crossing_rows: Vec<usize> = Vec::new();
    for row in 1..rows.lane.len() {
        if rows.lane[row] == rows.lane[row - 1] || rows.segment[row] != rows.segment[row - 1] {
            continue;
        }
        match crossing_rows.last() {
            Some(&last)
                if rows.lane[row] == rows.lane[last - 1]
                    && rows.time_s[row] - rows.time_s[last] < WEAVE_S =>
            {
                crossing_rows.pop();
            }
            _ => crossing_rows.push(row),
        }
    }
    crossing_rows
}

/// Fills `lane_change`, `changing` and `change_completes`.
pub(super) fn label(rows: &mut Rows, road: &Road, rate_hz: f64) {
    let n = rows.time_s.len();
    rows.lane_change = vec![false; n];
    rows.changing = vec![0; n];
    rows.change_completes = vec![false; n];
    let speed = rows.slopes(&rows.ego_y_m, HALF_SPAN_S, rate_hz);
    let mut free_from = 0;
    for crossing in crossings(rows) {
        let new_lane = rows.lane[crossing];
        let sign = if new_lane > rows.lane[crossing - 1] { 1.0 } else { -1.0 };
        let segment = rows.segment[crossing];
        let onward =
            |row: &usize| rows.segment[*row] == segment && speed[*row] * sign > LATERAL_SPEED_MPS;
        let start = (free_from..crossing)
            .rev()
            .take_while(onward)
            .last()
            .unwrap_or(crossing - 1)
            .max(free_from);
        let centre = road.lane_centre_m(new_lane);
        let arrived = |row: &usize| {
            speed[*row].abs() < LATERAL_SPEED_MPS && (rows.ego_y_m[*row] - centre).abs() < CENTRE_M
        };
        let last_of_segment =
            (crossing..n).take_while(|&r| rows.segment[r] == segment).last().unwrap_or(crossing);
        let left_again = (crossing..=last_of_segment).find(|&r| rows.lane[r] != new_lane);
        let limit = left_again.unwrap_or(last_of_segment + 1);
        let end = (crossing..limit).find(arrived);
        let stop = end.unwrap_or(limit).max(crossing + 1);
        for row in start..stop {
            rows.changing[row] = sign as i8;
        }
        // Passing straight on into a third lane is an arrival too; the drive's end is not.
        rows.change_completes[stop - 1] = end.is_some() || left_again.is_some();
        let label_start = rows.time_s[start] - LABEL_S + 0.5 / rate_hz;
        for row in (0..=start)
            .rev()
            .take_while(|&r| rows.time_s[r] > label_start && rows.segment[r] == segment)
        {
            rows.lane_change[row] = true;
        }
        free_from = stop;
    }
}

/// Reads the changes back from the columns that [`label`] filled.
pub(super) fn events(rows: &Rows) -> Vec<LaneChange> {
    let mut changes = Vec::new();
    let mut start = None;
    for (row, &sign) in rows.changing.iter().enumerate() {
        if sign == 0 {
            start = None;
            continue;
        }
        let first = *start.get_or_insert(row);
        let next = rows.changing.get(row + 1);
        let completed = rows.change_completes[row];
        if completed || next != Some(&sign) {
            let direction = if sign > 0 { Direction::Left } else { Direction::Right };
            let gap_behind_m = match direction {
                Direction::Left => rows.gap_behind_left_m[first],
                Direction::Right => rows.gap_behind_right_m[first],
            };
            changes.push(LaneChange {
                start: first,
                end: row + 1,
                direction,
                completed,
                gap_behind_m,
            });
            start = None;
        }
    }
    changes
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE: f64 = 20.0;

    fn rows(y: impl Fn(f64) -> f64, seconds: f64) -> Rows {
        let time_s: Vec<f64> = (0..(seconds * RATE) as usize).map(|i| i as f64 / RATE).collect();
        let ego_y_m: Vec<f64> = time_s.iter().map(|&t| y(t)).collect();
        let n = time_s.len();
        let mut rows = Rows {
            lane: ego_y_m.iter().map(|&y| Road::PAPER.nearest_lane(y)).collect(),
            segment: vec![0; n],
            gap_behind_left_m: vec![None; n],
            gap_behind_right_m: vec![Some(40.0); n],
            time_s,
            ego_y_m,
            ..Rows::default()
        };
        label(&mut rows, &Road::PAPER, RATE);
        rows
    }

    /// A smooth step of one lane width from time `from`, over 4 s.
    fn step(t: f64, from: f64) -> f64 {
        let s = ((t - from) / 4.0).clamp(0.0, 1.0);
        3.66 * s * s * (3.0 - 2.0 * s)
    }

    #[test]
    fn a_pass_is_one_change_out_and_one_back() {
        let changes = events(&rows(|t| step(t, 5.0) - step(t, 20.0), 30.0));
        assert_eq!(changes.len(), 2);
        assert_eq!(changes[0].direction, Direction::Left);
        assert!(changes[0].completed && changes[1].completed);
        assert!((changes[0].start as f64 / RATE - 5.0).abs() < 0.4, "{changes:?}");
        assert!((changes[0].end as f64 / RATE - 9.0).abs() < 0.4, "{changes:?}");
        assert_eq!(changes[1].gap_behind_m, Some(40.0));
    }

    #[test]
    fn lateral_speed_is_seen_a_fifth_of_a_second_to_both_sides() {
        // A lane's width from second 5 to 7, evenly: a row on either side tells from 97 on and until 143.
        let even = |t: f64| 3.66 * ((t - 5.0) / 2.0).clamp(0.0, 1.0);
        let change = events(&rows(even, 12.0))[0];
        assert_eq!((change.start, change.end), (97, 144));
    }

    #[test]
    fn a_car_that_drifts_across_changes_from_the_row_before() {
        // So slowly that no row moves onward.
        let drift = rows(|t| 1.5 + 0.5 * LATERAL_SPEED_MPS * t, 12.0);
        let crossing = drift.lane.iter().position(|&l| l != drift.lane[0]).unwrap();
        let changes = events(&drift);
        assert_eq!((changes.len(), changes[0].start), (1, crossing - 1));
        assert!(!changes[0].completed);
    }

    #[test]
    fn a_crossing_undone_within_three_seconds_is_a_weave() {
        let weave = |t: f64| 2.2 * (1.0 - ((t - 6.0) / 1.5).powi(2)).max(0.0);
        assert!(events(&rows(weave, 12.0)).is_empty());
    }

    #[test]
    fn the_label_is_the_second_before_the_start() {
        let rows = rows(|t| step(t, 5.0), 12.0);
        let start = events(&rows)[0].start;
        assert_eq!(rows.lane_change.iter().filter(|&&l| l).count(), 20);
        assert!(rows.lane_change[start] && !rows.lane_change[start + 1]);
    }

    #[test]
    fn a_change_cut_by_the_end_is_not_completed() {
        let changes = events(&rows(|t| step(t, 5.0), 7.6));
        assert_eq!(changes.len(), 1);
        assert!(!changes[0].completed);
    }
}
