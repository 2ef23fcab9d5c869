//! What a log does not hold is never filled in: order, leaders, holes and what no car can be.

use super::mapped::{UNITS, mapped};
use maveric_ingest::{IngestError, Ingested, WarningKind};

/// A mapping of pairs whose gap is between bumpers: columns by their keys, each of that name.
fn pair(columns: &str) -> String {
    let named = columns.split(' ').map(|c| format!("{c} = \"{c}\"\n"));
    let named: String = named.collect();
    format!(
        "[table]\nlayout = \"pair\"\ngap_kind = \"bumper_to_bumper\"\n{UNITS}[table.columns]\n{named}"
    )
}

fn of_pair(columns: &str, rows: &[String]) -> Result<Ingested, IngestError> {
    let text = format!("{}\n{}\n", columns.replace(' ', ","), rows.join("\n"));
    mapped(&pair(columns), &text).map(|mut drives| drives.remove(0))
}

/// How often a warning says something; 0 where none does.
fn said(found: &Ingested, what: &str) -> usize {
    let fits = found.warnings.iter().find(|w| w.what.contains(what));
    fits.map_or(0, |w| w.count)
}

/// Two minutes at 10 Hz, ego at 20 to 30 m/s behind a leader.
fn drive() -> Vec<String> {
    let row = |i: u32| {
        let t = f64::from(i) / 10.0;
        format!("{t},{},{},25", 25.0 + 5.0 * (0.1 * t).sin(), 30.0 + 0.02 * t)
    };
    (0..1200).map(row).collect()
}

#[test]
fn rows_in_any_order_are_the_drive_that_they_are_in_order_where_each_time_comes_once() {
    let columns = "time ego_speed gap lead_speed";
    let in_order = of_pair(columns, &drive()).unwrap();
    let mut as_text = drive();
    as_text.sort();
    // 7 and 1200 share no divisor: every row comes once.
    let shuffled: Vec<String> = (0..1200).map(|i| drive()[i * 7 % 1200].clone()).collect();
    let parts = [&drive()[600..], &drive()[..600]].concat();
    for rows in [as_text, shuffled, parts] {
        let found = of_pair(columns, &rows).unwrap();
        assert_eq!(found.recording, in_order.recording);
        assert!(said(&found, "out of order and were sorted") > 0);
        let kinds = |k| found.warnings.iter().any(|w| w.kind == k);
        assert!(!kinds(WarningKind::Hole) && !kinds(WarningKind::ClockRestart));
    }
    // Without the leader's speed too.
    let columns = "time ego_speed gap";
    let cut = |rows: Vec<String>| -> Vec<String> {
        let cut = |r: String| r.rsplit_once(',').unwrap().0.to_owned();
        rows.into_iter().map(cut).collect()
    };
    let in_order = of_pair(columns, &cut(drive())).unwrap().recording;
    let back = of_pair(columns, &cut(drive().into_iter().rev().collect())).unwrap();
    assert_eq!(back.recording, in_order);
}

#[test]
fn two_runs_over_the_same_times_are_two_pieces_still() {
    let columns = "time ego_x ego_speed gap lead_speed";
    let run = |from_m: f64, late_s: f64| {
        (0..300).map(move |i| {
            let t = f64::from(i) / 10.0;
            format!("{},{},20,30,20", t + late_s, from_m + 20.0 * t)
        })
    };
    for late_s in [0.0, 0.05] {
        let rows: Vec<String> = run(0.0, 0.0).chain(run(5000.0, late_s)).collect();
        let found = of_pair(columns, &rows).unwrap();
        assert_eq!(said(&found, "the clock was set back"), 1, "{late_s}");
    }
}

/// Ego at 20 m/s behind one leader 30 m ahead for half a minute, then behind another 72 m ahead; both drive at 20 m/s.
fn two_leaders(row: impl Fn(bool) -> String) -> Vec<String> {
    let row = |i: u32| {
        let second = i >= 300;
        let gap = if second { 72 } else { 30 };
        format!("{},20,{gap}{}", f64::from(i) / 10.0, row(second))
    };
    (0..600).map(row).collect()
}

#[test]
fn a_leaders_speed_is_that_of_its_own_positions() {
    let named = two_leaders(|second| format!(",{}", if second { "b" } else { "a" }));
    let unnamed = two_leaders(|_| String::new());
    for (columns, rows) in [("time ego_speed gap lead_id", named), ("time ego_speed gap", unnamed)]
    {
        let found = of_pair(columns, &rows).unwrap();
        let tracks = found.recording.others();
        assert_eq!(tracks.len(), 2, "{columns}");
        for v in tracks.iter().flat_map(|t| &t.speed_mps) {
            assert!((v - 20.0).abs() < 1e-6, "{columns}: {v} m/s");
        }
    }
}

#[test]
fn each_leader_is_as_long_as_it_is() {
    let columns = "time ego_speed gap lead_speed lead_length lead_id";
    let tail = |second| {
        if second { ",20,16.5,truck" } else { ",20,4.5,car" }
    };
    let named = two_leaders(|second| tail(second).to_owned());
    let cut = |r: &String| r.rsplit_once(',').unwrap().0.to_owned();
    let unnamed: Vec<String> = named.iter().map(cut).collect();
    for (columns, rows) in [(columns, &named), (columns.rsplit_once(' ').unwrap().0, &unnamed)] {
        let found = of_pair(columns, rows).unwrap();
        let lengths: Vec<f64> = found.recording.others().iter().map(|t| t.length_m).collect();
        assert_eq!(lengths, [4.5, 16.5], "{columns}");
        let gap = |row: usize| {
            let scene = found.recording.scene(row).unwrap();
            maveric_domain::scene::bumper_distance_m(&scene.ego, &scene.vehicles[0])
        };
        let last = found.recording.rows() - 1;
        assert!((gap(0) - 30.0).abs() < 1e-9, "{}", gap(0));
        assert!((gap(last) - 72.0).abs() < 1e-9, "{}", gap(last));
    }
}

#[test]
fn speeds_that_no_car_has_are_holes_named_by_their_rows() {
    let rows = |bad: &'static [u32]| -> Vec<String> {
        let row = move |i: u32| {
            let v = if bad.contains(&i) { 9999 } else { 20 };
            format!("{},{v},30,20", f64::from(i) / 10.0)
        };
        (0..600).map(row).collect()
    };
    let columns = "time ego_speed gap lead_speed";
    let clean = of_pair(columns, &rows(&[])).unwrap();
    let found = of_pair(columns, &rows(&[100, 101, 400])).unwrap();
    let (a, b) = (clean.recording.ego(), found.recording.ego());
    for (a, b) in a.x_m.iter().zip(&b.x_m).chain(a.speed_mps.iter().zip(&b.speed_mps)) {
        assert!((a - b).abs() < 1e-6, "{b} for {a}");
    }
    assert_eq!(said(&found, "speeds of ego are above 90 m/s"), 3);
    assert_eq!(said(&found, "rows 101, 102, 401"), 3);
    // The leader's as well.
    let leader = |i: u32| {
        let w = if i == 7 { -9999 } else { 20 };
        format!("{},20,30,{w}", f64::from(i) / 10.0)
    };
    let found = of_pair(columns, &(0..600).map(leader).collect::<Vec<_>>()).unwrap();
    assert_eq!(said(&found, "rows 8)"), 1);
    for v in found.recording.others().iter().flat_map(|t| &t.speed_mps) {
        assert!((v - 20.0).abs() < 1e-9, "{v}");
    }
}

#[test]
fn a_table_that_drives_against_x_is_asked_which_way_is_forward() {
    let columns = "time ego_x ego_speed gap lead_speed";
    let row = |i: u32| {
        let t = f64::from(i) / 10.0;
        format!("{t},{},20,30,20", 5000.0 - 20.0 * t)
    };
    let rows: Vec<String> = (0..600).map(row).collect();
    let error = of_pair(columns, &rows).unwrap_err().to_string();
    assert!(error.contains("`forward = \"-x\"`"), "{error}");
    let text = format!("{}\n{}\n", columns.replace(' ', ","), rows.join("\n"));
    let told = pair(columns).replace("[table.units]", "forward = \"-x\"\n[table.units]");
    let found = mapped(&told, &text).unwrap().remove(0);
    let x = &found.recording.ego().x_m;
    assert!(x.windows(2).all(|w| w[1] > w[0]));
}

const LONG: &str = "[table]\nlayout = \"long\"\npoint = \"centre\"\ny_grows = \"left\"\n[road]\nlanes = 2\nlane_width_m = 3.5\nposted_speed_mps = 25.0\nright_lane_centre_y_m = 0.0\nframe = \"map\"\n";
const LONG_COLUMNS: &str =
    "[table.columns]\ntime = \"t\"\nid = \"id\"\nx = \"x\"\ny = \"y\"\nspeed = \"v\"\n";

#[test]
fn vehicles_that_are_stamped_one_after_the_other_see_each_other_where_they_are_at_that_time() {
    let mapping = format!("{LONG}{UNITS}{LONG_COLUMNS}");
    let table = |apart_s: f64| {
        let rows = (0..300).flat_map(|i| {
            (0..3).map(move |car| {
                let t = f64::from(i) / 10.0 + apart_s * f64::from(car);
                format!("{t:.4},{car},{:.6},0,20\n", 40.0 * f64::from(car) + 20.0 * t)
            })
        });
        format!("t,id,x,y,v\n{}", rows.collect::<String>())
    };
    for apart_s in [0.0, 0.001, 0.02, 0.049] {
        let found = mapped(&mapping, &table(apart_s)).unwrap();
        assert_eq!(found.len(), 3);
        for drive in &found {
            let recording = &drive.recording;
            for row in 3..recording.rows() - 3 {
                let scene = recording.scene(row).unwrap();
                assert_eq!(scene.vehicles.len(), 2, "{apart_s} s apart, row {row}");
                let mut x: Vec<f64> = scene.vehicles.iter().map(|v| v.x_m).collect();
                x.push(scene.ego.x_m);
                x.sort_by(f64::total_cmp);
                for w in x.windows(2) {
                    assert!((w[1] - w[0] - 40.0).abs() < 1e-3, "{apart_s} s apart: {x:?}");
                }
            }
        }
    }
}

#[test]
fn where_all_others_of_a_table_are_silent_nothing_is_known_of_the_road() {
    let mapping = format!("{LONG}ego = \"0\"\n{UNITS}{LONG_COLUMNS}")
        .replace("y_grows = \"left\"\n[road]", "y_grows = \"left\"\nego = \"0\"\n[road]");
    let mapping = mapping.replacen("frame = \"map\"\nego = \"0\"\n", "frame = \"map\"\n", 1);
    let table = |there: &dyn Fn(i32) -> bool| {
        let rows = (0..600).map(|i| {
            let t = f64::from(i) / 10.0;
            let ego = format!("{t},0,{},0,20\n", 20.0 * t);
            let car = format!("{t},1,{},0,20\n", 40.0 + 20.0 * t);
            ego + if there(i) { &car } else { "" }
        });
        format!("t,id,x,y,v\n{}", rows.collect::<String>())
    };
    let found = mapped(&mapping, &table(&|i| !(200..300).contains(&i))).unwrap().remove(0);
    let recording = &found.recording;
    for row in 0..recording.rows() {
        assert_eq!(recording.scene(row).unwrap().vehicles.len(), 1, "row {row}");
    }
    assert_eq!(recording.segment().last(), Some(&1));
    assert!(said(&found, "the others are not seen") > 0);
    // Once a second is too rarely for any drive.
    let error = mapped(&mapping, &table(&|i| i % 10 == 0)).unwrap_err();
    assert!(error.to_string().contains("the others are seen"), "{error}");
    // Who leaves for good leaves an empty road.
    let found = mapped(&mapping, &table(&|i| i < 200)).unwrap().remove(0);
    assert_eq!(found.recording.segment().last(), Some(&0));
    assert!(found.recording.time_s().last().unwrap() > &59.0);
}

#[test]
fn a_point_in_a_table_of_decimal_commas_is_asked_about() {
    let columns = "time ego_speed gap lead_speed";
    let mapping = pair(columns).replacen("[table]\n", "[table]\ndecimal_comma = true\n", 1);
    let table = |gap: &str| {
        let rows = (0..50).map(|i| format!("{},{};20;{gap};20\n", i / 10, i % 10));
        format!("{}\n{}", columns.replace(' ', ";"), rows.collect::<String>())
    };
    assert!(mapped(&mapping, &table("31,25")).is_ok());
    for gap in ["1.198", "1.198,5", "31.25"] {
        let error = mapped(&mapping, &table(gap)).unwrap_err().to_string();
        let named = error.contains("row 1") && error.contains("`gap`") && error.contains(gap);
        assert!(named && error.contains("decimal comma"), "{error}");
    }
}

#[test]
fn a_time_that_is_none_is_named_as_the_time() {
    let mut rows = drive();
    rows[3] = "soon,20,30,20".to_owned();
    let error = of_pair("time ego_speed gap lead_speed", &rows).unwrap_err().to_string();
    let named = error.contains("row 4") && error.contains("`soon`");
    assert!(named && error.contains("expected a time in s"), "{error}");
}

#[test]
fn speed_lost_for_a_while_is_reported() {
    let columns = "time ego_x ego_speed gap lead_speed";
    let row = |i: u32, ego: f64, lead: f64| {
        let t = f64::from(i) / 10.0;
        format!("{t},{},{ego},30,{lead}", 20.0 * t)
    };
    let lost = |i: u32| if (200..320).contains(&i) { 0.0 } else { 20.0 };
    let read = |row: &dyn Fn(u32) -> String| {
        of_pair(columns, &(0..600).map(row).collect::<Vec<_>>()).unwrap()
    };
    let of_ego = read(&|i| row(i, lost(i), 20.0));
    assert!(said(&of_ego, "speed of ego does not fit its positions") >= 120);
    let of_lead = read(&|i| row(i, 20.0, lost(i)));
    assert_eq!(said(&of_lead, "speed of ego does not fit"), 0);
    assert!(said(&of_lead, "speed of another vehicle does not fit its positions") >= 120);
    assert_eq!(said(&read(&|i| row(i, 20.0, 20.0)), "does not fit its positions"), 0);
}

#[test]
fn row_with_an_unset_time_is_skipped_and_counted() {
    let columns = "time ego_speed gap lead_speed";
    let row = |i: u32| {
        let t = if i == 100 { 0.0 } else { 1_700_000_000.0 + f64::from(i) / 10.0 };
        format!("{t},20,30,20")
    };
    let found = of_pair(columns, &(0..600).map(row).collect::<Vec<_>>()).unwrap();
    assert_eq!(said(&found, "their time is 0 or less"), 1);
    assert_eq!(found.recording.rows(), 1199);
    // Times that begin at 0 are times.
    let from_zero = of_pair(columns, &drive()).unwrap();
    assert_eq!(said(&from_zero, "their time is 0 or less"), 0);
}

#[test]
fn times_of_day_go_on_over_midnight() {
    let columns = "time ego_speed gap lead_speed";
    let pattern = pair(columns).replace("time = \"s\"", "time = \"pattern\"").replacen(
        "[table]\n",
        "[table]\ntime_pattern = \"%H:%M:%S.%f\"\n",
        1,
    );
    // From half a minute before midnight to half a minute behind it.
    let of_day = |i: u32| (86_370 + i / 10) % 86_400;
    let as_text = |i: u32| {
        let s = of_day(i);
        format!("{:02}:{:02}:{:02}.{}", s / 3600, s / 60 % 60, s % 60, i % 10)
    };
    let as_number = |i: u32| format!("{}.{}", of_day(i), i % 10);
    for (mapping, time) in
        [(pattern, &as_text as &dyn Fn(u32) -> String), (pair(columns), &as_number)]
    {
        let row = |i: u32| format!("{},{},30,20\n", time(i), 20.0 + f64::from(i) / 600.0);
        let rows: String = (0..600).map(row).collect();
        let text = format!("{}\n{rows}", columns.replace(' ', ","));
        let found = mapped(&mapping, &text).unwrap().remove(0);
        let recording = &found.recording;
        assert!(recording.time_s().last().unwrap() < &60.0, "{:?}", recording.time_s().last());
        assert_eq!(recording.segment().last(), Some(&0));
        assert!(recording.ego().speed_mps.is_sorted(), "before midnight comes first");
    }
}
