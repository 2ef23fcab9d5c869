//! Trains on drives in a CSV, one row a moment, and prints where in style space each driver is.
//!
//! `cargo run --release -p maveric-model --example train_on_csv [FILE.csv]`; the file shipped here is synthetic: five made-up drivers,
//! 200 s each. Your own needs the same columns; where nobody drives ahead the last four are empty.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use maveric_domain::{
    Drive, DriveId, DriveMeta, DrivenBy, EgoTrack, ObjectTrack, ParticipantId, Recording, Road,
    VehicleId,
};
use maveric_model::{TrainSettings, TrainingDrive, train};
use std::{collections::BTreeMap, error::Error, ops::ControlFlow};

fn main() -> Result<(), Box<dyn Error>> {
    let shipped = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/drives.csv");
    let path = std::env::args().nth(1).unwrap_or(shipped.to_owned());
    let text = std::fs::read_to_string(&path).map_err(|e| format!("{path}: {e}"))?;
    let mut lines_of: BTreeMap<&str, Vec<Vec<&str>>> = BTreeMap::new();
    for (index, line) in text.lines().enumerate().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        if cells.len() != 9 {
            return Err(
                format!("{path}: line {}: {} cells, expected 9", index + 1, cells.len()).into()
            );
        }
        lines_of.entry(cells[0]).or_default().push(cells);
    }
    let drives = lines_of.iter().map(|(driver, lines)| drive(driver, lines));
    let drives: Vec<Drive> = drives.collect::<Result<_, _>>()?;
    let given: Vec<_> = drives.iter().map(|drive| TrainingDrive { drive, adb: None }).collect();
    let params = TrainSettings {
        heads: maveric_model::HeadsKind::Paper,
        epochs: 30,
        batch_size: 128,
        ..TrainSettings::default()
    };
    let trained = train(&given, &params, 1, &mut |_| ControlFlow::Continue(()))?;
    for (drive, embedding) in &trained.embeddings {
        println!("{drive}: {:.2?}", embedding.coordinates());
    }
    Ok(())
}

/// One driver's lines, `driver,time_s,x_m,y_m,speed_mps,lead_id,lead_x_m,lead_y_m,lead_speed_mps`, as a drive.
fn drive(driver: &str, lines: &[Vec<&str>]) -> Result<Drive, Box<dyn Error>> {
    let column = |i: usize| lines.iter().map(|l| l[i].parse()).collect::<Result<Vec<f64>, _>>();
    let (time_s, n) = (column(1)?, lines.len());
    let rate_hz = (n - 1) as f64 / (time_s[n - 1] - time_s[0]);
    let ego = EgoTrack { length_m: 4.7, x_m: column(2)?, y_m: column(3)?, speed_mps: column(4)? };
    let mut leads: Vec<ObjectTrack> = Vec::new();
    for (row, line) in lines.iter().enumerate().filter(|(_, line)| !line[5].is_empty()) {
        let id = VehicleId(line[5].parse()?);
        let goes_on = |t: &ObjectTrack| t.id == id && t.first_row + t.x_m.len() == row;
        if !leads.last().is_some_and(goes_on) {
            // A vehicle that was out of sight comes back as another one.
            let id =
                if leads.iter().any(|t| t.id == id) { VehicleId(10_000 + row as u32) } else { id };
            leads.push(ObjectTrack {
                id,
                length_m: 4.7,
                first_row: row,
                x_m: vec![],
                y_m: vec![],
                speed_mps: vec![],
            });
        }
        if let Some(lead) = leads.last_mut() {
            lead.x_m.push(line[6].parse()?);
            lead.y_m.push(line[7].parse()?);
            lead.speed_mps.push(line[8].parse()?);
        }
    }
    let recording = Recording::new(Road::PAPER, rate_hz, time_s, vec![0; n], ego, leads)?;
    let (condition, driven_by) = ("own".parse()?, DrivenBy::Synthetic);
    let (drive, participant) = (DriveId::new(driver)?, ParticipantId::new(driver)?);
    let meta = DriveMeta::new(drive, participant, condition, driven_by);
    Ok(Drive::from_recording(meta, &recording)?)
}
