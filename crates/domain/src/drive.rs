//! A drive: the signals of the method, one row a sample.

pub mod following;
pub mod lane_change;
mod meta;
pub mod reference_vehicle;

use crate::{
    error::{DomainError, as_long, at_least, finite, positive},
    recording::Recording,
    scene::{Road, Scene, Situation, bumper_distance_m},
    sees::Sees,
};
pub use lane_change::{Direction, LaneChange};
pub use meta::{DriveMeta, DrivenBy};
pub use reference_vehicle::ReferenceTracker;
use std::ops::Range;

/// Declares the columns of a drive, a line each, and what is done with all of them.
macro_rules! rows {
    ($(#[$meta:meta])* pub struct $rows:ident { $( $(#[$doc:meta])* $column:ident: $type:ty, )* }) => {
        $(#[$meta])*
        pub struct $rows {
            $( $(#[$doc])* pub $column: Vec<$type>, )*
        }

        impl $rows {
            fn lengths(&self) -> impl Iterator<Item = (&'static str, usize)> {
                [$((stringify!($column), self.$column.len())),*].into_iter()
            }

            fn slice(&self, range: Range<usize>) -> Self {
                Self { $($column: self.$column[range.clone()].to_vec()),* }
            }
        }
    };
}

rows! {
    /// The signals, column by column; every column has shape `(n,)`.
    ///
    /// # Source
    /// Method section 2, names to the letter.
    #[derive(Debug, Clone, PartialEq, Default)]
    pub struct Rows {
        /// Time since the start, in s.
        time_s: f64,
        /// Rises by one after each hole too long to bridge.
        segment: u32,
        /// Ego's position along the road, in m.
        ego_x_m: f64,
        /// Ego's lateral position, in m.
        ego_y_m: f64,
        /// v^(ev), in m/s.
        ego_speed_mps: f64,
        /// Ego's lane, 0 the right (slow) one.
        lane: u8,
        /// Whether there is a reference vehicle; where not, the lead columns hold free-road values.
        lead_present: bool,
        /// Number of the reference vehicle within the recording.
        lead_id: Option<u32>,
        /// d^(x), in m: a signed bumper-to-bumper distance.
        lead_dx_m: f64,
        /// d^(y), in m.
        lead_dy_m: f64,
        /// v^(lv), in m/s.
        lead_speed_mps: f64,
        /// l^(ev): whether a lane change is being started (the second that ends at its start).
        lane_change: bool,
        /// +1 while changing to the left, -1 to the right, 0 while keeping lane.
        changing: i8,
        /// Whether the last row of a change completes it (only the row before its end is true).
        change_completes: bool,
        /// Whether ego follows the reference vehicle; `following_distance_m` is `lead_dx_m` there.
        following: bool,
        /// Gap to the vehicle behind in the lane to the left, in m; none within 200 m, or no such lane.
        gap_behind_left_m: Option<f64>,
        /// Gap to the vehicle behind in the lane to the right, in m.
        gap_behind_right_m: Option<f64>,
    }
}

/// Ego speed up to which a gap is no time gap, in m/s: at standstill there is none, not a large one.
pub const STANDSTILL_MPS: f64 = 0.5;

impl Rows {
    /// Whether the reference vehicle is ahead in ego's own lane at `row`: further aside than half a lane is another.
    fn lead_ahead(&self, row: usize, road: &Road) -> bool {
        self.lead_present[row]
            && self.lead_dx_m[row] > 0.0
            && self.lead_dy_m[row].abs() < 0.5 * road.lane_width_m
    }

    /// How fast a column changes at each row, in its unit a second: a central difference over `half_span_s` on both sides, of rows
    /// sampled `rate_hz` times a second, that never spans two segments.
    ///
    /// # Panics
    /// If the column is not of these rows.
    pub fn slopes(&self, column: &[f64], half_span_s: f64, rate_hz: f64) -> Vec<f64> {
        let n = self.time_s.len();
        let half = ((half_span_s * rate_hz).round() as usize).max(1);
        let slope = |row: usize| {
            let same = |i: &usize| self.segment[*i] == self.segment[row];
            let low = (row.saturating_sub(half)..=row).find(same).unwrap_or(row);
            let high = (row..=(row + half).min(n - 1)).rfind(same).unwrap_or(row);
            let span = self.time_s[high] - self.time_s[low];
            if span > 0.0 { (column[high] - column[low]) / span } else { 0.0 }
        };
        (0..n).map(slope).collect()
    }
}

/// A drive: whose it is and what happened, evenly sampled.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    meta: DriveMeta,
    road: Road,
    rate_hz: f64,
    rows: Rows,
    lateral: bool,
    sees: Sees,
}

/// Distance beyond which a vehicle behind in another lane does not count, in m.
const BEHIND_LIMIT_M: f64 = 200.0;

fn gap_behind(scene: &Scene, road: &Road, lane: Option<u8>) -> Option<f64> {
    let lane = lane.filter(|&l| l < road.lanes)?;
    let gaps = scene
        .vehicles
        .iter()
        .filter(|v| road.lane_at(v.y_m) == Some(lane) && v.x_m <= scene.ego.x_m);
    gaps.map(|v| -bumper_distance_m(&scene.ego, v))
        .filter(|&g| g <= BEHIND_LIMIT_M)
        .min_by(f64::total_cmp)
        .map(|g| g.max(0.0))
}

impl Drive {
    /// Finds reference vehicle, lane changes and following rows in a recording.
    ///
    /// # Errors
    /// None today for a [`Recording`] that exists; the signature leaves room for rules that refuse one.
    ///
    /// # Source
    /// Method section 2; the tracker's remedies are from calibration section 4.
    pub fn from_recording(meta: DriveMeta, recording: &Recording) -> Result<Self, DomainError> {
        let road = *recording.road();
        let ego = recording.ego();
        let mut rows = Rows {
            time_s: recording.time_s().to_vec(),
            segment: recording.segment().to_vec(),
            ego_x_m: ego.x_m.clone(),
            ego_y_m: ego.y_m.clone(),
            ego_speed_mps: ego.speed_mps.clone(),
            lane: ego.y_m.iter().map(|&y| road.nearest_lane(y)).collect(),
            ..Rows::default()
        };
        let mut tracker = ReferenceTracker::new(road);
        for (row, scene) in recording.scenes().enumerate() {
            if row > 0 && rows.segment[row] != rows.segment[row - 1] {
                tracker = ReferenceTracker::new(road);
            }
            let reference = tracker.observe(&scene);
            rows.lead_present.push(reference.vehicle.is_some());
            rows.lead_id.push(reference.vehicle.map(|v| v.0));
            rows.lead_dx_m.push(reference.dx_m);
            rows.lead_dy_m.push(reference.dy_m);
            rows.lead_speed_mps.push(reference.speed_mps);
            let lane = rows.lane[row];
            rows.gap_behind_left_m.push(gap_behind(&scene, &road, lane.checked_add(1)));
            rows.gap_behind_right_m.push(gap_behind(&scene, &road, lane.checked_sub(1)));
        }
        lane_change::label(&mut rows, &road, recording.rate_hz());
        following::label(&mut rows, &road);
        Ok(Self {
            meta,
            road,
            rate_hz: recording.rate_hz(),
            rows,
            lateral: recording.has_lateral(),
            sees: recording.sees(),
        })
    }

    /// Takes rows that [`Drive::from_recording`] made earlier, as read back from a file.
    ///
    /// # Errors
    /// [`DomainError::TooShort`], [`DomainError::LengthMismatch`] or [`DomainError::NotFinite`] where the
    /// columns cannot have come from there.
    pub fn from_rows(
        meta: DriveMeta,
        road: Road,
        rate_hz: f64,
        rows: Rows,
    ) -> Result<Self, DomainError> {
        let n = rows.time_s.len();
        at_least("drive", n, 2)?;
        for (column, found) in rows.lengths() {
            as_long(column, found, n)?;
        }
        for (column, values) in [
            ("time_s", &rows.time_s),
            ("ego_x_m", &rows.ego_x_m),
            ("ego_y_m", &rows.ego_y_m),
            ("ego_speed_mps", &rows.ego_speed_mps),
            ("lead_dx_m", &rows.lead_dx_m),
            ("lead_dy_m", &rows.lead_dy_m),
            ("lead_speed_mps", &rows.lead_speed_mps),
        ] {
            finite(column, values)?;
        }
        positive("rate_hz", rate_hz)?;
        Ok(Self { meta, road, rate_hz, rows, lateral: true, sees: Sees::ALL })
    }

    /// The same, made from a recording [without lateral positions](Recording::without_lateral).
    #[must_use]
    pub fn without_lateral(self) -> Self {
        Self { lateral: false, ..self }
    }

    /// Whether it is known who is beside ego and who ahead: without, nothing can be said of passing.
    pub fn has_lateral(&self) -> bool {
        self.lateral
    }

    /// The same, by a rig that sees only this.
    #[must_use]
    pub fn seen_by(self, sees: Sees) -> Self {
        Self { sees, ..self }
    }

    /// What the rig sees: what it does not see cannot be read of the drive.
    pub fn sees(&self) -> Sees {
        self.sees
    }

    /// Whose drive it is.
    pub fn meta(&self) -> &DriveMeta {
        &self.meta
    }

    /// Its lanes, their width and the posted speed.
    pub fn road(&self) -> &Road {
        &self.road
    }

    /// Samples a second.
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Number of rows, n.
    pub fn len(&self) -> usize {
        self.rows.time_s.len()
    }

    /// Whether there are no rows: never, by construction.
    pub fn is_empty(&self) -> bool {
        self.rows.time_s.is_empty()
    }

    /// The signals.
    pub fn rows(&self) -> &Rows {
        &self.rows
    }

    /// The lane changes, in order; those the drive's end cut short say so. None where the rig does not see lanes.
    pub fn lane_changes(&self) -> Vec<LaneChange> {
        if self.sees.lanes { lane_change::events(&self.rows) } else { Vec::new() }
    }

    /// Whether the reference vehicle is ahead in ego's own lane at `row`.
    pub fn lead_ahead(&self, row: usize) -> bool {
        self.rows.lead_ahead(row, &self.road)
    }

    /// Gap to the reference vehicle over ego speed at `row`, in s; none up to [`STANDSTILL_MPS`].
    pub fn time_gap_s(&self, row: usize) -> Option<f64> {
        let speed = self.rows.ego_speed_mps[row];
        (speed > STANDSTILL_MPS).then(|| self.rows.lead_dx_m[row] / speed)
    }

    /// What a planner would have been told at `row`; `None` past the end.
    pub fn situation(&self, row: usize) -> Option<Situation> {
        let reference = crate::scene::Reference {
            vehicle: self.rows.lead_id.get(row)?.map(crate::ids::VehicleId),
            dx_m: self.rows.lead_dx_m[row],
            dy_m: self.rows.lead_dy_m[row],
            speed_mps: self.rows.lead_speed_mps[row],
        };
        Some(Situation {
            time_s: self.rows.time_s[row],
            ego_speed_mps: self.rows.ego_speed_mps[row],
            reference,
        })
    }

    /// The drive between two rows, `start` included, `end` not.
    ///
    /// # Errors
    /// [`DomainError::TooShort`] if fewer than two rows remain.
    pub fn slice(&self, start: usize, end: usize) -> Result<Self, DomainError> {
        let end = end.min(self.len());
        at_least("drive", end.saturating_sub(start), 2)?;
        Ok(Self { meta: self.meta.clone(), rows: self.rows.slice(start..end), ..*self })
    }
}
