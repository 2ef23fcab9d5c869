//! Where ego is across the road: its lane, and its place in it.

use super::{
    super::{
        lane::{Lanes, beyond_lane, is_beyond},
        open::Kind,
    },
    rows::Files,
};
use crate::{
    error::IngestError,
    lane_centres::WITHIN_LANE,
    mapping::{LaneChangesSignal, LaneSignal, RoadMapping, Side, TableMapping},
    quality::{Warning, WarningKind, report},
};
use maveric_domain::Road;
use std::path::Path;

/// Longest time over which two places across the road are joined by a straight line, in s. While ego changes lanes a camera loses
/// the markings for a second or three.
const JOINED_S: f64 = 4.0;
/// Half the time that a lane change takes of which only the moment is known, in s.
const HALF_CHANGE_S: f64 = 2.0;
/// Time between the places that stand in where none was seen, in s.
const STEP_S: f64 = 0.5;

/// A lane change: when ego crossed the marking, and by how many lanes to the left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Change {
    pub(super) stamp_ns: i64,
    pub(super) to_left: i64,
}

/// A place in the lane: when, and how far left of its centre, in m.
type Offset = (i64, f64);

/// Where ego is across the road at any time.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Place {
    /// From when on ego is in which lane, 0 the right one.
    lanes: Vec<(i64, i64)>,
    /// Lateral positions in the order of time: between two the way is straight.
    knots: Vec<Offset>,
    /// When the lanes are counted anew: the changes before and behind do not fit one road.
    pub(super) anew: Vec<i64>,
    width_m: f64,
}

/// What a drive's files say of ego's place.
#[derive(Debug, Default)]
pub(super) struct Across {
    /// Changes of lane, in the order of time.
    pub(super) changes: Vec<Change>,
    /// When ego was in which lane by its number, 0 the right one.
    numbers: Vec<(i64, i64)>,
    /// Places in the lane; none where no signal says them.
    offsets: Option<Vec<Offset>>,
    /// Times at which there is a place.
    stamps: Vec<i64>,
}

impl Across {
    /// Takes in the signal of the lane, on this road.
    pub(super) fn lane(
        &mut self,
        files: &mut Files<'_>,
        signal: &LaneSignal,
        mapping: &TableMapping,
        road: &RoadMapping,
        warnings: &mut Vec<Warning>,
    ) -> Result<(), IngestError> {
        let columns = [&signal.number, &signal.offset].into_iter().flatten();
        let columns: Vec<(&str, Kind)> = columns.map(|c| (c.as_str(), Kind::Number)).collect();
        let rows = files.rows(&signal.file, &signal.time, &columns, signal.only.as_ref())?;
        rows.report(warnings);
        if let Some(name) = &signal.number {
            let numbers = rows.numbers(name, &signal.missing, 1.0)?;
            let (mut beside, mut last) = (0, None);
            let numbering = Lanes::new(mapping, road, None);
            for (&stamp_ns, number) in rows.stamp_ns.iter().zip(numbers) {
                let Some(number) = number else { continue };
                let lane = numbering.counted_from_right(number);
                let on_road = lane.clamp(0, i64::from(road.lanes) - 1);
                beside += usize::from(lane != on_road);
                if let Some(to_left) = last.map(|last| on_road - last).filter(|d| *d != 0) {
                    self.changes.push(Change { stamp_ns, to_left });
                }
                last = Some(on_road);
                self.numbers.push((stamp_ns, on_road));
            }
            let what = format!(
                "numbers of lanes lie beside the road of {} lanes: its outer lane stands in",
                road.lanes
            );
            report(warnings, &rows.path, WarningKind::Unit, beside, &what);
        }
        if let Some(name) = &signal.offset {
            let to_left = signal.offset_grows.map_or(1.0, Side::to_left);
            let to_left_m = to_left * mapping.units.length.metres();
            let offsets = rows.numbers(name, &signal.missing, to_left_m)?;
            let known = rows.stamp_ns.iter().zip(offsets);
            let mut known: Vec<Offset> = known.filter_map(|(t, o)| Some((*t, o?))).collect();
            known.dedup_by_key(|o| o.0);
            if known.is_empty() {
                let what = "no row says the place in the lane: the lane's centre stands in";
                warnings.push(Warning::new(&rows.path, WarningKind::Default, 1, what));
            }
            self.offsets = Some(known);
        }
        self.stamps = rows.stamp_ns;
        Ok(())
    }

    /// Takes in a list of lane changes; an empty file is a list of none.
    ///
    /// # Errors
    /// As [`Files::rows`]; [`IngestError::BadCell`] for a direction that is neither.
    pub(super) fn listed(
        &mut self,
        files: &mut Files<'_>,
        signal: &LaneChangesSignal,
        warnings: &mut Vec<Warning>,
    ) -> Result<(), IngestError> {
        let path = files.path(&signal.file);
        let bytes = std::fs::metadata(&path).map_err(|e| IngestError::io(&path, e))?;
        if bytes.len() == 0 {
            return Ok(());
        }
        let columns = [(signal.direction.as_str(), Kind::Word)];
        let rows = files.rows(&signal.file, &signal.time, &columns, None)?;
        rows.report(warnings);
        let words = rows.table.words(&signal.direction)?;
        for (nth, &stamp_ns) in rows.stamp_ns.iter().enumerate() {
            let word = words[rows.rows[nth]].clone().unwrap_or_default();
            let to_left = match (signal.left.contains(&word), signal.right.contains(&word)) {
                (true, _) => 1,
                (_, true) => -1,
                _ => {
                    let known = [signal.left.as_slice(), &signal.right]
                        .concat()
                        .join("`, `");
                    let expected = format!("one of `{known}`, as the mapping says");
                    return Err(rows.bad_cell(nth, &signal.direction, word, &expected));
                }
            };
            self.changes.push(Change { stamp_ns, to_left });
        }
        Ok(())
    }

    /// Where ego is at any time from `first_ns` to `last_ns`, on a road of this kind; `thought` is where its lane was guessed.
    pub(super) fn place(
        &self,
        log: &Path,
        road: &Road,
        thought: &[(i64, i64)],
        (first_ns, last_ns): (i64, i64),
        warnings: &mut Vec<Warning>,
    ) -> Place {
        let mut place = Place {
            width_m: road.lane_width_m,
            ..Place::default()
        };
        if self.numbers.is_empty() {
            place.count(&self.changes, road.lanes, thought, first_ns);
        } else {
            place.lanes.clone_from(&self.numbers);
            place.lanes.dedup_by_key(|l| l.1);
        }
        let changes = place.anew.len();
        if changes > 0 {
            let what = format!(
                "lane changes lead beside a road of {} lanes: the lanes are counted anew, and a segment begins, midway between two of them",
                road.lanes
            );
            let since = |ns: &i64| (ns - first_ns) as f64 / 1e9;
            let spans: Vec<(f64, f64)> = place.anew.iter().map(|t| (since(t), since(t))).collect();
            warnings.push(Warning::new(log, WarningKind::Hole, changes, what).with_spans(spans));
        }
        let most_m = WITHIN_LANE * road.lane_width_m;
        let seen = self.offsets.iter().flatten();
        let seen: Vec<Offset> = seen
            .map(|&(t, o)| (t, place.centre_m(t) + o.clamp(-most_m, most_m)))
            .collect();
        let standing_in = self.standing_in(&place, &seen, (first_ns, last_ns));
        if self.offsets.as_ref().is_some_and(|o| !o.is_empty()) {
            let seconds = standing_in.len() as f64 * STEP_S;
            let what = format!(
                "no place in the lane was seen for {JOINED_S} s and more, {seconds:.0} s in all: the lane's centre stands in"
            );
            let count = standing_in.len();
            report(warnings, log, WarningKind::Default, count, &what);
        }
        let offsets = self.offsets.iter().flatten();
        let beyond = offsets.filter(|(_, m)| is_beyond(*m, road.lane_width_m));
        let (beyond, what) = (beyond.count(), beyond_lane(road.lane_width_m));
        report(warnings, log, WarningKind::Unit, beyond, &what);
        // The marking that is crossed lies between the lanes.
        let crossing = |c: &Change| {
            let middle = place.centre_m(c.stamp_ns) - 0.5 * c.to_left as f64 * place.width_m;
            (c.stamp_ns, middle)
        };
        let crossings: Vec<Offset> = self.changes.iter().map(crossing).collect();
        let mut knots = [seen, standing_in, crossings].concat();
        // Stable: of two at one time the crossing gives way to what was seen.
        knots.sort_by_key(|k| k.0);
        knots.dedup_by_key(|k| k.0);
        place.knots = knots;
        place
    }

    /// Centres of lanes where no place was seen for long, but not while ego changes lanes.
    fn standing_in(
        &self,
        place: &Place,
        seen: &[Offset],
        (first, last): (i64, i64),
    ) -> Vec<Offset> {
        let ns = |s: f64| (s * 1e9) as i64;
        let mut offsets = Vec::new();
        let ends = seen
            .iter()
            .map(|s| s.0)
            .filter(|t| (first..=last).contains(t));
        // Whole seconds around the drive, so that its ends have a place as well.
        let ends = [first - ns(JOINED_S + STEP_S)].into_iter().chain(ends);
        let ends: Vec<i64> = ends.chain([last + ns(JOINED_S + STEP_S)]).collect();
        for hole in ends.windows(2).filter(|w| w[1] - w[0] > ns(JOINED_S)) {
            let margin = ns(HALF_CHANGE_S).min((hole[1] - hole[0]) / 2);
            let mut time_ns = hole[0] + margin;
            while time_ns <= hole[1] - margin {
                let near = |c: &Change| (c.stamp_ns - time_ns).abs() < ns(HALF_CHANGE_S);
                if (first..=last).contains(&time_ns) && !self.changes.iter().any(near) {
                    offsets.push((time_ns, place.centre_m(time_ns)));
                }
                time_ns += ns(STEP_S);
            }
        }
        offsets
    }

    /// Times, in order, at which ego's place is worth a sample.
    pub(super) fn stamps(&self) -> impl Iterator<Item = i64> + '_ {
        let around = |c: &Change| {
            let half = (HALF_CHANGE_S * 1e9) as i64;
            [c.stamp_ns - half, c.stamp_ns, c.stamp_ns + half]
        };
        let changes = self.changes.iter().flat_map(around);
        self.stamps.iter().copied().chain(changes)
    }
}

impl Place {
    /// Counts the lanes along changes: as far as they fit a road of so many lanes, then anew. Of the lanes that fit, it is the one that
    /// ego was most often thought to be in, else the rightmost.
    fn count(&mut self, changes: &[Change], lanes: u8, thought: &[(i64, i64)], first_ns: i64) {
        let most = i64::from(lanes) - 1;
        let mut start = 0;
        let mut from_ns = first_ns;
        while start <= changes.len() {
            // Relative to the first lane: where ego is, and how far it has been to either side.
            let (mut now, mut right, mut left) = (0, 0, 0);
            let mut end = start;
            for change in &changes[start..] {
                let next = now + change.to_left;
                let (r, l) = (right.min(next), left.max(next));
                if l - r > most && end > start {
                    break;
                }
                (now, right, left, end) = (next, r, l, end + 1);
            }
            let until_ns = match (changes.get(end), end.checked_sub(1)) {
                (Some(next), Some(last)) => {
                    changes[last].stamp_ns + (next.stamp_ns - changes[last].stamp_ns) / 2
                }
                _ => i64::MAX,
            };
            let stretch = &changes[start..end];
            let relative = |t: i64| {
                let before = stretch.iter().take_while(|c| c.stamp_ns <= t);
                before.map(|c| c.to_left).sum::<i64>()
            };
            let votes = |first: i64| {
                let within = thought
                    .iter()
                    .filter(|(t, _)| (from_ns..until_ns).contains(t));
                within
                    .filter(|(t, lane)| first + relative(*t) == *lane)
                    .count()
            };
            // Of as many votes the last is taken: the rightmost.
            let fitting = (-right..=(most - left).max(-right)).rev();
            let mut lane = fitting.max_by_key(|first| votes(*first)).unwrap_or(-right);
            self.lanes.push((from_ns, lane));
            for change in stretch {
                lane += change.to_left;
                self.lanes.push((change.stamp_ns, lane));
            }
            if end >= changes.len() {
                break;
            }
            self.anew.push(until_ns);
            (start, from_ns) = (end, until_ns);
        }
    }

    /// Ego's lane at a time, 0 the right one.
    fn lane(&self, stamp_ns: i64) -> i64 {
        let next = self.lanes.partition_point(|l| l.0 <= stamp_ns);
        let lane = self.lanes.get(next.saturating_sub(1));
        lane.map_or(0, |l| l.1)
    }

    /// Lateral position of the centre of ego's lane at a time, in m.
    pub(super) fn centre_m(&self, stamp_ns: i64) -> f64 {
        self.lane(stamp_ns) as f64 * self.width_m
    }

    /// Whether ego is in another lane at one time than it was at another before.
    pub(super) fn changes_between(&self, from_ns: i64, to_ns: i64) -> bool {
        let first = self.lanes.partition_point(|l| l.0 <= from_ns);
        self.lanes.get(first).is_some_and(|l| l.0 <= to_ns)
    }

    /// Ego's lateral position at a time, in m.
    pub(super) fn lateral_m(&self, stamp_ns: i64) -> f64 {
        let next = self.knots.partition_point(|k| k.0 <= stamp_ns);
        let (before, after) = (
            next.checked_sub(1).map(|i| self.knots[i]),
            self.knots.get(next),
        );
        match (before, after) {
            (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (stamp_ns - a.0) as f64 / (b.0 - a.0) as f64,
            (Some(a), None) => a.1,
            (None, Some(b)) => b.1,
            (None, None) => self.centre_m(stamp_ns),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const S: i64 = 1_000_000_000;

    fn road(lanes: u8) -> Road {
        Road {
            lanes,
            lane_width_m: 3.5,
            ..Road::PAPER
        }
    }

    fn changes(list: &[(i64, i64)]) -> Vec<Change> {
        let change = |&(s, to_left): &(i64, i64)| Change {
            stamp_ns: s * S,
            to_left,
        };
        list.iter().map(change).collect()
    }

    fn placed(across: &Across, lanes: u8, thought: &[(i64, i64)]) -> (Place, Vec<Warning>) {
        let mut warnings = Vec::new();
        let place = across.place(
            Path::new("d"),
            &road(lanes),
            thought,
            (0, 100 * S),
            &mut warnings,
        );
        (place, warnings)
    }

    #[test]
    fn a_listed_change_takes_four_seconds_around_its_time_and_ends_in_the_lane_beside() {
        let across = Across {
            changes: changes(&[(20, 1), (60, -1)]),
            ..Across::default()
        };
        let (place, warnings) = placed(&across, 2, &[]);
        for (s, y) in [
            (0.0, 0.0),
            (17.9, 0.0),
            (20.0, 1.75),
            (22.1, 3.5),
            (40.0, 3.5),
            (60.0, 1.75),
            (62.5, 0.0),
            (100.0, 0.0),
        ] {
            let found = place.lateral_m((s * 1e9) as i64);
            assert!((found - y).abs() < 0.11, "{found} at {s} s, expected {y}");
        }
        assert!(warnings.is_empty() && place.anew.is_empty());
    }

    #[test]
    fn the_lane_in_which_changes_start_is_the_rightmost_that_fits_or_the_one_that_was_thought() {
        let across = Across {
            changes: changes(&[(20, 1)]),
            ..Across::default()
        };
        assert_eq!(placed(&across, 3, &[]).0.lane(0), 0);
        let thought = [(10 * S, 1), (30 * S, 2), (40 * S, 1)];
        let (place, _) = placed(&across, 3, &thought);
        assert_eq!((place.lane(0), place.lane(30 * S)), (1, 2));
    }

    #[test]
    fn changes_that_fit_no_road_are_counted_anew_and_none_is_lost() {
        let across = Across {
            changes: changes(&[(10, 1), (20, 1), (40, 1), (50, -1)]),
            ..Across::default()
        };
        let (place, warnings) = placed(&across, 3, &[]);
        assert_eq!(place.anew, [30 * S]);
        let lanes: Vec<i64> = [5, 15, 25, 35, 45, 55].map(|s| place.lane(s * S)).into();
        assert_eq!(lanes, [0, 1, 2, 0, 1, 0]);
        assert_eq!((warnings.len(), warnings[0].count), (1, 1));
    }

    #[test]
    fn a_place_in_the_lane_never_makes_a_change_and_a_short_hole_is_joined() {
        let offsets = vec![(0, 0.2), (5 * S, 3.0), (8 * S, -0.2), (100 * S, 0.0)];
        let across = Across {
            offsets: Some(offsets),
            ..Across::default()
        };
        let (place, warnings) = placed(&across, 2, &[]);
        assert!(place.lateral_m(5 * S) < 1.75, "still in lane 0");
        let joined = 0.5 * (0.49 * 3.5 - 0.2);
        assert!((place.lateral_m(13 * S / 2) - joined).abs() < 1e-9);
        assert!(
            (place.lateral_m(50 * S)).abs() < 1e-9,
            "nothing seen: the centre"
        );
        assert!(warnings[0].what.contains("the lane's centre stands in"));
        // That of 3 m.
        assert_eq!((warnings.len(), warnings[1].count), (2, 1));
    }
}
