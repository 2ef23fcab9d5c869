//! Plain tables as the scripts in docs/ingest.md write them of UAH-DriveSet and comma2k19. The numbers are synthetic.

use super::mapped::{UNITS, drive_of, mapped, read_named, settings, shipped};
use maveric_domain::{Drive, Sees};
use maveric_ingest::{Provenance, inspect_with, read_drive_from, write_drive_to};
use std::fmt::Write as _;

/// Row of a drive at a time.
fn row_at(drive: &Drive, seconds: f64) -> usize {
    let mut times = drive.rows().time_s.iter();
    times.position(|t| (t - seconds).abs() < 1e-6).unwrap()
}

/// 60 s at 30 m/s behind a vehicle at 28 m/s, 60 m ahead; from 20 s on nobody is ahead, and from 40 s on another vehicle is.
fn rows(time_of: impl Fn(u32) -> f64, count: u32, with_offset: bool) -> String {
    let mut text = String::new();
    for i in 0..count {
        let t = time_of(i);
        let lead = match t {
            ..20.0 => format!("{},1,28.0", 60.0 - 2.0 * t),
            20.0..40.0 => ",,".to_owned(),
            _ => "25.5,2,30.0".to_owned(),
        };
        let offset = match (with_offset, t) {
            (false, _) => "",
            // The camera loses the markings for three seconds.
            (true, 10.0..13.0) => ",",
            (true, _) => ",0.30",
        };
        writeln!(text, "{t:.3},30.0,{lead}{offset}").unwrap();
    }
    text
}

/// Speeds, gaps and who leads of those rows.
fn holds_what_the_rows_say(drive: &Drive) {
    let rows = drive.rows();
    assert!(rows.ego_speed_mps.iter().all(|v| (v - 30.0).abs() < 1e-9));
    for (seconds, gap_m, speed_mps, id) in
        [(0.0, 60.0, 28.0, 1), (9.0, 42.0, 28.0, 1), (50.0, 25.5, 30.0, 2)]
    {
        let row = row_at(drive, seconds);
        assert!((rows.lead_dx_m[row] - gap_m).abs() < 1e-6, "{seconds}");
        assert!((rows.lead_speed_mps[row] - speed_mps).abs() < 1e-6);
        assert_eq!(rows.lead_id[row], Some(id), "{seconds}");
    }
    assert!(!rows.lead_present[row_at(drive, 30.0)]);
    assert!(!drive.sees().lanes && drive.sees().ahead && !drive.sees().behind);
}

#[test]
fn table_of_uah_gives_speed_gap_and_offset() {
    let name = "20300101123124-25km-D7-NORMAL-MOTORWAY.csv";
    let header = "time_s,speed_mps,gap_m,lead,lead_speed_mps,offset_m\n";
    let text = header.to_owned() + &rows(|i| f64::from(i) / 5.0, 301, true);
    let found = read_named(name, &text, shipped("uah.toml")).unwrap();
    let (meta, drive) = (&found[0].meta, drive_of(&found[0]));
    assert_eq!(meta.drive.as_str(), "D7-NORMAL-MOTORWAY");
    assert_eq!(meta.participant.as_str(), "D7");
    assert_eq!(meta.condition.as_str(), "normal_motorway");
    holds_what_the_rows_say(&drive);
    // The script keeps the side of UAH-DriveSet: the place grows to the right, y to the left.
    assert!(drive.rows().ego_y_m.iter().all(|y| (y + 0.3).abs() < 1e-9));
    assert_eq!(drive.rows().segment.iter().max(), Some(&1));
    let without_place = found[0].warnings.iter();
    let counts: Vec<usize> = without_place
        .filter(|w| w.what.starts_with("samples of ego with a value that is not finite"))
        .map(|w| w.count)
        .collect();
    assert_eq!(counts, [15]);
    // Without the column there is no hole.
    let header = "time_s,speed_mps,gap_m,lead,lead_speed_mps\n";
    let text = header.to_owned() + &rows(|i| f64::from(i) / 5.0, 301, false);
    let found = read_named(name, &text, shipped("uah.toml")).unwrap();
    let drive = drive_of(&found[0]);
    holds_what_the_rows_say(&drive);
    assert_eq!(drive.len(), 1201);
}

#[test]
fn table_of_comma2k19_gives_speed_and_gap() {
    let header = "time_s,speed_mps,gap_m,lead,lead_speed_mps\n";
    let body = rows(|i| f64::from(i) / 80.0, 4801, false);
    // Times since the device started.
    let since_start = |line: &str| {
        let (t, rest) = line.split_once(',').unwrap();
        format!("{:.4},{rest}\n", 46_408.0 + t.parse::<f64>().unwrap())
    };
    let text = header.to_owned() + &body.lines().map(since_start).collect::<String>();
    let found = read_named("b0c9_40.csv", &text, shipped("comma2k19.toml")).unwrap();
    assert_eq!(found[0].meta.drive.as_str(), "b0c9_40");
    let drive = drive_of(&found[0]);
    holds_what_the_rows_say(&drive);
    assert_eq!(drive.len(), 1201);
}

#[test]
fn drive_file_keeps_what_the_rig_sees() {
    let folder = tempfile::tempdir().unwrap();
    let table = folder.path().join("b0c9_40.csv");
    let header = "time_s,speed_mps,gap_m,lead,lead_speed_mps\n";
    let text = header.to_owned() + &rows(|i| f64::from(i) / 20.0, 1201, false);
    std::fs::write(&table, &text).unwrap();
    let mapping = shipped("comma2k19.toml");
    let summary = inspect_with(&table, &settings(mapping.clone())).unwrap();
    assert_eq!(summary.sees, Some("ahead".parse().unwrap()));
    assert!(summary.would_ingest.ends_with("the rig sees: ahead"));
    let path = folder.path().join("drive.parquet");
    let kept = |drive: &Drive| {
        let file = std::fs::File::create(&path).unwrap();
        write_drive_to(file, drive, &Provenance::default()).unwrap();
        read_drive_from(&path).unwrap().0
    };
    let mut changed = mapping.clone();
    changed.sees.behind = Some(true);
    let found = read_named("b0c9_40.csv", &text, changed).unwrap();
    assert_eq!(found[0].recording.sees(), "ahead behind".parse().unwrap());
    let drive = drive_of(&found[0]);
    assert_eq!(kept(&drive), drive);
    // A file whose rig sees everything says nothing.
    let all = drive.seen_by(Sees::ALL);
    assert_eq!(kept(&all).sees(), Sees::ALL);
    let bytes = std::fs::read(&path).unwrap();
    assert!(!bytes.windows(12).any(|w| w == b"maveric.sees"));
}

#[test]
fn table_without_header_has_columns_by_number() {
    let mapping = format!(
        "[table]\nlayout = \"pair\"\nheader = false\nseparator = \" \"\ngap_kind = \"bumper_to_bumper\"\n{UNITS}\
         [table.columns]\ntime = \"1\"\nego_speed = \"2\"\ngap = \"4\"\nlead_speed = \"5\"\n"
    );
    let text = |odd: &str| {
        let row = |i: u32| format!("{:.1}  30.0\t-1 40.0 30.0 \n", f64::from(i) / 10.0);
        let rows = (0..6).map(row).collect::<String>();
        rows + odd + &(6..12).map(row).collect::<String>()
    };
    let drive = drive_of(&mapped(&mapping, &text("")).unwrap()[0]);
    assert!(drive.rows().lead_dx_m.iter().all(|m| (m - 40.0).abs() < 1e-9));
    for (odd, says) in [
        ("0.55 30.0\n", "row 7 has 2 cells, expected 5"),
        ("0.55 30.0 -1 40.0 30.0 7\n", "row 7 has 6 cells, expected 5"),
        ("0.55 fast -1 40.0 30.0\n", "row 7 column `2` holds `fast`"),
    ] {
        let error = mapped(&mapping, &text(odd)).unwrap_err().to_string();
        assert!(error.contains(says), "{error}");
    }
}
