//! Recordings that a logger split over several files: tables and others, by the end of their names.

use crate::{
    bytes_of,
    mapped::{self, of_toml},
    recording, rewritten,
};
use maveric_ingest::{
    IngestError, IngestSettings, Ingested, Warning, WarningKind, inspect_with, log_files,
    log_parts, read_log,
};
use mcap::WriteOptions;
use std::{fmt::Write as _, path::PathBuf};

const PAIR: &str = "[names]\nfile = \"{participant}_{condition}\"\nparts = \"_{n}\"\ndrive = \"{participant}-{condition}\"\n\
    participant = \"{participant}\"\ncondition = \"{condition}\"\n[table]\nlayout = \"pair\"\ngap_kind = \"bumper_to_bumper\"\n\
    [table.units]\ntime = \"s\"\nlength = \"m\"\nspeed = \"m/s\"\n[table.columns]\ntime = \"t\"\nego_speed = \"v\"\ngap = \"gap\"\n\
    lead_speed = \"w\"\n";

fn settings(mapping: &str) -> IngestSettings {
    mapped::settings(of_toml(mapping).unwrap())
}

/// Rows at 20 Hz from one time to another, in s; ego 0.1 m/s faster each second.
fn rows(from_s: f64, to_s: f64) -> String {
    let mut text = "t,v,gap,w\n".to_owned();
    let count = ((to_s - from_s) * 20.0).round() as u32;
    for i in 0..count {
        let t = from_s + f64::from(i) / 20.0;
        writeln!(text, "{t},{},{},25", 20.0 + 0.1 * t, 40.0 - 0.05 * t).unwrap();
    }
    text
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new(files: &[(&str, String)]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn read(&self, name: &str) -> Result<Ingested, IngestError> {
        read_log(&self.path(name), &settings(PAIR)).map(|mut drives| drives.remove(0))
    }
}

#[expect(clippy::panic, reason = "a test says what it looked for")]
fn warning<'a>(drive: &'a Ingested, words: &str) -> &'a Warning {
    let found = drive.warnings.iter().find(|w| w.what.contains(words));
    found.unwrap_or_else(|| panic!("no warning says `{words}`: {:?}", drive.warnings))
}

fn same_drive(a: &Ingested, b: &Ingested) -> bool {
    let close = |a: &[f64], b: &[f64]| {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9)
    };
    let (a, b) = (&a.recording, &b.recording);
    close(a.time_s(), b.time_s())
        && close(&a.ego().speed_mps, &b.ego().speed_mps)
        && close(&a.ego().x_m, &b.ego().x_m)
        && close(&a.others()[0].x_m, &b.others()[0].x_m)
}

#[test]
fn parts_whose_clock_goes_on_are_the_drive_that_one_file_is_whichever_of_them_is_named() {
    let whole = Folder::new(&[("P01_calm.csv", rows(0.0, 120.0))]);
    let whole = whole.read("P01_calm.csv").unwrap();
    let parts = ["P01_calm.csv", "P01_calm_2.csv", "P01_calm_10.csv"];
    let split = Folder::new(&[
        (parts[0], rows(0.0, 50.0)),
        (parts[1], rows(50.0, 90.0)),
        (parts[2], rows(90.0, 120.0)),
        ("P02_calm.csv", rows(0.0, 60.0)),
    ]);
    let error = split.read(parts[0]).unwrap_err();
    assert!(
        matches!(&error, IngestError::MissingPart { part, .. } if part == "P01_calm_3.csv"),
        "{error}"
    );
    std::fs::rename(split.path(parts[2]), split.path("P01_calm_3.csv")).unwrap();
    let parts = [parts[0], parts[1], "P01_calm_3.csv"];
    for part in parts {
        let drive = split.read(part).unwrap();
        assert_eq!(drive.meta.drive.as_str(), "P01-calm");
        assert_eq!(drive.meta.condition.to_string(), "calm");
        assert!(same_drive(&drive, &whole), "{part}");
        let names: Vec<&str> = drive.sources.iter().map(|s| s.name.as_str()).collect();
        assert_eq!(names, parts);
        let told = warning(&drive, "goes on in its part 2, 0.050 s later");
        assert_eq!(told.kind, WarningKind::Noted);
        let times = told.spans_s[0];
        assert!((times.0 - 49.95).abs() < 1e-9 && (times.1 - 50.0).abs() < 1e-9);
        warning(&drive, "goes on in its part 3, 0.050 s later");
    }
    let mapping = settings(PAIR).mapping;
    let logs = log_files(split.0.path(), mapping.as_ref()).unwrap();
    assert_eq!(logs, [split.path(parts[0]), split.path("P02_calm.csv")]);
    let files = log_parts(&logs[0], mapping.as_ref()).unwrap();
    assert_eq!(files, parts.map(|part| split.path(part)));
    let said = inspect_with(&split.path(parts[0]), &settings(PAIR)).unwrap().would_ingest;
    assert!(said.contains("1 drive of 2400 rows"), "{said}");
    // Without the key each file is a log of its own.
    let apart = PAIR.replace("parts = \"_{n}\"\n", "");
    assert_eq!(log_files(split.0.path(), settings(&apart).mapping.as_ref()).unwrap().len(), 4);
}

#[test]
fn the_hole_between_parts_is_told_and_a_clock_that_begins_anew_makes_one_of_no_known_length() {
    let hole =
        Folder::new(&[("P01_calm_1.csv", rows(0.0, 50.0)), ("P01_calm_2.csv", rows(62.5, 120.0))]);
    let drive = hole.read("P01_calm_2.csv").unwrap();
    let told = warning(&drive, "goes on in its part 2, 12.550 s later");
    assert_eq!(told.kind, WarningKind::Noted);
    assert_eq!(warning(&drive, "holes of more than 0.5 s").count, 1);
    assert_eq!(drive.recording.rows(), 1000 + 1150);
    let segments = drive.recording.segment();
    assert_eq!((segments[999], segments[1000]), (0, 1));

    let anew =
        Folder::new(&[("P01_calm_1.csv", rows(0.0, 50.0)), ("P01_calm_2.csv", rows(0.0, 60.0))]);
    let drive = anew.read("P01_calm_1.csv").unwrap();
    let told =
        warning(&drive, "whose times begin anew: how long the hole between them was is not known");
    assert_eq!(told.kind, WarningKind::ClockRestart);
    assert_eq!(drive.recording.rows(), 1000 + 1200);
    let (time_s, segments) = (drive.recording.time_s(), drive.recording.segment());
    assert_eq!((segments[999], segments[1000]), (0, 1));
    assert!((time_s[1000] - time_s[999] - 1.0).abs() < 1e-9, "{}", time_s[1000]);
    let speeds = &drive.recording.ego().speed_mps;
    assert!((speeds[1000] - 20.0).abs() < 1e-9 && (speeds[999] - 24.995).abs() < 1e-9);
}

#[test]
fn parts_that_overlap_that_are_one_part_twice_or_that_differ_in_columns_are_refused_by_name() {
    let over =
        Folder::new(&[("P01_calm_1.csv", rows(0.0, 50.0)), ("P01_calm_2.csv", rows(40.0, 90.0))]);
    let error = over.read("P01_calm_1.csv").unwrap_err().to_string();
    assert!(
        error.contains("P01_calm_2.csv")
            && error.contains("begins at 40.000 s, but P01_calm_1.csv above it ends at 49.950 s"),
        "{error}"
    );
    let twice =
        Folder::new(&[("P01_calm_1.csv", rows(0.0, 50.0)), ("P01_calm_01.csv", rows(50.0, 90.0))]);
    let error = twice.read("P01_calm_1.csv").unwrap_err().to_string();
    assert!(error.contains("the same part of a recording as P01_calm_01.csv"), "{error}");
    let other = rows(50.0, 90.0).replace("t,v,gap,w", "t,v,distance,w");
    let columns = Folder::new(&[("P01_calm_1.csv", rows(0.0, 50.0)), ("P01_calm_2.csv", other)]);
    let error = columns.read("P01_calm_1.csv").unwrap_err().to_string();
    assert!(error.contains("no column `gap` in ") && error.contains("P01_calm_2.csv"), "{error}");
    let word = rows(50.0, 90.0).replace("t,v,gap,w\n", "t,v,gap,w\n50,fast,40,25\n");
    let words = Folder::new(&[("P01_calm_1.csv", rows(0.0, 50.0)), ("P01_calm_2.csv", word)]);
    let error = words.read("P01_calm_1.csv").unwrap_err().to_string();
    assert!(error.contains("P01_calm_2.csv row 1 column `v` holds `fast`"), "{error}");
    // With decimal commas as well, whichever part it is.
    let commas = |text: String| text.replace(',', ";").replace('.', ",");
    let toml = PAIR.replace("layout = \"pair\"\n", "layout = \"pair\"\ndecimal_comma = true\n");
    for (first, second, said) in [
        ("20,0", "fast", "P01_calm_2.csv row 1 column `v` holds `fast`"),
        ("fast", "20,0", "P01_calm_1.csv row 1 column `v` holds `fast`"),
    ] {
        let with = |cell: &str, from: f64| {
            commas(rows(from, from + 50.0)).replacen(
                "t;v;gap;w\n",
                &format!("t;v;gap;w\n{from};{cell};40;25\n"),
                1,
            )
        };
        let words = Folder::new(&[
            ("P01_calm_1.csv", with(first, 0.0)),
            ("P01_calm_2.csv", with(second, 60.0)),
        ]);
        let error =
            read_log(&words.path("P01_calm_1.csv"), &settings(&toml)).unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    }
    // The same columns in another order are the same.
    let mut turned = "w,gap,v,t\n".to_owned();
    for row in rows(50.0, 90.0).lines().skip(1) {
        let cells: Vec<&str> = row.split(',').rev().collect();
        turned += &(cells.join(",") + "\n");
    }
    let turned = Folder::new(&[("P01_calm_1.csv", rows(0.0, 50.0)), ("P01_calm_2.csv", turned)]);
    assert_eq!(turned.read("P01_calm_1.csv").unwrap().recording.rows(), 1800);
}

#[test]
fn a_part_that_is_not_there_is_a_hole_with_recover_alone() {
    let split =
        Folder::new(&[("P01_calm_1.csv", rows(0.0, 50.0)), ("P01_calm_3.csv", rows(90.0, 120.0))]);
    let error = split.read("P01_calm_1.csv").unwrap_err();
    assert!(error.to_string().contains("lacks its part `P01_calm_2.csv`"), "{error}");
    let recover = IngestSettings { recover: true, ..settings(PAIR) };
    let drive = read_log(&split.path("P01_calm_1.csv"), &recover).unwrap().remove(0);
    assert_eq!(warning(&drive, "its part `P01_calm_2.csv` is not there").kind, WarningKind::Damage);
    warning(&drive, "goes on in its part 3, 40.050 s later");
    assert_eq!(drive.recording.rows(), 1000 + 600);
}

#[test]
fn parts_of_long_tables_join_as_those_of_pairs_do() {
    let names = PAIR.split("[table]").next().unwrap();
    let units = "[table.units]\ntime = \"s\"\nlength = \"m\"\nspeed = \"m/s\"\n";
    let long = format!(
        "{names}[table]\nlayout = \"long\"\npoint = \"centre\"\nego = \"a\"\n{units}[table.columns]\ntime = \"t\"\nid = \"id\"\nx = \"x\"\nspeed = \"v\"\n"
    );
    let table = |from: u32, to: u32| {
        let mut text = "t,id,x,v\n".to_owned();
        for i in from..to {
            let t = f64::from(i) / 20.0;
            writeln!(text, "{t},a,{},20\n{t},b,{},20", 20.0 * t, 50.0 + 20.0 * t).unwrap();
        }
        text
    };
    let split =
        Folder::new(&[("P01_calm_1.csv", table(0, 600)), ("P01_calm_2.csv", table(600, 1200))]);
    let drive = read_log(&split.path("P01_calm_1.csv"), &settings(&long)).unwrap().remove(0);
    assert_eq!((drive.recording.rows(), drive.recording.others().len()), (1200, 1));
    assert_eq!(drive.recording.others()[0].x_m.len(), 1200);
    warning(&drive, "goes on in its part 2, 0.050 s later");
    // Begun anew a long table mixes no times either.
    let anew = Folder::new(&[("P01_calm_1.csv", table(0, 600)), ("P01_calm_2.csv", table(0, 600))]);
    let drive = read_log(&anew.path("P01_calm_1.csv"), &settings(&long)).unwrap().remove(0);
    assert_eq!(drive.recording.rows(), 1200);
    assert_eq!(drive.recording.segment()[600], 1);
}

#[test]
fn recordings_that_lie_beside_others_join_by_their_names_too() {
    let bytes = bytes_of(&recording(false));
    let folder = tempfile::tempdir().unwrap();
    let mapping = settings(
        "[names]\nfile = \"{drive}\"\nparts = \"_part{n}\"\ndrive = \"{drive}\"\nparticipant = \"{drive}\"\n",
    );
    for n in 1..3_u64 {
        let half = rewritten(&bytes, WriteOptions::new(), |message| {
            (message.log_time / 30_000_000_000 == n - 1).then_some(message)
        });
        std::fs::write(folder.path().join(format!("P07_part{n}.mcap")), half).unwrap();
    }
    std::fs::write(folder.path().join("P08_part1.mcap"), &bytes).unwrap();
    let logs = log_files(folder.path(), mapping.mapping.as_ref()).unwrap();
    assert_eq!(logs, ["P07_part1.mcap", "P08_part1.mcap"].map(|name| folder.path().join(name)));
    let joined = read_log(&logs[0], &mapping).unwrap().remove(0);
    let alone = read_log(&logs[1], &mapping).unwrap().remove(0);
    assert_eq!(joined.recording, alone.recording);
    assert_eq!(joined.sources.len(), 2);
}

#[test]
fn an_ending_without_a_number_or_without_a_text_before_it_is_no_pattern() {
    for ending in ["_part", "{n}", "0{n}", "_{n}_{m}"] {
        let text = PAIR.replace("\"_{n}\"", &format!("\"{ending}\""));
        let error = of_toml(&text).unwrap_err().to_string();
        assert!(error.contains("`names.parts`"), "{error}");
    }
}
