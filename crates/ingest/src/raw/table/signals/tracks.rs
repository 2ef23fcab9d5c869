//! Tracks of a radar: which of them are vehicles, and where those are along ego's path.

use super::{
    super::{open::Kind, pair::bumper_gap_m, parts::stamps},
    path::DrivenPath,
    rows::Files,
};
use crate::{
    error::IngestError,
    mapping::{TableMapping, TracksSignal},
    quality::{Warning, WarningKind, report},
    raw::{ObjectSample, ObjectSamples, Timed as _},
};
use std::collections::BTreeMap;

/// A track number that jumps further than this between two samples is another vehicle's, in m.
const JUMP_M: f64 = 5.0;
/// A track unseen for longer than this is another vehicle's, in s.
const UNSEEN_S: f64 = 0.5;
/// Tracks shorter than this are ghosts, in s.
const SHORTEST_S: f64 = 0.5;
/// What never drives forward faster than this is a sign, a bridge or oncoming, in m/s.
const MOVING_MPS: f64 = 2.0;

/// Reads the vehicles ahead, in the frame of ego's way.
pub(super) fn read(
    files: &mut Files<'_>,
    signal: &TracksSignal,
    mapping: &TableMapping,
    driven: &DrivenPath,
    warnings: &mut Vec<Warning>,
) -> Result<ObjectSamples, IngestError> {
    let mut wanted = vec![
        (signal.time.as_str(), files.clock.kind()),
        (signal.track.as_str(), Kind::Word),
    ];
    let numbers = [&signal.forward, &signal.left, &signal.relative_speed];
    wanted.extend(numbers.map(|name| (name.as_str(), Kind::Number)));
    wanted.extend(signal.new_track.iter().map(|n| (n.as_str(), Kind::Number)));
    let (log, table) = (files.log, files.open(&signal.file, &wanted)?);
    let times = stamps(&table, &signal.time, files.clock)?;
    let (tracks, _) = table.codes(&signal.track)?;
    let length = mapping.units.length.metres();
    let speed = mapping.units.speed.metres_per_second();
    let forward = table.numbers(&signal.forward)?;
    let left = table.numbers(&signal.left)?;
    let relative = table.numbers(&signal.relative_speed)?;
    let renewed = match &signal.new_track {
        Some(name) => table.numbers(name)?,
        None => vec![0.0; times.len()],
    };
    let lead_length_m = mapping.lead_length_m;
    // From ego's centre to its front bumper, and from the vehicle's rear bumper to its centre.
    let (front_m, back_m) = (0.5 * mapping.ego_length_m, 0.5 * lead_length_m);

    let mut numbering = Numbering::default();
    let mut seen: BTreeMap<u32, Vec<ObjectSample>> = BTreeMap::new();
    let mut left_out = 0;
    let mut alone = 0;
    for row in 0..times.len() {
        let (Some(stamp_ns), Some(track)) = (times[row], tracks[row]) else {
            left_out += 1;
            continue;
        };
        let gap_m = bumper_gap_m(
            forward[row] * length,
            mapping.gap_kind,
            mapping.ego_length_m,
            lead_length_m,
        );
        let (left_m, relative_mps) = (left[row] * length, relative[row] * speed);
        if !(gap_m + left_m + relative_mps).is_finite() {
            left_out += 1;
            continue;
        }
        let id = numbering.id(track, stamp_ns, gap_m, renewed[row] > 0.0);
        let Some(placed) = driven.place(stamp_ns, front_m + gap_m, left_m) else {
            alone += 1;
            continue;
        };
        seen.entry(id).or_default().push(ObjectSample {
            stamp_ns,
            log_ns: stamp_ns,
            nth: 0,
            id,
            x_m: placed.way_m + back_m,
            y_m: placed.left_m,
            speed_mps: placed.ego_speed_mps + relative_mps,
            length_m: lead_length_m,
        });
    }
    let (mut ghosts, mut standing) = (0, 0);
    seen.retain(|_, samples| {
        let from = samples.iter().map(|s| s.stamp_ns).min().unwrap_or_default();
        let to = samples.iter().map(|s| s.stamp_ns).max().unwrap_or_default();
        let ghost = to.saturating_sub(from) as f64 / 1e9 < SHORTEST_S;
        let moves = samples.iter().any(|s| s.speed_mps > MOVING_MPS);
        ghosts += usize::from(ghost);
        standing += usize::from(!ghost && !moves);
        !ghost && moves
    });
    let missing = WarningKind::MissingValue;
    let what = "rows of tracks without time, number or position are left out";
    report(warnings, log, missing, left_out, what);
    let what = "rows of tracks before ego's first speed or after its last are left out";
    report(warnings, log, WarningKind::NoOverlap, alone, what);
    let choice = WarningKind::Choice;
    let what = format!("tracks shorter than {SHORTEST_S} s are left out as ghosts");
    report(warnings, log, choice, ghosts, &what);
    let what =
        "tracks that never move along the road are left out: signs, bridges, oncoming traffic";
    report(warnings, log, choice, standing, what);
    let mut objects: ObjectSamples = seen.into_values().flatten().collect();
    // As a reader of one file would give them: in the order of time.
    objects.sort();
    let what =
        format!("a radar tells no lengths: vehicles ahead are taken to be {lead_length_m} m long");
    let some = usize::from(!objects.is_empty());
    report(warnings, log, WarningKind::Default, some, &what);
    Ok(objects)
}

/// Numbers of vehicles from numbers of tracks, which are used again and again.
#[derive(Debug, Default)]
struct Numbering {
    /// By track: time and distance last seen, and the vehicle's number.
    last: BTreeMap<u32, (i64, f64, u32)>,
    vehicles: u32,
}

impl Numbering {
    fn id(&mut self, track: u32, stamp_ns: i64, gap_m: f64, renewed: bool) -> u32 {
        let same = self.last.get(&track).filter(|(then_ns, then_m, _)| {
            let unseen_s = stamp_ns.saturating_sub(*then_ns) as f64 / 1e9;
            !renewed && unseen_s <= UNSEEN_S && (gap_m - then_m).abs() <= JUMP_M
        });
        let id = if let Some((_, _, id)) = same {
            *id
        } else {
            self.vehicles += 1;
            self.vehicles
        };
        self.last.insert(track, (stamp_ns, gap_m, id));
        id
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_track_number_is_another_vehicle_after_a_flag_a_jump_or_a_pause() {
        let mut numbering = Numbering::default();
        let s = 1_000_000_000;
        assert_eq!(numbering.id(7, 0, 30.0, false), 1);
        assert_eq!(numbering.id(7, s / 20, 30.2, false), 1);
        assert_eq!(numbering.id(7, s / 10, 30.4, true), 2);
        assert_eq!(numbering.id(7, s / 5, 60.0, false), 3);
        assert_eq!(numbering.id(7, 2 * s, 60.0, false), 4);
        assert_eq!(numbering.id(8, 2 * s, 60.0, false), 5);
    }
}
