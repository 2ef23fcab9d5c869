//! Drives under pseudonyms: recordings that begin at 0, and tables of them where they are asked for.

use super::{
    options::{DriveTables, ExportOptions},
    pseudonym::Pseudonyms,
};
use crate::{
    atomic_write::write_recording,
    error::StudyError,
    outcome::{Watch, for_each_on},
    tables::drives::{write_drive, write_samples},
};
use maveric_domain::{Drive, DriveId, DriveMeta, Recording};
use maveric_ingest::Beside;
use std::{collections::BTreeMap, path::Path};

/// Writes `logs/`, and `drives/` where tables are asked for.
pub(super) fn write(
    out: &Path,
    drives: &[(DriveMeta, Recording)],
    names: &Pseudonyms,
    options: &ExportOptions,
    watch: Watch<'_>,
) -> Result<(), StudyError> {
    let drives = renamed(drives, names)?;
    let one = |(meta, recording): &(DriveMeta, &Recording)| {
        let moved = from_zero(recording)?;
        let log = out.join("logs").join(format!("{}.mcap", meta.drive));
        write_recording(&log, &moved, meta, &Beside::default())?;
        let Some(tables) = options.drives else {
            return Ok(());
        };
        let drive = Drive::from_recording(meta.clone(), &moved)?;
        let folder = out.join("drives");
        match tables {
            DriveTables::Csv => write_samples(&folder.join(format!("{}.csv", meta.drive)), &drive),
            DriveTables::Parquet => write_drive(&folder, &drive).map(|_| ()),
        }
    };
    for_each_on(options.jobs, &drives, watch, "drives written", one)?;
    Ok(())
}

/// The drives by pseudonym and condition, and by number where somebody has several.
fn renamed<'a>(
    drives: &'a [(DriveMeta, Recording)],
    names: &Pseudonyms,
) -> Result<Vec<(DriveMeta, &'a Recording)>, StudyError> {
    let mut numbers: BTreeMap<DriveId, usize> = BTreeMap::new();
    let rename = |(meta, recording): &'a (DriveMeta, Recording)| {
        let participant = names.pseudonym(&meta.participant);
        let mut drive = DriveId::in_condition(&participant, meta.ride())?;
        let number = numbers.entry(drive.clone()).or_default();
        *number += 1;
        if *number > 1 {
            drive = DriveId::new(format!("{drive}-{number}"))?;
        }
        let meta = DriveMeta { drive, participant, ..meta.clone() };
        Ok((meta, recording))
    };
    drives.iter().map(rename).collect()
}

/// The same recording, starting at time 0 and at position 0 along the road, to the millimetre.
fn from_zero(recording: &Recording) -> Result<Recording, StudyError> {
    let millimetres = |x: f64| (x * 1000.0).round() / 1000.0;
    let (time, ego) = (recording.time_s(), recording.ego());
    let (start, origin) = (time[0], ego.x_m[0]);
    let along = |x: &[f64]| x.iter().map(|x| millimetres(x - origin)).collect::<Vec<f64>>();
    let rounded = |y: &[f64]| y.iter().map(|y| millimetres(*y)).collect::<Vec<f64>>();
    let mut moved_ego = ego.clone();
    (moved_ego.x_m, moved_ego.y_m) = (along(&ego.x_m), rounded(&ego.y_m));
    moved_ego.speed_mps = rounded(&ego.speed_mps);
    let others = recording.others().iter().map(|track| {
        let mut moved = track.clone();
        (moved.x_m, moved.y_m) = (along(&track.x_m), rounded(&track.y_m));
        moved.speed_mps = rounded(&track.speed_mps);
        moved
    });
    let moved = Recording::new(
        *recording.road(),
        recording.rate_hz(),
        time.iter().map(|t| t - start).collect(),
        recording.segment().to_vec(),
        moved_ego,
        others.collect(),
    )?;
    let moved = moved.seen_by(recording.sees());
    Ok(if recording.has_lateral() { moved } else { moved.without_lateral() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::Road;
    use maveric_domain::recording::EgoTrack;

    #[test]
    fn what_a_rig_does_not_see_it_does_not_see_when_it_is_given_away() {
        let ego = EgoTrack {
            x_m: vec![100.0, 101.0001],
            y_m: vec![0.0, 0.0],
            speed_mps: vec![20.0, 20.0],
            length_m: 4.5,
        };
        let road = Road::PAPER;
        let new = |ego| Recording::new(road, 20.0, vec![7.0, 7.05], vec![0, 0], ego, Vec::new());
        let seen = new(ego.clone()).unwrap();
        assert!(from_zero(&seen).unwrap().has_lateral());
        let moved = from_zero(&new(ego).unwrap().without_lateral()).unwrap();
        assert!(!moved.has_lateral());
        assert_eq!((moved.ego().x_m[1], moved.time_s()[0]), (1.0, 0.0));
    }
}
