//! The time from a table to its drive, beside that of polars reading the same columns.
//!
//! `cargo bench -p maveric-ingest --bench tables`: an hour of one follower at 100 Hz, 360,000 rows of 12 columns, 30 MB; and ten minutes of
//! an AV drive as a log.
#![expect(clippy::unwrap_used, reason = "a benchmark fails as tests do")]

use maveric_domain::{
    Drive, DriveMeta, DrivenBy, EgoTrack, ObjectTrack, Recording, Road, VehicleId,
};
use maveric_ingest::{IngestSettings, Mapping, Provenance, read_log, write_drive_to, write_mcap};
use polars::prelude::{CsvReadOptions, PlSmallStr, SerReader};
use std::{fmt::Write as _, io::Cursor, path::PathBuf, sync::LazyLock};

const COLUMNS: [&str; 6] = ["t", "x", "v", "gap", "lead_v", "lead_length"];

static TABLE: LazyLock<PathBuf> = LazyLock::new(|| {
    let path = std::env::temp_dir().join(format!("maveric-bench-{}.csv", std::process::id()));
    let mut text = format!("{},a,b,c,d,e,f\n", COLUMNS.join(","));
    for i in 0..360_000_u32 {
        let t = f64::from(i) / 100.0;
        let v = 25.0 + (0.01 * t).sin();
        let x = 25.0 * t - 100.0 * (0.01 * t).cos();
        let gap = 30.0 + 5.0 * (0.02 * t).cos();
        writeln!(
            text,
            "{t:.2},{x:.4},{v:.5},{gap:.4},{v:.5},4.5,{t:.3},{x:.3},{v:.3},1.25,-0.5,17"
        )
        .unwrap();
    }
    std::fs::write(&path, text).unwrap();
    path
});

fn main() {
    divan::main();
    let _ = std::fs::remove_file(&*TABLE);
}

/// Polars reads the columns that the drive is made of.
#[divan::bench(name = "polars/csv/360000", sample_count = 20)]
fn polars(bencher: divan::Bencher<'_, '_>) {
    let path = &*TABLE;
    bencher.bench(|| {
        let columns: Vec<PlSmallStr> = COLUMNS.map(PlSmallStr::from).into();
        let options = CsvReadOptions::default().with_columns(Some(columns.into()));
        let bytes = std::fs::read(path).unwrap();
        let reader = options.into_reader_with_file_handle(Cursor::new(bytes));
        reader.finish().unwrap().height()
    });
}

/// The same file to a complete drive.
#[divan::bench(name = "ingest/csv/360000", sample_count = 20)]
fn drive(bencher: divan::Bencher<'_, '_>) {
    let path = &*TABLE;
    let mapping = "[table]\nlayout = \"pair\"\ngap_kind = \"bumper_to_bumper\"\n[table.units]\ntime = \"s\"\nlength = \"m\"\n\
        speed = \"m/s\"\n[table.columns]\ntime = \"t\"\nego_x = \"x\"\nego_speed = \"v\"\ngap = \"gap\"\nlead_speed = \"lead_v\"\n\
        lead_length = \"lead_length\"\n";
    let settings = IngestSettings {
        mapping: Some(Mapping::from_toml(mapping, "m.toml".as_ref()).unwrap()),
        ..IngestSettings::default()
    };
    bencher.bench(|| {
        let log = read_log(path, &settings).unwrap().remove(0);
        Drive::from_recording(log.meta, &log.recording).unwrap().len()
    });
}

/// Ten minutes at 20 Hz with eight others around.
fn recording() -> Recording {
    let rows = 12_000;
    let time_s: Vec<f64> = (0..rows).map(|i| f64::from(i) / 20.0).collect();
    let x = |ahead: f64| {
        time_s.iter().map(|t| 30.0 * t + ahead + (0.1 * t).sin()).collect::<Vec<f64>>()
    };
    let flat = |value: f64| vec![value; time_s.len()];
    let other = |id: u32| ObjectTrack {
        id: VehicleId(id),
        length_m: 4.5,
        first_row: 0,
        x_m: x(20.0 * f64::from(id) - 90.0),
        y_m: flat(3.66 * f64::from(id % 2)),
        speed_mps: flat(30.0),
    };
    let ego = EgoTrack { length_m: 4.7, x_m: x(0.0), y_m: flat(0.0), speed_mps: flat(30.0) };
    Recording::new(
        Road::PAPER,
        20.0,
        time_s.clone(),
        vec![0; rows as usize],
        ego,
        (1..=8).map(other).collect(),
    )
    .unwrap()
}

fn meta() -> DriveMeta {
    DriveMeta::named("P01-mimic", "P01", "mimic", DrivenBy::Automated).unwrap()
}

#[divan::bench(name = "write/log/12000", sample_count = 20)]
fn write_log(bencher: divan::Bencher<'_, '_>) {
    let recording = recording();
    bencher.bench(|| {
        let mut out = Cursor::new(Vec::new());
        write_mcap(&recording, &meta(), &mut out).unwrap();
        out.into_inner().len()
    });
}

#[divan::bench(name = "write/parquet/12000", sample_count = 20)]
fn write_parquet(bencher: divan::Bencher<'_, '_>) {
    let drive = Drive::from_recording(meta(), &recording()).unwrap();
    bencher.bench(|| {
        let mut out = Vec::new();
        write_drive_to(&mut out, &drive, &Provenance::default()).unwrap();
        out.len()
    });
}

/// Eight hours at 20 Hz in which so many others come and go, five seconds each.
#[divan::bench(name = "drive/eight_hours", args = [10_000, 100_000], sample_count = 3, sample_size = 1)]
fn eight_hours(bencher: divan::Bencher<'_, '_>, tracks: u32) {
    const ROWS: usize = 8 * 3600 * 20;
    const STAY: usize = 100;
    let line = |from: f64| (0..STAY).map(|i| from + 1.5 * i as f64).collect::<Vec<f64>>();
    let other = |id: u32| {
        let first_row = id as usize * (ROWS - STAY) / tracks as usize;
        ObjectTrack {
            id: VehicleId(id),
            length_m: 4.5,
            first_row,
            x_m: line(1.5 * first_row as f64 + 40.0),
            y_m: vec![3.66 * f64::from(id % 3); STAY],
            speed_mps: vec![30.0; STAY],
        }
    };
    let ego = EgoTrack {
        length_m: 4.7,
        x_m: (0..ROWS).map(|i| 1.5 * i as f64).collect(),
        y_m: vec![0.0; ROWS],
        speed_mps: vec![30.0; ROWS],
    };
    let time_s = (0..ROWS).map(|i| i as f64 / 20.0).collect();
    let recording = Recording::new(
        Road::PAPER,
        20.0,
        time_s,
        vec![0; ROWS],
        ego,
        (0..tracks).map(other).collect(),
    );
    let recording = recording.unwrap();
    bencher.bench(|| Drive::from_recording(meta(), &recording).unwrap().len());
}
