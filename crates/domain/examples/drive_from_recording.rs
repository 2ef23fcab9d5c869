//! Makes a drive from eleven seconds behind a slower car and says what ego did.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use maveric_domain::{
    DomainError, Drive, DriveMeta, DrivenBy, EgoTrack, ObjectTrack, Recording, Road, VehicleId,
};

fn main() -> Result<(), DomainError> {
    let time_s: Vec<f64> = (0..220).map(|i| f64::from(i) / 20.0).collect();
    let ego = EgoTrack {
        length_m: 4.7,
        x_m: time_s.iter().map(|t| 27.0 * t).collect(),
        y_m: vec![0.0; time_s.len()],
        speed_mps: vec![27.0; time_s.len()],
    };
    let lead = ObjectTrack {
        id: VehicleId(1),
        length_m: 4.7,
        first_row: 0,
        x_m: time_s.iter().map(|t| 60.0 + 26.5 * t).collect(),
        y_m: vec![0.0; time_s.len()],
        speed_mps: vec![26.5; time_s.len()],
    };
    let segment = vec![0; time_s.len()];
    let recording = Recording::new(Road::PAPER, 20.0, time_s, segment, ego, vec![lead])?;
    let meta = DriveMeta::named("P01-own", "P01", "own", DrivenBy::Synthetic)?;
    let drive = Drive::from_recording(meta, &recording)?;
    let following = drive.rows().following.iter().filter(|&&f| f).count();
    println!(
        "{} of {} rows following, {} lane changes",
        following,
        drive.len(),
        drive.lane_changes().len()
    );
    Ok(())
}
