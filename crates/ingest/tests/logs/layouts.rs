//! Tables of every layout, made up so that what must come out is known.

use super::mapped::{UNITS, drive_of, mapped, of_toml, read_named, settings, shipped};
use maveric_domain::{Recording, Sees};
use maveric_ingest::{IngestError, Ingested, WarningKind, log_files, read_log};
use std::{fmt::Write as _, path::PathBuf};

fn write(folder: &tempfile::TempDir, name: &str, text: &str) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    path
}

fn ids(drives: &[Ingested]) -> Vec<&str> {
    drives.iter().map(|d| d.meta.drive.as_str()).collect()
}

fn near(found: f64, expected: f64) -> bool {
    (found - expected).abs() < 1e-6
}

fn lead_ids(recording: &Recording) -> Vec<u32> {
    recording.others().iter().map(|t| t.id.0).collect()
}

#[test]
fn a_platoon_below_a_preamble_has_a_drive_for_every_follower() {
    let mut text = "Freq,10,Hz\nDate,4.7.2019\nCars,a,b,c\nACC,off\nOrder,1,2,3\n\
        Time,Speed1,E1,Speed2,E2,Speed3,E3,IVS1,IVS2\n"
        .to_owned();
    for i in 0..100 {
        let t = f64::from(i) / 10.0;
        writeln!(text, "{t},20,0,21,0,22,0,{},{}", 30.0 + t, 40.0 - t).unwrap();
    }
    let found = read_named("ASta_1.csv", &text, shipped("openacc_platoon.toml")).unwrap();
    assert_eq!(ids(&found), ["ASta_1-f2", "ASta_1-f3"]);
    assert_eq!(found[0].recording.sees(), Sees::LEAD);
    let third = drive_of(&found[1]);
    assert_eq!(third.len(), 100);
    let rows = third.rows();
    for row in 0..100 {
        assert!(near(rows.lead_dx_m[row], 40.0 - row as f64 / 10.0));
        assert!(near(rows.ego_speed_mps[row], 22.0) && near(rows.lead_speed_mps[row], 21.0));
        assert!(near(rows.ego_x_m[row], 2.2 * row as f64), "the way is the speed's integral");
    }
}

/// Two vehicles in file on each of two roads, as highD has them: corners of boxes, y downwards.
fn highd(folder: &tempfile::TempDir) -> PathBuf {
    let mut text = "frame,id,x,y,width,height,xVelocity,yVelocity,precedingId,laneId\n".to_owned();
    for f in 1..=50 {
        let way = f64::from(f) / 25.0 * 30.0;
        // Along x in the right lane (lower markings 20, 24, 28), 4 and 5 m long.
        writeln!(text, "{f},1,{},25,4,2,30,0,2,6", 100.0 + way).unwrap();
        writeln!(text, "{f},2,{},25,5,2,30,0,0,6", 150.0 + way).unwrap();
        // Against x in the left lane (upper markings 8, 12, 16).
        writeln!(text, "{f},3,{},13,4,2,-30,0,4,3", 400.0 - way).unwrap();
        writeln!(text, "{f},4,{},13,6,2,-30,0,0,3", 350.0 - way).unwrap();
    }
    write(
        folder,
        "01_recordingMeta.csv",
        "id,frameRate,locationId,speedLimit,upperLaneMarkings,lowerLaneMarkings\n\
         1,25,2,36.11,8.00;12.00;16.00,20.00;24.00;28.00\n",
    );
    write(folder, "01_tracks.csv", &text)
}

#[test]
fn highd_has_both_directions_lanes_from_its_meta_file_and_gaps_between_boxes() {
    let folder = tempfile::tempdir().unwrap();
    let path = highd(&folder);
    let settings = settings(shipped("highd.toml"));
    assert_eq!(
        log_files(folder.path(), settings.mapping.as_ref()).unwrap(),
        std::slice::from_ref(&path)
    );
    let found = read_log(&path, &settings).unwrap();
    assert_eq!(ids(&found), ["highd-01-1", "highd-01-2", "highd-01-3", "highd-01-4"]);
    for (ego, lane, gap) in [(0, 0, 46.0), (2, 1, 44.0)] {
        let drive = drive_of(&found[ego]);
        assert_eq!(drive.sees(), Sees::ALL);
        assert_eq!(drive.road().lanes, 2);
        assert!(near(drive.road().lane_width_m, 4.0) && near(drive.road().posted_speed_mps, 36.11));
        let rows = drive.rows();
        assert!(rows.lane.iter().all(|&l| l == lane), "{:?}", rows.lane);
        assert!(rows.lead_present.iter().all(|&p| p));
        assert!(rows.lead_dx_m.iter().all(|&dx| near(dx, gap)), "{:?}", rows.lead_dx_m);
        assert!(near(rows.ego_speed_mps[7], 30.0) && rows.ego_x_m[9] > rows.ego_x_m[8]);
        assert!(found[ego].recording.others().len() == 1, "the other road is not there");
    }
    let missing = tempfile::tempdir().unwrap();
    let alone = missing.path().join("01_tracks.csv");
    std::fs::copy(&path, &alone).unwrap();
    let error = read_log(&alone, &settings).unwrap_err();
    assert!(
        matches!(&error, IngestError::NotFound { path } if path.ends_with("01_recordingMeta.csv"))
    );
}

#[test]
fn exid_follows_the_named_leader_through_a_bend() {
    // A circle of 200 m at 20 m/s, the leader 0.2 rad (40 m of arc) ahead, both 4 m long.
    let mut text = "recordingId,trackId,frame,xCenter,yCenter,heading,width,length,xVelocity,yVelocity,leadId\n".to_owned();
    for f in 0..250 {
        for (id, ahead, lead) in [(7, 0.0, "9"), (9, 0.2, "-1")] {
            let angle = 0.1 * f64::from(f) / 25.0 + ahead;
            let (sin, cos) = angle.sin_cos();
            let (x, y) = (500.0 + 200.0 * sin, 800.0 - 200.0 * cos);
            writeln!(
                text,
                "0,{id},{f},{x},{y},{},2,4,{},{},{lead}",
                angle.to_degrees(),
                20.0 * cos,
                20.0 * sin
            )
            .unwrap();
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let path = write(&folder, "00_tracks.csv", &text);
    write(&folder, "00_recordingMeta.csv", "recordingId,frameRate,speedLimit\n0,25,-1\n");
    let found = read_log(&path, &settings(shipped("exid.toml"))).unwrap();
    assert_eq!(ids(&found), ["exid-00-7", "exid-00-9"]);
    let drive = drive_of(&found[0]);
    let rows = drive.rows();
    assert!(near(drive.road().posted_speed_mps, 36.11), "-1 is no speed limit");
    let chord = 400.0 * 0.1_f64.sin();
    for row in 5..190 {
        assert!(rows.lead_present[row]);
        assert!((rows.lead_dx_m[row] - (chord - 4.0)).abs() < 0.3, "{}", rows.lead_dx_m[row]);
    }
    assert_eq!(lead_ids(&found[1].recording), [0_u32; 0], "-1 is nobody");
}

const LONG: &str = "[road]\nlanes = 2\nlane_width_m = 3.5\nposted_speed_mps = 30.0\n[table]\nlayout = \"long\"\n\
    point = \"rear\"\nlanes_from = \"left\"\n[table.units]\ntime = \"us\"\nlength = \"ft\"\nspeed = \"km/h\"\n\
    [table.columns]\ntime = \"stamp\"\nid = \"car\"\nx = \"s\"\nlane = \"lane\"\nspeed = \"v\"\n";

fn of_long(text: &str) -> Result<Vec<Ingested>, IngestError> {
    read_named("cars.tsv", text, of_toml(LONG)?)
}

#[test]
fn lanes_without_a_y_move_in_steps_and_the_leader_is_the_one_in_the_lane() {
    let mut text = "stamp\tcar\ts\tlane\tv\n".to_owned();
    for i in 0..40 {
        let us = i * 100_000;
        let way = f64::from(i) * 10.0 / 3.6 / 0.3048;
        // `a` changes from lane 2 (right) to lane 1 (left) at 2 s; `b` is ahead on the right, `c` on the left.
        let lane = if i < 20 { 2 } else { 1 };
        writeln!(text, "{us}\ta\t{way}\t{lane}\t100").unwrap();
        writeln!(text, "{us}\tb\t{}\t2\t100", way + 100.0).unwrap();
        writeln!(text, "{us}\tc\t{}\t1\t100", way + 200.0).unwrap();
    }
    let found = of_long(&text).unwrap();
    assert_eq!(ids(&found), ["cars-a", "cars-b", "cars-c"]);
    let drive = drive_of(&found[0]);
    let rows = drive.rows();
    assert!(near(rows.ego_speed_mps[3], 100.0 / 3.6));
    let stepped = rows.ego_y_m.iter().all(|y| near(*y, 0.0) || near(*y, 3.5));
    assert!(stepped, "never between lanes: {:?}", rows.ego_y_m);
    assert_eq!(rows.lane.iter().position(|&l| l == 1), Some(40), "not before its sample");
    assert!(near(rows.lead_dx_m[0], 100.0 * 0.3048 - 4.7), "{}", rows.lead_dx_m[0]);
    let doubts: Vec<WarningKind> = found[0].warnings.iter().map(|w| w.kind).collect();
    assert!(doubts.contains(&WarningKind::Default), "the length stands in: {doubts:?}");
}

#[test]
fn a_leader_by_its_number_alone_and_one_that_vanishes() {
    let mut text = "t,id,x,v,front\n".to_owned();
    for i in 0..60 {
        let t = f64::from(i) / 10.0;
        let front = if i < 30 { "2" } else { "0" };
        writeln!(text, "{t},1,{},10,{front}", 10.0 * t).unwrap();
        writeln!(text, "{t},2,{},10,", 10.0 * t + 30.0).unwrap();
        writeln!(text, "{t},3,{},10,1", 10.0 * t - 15.0).unwrap();
    }
    let toml = "[table]\nlayout = \"long\"\npoint = \"centre\"\n[table.units]\ntime = \"s\"\nlength = \"m\"\n\
        speed = \"m/s\"\n[table.columns]\ntime = \"t\"\nid = \"id\"\nx = \"x\"\nspeed = \"v\"\nlead_id = \"front\"\n";
    let found = mapped(toml, &text).unwrap();
    let rows = drive_of(&found[0]).rows().clone();
    assert!(near(rows.lead_dx_m[10], 30.0 - 4.7));
    assert_eq!(rows.lead_present.iter().filter(|p| **p).count(), 59, "until 2.9 s");
    assert!(drive_of(&found[1]).rows().lead_present.iter().all(|p| !p));
}

#[test]
fn a_speed_that_rows_of_a_long_table_lack_is_told_and_one_below_zero_is_of_whoever_reverses() {
    let toml = "[table]\nlayout = \"long\"\npoint = \"centre\"\n[table.units]\ntime = \"s\"\nlength = \"m\"\n\
        speed = \"m/s\"\n[table.columns]\ntime = \"t\"\nid = \"id\"\nx = \"x\"\nspeed = \"v\"\nlead_id = \"front\"\n";
    let read = |way: f64, speed_ahead: fn(u32) -> &'static str| {
        let mut text = "t,id,x,v,front\n".to_owned();
        for i in 0..60 {
            let t = f64::from(i) / 10.0;
            writeln!(text, "{t},1,{},{way},2", way * t).unwrap();
            writeln!(text, "{t},2,{},{},", 10.0 * t + 30.0, speed_ahead(i)).unwrap();
        }
        mapped(toml, &text).unwrap()
    };
    let count = |found: &[Ingested], what: &str| -> usize {
        let warnings = found.iter().flat_map(|d| &d.warnings);
        warnings.filter(|w| w.what.contains(what)).map(|w| w.count).sum()
    };
    let lacking = |i: u32| if (20..30).contains(&i) { "" } else { "10" };
    let told = "rows of vehicle 2 hold no speed";
    assert_eq!(count(&read(10.0, lacking), told), 10);
    let whole = read(10.0, |_| "10");
    assert_eq!(count(&whole, told), 0);
    assert_eq!(count(&whole, "drives backwards"), 0);
    let back = read(-10.0, |_| "10");
    let speeds = &back[0].recording.ego().speed_mps;
    assert!(speeds.iter().all(|v| near(*v, -10.0)), "{speeds:?}");
    assert_eq!(count(&back, "drives backwards"), 60);
}

#[test]
fn our_own_drives_as_csv_keep_passed_vehicles_behind() {
    let mut text =
        "time_s,ego_x_m,ego_y_m,ego_speed_mps,lead_id,lead_dx_m,lead_dy_m,lead_speed_mps\n"
            .to_owned();
    for i in 0..200 {
        let t = f64::from(i) / 20.0;
        let (lead, dx) = match i {
            0..100 => ("5", 50.0 - t),
            100..150 => ("5", -10.0 - t),
            _ => ("", 200.0),
        };
        writeln!(text, "{t},{},3.66,30,{lead},{dx},-3.66,25", 30.0 * t).unwrap();
    }
    let found = read_named("P01-own.csv", &text, shipped("ours.toml")).unwrap().remove(0);
    assert_eq!(found.meta.participant.as_str(), "P01-own");
    let rows = drive_of(&found).rows().clone();
    assert!(rows.lane.iter().all(|&l| l == 1));
    assert!(near(rows.lead_dx_m[120], -16.0), "{}", rows.lead_dx_m[120]);
    assert!(!rows.lead_present[160]);
}

#[test]
fn wrong_units_are_doubted_and_a_clock_that_jumps_back_is_counted() {
    let mut text = "t,x_follower,v_follower,v_leader,leader_length,spacing\n".to_owned();
    for i in 0..200 {
        let t = if i == 50 { 3.0 } else { f64::from(i) / 10.0 };
        writeln!(text, "{t},{},72,72,0,30", 2.0 * f64::from(i)).unwrap();
    }
    let found = read_named("oa_pair_r_f2_c.csv", &text, shipped("openacc.toml")).unwrap().remove(0);
    let said: Vec<(WarningKind, usize)> =
        found.warnings.iter().map(|w| (w.kind, w.count)).collect();
    assert!(said.contains(&(WarningKind::OutOfOrder, 1)), "{said:?}");
    assert!(said.contains(&(WarningKind::DuplicateTime, 1)), "{said:?}");
    let doubt = found.warnings.iter().find(|w| w.kind == WarningKind::Unit).unwrap();
    assert!(doubt.what.contains("3.60 times"), "{}", doubt.what);
}

/// Ego of 4 m, and 40 m ahead of its centre that of a leader of 6 m, both at 20 m/s: 35 m between their bumpers.
fn gaps_m(
    layout: &str,
    keys: &str,
    columns: &str,
    x_m: [f64; 2],
    gap_m: f64,
    along: f64,
) -> Vec<f64> {
    let (id, speed) = if layout == "long" {
        ("id = \"id\"\nx = \"x\"\nlength = \"l\"\nwidth = \"b\"\n", "speed")
    } else {
        ("ego_x = \"x\"\nego_length = \"l\"\n", "ego_speed")
    };
    let toml = format!(
        "[table]\nlayout = \"{layout}\"\n{keys}\n[table.units]\ntime = \"s\"\nlength = \"m\"\nspeed = \"m/s\"\n[table.columns]\n\
         time = \"t\"\n{id}{speed} = \"v\"\nlead_speed = \"w\"\nlead_length = \"k\"\n{columns}\n"
    );
    let mut text = "t,id,x,v,l,b,lead,w,k,gap\n".to_owned();
    for i in 0..60 {
        let t = f64::from(i) / 10.0;
        let [x, lead] = x_m.map(|x| along * (x + 20.0 * t));
        writeln!(text, "{t},1,{x},20,4,1.8,{lead},20,6,{gap_m}").unwrap();
    }
    let found = mapped(&toml, &text).unwrap();
    assert_eq!(found.len(), 1, "{toml}");
    drive_of(&found[0]).rows().lead_dx_m.clone()
}

#[test]
fn the_same_gap_comes_of_every_point_of_a_vehicle_and_of_every_kind_of_gap() {
    let lead = "lead_x = \"lead\"";
    let points = [
        ("front", [2.0, 43.0]),
        ("rear", [-2.0, 37.0]),
        ("centre", [0.0, 40.0]),
        ("corner", [-2.0, 37.0]),
        ("reference", [-1.3, 38.7]),
    ];
    let all_35 = |dx_m: Vec<f64>, what: &str| {
        assert!(dx_m.len() > 100 && dx_m.iter().all(|dx| near(*dx, 35.0)), "{what}: {dx_m:?}");
    };
    for (point, x_m) in points {
        let reference = if point == "reference" { "centre_ahead_m = 1.3" } else { "" };
        let keys = format!("point = \"{point}\"\n{reference}");
        all_35(gaps_m("long", &keys, lead, x_m, 0.0, 1.0), &keys);
        if ["front", "rear", "centre"].contains(&point) {
            all_35(gaps_m("pair", &keys, lead, x_m, 0.0, 1.0), &keys);
            let keys = format!("{keys}\nforward = \"-x\"");
            all_35(gaps_m("long", &keys, lead, x_m, 0.0, -1.0), &keys);
            all_35(gaps_m("pair", &keys, lead, x_m, 0.0, -1.0), &keys);
        }
    }
    for (kind, gap_m) in
        [("bumper_to_bumper", 35.0), ("front_to_front", 41.0), ("centre_to_centre", 40.0)]
    {
        let keys = format!("gap_kind = \"{kind}\"");
        all_35(gaps_m("pair", &keys, "gap = \"gap\"", [0.0, 0.0], gap_m, 1.0), &keys);
        let keys = format!("{keys}\npoint = \"centre\"");
        all_35(gaps_m("long", &keys, "gap = \"gap\"", [0.0, 0.0], gap_m, 1.0), &keys);
    }
}

#[test]
fn corner_is_mirrored_where_forward_is_against_x() {
    let keys = "point = \"corner\"\nforward = \"-x\"";
    let dx_m = gaps_m("long", keys, "lead_x = \"lead\"", [2.0, 43.0], 0.0, -1.0);
    assert!(dx_m.iter().all(|dx| near(*dx, 35.0)), "{dx_m:?}");
    // Two cars, each with rows of its own, against the table's x in the lane around its y of -3.5 (left of y = 0 then).
    let toml = format!(
        "[road]\nlanes = 2\nlane_width_m = 3.5\nposted_speed_mps = 30.0\nframe = \"map\"\n[table]\nlayout = \"long\"\n{keys}\n\
         y_grows = \"left\"\n[table.units]\ntime = \"s\"\nlength = \"m\"\nspeed = \"m/s\"\n[table.columns]\ntime = \"t\"\n\
         id = \"id\"\nx = \"x\"\ny = \"y\"\nspeed = \"v\"\nlength = \"l\"\nwidth = \"b\"\n"
    );
    let mut text = "t,id,x,y,v,l,b\n".to_owned();
    for i in 0..60 {
        let t = f64::from(i) / 10.0;
        for (id, centre_m, length_m) in [(1, 0.0, 4.0), (2, 50.0, 6.0)] {
            let corner_m = -(centre_m + 20.0 * t) - 0.5 * length_m;
            writeln!(text, "{t},{id},{corner_m},{},20,{length_m},1.8", -3.5 - 0.9).unwrap();
        }
    }
    let found = mapped(&toml, &text).unwrap();
    let rows = drive_of(&found[0]).rows().clone();
    assert!(rows.lead_dx_m.iter().all(|dx| near(*dx, 45.0)), "{:?}", rows.lead_dx_m);
    assert!(rows.ego_y_m.iter().all(|y| near(*y, 3.5)), "{:?}", rows.ego_y_m);
}

#[test]
fn a_leader_is_as_far_beside_ego_as_its_column_says_wherever_ego_is() {
    let toml = "[road]\nlanes = 3\nlane_width_m = 3.5\nposted_speed_mps = 30.0\nframe = \"map\"\n[table]\nlayout = \"pair\"\n\
        gap_kind = \"bumper_to_bumper\"\n[table.units]\ntime = \"s\"\nlength = \"m\"\nspeed = \"m/s\"\n[table.columns]\n\
        time = \"t\"\nego_x = \"x\"\nego_y = \"y\"\nego_speed = \"v\"\ngap = \"gap\"\nlead_speed = \"v\"\nlead_dy = \"dy\"\n";
    let mut text = "t,x,y,v,gap,dy\n".to_owned();
    for i in 0..60 {
        let t = f64::from(i) / 10.0;
        writeln!(text, "{t},{},3.5,20,30,0.75", 20.0 * t).unwrap();
    }
    let found = mapped(toml, &text).unwrap();
    let recording = &found[0].recording;
    assert!(recording.ego().y_m.iter().all(|y| near(*y, 3.5)));
    assert!(recording.others()[0].y_m.iter().all(|y| near(*y, 4.25)));
    let rows = drive_of(&found[0]).rows().clone();
    assert!(rows.lead_dy_m.iter().all(|dy| near(*dy, 0.75)));
    assert!(rows.lead_dx_m.iter().all(|dx| near(*dx, 30.0)));
}

/// How many warnings a drive has of lengths that stand in.
fn stood_in(log: &Ingested, whose: &str) -> usize {
    let fits = |w: &&maveric_ingest::Warning| {
        w.kind == WarningKind::Default
            && w.what.contains(whose)
            && w.what.contains("length is not known")
    };
    log.warnings.iter().filter(fits).map(|w| w.count).sum()
}

/// Two cars whose positions of a point are 50 m apart, at 20 m/s.
fn two_cars(point: &str, length: Option<(&str, &str)>) -> Vec<Ingested> {
    let column = if length.is_some() { "length = \"l\"\n" } else { "" };
    let toml = format!(
        "[table]\nlayout = \"long\"\npoint = \"{point}\"\nego_length_m = 4.0\nlead_length_m = 16.0\n{UNITS}[table.columns]\n\
         time = \"t\"\nid = \"id\"\nx = \"x\"\nspeed = \"v\"\nlead_id = \"front\"\n{column}"
    );
    let (ego, lead) = length.unwrap_or_default();
    let mut text = "t,id,x,v,front,l\n".to_owned();
    for i in 0..60 {
        let t = f64::from(i) / 10.0;
        writeln!(text, "{t},1,{},20,2,{ego}", 20.0 * t).unwrap();
        writeln!(text, "{t},2,{},20,,{lead}", 20.0 * t + 50.0).unwrap();
    }
    mapped(&toml, &text).unwrap()
}

#[test]
fn lead_length_of_mapping_stands_in_in_long_tables() {
    for (point, gap_m) in [("front", 34.0), ("centre", 40.0), ("rear", 46.0)] {
        for length in [None, Some(("4", "0")), Some(("4", ""))] {
            let found = two_cars(point, length);
            let rows = drive_of(&found[0]).rows().clone();
            assert!(near(rows.lead_dx_m[20], gap_m), "{point} {length:?}: {}", rows.lead_dx_m[20]);
            assert_eq!(stood_in(&found[0], "other vehicles whose"), 1, "{point} {length:?}");
        }
        let known = two_cars(point, Some(("4", "16")));
        assert!(near(drive_of(&known[0]).rows().lead_dx_m[20], gap_m), "{point}");
        assert_eq!(stood_in(&known[0], ""), 0);
    }
}

#[test]
fn length_of_zero_is_reported_in_pairs_and_platoons() {
    let pair = |ego: &str, lead: &str| {
        let toml = format!(
            "[table]\nlayout = \"pair\"\ngap_kind = \"bumper_to_bumper\"\n{UNITS}[table.columns]\ntime = \"t\"\nego_speed = \"v\"\n\
             gap = \"gap\"\nlead_speed = \"v\"\nego_length = \"l\"\nlead_length = \"k\"\n"
        );
        let row = |i| format!("{},20,30,{ego},{lead}\n", f64::from(i) / 10.0);
        let rows: String = (0..60).map(row).collect();
        let found = mapped(&toml, &format!("t,v,gap,l,k\n{rows}")).unwrap();
        (stood_in(&found[0], "ego's"), stood_in(&found[0], "leader's"))
    };
    assert_eq!(pair("4", "5"), (0, 0));
    assert_eq!(pair("0", "5"), (1, 0));
    assert_eq!(pair("4", "0"), (0, 60));
    let platoon = |second: &str, first: &str| {
        let toml = format!(
            "[table]\nlayout = \"platoon\"\ngap_kind = \"bumper_to_bumper\"\n{UNITS}[table.columns]\ntime = \"t\"\nspeed = \"v{{n}}\"\n\
             gap = \"gap{{n}}\"\nlength = \"l{{n}}\"\n"
        );
        let row = |i| format!("{},20,20,30,{first},{second}\n", f64::from(i) / 10.0);
        let rows: String = (0..60).map(row).collect();
        let found = mapped(&toml, &format!("t,v1,v2,gap1,l1,l2\n{rows}")).unwrap();
        (stood_in(&found[0], "ego's"), stood_in(&found[0], "leader's"))
    };
    assert_eq!(platoon("4", "5"), (0, 0));
    assert_eq!(platoon("0", "5"), (1, 0));
    assert_eq!(platoon("4", ""), (0, 60));
}

const TRACKS: &str = "[road]\nlanes = 2\nlane_width_m = 3.5\nposted_speed_mps = 30.0\nframe = \"map\"\n[table]\nlayout = \"long\"\n\
    point = \"centre\"\ny_grows = \"left\"\n[table.units]\ntime = \"s\"\nlength = \"m\"\nspeed = \"m/s\"\n[table.columns]\ntime = \"t\"\n\
    id = \"id\"\nx = \"x\"\ny = \"y\"\nspeed = \"v\"\n";

#[test]
fn two_runs_in_long_table_are_two_pieces() {
    // Vehicle 2 is 40 m ahead in the second run alone.
    let row = |i: u32, id: u32, speed: f64| {
        let t = f64::from(i) / 10.0;
        let x = speed * t + 40.0 * f64::from(id - 1);
        format!("{t},{id},{x},0,{speed}\n")
    };
    let first: String = (0..200).map(|i| row(i, 1, 20.0)).collect();
    let second: String = (0..200).map(|i| row(i, 1, 30.0) + &row(i, 2, 30.0)).collect();
    let found = mapped(TRACKS, &format!("t,id,x,y,v\n{first}{second}")).unwrap();
    let drive = drive_of(&found[0]);
    let rows = drive.rows();
    let n = rows.ego_speed_mps.len();
    let mean = rows.ego_speed_mps.iter().sum::<f64>() / n as f64;
    assert!((mean - 25.0).abs() < 0.1, "{mean}");
    assert_eq!(found[0].recording.segment().last(), Some(&1));
    let led = (0..n).filter(|row| rows.lead_present[*row]);
    let second_run = (0..n).filter(|row| rows.segment[*row] == 1);
    assert_eq!(led.collect::<Vec<_>>(), second_run.collect::<Vec<_>>());
    let restart = |w: &&maveric_ingest::Warning| w.kind == WarningKind::ClockRestart;
    assert_eq!(found[0].warnings.iter().filter(restart).count(), 1);
    // Vehicle after vehicle, and each in order, is one run.
    let by_vehicle: String =
        (1..4).flat_map(|id| (0..200).map(move |i| row(i, id, 20.0))).collect();
    let found = mapped(TRACKS, &format!("t,id,x,y,v\n{by_vehicle}")).unwrap();
    assert!(found.iter().all(|d| d.recording.segment().last() == Some(&0)));
    // Vehicle after vehicle, each with two runs: which belong together is unknown.
    let run = |id: u32, speed: f64| (0..200).map(|i| row(i, id, speed)).collect::<String>();
    let twice = [run(1, 20.0), run(1, 30.0), run(2, 20.0), run(2, 30.0)].concat();
    let error = mapped(TRACKS, &format!("t,id,x,y,v\n{twice}")).unwrap_err().to_string();
    assert!(error.contains("vehicle 1") && error.contains("`groups`"), "{error}");
}

#[test]
fn number_of_several_vehicles_at_one_time_is_reported() {
    let row = |i: u32| {
        let t = f64::from(i) / 10.0;
        let car = |id: u32, ahead: f64| format!("{t},{id},{},0,20\n", 20.0 * t + ahead);
        car(1, 0.0) + &car(2, 58.0) + &car(2, -100.0)
    };
    let rows: String = (0..200).map(row).collect();
    let found = mapped(TRACKS, &format!("t,id,x,y,v\n{rows}")).unwrap();
    let twice = |w: &&maveric_ingest::Warning| {
        w.kind == WarningKind::DuplicateTime && w.what.contains("vehicle 2")
    };
    let told: Vec<usize> = found[0].warnings.iter().filter(twice).map(|w| w.count).collect();
    assert_eq!(told, [200]);
    assert!(drive_of(&found[0]).rows().lead_present.iter().all(|p| *p), "the first row counts");
}
