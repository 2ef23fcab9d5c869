//! Whose collision it was: which assumption of the safety rule had broken.

use crate::{control::safe_distance_m, road::CentreLine, scenario::ControllerSettings};
use maveric_domain::{ObjectTrack, Recording, VehicleId};
use serde::{Deserialize, Serialize};

/// One episode in which ego and another vehicle overlapped.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Collision {
    /// Time since the start of the drive at which they touched, in s.
    pub time_s: f64,
    /// The other vehicle.
    pub vehicle: VehicleId,
    /// What had gone wrong.
    pub cause: CollisionCause,
}

/// Which assumption of the safety rule had broken before a collision.
///
/// Told from the recording alone. The conflict begins when the two come to overlap sideways, within the lateral margin; from then on the
/// one behind answers for the distance, and whoever moved sideways into it for the distance at that moment.
///
/// # Source
/// Shalev-Shwartz, Shammah and Shashua 2017, section 3: who has to respond, and to what.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CollisionCause {
    /// None: the rule's assumptions held and ego should have avoided it.
    AssumptionsHeld,
    /// A vehicle behind ran into ego, which had left it the safe distance or had been in its lane before it.
    HitFromBehind,
    /// The other moved into ego's way nearer than the safe distance.
    CutInside,
    /// The other moved sideways into ego beside it.
    Sideswiped,
    /// The one ahead braked harder than the rule assumes.
    BrakedHarder,
    /// The two were nearer than the safe distance when the other came into the recording.
    StartedInside,
}

/// Time over which sideways motion before a conflict is compared, in s.
const BEFORE_S: f64 = 1.0;
/// Braking may exceed the rule's by this before it counts as harder, in m/s²: rounding of sampled speeds.
const BRAKING_TOLERANCE_MPS2: f64 = 0.05;

/// Two vehicles over the rows that both have.
struct Pair<'a> {
    recording: &'a Recording,
    line: &'a CentreLine,
    track: &'a ObjectTrack,
}

impl Pair<'_> {
    fn other(&self, column: &[f64], row: usize) -> f64 {
        column[row - self.track.first_row]
    }

    fn apart_y_m(&self, row: usize) -> f64 {
        (self.other(&self.track.y_m, row) - self.recording.ego().y_m[row]).abs()
    }

    /// Centre of the other ahead of ego's centre, along its lane, in m.
    fn ahead_m(&self, row: usize) -> f64 {
        let ego_x_m = self.recording.ego().x_m[row];
        let (x_m, y_m) = (self.other(&self.track.x_m, row), self.other(&self.track.y_m, row));
        self.line.lane_x_m(ego_x_m, x_m, y_m) - ego_x_m
    }

    fn gap_m(&self, row: usize) -> f64 {
        let lengths = 0.5 * (self.track.length_m + self.recording.ego().length_m);
        (self.ahead_m(row).abs() - lengths).max(0.0)
    }

    /// How far ego and the other moved sideways in the second before `row`, in m.
    fn sideways_m(&self, row: usize) -> (f64, f64) {
        let rows = (BEFORE_S * self.recording.rate_hz()) as usize;
        let from = row.saturating_sub(rows).max(self.track.first_row);
        let ego = &self.recording.ego().y_m;
        let other = &self.track.y_m;
        ((ego[row] - ego[from]).abs(), (self.other(other, row) - self.other(other, from)).abs())
    }

    fn braking_mps2(&self, from: usize, to: usize) -> f64 {
        let speed = |row| self.other(&self.track.speed_mps, row);
        (from..to)
            .map(|row| (speed(row) - speed(row + 1)) * self.recording.rate_hz())
            .fold(0.0, f64::max)
    }
}

/// What had gone wrong before ego touched `vehicle` at `row`.
pub(crate) fn cause(
    recording: &Recording,
    line: &CentreLine,
    rule: &ControllerSettings,
    width_m: f64,
    (row, vehicle): (usize, VehicleId),
) -> CollisionCause {
    let covers = |t: &&ObjectTrack| {
        t.id == vehicle && (t.first_row..t.first_row + t.x_m.len()).contains(&row)
    };
    let Some(track) = recording.others().iter().find(covers) else {
        return CollisionCause::StartedInside;
    };
    let pair = Pair { recording, line, track };
    let in_way = |r: usize| pair.apart_y_m(r) < width_m + rule.lateral_margin_m;
    let begins = (track.first_row..=row).rev().take_while(|&r| in_way(r)).last().unwrap_or(row);
    let from_the_start = begins == track.first_row;
    let (ego_moved_m, other_moved_m) = pair.sideways_m(begins);
    let gap_m = pair.gap_m(begins);
    let ego_mps = recording.ego().speed_mps[begins];
    let other_mps = pair.other(&track.speed_mps, begins);
    let other_came = other_moved_m > ego_moved_m;
    // Beside each other no distance is safe, though the rule asks none of a slower car behind a faster one.
    let beside = gap_m <= 0.0;
    if pair.ahead_m(begins) > 0.0 {
        if !beside && gap_m >= safe_distance_m(rule, ego_mps, other_mps) {
            let limit = rule.other_braking_mps2 + BRAKING_TOLERANCE_MPS2;
            return if pair.braking_mps2(begins, row) > limit {
                CollisionCause::BrakedHarder
            } else {
                CollisionCause::AssumptionsHeld
            };
        }
        return match (from_the_start, other_came, !beside) {
            (true, ..) => CollisionCause::StartedInside,
            (_, true, true) => CollisionCause::CutInside,
            (_, true, false) => CollisionCause::Sideswiped,
            _ => CollisionCause::AssumptionsHeld,
        };
    }
    if from_the_start || other_came {
        return if beside { CollisionCause::Sideswiped } else { CollisionCause::HitFromBehind };
    }
    if !beside && gap_m >= safe_distance_m(rule, other_mps, ego_mps) {
        CollisionCause::HitFromBehind
    } else {
        CollisionCause::AssumptionsHeld
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::AT_ONCE;
    use maveric_domain::{EgoTrack, Road};

    /// A second of ego at `ego_mps` with another vehicle `gap_m` ahead, or behind where that is negative, whose speed changes by
    /// `gains_mps` a row; one of them is in the other lane before row 5.
    struct Meeting {
        gap_m: f64,
        ego_mps: f64,
        other_mps: f64,
        gains_mps: f64,
        moved: Option<Moved>,
    }

    #[derive(Clone, Copy, PartialEq)]
    enum Moved {
        Ego,
        Other,
    }

    impl Meeting {
        fn cause(&self) -> CollisionCause {
            let rows = 11;
            let y_m = |who: Moved| -> Vec<f64> {
                let away = |row: usize| if row < 5 { 3.66 } else { 0.0 };
                let moves = self.moved == Some(who);
                let at = |row| if moves { away(row) } else { 0.0 };
                (0..rows).map(at).collect()
            };
            let ego = EgoTrack {
                length_m: 5.0,
                x_m: vec![0.0; rows],
                y_m: y_m(Moved::Ego),
                speed_mps: vec![self.ego_mps; rows],
            };
            let apart_m = self.gap_m + 5.0_f64.copysign(self.gap_m);
            let gained = |row: usize| self.gains_mps * row as f64;
            let track = ObjectTrack {
                id: VehicleId(1),
                length_m: 5.0,
                first_row: 0,
                x_m: vec![apart_m; rows],
                y_m: y_m(Moved::Other),
                speed_mps: (0..rows).map(|row| self.other_mps + gained(row)).collect(),
            };
            let time_s = (0..rows).map(|row| row as f64 / 10.0).collect();
            let segment = vec![0; rows];
            let road = Road::PAPER;
            let recording = Recording::new(road, 10.0, time_s, segment, ego, vec![track]).unwrap();
            let at = (rows - 1, VehicleId(1));
            cause(&recording, &CentreLine::default(), &AT_ONCE, 1.9, at)
        }
    }

    #[test]
    fn whoever_broke_an_assumption_first_is_named() {
        use CollisionCause::{
            AssumptionsHeld, BrakedHarder, CutInside, HitFromBehind, Sideswiped, StartedInside,
        };
        // Ego at 20 m/s needs (20² - 12²) / 16 = 16 m to one at 12 m/s, and one at 28 m/s 24 m to ego.
        let of = |gap_m: f64, other_mps: f64, moved: Option<Moved>| Meeting {
            gap_m,
            ego_mps: 20.0,
            other_mps,
            gains_mps: 0.0,
            moved,
        };
        let (ego, other) = (Some(Moved::Ego), Some(Moved::Other));
        for (meeting, expected) in [
            (of(16.1, 12.0, None), AssumptionsHeld),
            (of(15.9, 12.0, None), StartedInside),
            (of(15.9, 12.0, other), CutInside),
            (of(16.1, 12.0, other), AssumptionsHeld),
            (of(15.9, 12.0, ego), AssumptionsHeld),
            // Beside each other, whoever is further on.
            (of(0.0, 30.0, other), Sideswiped),
            (of(-0.0, 12.0, other), Sideswiped),
            (of(0.0, 12.0, ego), AssumptionsHeld),
            (of(-0.0, 12.0, ego), AssumptionsHeld),
            // From behind: into the one who was there, who had left room, or who had not.
            (of(-5.0, 28.0, None), HitFromBehind),
            (of(-5.0, 28.0, other), HitFromBehind),
            (of(-24.1, 28.0, ego), HitFromBehind),
            (of(-23.9, 28.0, ego), AssumptionsHeld),
        ] {
            let (gap_m, moved) = (meeting.gap_m, meeting.moved.is_some());
            assert_eq!(meeting.cause(), expected, "{gap_m} {moved}");
        }
        let brakes = |gains_mps: f64| Meeting { gains_mps, ..of(40.0, 20.0, None) };
        // 8 m/s² are reckoned with, 8.1 are not.
        assert_eq!(brakes(-0.8).cause(), AssumptionsHeld);
        assert_eq!(brakes(-0.81).cause(), BrakedHarder);
        assert_eq!(brakes(0.81).cause(), AssumptionsHeld);
    }
}
