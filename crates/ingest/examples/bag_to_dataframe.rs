//! A bag to a polars data frame; the bag is the file that is named, else ten seconds of driving made here.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use maveric_domain::{Drive, DriveMeta, DrivenBy, EgoTrack, Recording, Road};
use maveric_ingest::{IngestSettings, drive_frame, read_log, write_mcap};
use std::{error::Error, fs::File, path::PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let named = std::env::args().nth(1).map(PathBuf::from);
    let temporary = named.is_none().then(a_bag).transpose()?;
    let path = named.or(temporary.clone()).unwrap_or_default();

    let log = read_log(&path, &IngestSettings::default())?.remove(0);
    let drive = Drive::from_recording(log.meta, &log.recording)?;
    let frame = drive_frame(&drive);
    println!("{} rows of {:?}", frame.height(), frame.get_column_names());
    let speeds = frame.column("ego_speed_mps")?.f64()?;
    let fastest = speeds.iter().flatten().fold(0.0, f64::max);
    println!("at most {fastest:.1} m/s");

    if let Some(temporary) = temporary {
        std::fs::remove_file(temporary)?;
    }
    Ok(())
}

fn a_bag() -> Result<PathBuf, Box<dyn Error>> {
    let time_s: Vec<f64> = (0..200).map(|i| f64::from(i) / 20.0).collect();
    let rows = time_s.len();
    let ego = EgoTrack {
        length_m: 4.7,
        x_m: time_s.iter().map(|t| 25.0 * t).collect(),
        y_m: vec![0.0; rows],
        speed_mps: vec![25.0; rows],
    };
    let recording = Recording::new(Road::PAPER, 20.0, time_s, vec![0; rows], ego, vec![])?;
    let meta = DriveMeta::named("P01-own", "P01", "own", DrivenBy::Synthetic)?;
    let path = std::env::temp_dir().join(format!("maveric-{}.mcap", std::process::id()));
    write_mcap(&recording, &meta, File::create(&path)?)?;
    Ok(path)
}
