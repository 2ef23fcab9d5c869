//! Writes ten seconds of driving as a rig would, looks into the file and reads it back.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use maveric_domain::{
    Condition, DriveId, DriveMeta, DrivenBy, EgoTrack, ParticipantId, Recording, Road, Study,
};
use maveric_ingest::{IngestSettings, inspect, read_log, write_mcap};
use std::{error::Error, fs::File};

fn main() -> Result<(), Box<dyn Error>> {
    let time_s: Vec<f64> = (0..200).map(|i| f64::from(i) / 20.0).collect();
    let rows = time_s.len();
    let ego = EgoTrack {
        length_m: 4.7,
        x_m: time_s.iter().map(|t| 25.0 * t).collect(),
        y_m: vec![0.0; rows],
        speed_mps: vec![25.0; rows],
    };
    let recording = Recording::new(Road::PAPER, 20.0, time_s, vec![0; rows], ego, vec![])?;
    let meta = DriveMeta {
        drive: DriveId::new("P01-own")?,
        participant: ParticipantId::new("P01")?,
        study: Study::One,
        condition: Condition::Own,
        driven_by: DrivenBy::Synthetic,
    };
    let path = std::env::temp_dir().join(format!("maveric-{}.mcap", std::process::id()));
    write_mcap(&recording, &meta, File::create(&path)?)?;
    println!("{}", inspect(&path)?.would_ingest);
    for drive in read_log(&path, &IngestSettings::default())? {
        let rows = drive.recording.rows();
        println!(
            "{}: {rows} rows, {} warnings",
            drive.meta.drive,
            drive.warnings.len()
        );
    }
    std::fs::remove_file(&path)?;
    Ok(())
}
