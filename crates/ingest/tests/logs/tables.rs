//! Tables of pairs, made up.

use super::mapped::{UNITS, drive_of, mapped, of_toml, read_named, shipped};
use maveric_domain::Recording;
use maveric_ingest::{IngestError, Ingested, Mapping, WarningKind};
use std::path::Path;

fn of_text(text: &str) -> Result<Ingested, IngestError> {
    let found = read_named("oa_pair_run_f2_Car.csv", text, shipped("openacc.toml"));
    found.map(|mut found| found.remove(0))
}

const HEADER: &str = "t,x_follower,v_follower,x_leader,v_leader,leader_length,spacing\n";

/// First gap between bumpers, in m.
fn first_gap_m(recording: &Recording) -> f64 {
    let scene = recording.scene(0).unwrap();
    maveric_domain::scene::bumper_distance_m(&scene.ego, &scene.vehicles[0])
}

#[test]
fn a_cell_that_is_no_number_is_named_and_an_empty_one_is_counted() {
    let bad = of_text(&format!("{HEADER}0,0,1,9,1,0,9\n0.1,0.1,fast,9,1,0,9\n")).unwrap_err();
    let text = bad.to_string();
    assert!(text.contains("row 2") && text.contains("v_follower") && text.contains("`fast`"));

    let found = of_text(&format!(
        "{HEADER}0,0,1,9,1,0,9\n0.1,,1,9,1,0,9\n0.2,0.2,1,9,NaN,0,9\n0.3,0.3,1,9,1,0,9\n"
    ))
    .unwrap();
    assert_eq!(found.recording.rows(), 4, "a dropout of 0.2 s is bridged");
    let counts: Vec<(WarningKind, usize)> =
        found.warnings.iter().map(|w| (w.kind, w.count)).collect();
    // The leader's length of 0 is unknown.
    let missing = (WarningKind::MissingValue, 1);
    assert_eq!(counts, [(WarningKind::Default, 2), missing, missing]);
}

#[test]
fn an_unknown_column_is_named_with_the_nearest_one() {
    let error = of_text("t,x_follower,v_folower,v_leader,leader_length,spacing\n0,0,1,1,0,9\n");
    let error = error.unwrap_err();
    assert!(matches!(&error, IngestError::UnknownColumn { column, .. } if column == "v_follower"));
    assert!(error.suggestion().unwrap().contains("`v_folower`"));
}

#[test]
fn a_separator_that_is_not_the_tables_is_the_matter_where_one_column_holds_all_names() {
    let mut mapping = shipped("openacc.toml");
    mapping.table.as_mut().unwrap().separator = Some(';');
    let table = format!("{HEADER}0,0,1,9,1,0,9\n");
    let error = read_named("oa_pair_run_f2_Car.csv", &table, mapping).unwrap_err();
    let help = error.suggestion().unwrap();
    assert!(help.contains("`separator`"), "{error}: {help}");
    let error = of_text("t,x_follower\n0,0\n").unwrap_err();
    let help = error.suggestion().unwrap();
    assert!(!help.contains("`separator`"), "{error}: {help}");
}

#[test]
fn a_table_without_rows_or_with_one_is_refused() {
    assert!(matches!(of_text(HEADER), Err(IngestError::BadTable { .. })));
    let one = of_text(&format!("{HEADER}0,0,1,9,1,0,9\n"));
    assert!(matches!(one, Err(IngestError::TooSparse { samples: 1, .. })));
}

#[test]
fn a_hole_in_a_table_starts_a_segment() {
    let found = of_text(&format!(
        "{HEADER}0,0,1,9,1,0,9\n0.1,0,1,9,1,0,9\n3,3,1,9,1,0,9\n3.1,3,1,9,1,0,9\n"
    ))
    .unwrap();
    assert_eq!(found.recording.segment(), [0, 0, 1, 1]);
    let hole = found.warnings.iter().find(|w| w.kind == WarningKind::Hole).unwrap();
    assert_eq!(hole.spans_s, [(0.1, 3.0)]);
    assert_eq!(found.recording.others().len(), 2);
}

#[test]
fn a_quote_that_is_never_closed_is_named_by_its_row() {
    let head = "t,x_follower,v_follower,v_leader,leader_length,spacing\n";
    let row = |i: u32| format!("{},{},20,20,4,26\n", f64::from(i) / 10.0, 2 * i);
    let whole = head.to_owned() + &(0..5).map(row).collect::<String>();
    for (text, named) in [
        // As a file that was cut behind a quote ends: found by fuzzing.
        (format!("{whole}0.5,10,\""), "row 6"),
        (format!("{whole}0.5,10,\"20"), "row 6"),
        (whole.replace("0.2,4,20", "0.2,\"4,20"), "row 3"),
    ] {
        let error = of_text(&text).unwrap_err();
        assert!(
            error.to_string().contains(named) && error.to_string().contains("quote"),
            "{error}"
        );
    }
    let quoted = whole.replace("0.2,4,20", "\"0.2\",\"4\",20");
    let (found, plain) = (of_text(&quoted).unwrap(), of_text(&whole).unwrap());
    assert_eq!(found.recording, plain.recording);
}

const PAIR: &str = "[table]\nlayout = \"pair\"\n";

/// A minute at 10 Hz: each row by its number and time.
fn minute(header: &str, row: impl Fn(usize, f64) -> String) -> String {
    let rows = (0..600).map(|i| row(i, i as f64 / 10.0) + "\n");
    format!("{header}\n{}", rows.collect::<String>())
}

#[test]
fn a_gap_of_the_wrong_kind_is_counted_and_refused_where_it_is_most_of_them() {
    let columns =
        "[table.columns]\ntime = \"t\"\nego_speed = \"v\"\ngap = \"gap\"\nlead_speed = \"w\"\n";
    let mapping = format!("{PAIR}gap_kind = \"front_to_front\"\n{UNITS}{columns}");
    let table = |short: usize| {
        minute("t,v,gap,w", |i, t| format!("{t},20,{},20", if i < short { 3 } else { 30 }))
    };
    let found = mapped(&mapping, &table(60)).unwrap().remove(0);
    let warning = found.warnings.iter().find(|w| w.what.contains("within ego"));
    assert_eq!(warning.unwrap().count, 60);
    let error = mapped(&mapping, &table(300)).unwrap_err().to_string();
    assert!(error.contains("in 300 of 600 samples gaps to the leader are negative"), "{error}");
    let fast = minute("t,v,gap,w", |_, t| format!("{t},20,30,100"));
    let error = mapped(&mapping, &fast).unwrap_err().to_string();
    assert!(error.contains("speeds of others are above 90 m/s"), "{error}");
}

#[test]
fn keys_that_do_nothing_are_refused_by_name() {
    let columns =
        "[table.columns]\ntime = \"t\"\nego_speed = \"v\"\ngap = \"gap\"\nlead_speed = \"w\"\n";
    for (key, said) in [
        ("directions = \"both\"", "unknown field `directions`, expected one of `forward`"),
        ("y_grows = \"left\"", "unknown field `y_grows`, expected one of `forward`"),
        (
            "new_vehicle_after_s = 2.0",
            "unknown field `new_vehicle_after_s`, expected one of `forward`",
        ),
        ("point = \"front\"", "`table.point`"),
        ("frames_per_s = 25.0", "`table.frames_per_s`"),
    ] {
        let mapping = format!("{PAIR}gap_kind = \"bumper_to_bumper\"\n{key}\n{UNITS}{columns}");
        let error = of_toml(&mapping).unwrap_err();
        assert!(error.to_string().contains(said), "{error}");
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../study_data/mappings");
    for entry in std::fs::read_dir(folder).unwrap() {
        Mapping::read(&entry.unwrap().path()).unwrap();
    }
}

#[test]
fn a_leader_numbered_0_is_a_leader_where_vehicles_are_counted_from_0() {
    let columns = "[table.columns]\ntime = \"t\"\nid = \"id\"\nx = \"x\"\nspeed = \"v\"\nlead_id = \"lead\"\n";
    let mapping = format!("[table]\nlayout = \"long\"\npoint = \"centre\"\n{UNITS}{columns}");
    let leads = |first: &str| {
        let row = |_: usize, t: f64| {
            format!("{t},{first},{},20,-1\n{t},car,{},20,{first}", 30.0 + 20.0 * t, 20.0 * t)
        };
        let found = mapped(&mapping, &minute("t,id,x,v,lead", row)).unwrap();
        let follower = found.iter().find(|d| d.recording.ego().x_m[0] == 0.0).unwrap();
        follower.recording.others().iter().map(|o| o.id.0).collect::<Vec<u32>>()
    };
    assert_eq!(leads("0"), [0]);
    assert_eq!(leads("7"), [7]);
    assert_eq!(leads("007").len(), 1);
}

#[test]
fn a_table_that_says_nothing_of_sides_has_no_measures_of_passing() {
    let columns = "[table.columns]\ntime = \"t\"\nego_x = \"x\"\nego_speed = \"v\"\ngap = \"gap\"\nlead_speed = \"w\"\n";
    let mapping = format!("{PAIR}gap_kind = \"signed\"\n{UNITS}{columns}");
    let passing = |slower: f64| {
        let row = |_: usize, t: f64| {
            format!("{t},{},20,{},{}", 20.0 * t, 60.0 - slower * t, 20.0 - slower)
        };
        let found = mapped(&mapping, &minute("t,x,v,gap,w", row)).unwrap().remove(0);
        let said = found.warnings.iter().any(|w| w.what.contains("has no measures"));
        let drive = drive_of(&found);
        (drive.has_lateral(), said)
    };
    assert_eq!(passing(5.0), (false, true));
    assert_eq!(passing(0.0), (true, false));
}

#[test]
fn a_row_that_lost_its_end_is_told_and_one_that_the_end_of_the_file_cuts_is_no_row() {
    let columns =
        "[table.columns]\ntime = \"t\"\nego_speed = \"v\"\ngap = \"gap\"\nlead_speed = \"w\"\n";
    let mapping = format!("{PAIR}gap_kind = \"bumper_to_bumper\"\n{UNITS}{columns}");
    let read = |text: &str| mapped(&mapping, text).unwrap().remove(0);
    let whole = minute("t,v,gap,w", |_, t| format!("{t},19.4,30,20"));
    let found = read(&whole);
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    let said = |found: &Ingested, what: &str| found.warnings.iter().any(|w| w.what.contains(what));
    // As a speed of 19.4 would be cut.
    let cut = read(&(whole.clone() + "60,1"));
    assert_eq!(cut.recording, found.recording);
    assert!(said(&cut, "the last row, 601, ends after 2 of 4 cells"), "{:?}", cut.warnings);
    let lost = read(&whole.replace("\n25,19.4,30,20\n", "\n25,19.4,30\n"));
    assert!(said(&lost, "the first of them row 251 after 3 of 4 cells"), "{:?}", lost.warnings);
}

#[test]
fn a_leader_that_would_stand_at_the_bumper_of_a_car_that_drives_is_nobody() {
    let columns =
        "[table.columns]\ntime = \"t\"\nego_speed = \"v\"\ngap = \"gap\"\nlead_speed = \"w\"\n";
    let mapping = format!("{PAIR}gap_kind = \"bumper_to_bumper\"\n{UNITS}{columns}");
    let read = |ego: f64, leader: &str| {
        let text = minute("t,v,gap,w", |i, t| {
            let leader = if (200..400).contains(&i) { leader } else { "30,20" };
            format!("{t},{ego},{leader}")
        });
        let found = mapped(&mapping, &text).unwrap().remove(0);
        let told = found.warnings.iter().find(|w| w.what.contains("nobody"));
        let drive = drive_of(&found);
        let alone = drive.rows().lead_present.iter().filter(|there| !**there);
        (told.map_or(0, |w| w.count), alone.count() > 300)
    };
    assert_eq!(read(20.0, "0,0"), (200, true));
    // In a queue, and behind a leader that drives or is a little way off.
    assert_eq!(read(0.0, "0,0"), (0, false));
    assert_eq!(read(20.0, "0,20"), (0, false));
    assert_eq!(read(20.0, "0.5,0"), (0, false));
    // From rest: 0 stands for nobody there too, where it does so while ego drives.
    let starts = |until: usize| {
        let text = minute("t,v,gap,w", |i, t| {
            let leader = if i < until { "0,0" } else { "30,20" };
            format!("{t},{},{leader}", (0.125 * i as f64).min(20.0))
        });
        let found = mapped(&mapping, &text).unwrap().remove(0);
        let told = found.warnings.iter().find(|w| w.what.contains("nobody"));
        let drive = drive_of(&found);
        let rows = drive.rows();
        let met = rows.lead_present.iter().zip(&rows.lead_dx_m);
        let at_bumper = met.filter(|(there, dx)| **there && dx.abs() < 0.5).count();
        (told.map_or(0, |w| w.count), at_bumper > 0)
    };
    assert_eq!(starts(200), (200, false));
    // Behind a leader that stands at its bumper until ego starts.
    assert_eq!(starts(10), (0, true));
}

#[test]
fn the_next_step_is_named_where_numbers_have_commas_and_times_another_unit_or_step() {
    let columns =
        "[table.columns]\ntime = \"t\"\nego_speed = \"v\"\ngap = \"gap\"\nlead_speed = \"w\"\n";
    let mapping =
        format!("{PAIR}separator = \";\"\ngap_kind = \"bumper_to_bumper\"\n{UNITS}{columns}");
    let help = |row: &dyn Fn(f64) -> String| {
        let text = minute("t;v;gap;w", |_, t| row(t));
        mapped(&mapping, &text).unwrap_err().suggestion().unwrap()
    };
    let comma = help(&|t| format!("{t};20,5;30;20"));
    assert!(comma.contains("`decimal_comma = true`"), "{comma}");
    for cell in ["fast", "20,5,1", "2.0,5"] {
        let word = help(&|t| format!("{t};{cell};30;20"));
        assert!(!word.contains("decimal_comma"), "{cell}: {word}");
    }
    let in_ms = help(&|t| format!("{};20;30;20", 1000.0 * t));
    assert!(in_ms.contains("another unit"), "{in_ms}");
    let every_second = help(&|t| format!("{};20;30;20", 10.0 * t));
    assert!(every_second.contains("`max_gap_s`"), "{every_second}");
}

#[test]
fn a_simulators_clock_axes_and_gap_are_read_as_they_come() {
    let units = UNITS.replace("time = \"s\"", "time = \"pattern\"").replace("\"m/s\"", "\"km/h\"");
    let columns = "[table.columns]\ntime = \"t\"\nego_x = \"x\"\nego_speed = \"v\"\ngap = \"gap\"\nlead_speed = \"w\"\n";
    let mapping = format!(
        "{PAIR}separator = \"#\"\nforward = \"-x\"\ngap_kind = \"centre_to_centre\"\ntime_pattern = \"%Y%m%d %H:%M:%S:%f\"\n{units}{columns}"
    );
    let row = |i: usize, t: f64| {
        let second = i / 10;
        format!("20220702 18:26:{second:02}:{:04}#{}#72#34.7#72", i % 10 * 1000, 900.0 - 20.0 * t)
    };
    let found = mapped(&mapping, &minute("t#x#v#gap#w", row)).unwrap().remove(0);
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    assert!((first_gap_m(&found.recording) - 30.0).abs() < 1e-9);
    let ego = found.recording.ego();
    assert!((ego.speed_mps[100] - 20.0).abs() < 1e-6);
    assert!((ego.x_m[100] - ego.x_m[0] - 100.0).abs() < 1e-6);
    let bad = mapping.replace("%S:%f", "%f:%S");
    let error = mapped(&bad, "t\n").unwrap_err().to_string();
    assert!(error.contains("`%f` at the end"), "{error}");
}

#[test]
fn sumo_tells_headings_by_the_compass() {
    // To the north-east, one car 30 m behind the other.
    let row = |_: usize, t: f64| {
        let at = |along: f64| {
            let side = along * std::f64::consts::FRAC_1_SQRT_2;
            format!("{side:.6};{side:.6};45.00;DEFAULT_VEHTYPE;20.00")
        };
        format!("{t:.2};lead;{}\n{t:.2};1;{}", at(30.0 + 20.0 * t), at(20.0 * t))
    };
    let header =
        "timestep_time;vehicle_id;vehicle_x;vehicle_y;vehicle_angle;vehicle_type;vehicle_speed";
    let table = minute(header, row);
    let found = read_named("town.csv", &table, shipped("sumo_fcd.toml")).unwrap();
    assert_eq!(found.len(), 2);
    let follower = found.iter().find(|d| d.meta.drive.as_str() == "town-1").unwrap();
    assert!((first_gap_m(&follower.recording) - 25.0).abs() < 0.01);
}

#[test]
fn a_neighbouring_lane_of_sumo_is_not_egos_own() {
    // `b` follows `a` in the right lane, `c` drives in the left one, a lane of 3.2 m further.
    let table = |step_s: f64| {
        let header =
            "timestep_time;vehicle_id;vehicle_x;vehicle_y;vehicle_angle;vehicle_speed".to_owned();
        (0..60).fold(header, |text, i| {
            let t = f64::from(i) * step_s;
            let (a, b, c) = (100.0 + 12.0 * t, 60.0 + 12.0 * t, 70.0 + 12.5 * t);
            text + &format!(
                "\n{t:.2};a;{a:.2};-4.80;90.00;12.00\n{t:.2};b;{b:.2};-4.80;90.00;12.00\n{t:.2};c;{c:.2};-1.60;90.00;12.50"
            )
        }) + "\n"
    };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../study_data/mappings");
    let text = std::fs::read_to_string(folder.join("sumo_fcd.toml")).unwrap();
    let read = |road: &str, step_s: f64, id: &str| {
        let mapping = of_toml(&text.replace("lanes = 1\n", road)).unwrap();
        let found = read_named("town.csv", &table(step_s), mapping).unwrap();
        let name = format!("town-{id}");
        let mut found = found.into_iter();
        found.find(|d| d.meta.drive.as_str() == name).unwrap()
    };
    let said = |found: &Ingested, what: &str| found.warnings.iter().any(|w| w.what.contains(what));
    // SUMO's usual step is a second.
    for step_s in [0.1, 1.0] {
        let follower = read("lanes = 1\n", step_s, "b");
        assert!(!follower.recording.sees().beside);
        assert!(said(&follower, "beside ego's lane are left out"));
        let drive = drive_of(&follower);
        let gaps = &drive.rows().lead_dx_m;
        assert!(gaps.iter().all(|dx| (dx - 35.0).abs() < 0.02), "{gaps:?}");
    }
    let unplaced = read("lanes = 2\n", 0.1, "c");
    assert!(said(&unplaced, "in which of the road's 2 lanes"));
    let road = "lanes = 2\nframe = \"map\"\nright_lane_centre_y_m = -4.8\n";
    let placed = read(road, 0.1, "c");
    assert!(!said(&placed, "in which of the road's 2 lanes"));
    assert!(placed.recording.sees().beside);
    assert!(drive_of(&placed).rows().lane.iter().all(|&lane| lane == 1));
}

#[test]
fn a_car_of_sumo_that_changes_lanes_has_the_leader_of_its_lane_and_is_told() {
    // `c` follows `a`, is behind `d` in the left lane from 20 to 40 s, and goes back.
    let row = |_: usize, t: f64| {
        let (a, d, c) = (100.0 + 12.0 * t, 110.0 + 12.0 * t, 60.0 + 12.0 * t);
        let y = if (20.0..40.0).contains(&t) { -1.6 } else { -4.8 };
        format!(
            "{t:.2};a;{a:.2};-4.80;90.00;12.00\n{t:.2};d;{d:.2};-1.60;90.00;12.00\n{t:.2};c;{c:.2};{y:.2};90.00;12.00"
        )
    };
    let header = "timestep_time;vehicle_id;vehicle_x;vehicle_y;vehicle_angle;vehicle_speed";
    let table = minute(header, row);
    let found = read_named("town.csv", &table, shipped("sumo_fcd.toml")).unwrap();
    let told = |name: &str| {
        let drive = found.iter().find(|d| d.meta.drive.as_str() == name);
        let mut warnings = drive.unwrap().warnings.iter();
        let told = warnings.find(|w| w.what.contains("the road's only lane"));
        told.map_or(0, |w| w.count)
    };
    assert_eq!((told("town-a"), told("town-d")), (0, 0));
    assert_eq!(told("town-c"), 200);
    let changes = found.iter().find(|d| d.meta.drive.as_str() == "town-c");
    let drive = drive_of(changes.unwrap());
    let rows = drive.rows();
    for (time_s, gap_m) in [(10.0, 35.0), (30.0, 45.0), (50.0, 35.0)] {
        let row = rows.time_s.iter().position(|t| *t >= time_s).unwrap();
        assert!(rows.lead_present[row], "{time_s} s");
        let dx_m = rows.lead_dx_m[row];
        assert!((dx_m - gap_m).abs() < 0.02, "{dx_m} m at {time_s} s");
    }
}
