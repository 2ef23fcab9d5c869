//! A leader that is named, and whose position no row gives, is not a free road.

use super::mapped::{UNITS, drive_of, mapped, of_toml, read_named, settings, shipped};
use maveric_ingest::{Ingested, read_log};
use std::fmt::Write as _;

/// Time during which ego has a leader, and time that is recorded at all, in s.
fn following_and_recorded_s(log: &Ingested) -> (f64, f64) {
    let drive = drive_of(log);
    let rows = drive.rows();
    let leads = rows.lead_present.iter().filter(|p| **p).count();
    (leads as f64 / drive.rate_hz(), rows.lead_present.len() as f64 / drive.rate_hz())
}

fn warned(log: &Ingested, what: &str) -> usize {
    log.warnings.iter().filter(|w| w.what.contains(what)).map(|w| w.count).sum()
}

const LOST: &str = "name a leader that has no rows";

/// Ego at 20 m/s for 40 s behind leader 4, which has rows where `there`; car 7 drives ahead on the left.
fn ngsim(there: impl Fn(u32) -> bool) -> String {
    let mut text =
        "Vehicle_ID,Global_Time,Local_X,Local_Y,v_length,v_Vel,Lane_ID,Preceding,Location\n"
            .to_owned();
    for i in 0..400 {
        let x = 2.0 * f64::from(i);
        writeln!(text, "3,{},12,{x},4.5,20,4,4,us-101", 100 * i).unwrap();
        writeln!(text, "7,{},8.3,{},4.5,20,3,0,us-101", 100 * i, x + 20.0).unwrap();
        if there(i) {
            writeln!(text, "4,{},12,{},4.5,20,4,0,us-101", 100 * i, x + 50.0).unwrap();
        }
    }
    text
}

#[test]
fn named_leader_without_rows_is_a_hole_in_ngsim() {
    let read = |there: fn(u32) -> bool| {
        let mut found = read_named("ngsim.csv", &ngsim(there), shipped("ngsim.toml")).unwrap();
        found.remove(0)
    };
    let found = read(|i| i < 200);
    let (following, recorded) = following_and_recorded_s(&found);
    assert!((following - 20.0).abs() < 0.2 && (recorded - 20.0).abs() < 0.2, "{recorded}");
    assert_eq!(warned(&found, LOST), 200);
    let whole = read(|_| true);
    assert_eq!(warned(&whole, LOST), 0);
    let (following, recorded) = following_and_recorded_s(&whole);
    assert!(following > 39.8 && following.to_bits() == recorded.to_bits(), "{following}");
}

#[test]
fn named_leader_without_rows_is_a_hole_in_exid() {
    let text = |there: bool| {
        let mut text = "recordingId,trackId,frame,xCenter,yCenter,heading,width,length,xVelocity,yVelocity,leadId\n".to_owned();
        for f in 0..250 {
            let x = 0.8 * f64::from(f);
            writeln!(text, "0,7,{f},{x},0,0,2,4,20,0,9").unwrap();
            if there || !(100..150).contains(&f) {
                writeln!(text, "0,9,{f},{},0,0,2,4,20,0,-1", x + 40.0).unwrap();
            }
        }
        text
    };
    let read = |there: bool| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("00_tracks.csv");
        std::fs::write(&path, text(there)).unwrap();
        let meta = "recordingId,frameRate,speedLimit\n0,25,-1\n";
        std::fs::write(folder.path().join("00_recordingMeta.csv"), meta).unwrap();
        read_log(&path, &settings(shipped("exid.toml"))).unwrap().remove(0)
    };
    let found = read(false);
    assert_eq!(warned(&found, LOST), 50);
    let drive = drive_of(&found);
    assert!(drive.rows().lead_present.iter().all(|p| *p));
    assert_eq!(found.recording.segment().last(), Some(&1));
    assert_eq!(read(true).recording.segment().last(), Some(&0));
}

#[test]
fn named_leader_without_rows_is_a_hole_in_highd() {
    let mut text = "frame,id,x,y,width,height,xVelocity,yVelocity,precedingId,laneId\n".to_owned();
    for f in 1..=250 {
        let x = 1.2 * f64::from(f);
        writeln!(text, "{f},1,{},25,4,2,30,0,2,6", 100.0 + x).unwrap();
        writeln!(text, "{f},3,{},21,4,2,30,0,0,5", 120.0 + x).unwrap();
        if !(100..129).contains(&f) {
            writeln!(text, "{f},2,{},25,5,2,30,0,0,6", 150.0 + x).unwrap();
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("01_tracks.csv");
    std::fs::write(&path, text).unwrap();
    let meta = "id,frameRate,locationId,speedLimit,upperLaneMarkings,lowerLaneMarkings\n\
        1,25,2,36.11,8.00;12.00;16.00,20.00;24.00;28.00\n";
    std::fs::write(folder.path().join("01_recordingMeta.csv"), meta).unwrap();
    let found = read_log(&path, &settings(shipped("highd.toml"))).unwrap().remove(0);
    assert_eq!(warned(&found, LOST), 29);
    assert!(drive_of(&found).rows().lead_present.iter().all(|p| *p));
    assert_eq!(found.recording.segment().last(), Some(&1));
}

#[test]
fn leader_that_never_has_rows_makes_no_drive() {
    let error =
        read_named("ngsim.csv", &ngsim(|_| false), of_toml(&only_ego()).unwrap()).unwrap_err();
    assert!(error.to_string().contains("named leader is unknown"), "{error}");
}

/// The mapping of NGSIM of vehicle 3 alone.
fn only_ego() -> String {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../study_data/mappings/ngsim.toml");
    let text = std::fs::read_to_string(path).unwrap();
    text.replace("layout = \"long\"", "layout = \"long\"\nego = \"3\"")
}

#[test]
fn leader_without_gap_or_speed_is_a_hole_in_pairs() {
    let read = |columns: &str, row: &dyn Fn(u32) -> String| {
        let name = |c| format!("{c} = \"{c}\"\n");
        let named: String = columns.split(' ').map(name).collect();
        let mapping = format!(
            "[table]\nlayout = \"pair\"\ngap_kind = \"bumper_to_bumper\"\n{UNITS}[table.columns]\n{named}"
        );
        let rows: Vec<String> = (0..400).map(row).collect();
        let text = format!("{}\n{}\n", columns.replace(' ', ","), rows.join("\n"));
        following_and_recorded_s(&mapped(&mapping, &text).unwrap()[0])
    };
    let time = |i: u32| f64::from(i) / 10.0;
    let half = |i: u32, cell: &'static str| if i < 200 { cell } else { "" };
    let near = |found: (f64, f64), expected: (f64, f64)| {
        (found.0 - expected.0).abs() < 0.2 && (found.1 - expected.1).abs() < 0.2
    };
    let columns = "time ego_speed gap lead_speed";
    let no_speed = read(columns, &|i| format!("{},20,30,{}", time(i), half(i, "20")));
    assert!(near(no_speed, (20.0, 20.0)), "{no_speed:?}");
    let nobody = read(columns, &|i| format!("{},20,{},", time(i), half(i, "30")) + half(i, "20"));
    assert!(near(nobody, (20.0, 40.0)), "{nobody:?}");
    let columns = "time ego_speed gap lead_speed lead_id";
    let no_gap = read(columns, &|i| format!("{},20,{},20,4", time(i), half(i, "30")));
    assert!(near(no_gap, (20.0, 20.0)), "{no_gap:?}");
}
