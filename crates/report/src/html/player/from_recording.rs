//! A drive to watch from a recording.

use super::drive::{CentreLine, ChangeSpan, InterventionSpan, PlayerDrive, Track};
use maveric_domain::{ConditionId, Drive, Recording};

/// Width that vehicles are drawn with, in m: recordings do not say it.
const WIDTH_M: f64 = 1.9;

/// What a recording does not say of itself.
#[derive(Debug, Clone, PartialEq)]
pub struct PlayerMeta {
    /// What the row is called.
    pub label: String,
    /// Who drove, in a word or two.
    pub note: String,
    /// Whose style.
    pub condition: ConditionId,
    /// When the safety layer stepped in, if that is known.
    pub interventions: Option<Vec<InterventionSpan>>,
    /// Where the road lies, if it is not straight.
    pub centre_line: Option<CentreLine>,
}

impl PlayerDrive {
    /// Takes everybody's tracks from a recording, and gap and lane changes from the drive made of it.
    ///
    /// Of another recording's drive [`super::player`] complains: its columns differ in length.
    pub fn from_recording(recording: &Recording, drive: &Drive, meta: PlayerMeta) -> Self {
        let rows = drive.rows();
        let ego = recording.ego();
        let time = |row: usize| {
            let last = rows.time_s.last().copied().unwrap_or(0.0);
            rows.time_s.get(row).copied().unwrap_or(last)
        };
        let change = |c: maveric_domain::drive::LaneChange| ChangeSpan {
            start_s: time(c.start),
            end_s: time(c.end),
            direction: c.direction,
        };
        let present = rows.lead_present.iter();
        Self {
            label: meta.label,
            note: meta.note,
            condition: meta.condition,
            lanes: recording.road().lanes,
            lane_width_m: recording.road().lane_width_m,
            centre_line: meta.centre_line,
            time_s: recording.time_s().to_vec(),
            segment: recording.segment().to_vec(),
            ego: Track {
                id: 0,
                length_m: ego.length_m,
                width_m: WIDTH_M,
                first_row: 0,
                x_m: ego.x_m.clone(),
                y_m: ego.y_m.clone(),
            },
            speed_mps: ego.speed_mps.clone(),
            gap_m: present
                .zip(&rows.lead_dx_m)
                .map(|(present, dx)| present.then_some(*dx))
                .collect(),
            reference: rows.lead_id.clone(),
            others: recording
                .others()
                .iter()
                .map(|track| Track {
                    id: track.id.0,
                    length_m: track.length_m,
                    width_m: WIDTH_M,
                    first_row: track.first_row,
                    x_m: track.x_m.clone(),
                    y_m: track.y_m.clone(),
                })
                .collect(),
            lane_changes: drive.lane_changes().into_iter().map(change).collect(),
            interventions: meta.interventions,
        }
    }
}
