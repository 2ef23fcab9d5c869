//! Logs of driving simulators as they write them, in made-up files of their shape.

use super::mapped::{drive_of, of_toml, read_named, shipped};
use maveric_domain::Recording;
use maveric_ingest::{Ingested, Mapping, suggest_mapping};
use std::fmt::Write as _;

fn read(mapping: Mapping, file: &str, text: &str) -> Result<Vec<Ingested>, String> {
    read_named(file, text, mapping).map_err(|e| e.to_string())
}

fn mapping(text: &str) -> Result<Mapping, String> {
    of_toml(text).map_err(|e| e.to_string())
}

fn gap_m(recording: &Recording, row: usize) -> f64 {
    let scene = recording.scene(row).unwrap();
    maveric_domain::scene::bumper_distance_m(&scene.ego, &scene.vehicles[0])
}

/// A smooth change by `width` around `at_s`, over some five seconds.
fn changed(t: f64, at_s: f64, width: f64) -> f64 {
    width / (1.0 + (-2.0 * (t - at_s)).exp())
}

/// What esmini's CSV logger writes: lines about the run, then a group of columns a vehicle and a comma at each line's end.
fn esmini() -> String {
    let columns = |n: usize| {
        format!(
            "#{n} Entity_Name [-] , #{n} Entity_ID [-] , #{n} Current_Speed [m/s] , #{n} bb_x [m] , #{n} bb_length [m] , \
             #{n} World_Position_X [m] , #{n} World_Position_Y [m] , #{n} World_Heading_Angle [rad] , #{n} collision_ids , "
        )
    };
    let mut text = format!(
        "esmini GIT REV: v2.37.0 \nScenario File Name: cut-in.xosc \nNumber of Vehicles: 2 \nIndex [-] , TimeStamp [s] , {}{}\n",
        columns(1),
        columns(2)
    );
    for i in 0..1200 {
        let t = f64::from(i) / 50.0;
        let y = -5.25 + changed(t, 15.0, 3.5);
        let _ = writeln!(
            text,
            "{i}, {t:.3}, Ego, 0, 20.0, 1.4, 5.0, {:.6}, {y:.6}, 0.0, , Target, 1, 20.0, 1.3, 4.0, {:.6}, -5.25, 0.0, , ",
            20.0 * t,
            20.0 * t + 40.0
        );
    }
    text
}

#[test]
fn esminis_columns_of_each_vehicle_become_one_drive_of_ego_behind_the_other() {
    let found = read(shipped("esmini_csv.toml"), "P01_own.csv", &esmini()).unwrap();
    assert_eq!(found.len(), 1, "only vehicle 1 is ego");
    assert_eq!(found[0].meta.drive.as_str(), "P01-own");
    assert!(found[0].warnings.is_empty(), "{:?}", found[0].warnings);
    let recording = &found[0].recording;
    // Rear axles are 40 m apart; the boxes' centres 1.4 and 1.3 m ahead of them; half a length each.
    assert!((gap_m(recording, 100) - (40.0 + 1.3 - 1.4 - 2.5 - 2.0)).abs() < 1e-6);
    assert!((recording.ego().length_m - 5.0).abs() < 1e-12);
    let drive = drive_of(&found[0]);
    let lanes = &drive.rows().lane;
    assert_eq!((lanes[0], lanes[lanes.len() - 1]), (0, 1));
    assert_eq!(drive.lane_changes().len(), 1);
}

/// A file of esmini whose vehicles of each time, by name, entity number and place ahead of ego, are in groups in that order.
fn esmini_groups(vehicles: impl Fn(u32) -> Vec<(&'static str, u32, f64)>) -> String {
    let columns = |n: usize| {
        format!(
            "#{n} Entity_Name [-] , #{n} Entity_ID [-] , #{n} Current_Speed [m/s] , #{n} bb_x [m] , #{n} bb_length [m] , \
             #{n} World_Position_X [m] , #{n} World_Position_Y [m] , #{n} World_Heading_Angle [rad] , "
        )
    };
    let mut text = "Index [-] , TimeStamp [s] , ".to_owned();
    text.extend((1..=3).map(columns));
    text.push('\n');
    for i in 0..1200 {
        let t = f64::from(i) / 50.0;
        let _ = write!(text, "{i}, {t:.3}, ");
        for (name, number, ahead) in vehicles(i) {
            let speed = 20.0 + f64::from(number);
            let x = ahead + speed * t;
            let _ = write!(text, "{name}, {number}, {speed}, 1.4, 4.0, {x:.6}, -5.25, 0.0, ");
        }
        text.push('\n');
    }
    text
}

#[test]
fn esmini_vehicles_are_found_by_name() {
    let cars = [("Ego", 0, 0.0), ("A", 1, 40.0), ("B", 2, 80.0)];
    let read = |vehicles: &dyn Fn(u32) -> Vec<(&'static str, u32, f64)>| {
        let text = esmini_groups(vehicles);
        read(shipped("esmini_csv.toml"), "P01_own.csv", &text)
    };
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    // Ego is deleted at 4 s: the other cars move up by a group.
    let deleted = |i: u32| if i < 200 { cars.to_vec() } else { cars[1..].to_vec() };
    let found = read(&deleted).unwrap();
    let recording = &found[0].recording;
    assert_eq!(found.len(), 1);
    assert!(recording.time_s().last().unwrap() < &4.0, "{:?}", recording.time_s().last());
    assert!((mean(&recording.ego().speed_mps) - 20.0).abs() < 1e-6);
    // Ego is the third of the scenario.
    let third = |_: u32| vec![cars[1], cars[2], cars[0]];
    let found = read(&third).unwrap();
    assert!((mean(&found[0].recording.ego().speed_mps) - 20.0).abs() < 1e-6);
    assert!((gap_m(&found[0].recording, 0) - 36.0).abs() < 1e-6);
    let error = read(&|_| cars[1..].to_vec()).unwrap_err();
    assert!(error.contains("`Ego`") && error.contains("A, B"), "{error}");
}

/// What openPASS writes: three lanes, an agent that goes away, and its cells empty from then on.
fn openpass(lanes_driven: usize) -> String {
    let samples = ["VelocityEgo", "XPosition", "YPosition", "YawAngle"];
    let header: Vec<String> =
        (0..4).flat_map(|id| samples.map(|s| format!("{id:02}:{s}"))).collect();
    let mut text = format!("Timestep, {}\n", header.join(", "));
    let y = |lane: usize| -9.0 + 3.75 * lane.min(lanes_driven - 1) as f64;
    for i in 0..600 {
        let t = f64::from(i) / 10.0;
        let ego_y = y(0) + changed(t, 30.0, y(1) - y(0));
        let _ = write!(text, "{}, 30, {:.3}, {ego_y:.6}, 0", 100 * i, 30.0 * t);
        for (lane, ahead) in [(0, 60.0), (1, -20.0), (2, 10.0)] {
            if lane == 1 && i >= 200 {
                text.push_str(", , , , ");
            } else {
                let _ = write!(text, ", 30, {:.3}, {:.3}, 0", 30.0 * t + ahead, y(lane));
            }
        }
        text.push('\n');
    }
    text
}

#[test]
fn openpass_agents_find_their_lanes_where_they_drive_and_go_when_their_cells_are_empty() {
    let found = read(shipped("openpass_cyclics.toml"), "P01_own.csv", &openpass(3)).unwrap();
    let recording = &found[0].recording;
    assert_eq!(found.len(), 1);
    let road = recording.road();
    let lanes = |row: usize| -> Vec<u8> {
        let scene = recording.scene(row).unwrap();
        let ys = std::iter::once(scene.ego.y_m).chain(scene.vehicles.iter().map(|v| v.y_m));
        ys.map(|y| road.nearest_lane(y)).collect()
    };
    assert_eq!(lanes(100), [0, 0, 1, 2]);
    assert_eq!(lanes(1100), [1, 0, 2], "agent 02 is gone");
    let drive = drive_of(&found[0]);
    assert_eq!(drive.lane_changes().len(), 1);
    let error = read(shipped("openpass_cyclics.toml"), "P01_own.csv", &openpass(2)).unwrap_err();
    assert!(error.contains("drove in 2 lanes") && error.contains("expected 3"), "{error}");
}

const WORLD: &str = "[road]\nlanes = 2\nlane_width_m = 3.5\nposted_speed_mps = 30.0\n[table]\nlayout = \"long\"\npoint = \"centre\"\n\
    y_grows = \"left\"\nego = \"me\"\n[table.units]\ntime = \"s\"\nlength = \"m\"\nspeed = \"m/s\"\n[table.columns]\ntime = \"t\"\n\
    x = \"{id}_x\"\ny = \"{id}_y\"\nspeed = \"{id}_v\"\n";

#[test]
fn a_curve_of_several_lanes_needs_no_column_of_lanes() {
    // Half a circle of 500 m to the left; ego on its right lane, who leads it too, and one beside them all the way.
    let radius_m = 500.0;
    let at = |way: f64, left: f64| {
        let (sin, cos) = (way / radius_m).sin_cos();
        ((radius_m - left) * sin, radius_m - (radius_m - left) * cos)
    };
    let points: Vec<String> = (0..=400)
        .map(|i| at(f64::from(i) * 4.0, 0.0))
        .map(|(x, y)| format!("[{x}, {y}]"))
        .collect();
    let mapping = mapping(&format!("centre_line = [{}]\n{WORLD}", points.join(", "))).unwrap();
    let mut text = "t,me_x,me_y,me_v,lead_x,lead_y,lead_v,side_x,side_y,side_v\n".to_owned();
    for i in 0..600 {
        let t = f64::from(i) / 10.0;
        let _ = write!(text, "{t}");
        for (ahead, left) in [(0.0, 0.0), (35.0, 0.0), (5.0, 3.5)] {
            let (x, y) = at(25.0 * t + ahead, left);
            let _ = write!(text, ",{x},{y},25");
        }
        text.push('\n');
    }
    let found = read(mapping, "bend.csv", &text).unwrap().remove(0);
    let drive = drive_of(&found);
    let rows = drive.rows();
    assert!(rows.lane.iter().all(|&lane| lane == 0));
    let gap = |row: usize| rows.lead_dx_m[row];
    for row in [10, 600, 1100] {
        assert!((gap(row) - (35.0 - 4.7)).abs() < 0.05, "{}", gap(row));
    }
    assert!(rows.lead_present.iter().all(|&there| there));
}

#[test]
fn edges_place_lanes_and_keys_that_contradict_them_are_refused() {
    let text = |y: f64| {
        let row = |i: i32| {
            let t = f64::from(i) / 10.0;
            format!("{t},{},{y},20,{},{y},20\n", 20.0 * t, 20.0 * t + 30.0)
        };
        let rows: String = (0..100).map(row).collect();
        format!("t,me_x,me_y,me_v,other_x,other_y,other_v\n{rows}")
    };
    let with = |keys: &str| {
        mapping(&format!("{keys}\n{}", WORLD.replacen("[road]\n", "[road]\nframe = \"map\"\n", 1)))
    };
    let edges = with("lane_edges_m = [-8.0, -5.0, -1.0]").unwrap();
    let lane = |y: f64| {
        let found = read(edges.clone(), "a.csv", &text(y)).unwrap().remove(0);
        found.recording.road().nearest_lane(found.recording.ego().y_m[50])
    };
    assert_eq!((lane(-6.5), lane(-4.6)), (0, 1));
    for (keys, words) in [
        ("lane_edges_m = [1.0, 2.0]", "has 2 numbers, expected 3"),
        ("lane_edges_m = [3.0, 2.0, 1.0]", "rising"),
        ("lane_edges_m = [1.0, 2.0, 3.0]\nlanes_driven = true", "only one of"),
    ] {
        let error = with(keys).unwrap_err();
        assert!(error.contains(words), "{keys}: {error}");
    }
    let unknown = WORLD.replace("ego = \"me\"", "ego = \"you\"");
    let error = read(mapping(&unknown).unwrap(), "a.csv", &text(0.0)).unwrap_err();
    assert!(error.contains("`you`") && error.contains("me, other"), "{error}");
    for (from, to, words) in [
        ("y = \"{id}_y\"", "y = \"side\"", "expected a name with `{id}`"),
        ("time = \"t\"", "time = \"t\"\nid = \"name\"", "as in `x`, or no `id`"),
        ("x = \"{id}_x\"", "x = \"x\"", "`{id}`"),
        ("\"centre\"", "\"reference\"", "centre_ahead_m"),
    ] {
        let error = mapping(&WORLD.replace(from, to)).unwrap_err();
        assert!(error.contains(words), "{to}: {error}");
    }
    let missing = text(0.0).replace("other_y", "other_side");
    let error = read(mapping(WORLD).unwrap(), "a.csv", &missing).unwrap_err();
    assert!(error.contains("`other_y`"), "{error}");
}

#[test]
fn times_of_day_and_dates_are_proposed_as_they_are_written_and_doubtful_ones_are_not() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.csv");
    let proposed = |time: &dyn Fn(u32) -> String| {
        let row = |i: u32| {
            let v = 20.0 + (0.01 * f64::from(i)).sin();
            format!("{},{v},{},{v}\n", time(i), 30.0 + 0.01 * f64::from(i))
        };
        let rows: String = (0..600).map(row).collect();
        let header = "Time,speed [m/s],gap [m],lead speed [m/s]\n";
        std::fs::write(&path, format!("{header}{rows}")).unwrap();
        suggest_mapping(&path).map_err(|e| e.to_string())
    };
    let clock = |i: u32| format!("08:{:02}:{:02}.{}", i / 600, i / 10 % 60, i % 10);
    for (date, pattern) in [
        ("", "%H:%M:%S.%f"),
        ("20220702 ", "%Y%m%d %H:%M:%S.%f"),
        ("2.7.2022 ", "%d.%m.%Y %H:%M:%S.%f"),
    ] {
        let found = proposed(&|i| format!("{date}{}", clock(i))).unwrap();
        assert!(
            found.contains(&format!("time_pattern = \"{pattern}\"\n"))
                && found.contains("time = \"pattern\"")
                && found.contains("\nlength = \"m\"\nspeed = \"m/s\"\n")
                && found.contains("Read by it: 1 drive"),
            "{found}"
        );
    }
    let iso = proposed(&|i| format!("2022-07-02T{}Z", clock(i))).unwrap();
    assert!(iso.contains("time = \"iso8601\"") && iso.contains("Read by it: 1 drive"), "{iso}");
    let month_or_day = proposed(&|i| format!("02/07/2022 {}", clock(i))).unwrap_err();
    assert!(month_or_day.contains("a time was not found"), "{month_or_day}");
}
