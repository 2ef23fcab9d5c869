//! A rig that writes a folder a drive: several files of blanks and numbers, without headers, at several rates.

use super::mapped::{drive_of, of_toml, settings, shipped};
use maveric_domain::{Drive, Sees, drive::Direction};
use maveric_ingest::{
    IngestError, Ingested, Layout, Mapping, Provenance, WarningKind, inspect_with, log_files,
    read_drive_from, read_log, write_drive_to,
};
use std::{fmt::Write as _, path::PathBuf};

/// Seconds that the drive takes.
const SECONDS: u32 = 90;
/// Where in its folder the drive lies.
const DRIVE: &str = "D7/20300101-25km-D7-NORMAL-MOTORWAY";
const FILES: [&str; 5] = [
    "RAW_GPS.txt",
    "PROC_VEHICLE_DETECTION.txt",
    "PROC_LANE_DETECTION.txt",
    "EVENTS_LIST_LANE_CHANGES.txt",
    "PROC_OPENSTREETMAP_DATA.txt",
];

fn uah() -> Mapping {
    shipped("uah.toml")
}

/// A folder of drives.
struct Rig(tempfile::TempDir);

impl Rig {
    /// 90 s at 108 km/h behind somebody at 100 km/h, 60 m ahead, whom the camera loses between 20 and 30 s; out to the left at 40 s,
    /// where somebody drives 30 m ahead as fast as ego, and back at 60 s. Where ego changes lanes the estimator has lost the markings.
    fn new() -> Self {
        let rig = Self(tempfile::tempdir().unwrap());
        std::fs::create_dir_all(rig.drive()).unwrap();
        let [mut gps, mut lead, mut lane] = [(); 3].map(|()| String::new());
        for s in 0..=SECONDS {
            let t = f64::from(s) + 5.0;
            writeln!(gps, "{t:.2} 108.0 40.5 -3.3 600.1 4 5 270.0 1 0 0 0 ").unwrap();
        }
        for i in 0..=5 * SECONDS {
            let s = f64::from(i) / 5.0;
            let gap = match s {
                20.0..30.0 | 60.0.. => -1.0,
                40.0..60.0 => 30.0,
                _ => 60.0 - s * 8.0 / 3.6 + if s < 20.0 { 0.0 } else { 30.0 },
            };
            writeln!(lead, "{:.2} {gap:.2} -1.00 1 108.0 ", s + 5.0).unwrap();
        }
        for i in 0..=10 * SECONDS {
            let s = f64::from(i) / 10.0;
            let lost = [40.0, 60.0].iter().any(|c| (s - c).abs() < 1.0);
            let row = if lost {
                "0.00 0.0 3.5 0"
            } else {
                "0.30 0.0 3.5 2"
            };
            writeln!(lane, "{:.2} {row}", s + 5.0).unwrap();
        }
        let changes = "45.00 -1 40.5 -3.3 1.0 1.5\n65.00 1 40.5 -3.3 1.0 1.5\n";
        let road = "5.50 -1.0 2 - -1 1 40.5 -3.3 1.0 108\n7.00 120.0 1 motorway 3 1 40.5 -3.3 1.0 108\n\
                    80.00 90.0 1 motorway_link 2 1 40.5 -3.3 1.0 108\n90.00 90.0 1 motorway_link 2 1 40.5 -3.3 1.0 108\n";
        for (name, text) in FILES.iter().zip([&gps, &lead, &lane, changes, road]) {
            rig.write(name, text);
        }
        rig
    }

    fn drive(&self) -> PathBuf {
        self.0.path().join(DRIVE)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.drive().join(name), text).unwrap();
    }

    fn text(&self, name: &str) -> String {
        std::fs::read_to_string(self.drive().join(name)).unwrap()
    }

    /// Puts a line in the place of one, counted from 1.
    fn line(&self, name: &str, number: usize, line: &str) {
        let text = self.text(name);
        let mut lines: Vec<&str> = text.lines().collect();
        lines[number - 1] = line;
        self.write(name, &(lines.join("\n") + "\n"));
    }

    fn read(&self) -> Result<Ingested, IngestError> {
        Ok(read_log(&self.drive(), &settings(uah()))?.remove(0))
    }

    fn error(&self) -> String {
        self.read().unwrap_err().to_string()
    }
}

/// Lines as a text.
fn lines<T: std::fmt::Display>(lines: impl Iterator<Item = T>) -> String {
    let mut text = String::new();
    for line in lines {
        writeln!(text, "{line}").unwrap();
    }
    text
}

fn said(found: &Ingested, kind: WarningKind) -> Vec<&str> {
    let of_kind = found.warnings.iter().filter(|w| w.kind == kind);
    of_kind.map(|w| w.what.as_str()).collect()
}

fn row_at(drive: &Drive, seconds: f64) -> usize {
    let times = &drive.rows().time_s;
    times.iter().position(|t| *t >= seconds - 1e-6).unwrap()
}

#[test]
fn a_folder_of_files_at_several_rates_is_one_drive_named_by_its_folder() {
    let rig = Rig::new();
    let logs = log_files(rig.0.path(), Some(&uah())).unwrap();
    assert_eq!(logs, [rig.drive()]);
    let found = rig.read().unwrap();
    let meta = &found.meta;
    assert_eq!(meta.drive.as_str(), "D7-NORMAL-MOTORWAY");
    assert_eq!(meta.participant.as_str(), "D7");
    assert_eq!(meta.condition.as_str(), "normal_motorway");
    let names: Vec<&str> = found.sources.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names.len(), 5, "{names:?}");
    let drive = drive_of(&found);
    let road = drive.road();
    assert_eq!(road.lanes, 3);
    assert!((road.posted_speed_mps - 120.0 / 3.6).abs() < 1e-9);
    let choices = said(&found, WarningKind::Choice);
    assert!(
        choices
            .iter()
            .any(|w| w.contains("posted speed changes") && w.contains("25.00 m/s")),
        "{choices:?}"
    );
    let rows = drive.rows();
    assert!(rows.ego_speed_mps.iter().all(|v| (v - 30.0).abs() < 1e-9));
    // Held by the slope of the gap, once a second-long window lies within the sight.
    let row = row_at(&drive, 10.0);
    assert!(
        (rows.lead_dx_m[row] - (60.0 - 80.0 / 3.6)).abs() < 0.1,
        "{}",
        rows.lead_dx_m[row]
    );
    assert!(
        (rows.lead_speed_mps[row] - 100.0 / 3.6).abs() < 0.05,
        "{}",
        rows.lead_speed_mps[row]
    );
}

#[test]
fn whoever_leaves_the_view_or_is_in_another_lane_is_another_vehicle_or_none() {
    let found = Rig::new().read().unwrap();
    let drive = drive_of(&found);
    let rows = drive.rows();
    let present = |s: f64| rows.lead_present[row_at(&drive, s)];
    assert!(present(10.0) && !present(25.0) && present(35.0) && present(50.0) && !present(70.0));
    let id = |s: f64| rows.lead_id[row_at(&drive, s)];
    assert_ne!(id(10.0), id(35.0), "not seen for ten seconds");
    assert_ne!(id(35.0), id(50.0), "ahead in another lane");
    let ahead = rows.lead_dx_m.iter().zip(&rows.lead_present);
    assert!(
        ahead.filter(|(_, p)| **p).all(|(dx, _)| *dx > 0.0),
        "nobody is passed"
    );
}

#[test]
fn a_listed_change_is_a_change_and_the_place_in_the_lane_is_where_it_was_seen() {
    let found = Rig::new().read().unwrap();
    let drive = drive_of(&found);
    let changes: Vec<(Direction, f64)> = drive
        .lane_changes()
        .iter()
        .map(|c| (c.direction, drive.rows().time_s[c.start]))
        .collect();
    assert_eq!(changes.len(), 2, "{changes:?}");
    assert_eq!(
        (changes[0].0, changes[1].0),
        (Direction::Left, Direction::Right)
    );
    assert!(
        (changes[0].1 - 39.0).abs() < 0.5 && (changes[1].1 - 59.0).abs() < 0.5,
        "{changes:?}"
    );
    let rows = drive.rows();
    let y = |s: f64| rows.ego_y_m[row_at(&drive, s)];
    // The place grows to the right, y to the left.
    assert!(
        (y(10.0) + 0.3).abs() < 1e-6 && (y(50.0) - 3.2).abs() < 1e-6,
        "{} {}",
        y(10.0),
        y(50.0)
    );
    let lanes: Vec<u8> = [10.0, 50.0, 80.0]
        .map(|s| rows.lane[row_at(&drive, s)])
        .into();
    assert_eq!(lanes, [0, 1, 0]);
}

#[test]
fn the_signals_of_a_table_with_lane_and_place_in_it_are_read_as_those_of_a_folder() {
    let toml = "[road]\nlanes = 2\nlane_width_m = 3.5\nposted_speed_mps = 30.0\nframe = \"map\"\n[table]\nlayout = \"signals\"\n\
        gap_kind = \"bumper_to_bumper\"\nlanes_from = \"left\"\n[table.units]\ntime = \"s\"\nlength = \"m\"\nspeed = \"m/s\"\n\
        [table.signals.speed]\ntime = \"t\"\nvalue = \"v\"\n[table.signals.lead]\ntime = \"t\"\ngap = \"gap\"\nspeed = \"lead\"\n\
        [table.signals.lane]\ntime = \"t\"\nnumber = \"lane\"\noffset = \"offset\"\noffset_grows = \"left\"\n";
    let mut text = "t,v,gap,lead,lane,offset\n".to_owned();
    for i in 0..1000 {
        let t = f64::from(i) / 10.0;
        let (lane, offset) = match t {
            ..30.0 => (2, 0.2),
            30.0..31.0 => (2, 0.2 + 1.4 * (t - 30.0)),
            31.0..32.0 => (1, -1.6 + 1.4 * (t - 31.0)),
            _ => (1, -0.2),
        };
        let gap = if t < 50.0 { "40,28" } else { "," };
        writeln!(text, "{t},30,{gap},{lane},{offset}").unwrap();
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("P01.csv");
    std::fs::write(&path, text).unwrap();
    let settings = settings(of_toml(toml).unwrap());
    assert_eq!(
        log_files(folder.path(), settings.mapping.as_ref()).unwrap(),
        std::slice::from_ref(&path)
    );
    let found = read_log(&path, &settings).unwrap().remove(0);
    let drive = drive_of(&found);
    let rows = drive.rows();
    let at = |s: f64| row_at(&drive, s);
    assert!(
        (rows.ego_y_m[at(10.0)] - 0.2).abs() < 1e-9 && (rows.ego_y_m[at(60.0)] - 3.3).abs() < 1e-9
    );
    assert_eq!(drive.lane_changes().len(), 1);
    assert!(
        (rows.lead_dx_m[at(10.0)] - 40.0).abs() < 1e-9
            && (rows.lead_speed_mps[at(10.0)] - 28.0).abs() < 1e-9
    );
    assert!(!rows.lead_present[at(60.0)]);
    let summary = inspect_with(&path, &settings).unwrap();
    let meaning = |name: &str| {
        let column = summary.columns.iter().find(|c| c.name == name);
        column.and_then(|c| c.meaning.clone())
    };
    assert_eq!(meaning("offset").as_deref(), Some("offset"));
}

#[test]
fn a_file_that_is_missing_is_named_whichever_it_is() {
    for name in FILES {
        let rig = Rig::new();
        std::fs::remove_file(rig.drive().join(name)).unwrap();
        assert_eq!(
            log_files(rig.0.path(), Some(&uah())).unwrap(),
            [rig.drive()],
            "{name}"
        );
        let error = rig.error();
        assert!(error.contains("no file") && error.contains(name), "{error}");
    }
}

#[test]
fn a_row_of_too_few_cells_and_a_word_among_numbers_are_named_by_file_and_row() {
    for (name, number, line, parts) in [
        (
            "RAW_GPS.txt",
            7,
            "11.00 108.0",
            "row 7 has 2 cells, expected 12",
        ),
        (
            "PROC_VEHICLE_DETECTION.txt",
            9,
            "6.60",
            "row 9 has 1 cell, expected 5",
        ),
        (
            "PROC_LANE_DETECTION.txt",
            3,
            "5.20 0.3 0.0 3.5 2 7",
            "row 3 has 6 cells, expected 5",
        ),
        (
            "EVENTS_LIST_LANE_CHANGES.txt",
            2,
            "65.00 back 40.5 -3.3 1.0 1.5",
            "row 2 column `2` holds `back`, expected one of `-1`",
        ),
        (
            "RAW_GPS.txt",
            4,
            "8.00 fast 40.5 -3.3 600.1 4 5 270.0 1 0 0 0",
            "row 4 column `2` holds `fast`",
        ),
    ] {
        let rig = Rig::new();
        rig.line(name, number, line);
        let error = rig.error();
        assert!(error.contains(name) && error.contains(parts), "{error}");
    }
}

#[test]
fn a_posted_speed_of_nothing_is_refused_unless_the_mapping_says_what_it_stands_for() {
    let rig = Rig::new();
    let row = "7.00 0.0 1 motorway 3 1 40.5 -3.3 1.0 108";
    rig.line("PROC_OPENSTREETMAP_DATA.txt", 2, row);
    let mut mapping = uah();
    let Layout::Signals(tables) = &mut mapping.table.as_mut().unwrap().layout else {
        panic!("uah.toml is of another layout");
    };
    tables.signals.road.as_mut().unwrap().missing = vec![-1.0];
    let error = read_log(&rig.drive(), &settings(mapping))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("PROC_OPENSTREETMAP_DATA.txt row 2 column `2` holds `0`")
            && error.contains("`missing`"),
        "{error}"
    );
    // The other rows say 90 km/h then.
    let found = rig.read().unwrap();
    assert!((found.recording.road().posted_speed_mps - 25.0).abs() < 1e-9);
    for number in 1..=4 {
        rig.line(
            "PROC_OPENSTREETMAP_DATA.txt",
            number,
            &format!("{number}.00 -1.0 1 - -1 1 40.5 -3.3 1.0 108"),
        );
    }
    let found = rig.read().unwrap();
    assert_eq!(
        said(&found, WarningKind::Default)
            .iter()
            .filter(|w| w.contains("no row says"))
            .count(),
        2
    );
}

#[test]
fn times_that_go_back_are_refused_by_row_and_rows_written_twice_are_left_out() {
    for (name, number) in [("RAW_GPS.txt", 30), ("PROC_LANE_DETECTION.txt", 200)] {
        let rig = Rig::new();
        let text = rig.text(name);
        let early = text.lines().nth(2).unwrap().replacen("270.0", "271.0", 1);
        let early = early.replacen("0.30", "0.31", 1);
        rig.line(name, number, &early.replacen("108.0", "107.0", 1));
        let error = rig.error();
        assert!(
            error.contains(name)
                && error.contains(&format!("row {number} column `1`"))
                && error.contains("not before"),
            "{error}"
        );
    }
    let rig = Rig::new();
    let text = rig.text("RAW_GPS.txt");
    let again: Vec<&str> = text.lines().skip(80).collect();
    rig.write("RAW_GPS.txt", &format!("{text}{}\n", again.join("\n")));
    let found = rig.read().unwrap();
    let twice = found
        .warnings
        .iter()
        .find(|w| w.kind == WarningKind::DuplicateTime)
        .unwrap();
    assert_eq!(
        (twice.count, twice.what.as_str()),
        (10, "rows that repeat one above are left out")
    );
    assert_eq!(found.recording, Rig::new().read().unwrap().recording);
}

#[test]
fn a_drive_without_anybody_ahead_without_lanes_or_of_half_a_minute_is_read_and_told() {
    let rig = Rig::new();
    let none = rig.text("PROC_VEHICLE_DETECTION.txt");
    let time = |l: &str| l.split(' ').next().unwrap().to_owned();
    let none = lines(none.lines().map(|l| time(l) + " -1.00 -1.00 0 108.0"));
    rig.write("PROC_VEHICLE_DETECTION.txt", &none);
    let found = rig.read().unwrap();
    assert!(drive_of(&found).rows().lead_present.iter().all(|p| !p));
    assert!(
        said(&found, WarningKind::NoOverlap).contains(&"nobody was seen ahead in the whole drive")
    );

    let rig = Rig::new();
    let lost = rig
        .text("PROC_LANE_DETECTION.txt")
        .replace("0.30 0.0 3.5 2", "-9 -9 -9 -9");
    rig.write("PROC_LANE_DETECTION.txt", &lost);
    rig.write("EVENTS_LIST_LANE_CHANGES.txt", "");
    let found = rig.read().unwrap();
    let drive = drive_of(&found);
    assert!(drive.lane_changes().is_empty() && drive.rows().ego_y_m.iter().all(|y| y.abs() < 1e-9));
    assert!(
        said(&found, WarningKind::Default)
            .iter()
            .any(|w| w.contains("no row says the place in the lane"))
    );

    let rig = Rig::new();
    let half = lines(rig.text("RAW_GPS.txt").lines().take(31));
    rig.write("RAW_GPS.txt", &half);
    let found = rig.read().unwrap();
    assert!((drive_of(&found).rows().time_s.last().unwrap() - 30.0).abs() < 0.1);
    assert!(said(&found, WarningKind::Noted)[0].contains("30.0 s long, shorter than 60 s"));
}

#[test]
fn what_the_camera_did_not_look_at_is_a_hole() {
    let rig = Rig::new();
    let seen = rig.text("PROC_VEHICLE_DETECTION.txt");
    let without =
        lines(seen.lines().filter(|l| {
            !(75.0..80.0).contains(&l.split(' ').next().unwrap().parse::<f64>().unwrap())
        }));
    rig.write("PROC_VEHICLE_DETECTION.txt", &without);
    let found = rig.read().unwrap();
    let rows = drive_of(&found).rows().clone();
    assert!(rows.time_s.iter().all(|t| !(70.1..74.9).contains(t)));
    assert_eq!(rows.segment.last(), Some(&1));
}

#[test]
fn what_the_rig_sees_is_what_its_signals_show_unless_the_mapping_says_it_and_is_kept_with_the_drive()
 {
    let rig = Rig::new();
    let camera: Sees = "ahead lanes".parse().unwrap();
    let found = rig.read().unwrap();
    assert_eq!(found.recording.sees(), camera);
    let summary = inspect_with(&rig.drive(), &settings(uah())).unwrap();
    assert_eq!(summary.sees, Some(camera));
    assert!(
        summary.would_ingest.ends_with("the rig sees: ahead lanes"),
        "{}",
        summary.would_ingest
    );
    let path = rig.0.path().join("D7.parquet");
    let kept = |drive: &Drive| {
        let file = std::fs::File::create(&path).unwrap();
        write_drive_to(
            file,
            drive,
            &Provenance {
                entries: Vec::new(),
            },
        )
        .unwrap();
        read_drive_from(&path).unwrap().0
    };
    let drive = drive_of(&found);
    assert_eq!(kept(&drive), drive);
    // As older files are, which say nothing.
    let all = drive.seen_by(Sees::ALL);
    assert_eq!(kept(&all).sees(), Sees::ALL);
    let bytes = std::fs::read(&path).unwrap();
    assert!(!bytes.windows(12).any(|w| w == b"maveric.sees"));

    let mut mapping = uah();
    mapping.sees.behind = Some(true);
    mapping.sees.lanes = Some(false);
    let found = read_log(&rig.drive(), &settings(mapping))
        .unwrap()
        .remove(0);
    assert_eq!(found.recording.sees(), "ahead behind".parse().unwrap());
    assert!(
        drive_of(&found).lane_changes().is_empty(),
        "without lanes no lane changes"
    );
}

#[test]
fn keys_of_signals_that_contradict_each_other_are_refused_with_what_to_do() {
    let text = uah().to_toml();
    let of = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}\n{text}");
        let changed = text.replacen(from, to, 1);
        of_toml(&changed).unwrap_err().to_string()
    };
    for (from, to, says) in [
        ("offset_grows = \"right\"\n", "", "together"),
        (
            "file = \"RAW_GPS.txt\"\n",
            "",
            "name the file of each, or of none",
        ),
        ("left = [\"-1\"", "left = [\"1\"", "expected one of them"),
        (
            "offset = \"2\"",
            "offset = \"2\"\nnumber = \"3\"",
            "give one of them",
        ),
        ("max_gap_s = 1.5", "max_gap_s = 0.0", "`max_gap_s`"),
        ("gap_kind = \"bumper_to_bumper\"\n", "", "`table.gap_kind`"),
        ("lanes_from = \"right\"\n", "", "`table.lanes_from`"),
    ] {
        let error = of(from, to);
        assert!(error.contains(says), "{error}");
    }
}
