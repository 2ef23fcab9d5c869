use super::*;
use std::collections::BTreeSet;

const LOG: &str =
    "time_s,ego_x_m,ego_y_m,ego_speed_mps,lead_id,lead_dx_m,lead_dy_m,lead_speed_mps\n";

fn table(rows: usize) -> String {
    let row = |i: usize| format!("{},{i},0,20,5,20,0,19\n", i as f64 / 20.0);
    LOG.to_owned() + &(0..rows).map(row).collect::<String>()
}

fn run(logs: Vec<PathBuf>, out: &Path) -> Result<Outcome<IngestedDrives>, StudyError> {
    let mappings = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../study_data/mappings");
    let options = Ingest {
        logs,
        out: out.to_owned(),
        mapping: Some(mappings.join("ours.toml")),
        jobs: 2,
        ..Ingest::default()
    };
    options.run(Watch::unwatched())
}

fn names(folder: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let name = |e: std::io::Result<std::fs::DirEntry>| e.unwrap().file_name();
    entries.map(|e| name(e).to_string_lossy().into_owned()).collect()
}

#[test]
fn a_used_folder_keeps_no_drive_that_its_list_no_longer_has_and_no_other_file_goes() {
    let folder = tempfile::tempdir().unwrap();
    let (logs, out) = (folder.path().join("logs"), folder.path().join("drives"));
    std::fs::create_dir(&logs).unwrap();
    for log in ["S1P01-own", "S1P02-own"] {
        std::fs::write(logs.join(format!("{log}.csv")), table(400)).unwrap();
    }
    run(vec![logs.clone()], &out).unwrap();
    std::fs::write(out.join("notes.txt"), "mine").unwrap();
    assert!(names(&out).contains("S1P02-own.parquet"));
    let again = || run(vec![logs.join("S1P01-own.csv")], &out);
    again().unwrap();
    let left = names(&out);
    assert!(left.contains("S1P01-own.parquet") && left.contains("notes.txt"));
    assert!(!left.contains("S1P02-own.parquet"), "{left:?}");
    std::fs::write(out.join("mine.parquet"), "mine").unwrap();
    let refused = again().unwrap_err().to_string();
    assert!(refused.contains("mine.parquet"), "{refused}");
    assert_eq!(std::fs::read(out.join("mine.parquet")).unwrap(), b"mine");
}

#[test]
fn a_log_in_the_folder_of_the_drives_is_neither_written_over_nor_removed() {
    let folder = tempfile::tempdir().unwrap();
    let (out, other) = (folder.path().join("drives"), folder.path().join("other"));
    let log = folder.path().join("a.csv");
    std::fs::write(&log, table(100)).unwrap();
    run(vec![log.clone()], &out).unwrap();
    let drive = out.join("a.parquet");
    let before = std::fs::read(&drive).unwrap();
    // A drive is a table that the same mapping reads: as a log it stays as it is, by whatever path.
    for log in [drive.clone(), out.join("../drives/a.parquet")] {
        let error = run(vec![log], &out).unwrap_err().to_string();
        assert!(
            error.contains("a.parquet") && error.contains("is an input of this command"),
            "{error}"
        );
        assert_eq!(std::fs::read(&drive).unwrap(), before);
    }
    // Nor does it go where it becomes a drive of another name.
    let renamed = folder.path().join("renamed.toml");
    let mappings = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../study_data/mappings");
    let text = std::fs::read_to_string(mappings.join("ours.toml")).unwrap();
    std::fs::write(&renamed, text.replace("drive = \"{drive}\"", "drive = \"{drive}-again\""))
        .unwrap();
    let by_another_name = |out: &Path| {
        let options = Ingest {
            logs: vec![drive.clone()],
            out: out.to_owned(),
            mapping: Some(renamed.clone()),
            jobs: 1,
            ..Ingest::default()
        };
        options.run(Watch::unwatched())
    };
    let error = by_another_name(&out).unwrap_err().to_string();
    assert!(error.contains("is an input of this command"), "{error}");
    assert_eq!(std::fs::read(&drive).unwrap(), before);
    let made = by_another_name(&other).unwrap();
    assert_eq!(made.value.drives[0].drive.as_str(), "a-again");
}

#[test]
fn drives_appear_together_and_a_log_that_cannot_be_read_is_listed_beside_them() {
    let folder = tempfile::tempdir().unwrap();
    let (logs, out) = (folder.path().join("logs"), folder.path().join("made/drives"));
    std::fs::create_dir(&logs).unwrap();
    std::fs::write(logs.join("d.csv"), table(50).replace(",20,", ",fast,")).unwrap();
    let error = run(vec![logs.clone()], &out).unwrap_err();
    assert!(error.to_string().contains("d.csv"), "{error}");
    assert_eq!(names(folder.path()), BTreeSet::from(["logs".to_owned()]));
    for name in ["a.csv", "b.csv", "c.csv"] {
        std::fs::write(logs.join(name), table(100)).unwrap();
    }
    let made = run(vec![logs.clone()], &out).unwrap();
    assert_eq!(made.value.drives.len(), 3);
    assert!(made.value.failed[0].why.contains("`fast`"), "{:?}", made.value.failed);
    let list = std::fs::read_to_string(out.join("exclusions.csv")).unwrap();
    let last = list.lines().last().unwrap();
    assert!(last.contains(",d.csv,") && last.contains("not ingested"), "{list}");

    std::fs::remove_file(logs.join("d.csv")).unwrap();
    let made = run(vec![logs.clone()], &out).unwrap();
    assert_eq!((made.value.drives.len(), made.value.rows), (3, 300));
    let expected = ["a.parquet", "b.parquet", "c.parquet", "drives.csv", "exclusions.csv"];
    assert_eq!(names(&out), expected.map(str::to_owned).into());

    // The same log twice is one drive twice; what stood there before stays.
    let before = std::fs::read(out.join("a.parquet")).unwrap();
    let error = run(vec![logs.clone(), logs.join("a.csv")], &out).unwrap_err();
    assert!(error.to_string().contains("a.csv makes the drive `a` twice"), "{error}");
    std::fs::create_dir(logs.join("again")).unwrap();
    std::fs::copy(logs.join("a.csv"), logs.join("again/a.csv")).unwrap();
    let error = run(vec![logs.clone()], &out).unwrap_err().to_string();
    for said in ["logs/a.csv", "logs/again/a.csv", " both make the drive `a`"] {
        assert!(error.contains(said), "{error}");
    }
    assert_eq!(names(&out).len(), 5);
    assert_eq!(std::fs::read(out.join("a.parquet")).unwrap(), before);
}

#[test]
fn where_no_drive_is_let_in_the_rule_is_to_be_changed_or_the_names() {
    let folder = tempfile::tempdir().unwrap();
    let (log, design) = (folder.path().join("P01-calm.csv"), folder.path().join("study.toml"));
    std::fs::write(&log, table(100)).unwrap();
    let mappings = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../study_data/mappings");
    let ours = std::fs::read_to_string(mappings.join("ours.toml")).unwrap();
    let named = ours.replace("{drive}", "{participant}-{condition}");
    let named = named.replace("condition = \"own\"", "condition = \"{condition}\"");
    let mapping = folder.path().join("mapping.toml");
    std::fs::write(&mapping, named).unwrap();
    let error = |conditions: [&str; 2], rest: &str, logs: &[&PathBuf]| {
        let condition = |id: &str| format!("[[condition]]\nid = \"{id}\"\n");
        let text = conditions.map(condition).concat();
        std::fs::write(&design, format!("[study]\ntitle = \"t\"\n{text}{rest}")).unwrap();
        let options = Ingest {
            logs: logs.iter().map(|log| (*log).clone()).collect(),
            design: Some(design.clone()),
            out: folder.path().join("drives"),
            mapping: Some(mapping.clone()),
            jobs: 1,
            ..Ingest::default()
        };
        options.run(Watch::unwatched()).unwrap_err()
    };
    let help =
        |conditions: [&str; 2], rest: &str| error(conditions, rest, &[&log]).suggestion().unwrap();
    let short = help(["calm", "sporty"], "[exclude]\ndrive_shorter_than_s = 300\n");
    assert!(
        short.contains("change the rule in the study (exclude.drive_shorter_than_s)"),
        "{short}"
    );
    let unknown = help(["bold", "sporty"], "");
    assert!(unknown.contains("[names] of the mapping"), "{unknown}");
    // A log that could not be read is a reason of its own.
    let broken = folder.path().join("P02-calm.csv");
    std::fs::write(&broken, "no,table\nof,ours\n").unwrap();
    let exclude = "[exclude]\ndrive_shorter_than_s = 300\n";
    let both = error(["calm", "sporty"], exclude, &[&log, &broken]).to_string();
    assert!(both.contains("P01-calm: ") && both.contains("1 log could not be ingested"), "{both}");
    let one = error(["calm", "sporty"], exclude, &[&log]).to_string();
    assert!(one.contains("P01-calm: ") && !one.contains("could not be ingested"), "{one}");
}

#[test]
fn what_is_told_of_a_table_of_many_is_told_whoever_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let toml = "[road]\nlanes = 1\nlane_width_m = 3.66\nposted_speed_mps = 25.0\nframe = \"map\"\n[names]\nfile = \"{file}\"\n\
                drive = \"{id}-calm\"\nparticipant = \"{id}\"\ncondition = \"calm\"\n[table]\nlayout = \"long\"\npoint = \"centre\"\n\
                y_grows = \"left\"\n[table.units]\ntime = \"s\"\nlength = \"m\"\nspeed = \"m/s\"\n[table.columns]\ntime = \"t\"\nid = \"id\"\n\
                x = \"x\"\ny = \"y\"\nspeed = \"v\"\n";
    std::fs::write(at("mapping.toml"), toml).unwrap();
    let row = |i: usize| {
        let t = i as f64 / 10.0;
        format!("{t},P01,{},0,20\n{t},P02,{},0,20\n", 20.0 * t, 20.0 * t + 50.0)
    };
    let rows: String = (0..100).map(row).collect();
    // Somebody who was seen once makes no drive.
    std::fs::write(at("many.csv"), format!("t,id,x,y,v\n{rows}5,P03,9,0,20\n")).unwrap();
    let told = |excluded: &str| {
        let design = format!(
            "[study]\ntitle = \"t\"\n[[condition]]\nid = \"calm\"\n[[condition]]\nid = \"sporty\"\n[exclude.drives]\n{excluded}"
        );
        std::fs::write(at("study.toml"), design).unwrap();
        let options = Ingest {
            logs: vec![at("many.csv")],
            design: Some(at("study.toml")),
            out: at("drives"),
            mapping: Some(at("mapping.toml")),
            jobs: 1,
            ..Ingest::default()
        };
        let made = options.run(Watch::unwatched()).unwrap();
        let list = std::fs::read_to_string(at("drives/exclusions.csv")).unwrap();
        let is_of_file = |line: &&str| line.contains("vehicles with a single row");
        let of_file = list.lines().filter(is_of_file);
        let drives = of_file.map(|line| line.split(',').next().unwrap_or("").to_owned());
        let warnings = made.warnings.iter().filter(|w| is_of_file(&w.as_str()));
        (drives.collect::<Vec<_>>(), warnings.count())
    };
    assert_eq!(told(""), (vec!["P01-calm".to_owned()], 1));
    let first = "P01-calm = \"broke off\"\n";
    assert_eq!(told(first), (vec!["P02-calm".to_owned()], 1));
    let second = "P02-calm = \"broke off\"\n";
    assert_eq!(told(second), (vec!["P01-calm".to_owned()], 1));
}

#[test]
fn a_folder_is_read_with_those_below_it_but_not_what_an_earlier_call_wrote_there() {
    let folder = tempfile::tempdir().unwrap();
    let logs = folder.path().join("logs");
    let out = logs.join("drives");
    for (place, log) in [("day1/morning", "a"), ("day1", "b"), ("day2", "c"), (".old", "d")] {
        std::fs::create_dir_all(logs.join(place)).unwrap();
        std::fs::write(logs.join(place).join(format!("{log}.csv")), table(100)).unwrap();
    }
    for _ in 0..2 {
        let made = run(vec![logs.clone()], &out).unwrap();
        let drives = made.value.drives.iter().map(|d| d.drive.as_str());
        assert_eq!(drives.collect::<Vec<_>>(), ["a", "b", "c"]);
        assert!(made.value.failed.is_empty(), "{:?}", made.value.failed);
    }
}

#[test]
fn parts_of_a_recording_that_are_named_one_by_one_are_one_drive() {
    let folder = tempfile::tempdir().unwrap();
    let mappings = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../study_data/mappings");
    let text = std::fs::read_to_string(mappings.join("ours.toml")).unwrap();
    let mapping = folder.path().join("mapping.toml");
    std::fs::write(&mapping, text.replace("[names]", "[names]\nparts = \"_{n}\"")).unwrap();
    let parts = ["a.csv", "a_2.csv"].map(|name| folder.path().join(name));
    let later = table(200).lines().skip(101).fold(LOG.to_owned(), |text, row| text + row + "\n");
    std::fs::write(&parts[0], table(100)).unwrap();
    std::fs::write(&parts[1], later).unwrap();
    for logs in [parts.to_vec(), vec![parts[1].clone()]] {
        let options = Ingest {
            logs,
            out: folder.path().join("drives"),
            mapping: Some(mapping.clone()),
            jobs: 1,
            ..Ingest::default()
        };
        let made = options.run(Watch::unwatched()).unwrap();
        assert_eq!((made.value.drives.len(), made.value.rows), (1, 200));
        assert_eq!(made.value.drives[0].drive.as_str(), "a");
        let told = made.warnings.iter().any(|w| w.contains("goes on in its part 2, 0.050 s later"));
        assert!(told, "{:?}", made.warnings);
    }
}
