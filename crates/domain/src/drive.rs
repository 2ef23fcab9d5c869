//! A drive: the signals of the method, one row a sample.

pub mod following;
pub mod lane_change;
pub mod reference_vehicle;

use crate::{
    ConditionId,
    error::DomainError,
    ids::{DriveId, ParticipantId},
    occasion::{Occasion, Ride, first, is_first},
    recording::Recording,
    scene::{Road, Scene, Situation, bumper_distance_m},
    sees::Sees,
};
pub use lane_change::{Direction, LaneChange};
pub use reference_vehicle::ReferenceTracker;
use serde::{Deserialize, Serialize};
use std::{num::NonZeroU32, str::FromStr};

/// Who or what drove.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DrivenBy {
    /// A person.
    Human,
    /// A script in a person's place, at the same wheel and pedals.
    Scripted,
    /// A driver model standing in for a person.
    Synthetic,
    /// The learned model through its controllers.
    Automated,
}

impl DrivenBy {
    /// Lower-case word used in files.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Human => "human",
            Self::Scripted => "scripted",
            Self::Synthetic => "synthetic",
            Self::Automated => "automated",
        }
    }
}

impl FromStr for DrivenBy {
    type Err = DomainError;
    fn from_str(text: &str) -> Result<Self, DomainError> {
        [
            Self::Human,
            Self::Scripted,
            Self::Synthetic,
            Self::Automated,
        ]
        .into_iter()
        .find(|d| d.as_str() == text)
        .ok_or_else(|| DomainError::UnknownWord {
            kind: "driver kind",
            found: text.to_owned(),
            expected: "human, scripted, synthetic, automated",
        })
    }
}

/// Whose drive it is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DriveMeta {
    /// Unique in a study.
    pub drive: DriveId,
    /// The participant whose style it shows.
    pub participant: ParticipantId,
    /// The condition, the baseline or the role: a label of the study's design.
    pub condition: ConditionId,
    /// Who or what drove.
    pub driven_by: DrivenBy,
    /// In which session.
    #[serde(default = "first", skip_serializing_if = "is_first")]
    pub session: NonZeroU32,
    /// Which drive of the condition within the session.
    #[serde(default = "first", skip_serializing_if = "is_first")]
    pub trial: NonZeroU32,
}

impl DriveMeta {
    /// Whose a drive is, the first of its condition.
    pub fn new(
        drive: DriveId,
        participant: ParticipantId,
        condition: ConditionId,
        driven_by: DrivenBy,
    ) -> Self {
        Self {
            drive,
            participant,
            condition,
            driven_by,
            session: first(),
            trial: first(),
        }
    }

    /// The same, of another session or trial.
    #[must_use]
    pub fn on(self, Occasion { session, trial }: Occasion) -> Self {
        Self {
            session,
            trial,
            ..self
        }
    }

    /// Which of several drives of the condition it is.
    pub fn occasion(&self) -> Occasion {
        Occasion {
            session: self.session,
            trial: self.trial,
        }
    }

    /// The condition, and which of several drives in it.
    pub fn ride(&self) -> Ride {
        Ride {
            condition: self.condition,
            occasion: self.occasion(),
        }
    }

    /// The same of ids as texts.
    ///
    /// # Errors
    /// [`DomainError::BadId`] or [`DomainError::BadCondition`] for a text that is none.
    ///
    /// # Example
    /// ```
    /// # use maveric_domain::{DriveMeta, DrivenBy};
    /// let meta = DriveMeta::named("P01-own", "P01", "own", DrivenBy::Human)?;
    /// assert_eq!(meta.participant.as_str(), "P01");
    /// # Ok::<(), maveric_domain::DomainError>(())
    /// ```
    pub fn named(
        drive: impl Into<String>,
        participant: impl Into<String>,
        condition: &str,
        driven_by: DrivenBy,
    ) -> Result<Self, DomainError> {
        Ok(Self::new(
            DriveId::new(drive)?,
            ParticipantId::new(participant)?,
            condition.parse()?,
            driven_by,
        ))
    }
}

/// The signals, column by column; every column has shape `(n,)`.
///
/// # Source
/// Method section 2, names to the letter.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Rows {
    /// Time since the start, in s.
    pub time_s: Vec<f64>,
    /// Rises by one after each hole too long to bridge.
    pub segment: Vec<u32>,
    /// Ego's position along the road, in m.
    pub ego_x_m: Vec<f64>,
    /// Ego's lateral position, in m.
    pub ego_y_m: Vec<f64>,
    /// v^(ev), in m/s.
    pub ego_speed_mps: Vec<f64>,
    /// Ego's lane, 0 the right (slow) one.
    pub lane: Vec<u8>,
    /// Whether there is a reference vehicle; where not, the lead columns hold free-road values.
    pub lead_present: Vec<bool>,
    /// Number of the reference vehicle within the recording.
    pub lead_id: Vec<Option<u32>>,
    /// d^(x), in m: a signed bumper-to-bumper distance.
    pub lead_dx_m: Vec<f64>,
    /// d^(y), in m.
    pub lead_dy_m: Vec<f64>,
    /// v^(lv), in m/s.
    pub lead_speed_mps: Vec<f64>,
    /// l^(ev): whether a lane change is being started (the second that ends at its start).
    pub lane_change: Vec<bool>,
    /// +1 while changing to the left, -1 to the right, 0 while keeping lane.
    pub changing: Vec<i8>,
    /// Whether the last row of a change completes it (only the row before its end is true).
    pub change_completes: Vec<bool>,
    /// Whether ego follows the reference vehicle; `following_distance_m` is `lead_dx_m` there.
    pub following: Vec<bool>,
    /// Gap to the vehicle behind in the lane to the left, in m; none within 200 m, or no such lane.
    pub gap_behind_left_m: Vec<Option<f64>>,
    /// Gap to the vehicle behind in the lane to the right, in m.
    pub gap_behind_right_m: Vec<Option<f64>>,
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
            rows.gap_behind_left_m
                .push(gap_behind(&scene, &road, lane.checked_add(1)));
            rows.gap_behind_right_m
                .push(gap_behind(&scene, &road, lane.checked_sub(1)));
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
        if n < 2 {
            return Err(DomainError::TooShort {
                what: "drive",
                found: n,
                expected: 2,
            });
        }
        let lengths = [
            ("segment", rows.segment.len()),
            ("ego_x_m", rows.ego_x_m.len()),
            ("ego_y_m", rows.ego_y_m.len()),
            ("ego_speed_mps", rows.ego_speed_mps.len()),
            ("lane", rows.lane.len()),
            ("lead_present", rows.lead_present.len()),
            ("lead_id", rows.lead_id.len()),
            ("lead_dx_m", rows.lead_dx_m.len()),
            ("lead_dy_m", rows.lead_dy_m.len()),
            ("lead_speed_mps", rows.lead_speed_mps.len()),
            ("lane_change", rows.lane_change.len()),
            ("changing", rows.changing.len()),
            ("change_completes", rows.change_completes.len()),
            ("following", rows.following.len()),
            ("gap_behind_left_m", rows.gap_behind_left_m.len()),
            ("gap_behind_right_m", rows.gap_behind_right_m.len()),
        ];
        if let Some(&(column, found)) = lengths.iter().find(|(_, found)| *found != n) {
            return Err(DomainError::LengthMismatch {
                column,
                found,
                expected: n,
            });
        }
        let numbers = [
            ("time_s", &rows.time_s),
            ("ego_x_m", &rows.ego_x_m),
            ("ego_y_m", &rows.ego_y_m),
            ("ego_speed_mps", &rows.ego_speed_mps),
            ("lead_dx_m", &rows.lead_dx_m),
            ("lead_dy_m", &rows.lead_dy_m),
            ("lead_speed_mps", &rows.lead_speed_mps),
        ];
        for (column, values) in numbers {
            if let Some(row) = values.iter().position(|v| !v.is_finite()) {
                return Err(DomainError::NotFinite {
                    column,
                    row,
                    found: values[row],
                });
            }
        }
        if !(rate_hz.is_finite() && rate_hz > 0.0) {
            return Err(DomainError::OutOfRange {
                name: "rate_hz",
                found: rate_hz,
                expected: "a finite number above 0",
            });
        }
        Ok(Self {
            meta,
            road,
            rate_hz,
            rows,
            lateral: true,
            sees: Sees::ALL,
        })
    }

    /// The same, made from a recording [without lateral positions](Recording::without_lateral).
    #[must_use]
    pub fn without_lateral(self) -> Self {
        Self {
            lateral: false,
            ..self
        }
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
        if self.sees.lanes {
            lane_change::events(&self.rows)
        } else {
            Vec::new()
        }
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
        if end < start + 2 {
            return Err(DomainError::TooShort {
                what: "drive",
                found: end.saturating_sub(start),
                expected: 2,
            });
        }
        let r = &self.rows;
        let range = start..end;
        let rows = Rows {
            time_s: r.time_s[range.clone()].to_vec(),
            segment: r.segment[range.clone()].to_vec(),
            ego_x_m: r.ego_x_m[range.clone()].to_vec(),
            ego_y_m: r.ego_y_m[range.clone()].to_vec(),
            ego_speed_mps: r.ego_speed_mps[range.clone()].to_vec(),
            lane: r.lane[range.clone()].to_vec(),
            lead_present: r.lead_present[range.clone()].to_vec(),
            lead_id: r.lead_id[range.clone()].to_vec(),
            lead_dx_m: r.lead_dx_m[range.clone()].to_vec(),
            lead_dy_m: r.lead_dy_m[range.clone()].to_vec(),
            lead_speed_mps: r.lead_speed_mps[range.clone()].to_vec(),
            lane_change: r.lane_change[range.clone()].to_vec(),
            changing: r.changing[range.clone()].to_vec(),
            change_completes: r.change_completes[range.clone()].to_vec(),
            following: r.following[range.clone()].to_vec(),
            gap_behind_left_m: r.gap_behind_left_m[range.clone()].to_vec(),
            gap_behind_right_m: r.gap_behind_right_m[range].to_vec(),
        };
        Ok(Self {
            meta: self.meta.clone(),
            road: self.road,
            rate_hz: self.rate_hz,
            rows,
            lateral: self.lateral,
            sees: self.sees,
        })
    }
}
