use super::*;
use crate::tables::{
    drives::write_drive, measurements::read_measurements, own_measures::read_own_measurements,
};
use maveric_domain::{Drive, DriveMeta, DrivenBy, EgoTrack, Recording, Road};

/// A drive that moves to the passing lane and back again at each of these times.
fn drive(who: &str, condition: &str, seconds: f64, passes_s: &[f64]) -> Drive {
    let n = (seconds * 20.0) as usize;
    let time_s: Vec<f64> = (0..n).map(|i| i as f64 / 20.0).collect();
    let step = |t: f64, from: f64| {
        let s = ((t - from) / 4.0).clamp(0.0, 1.0);
        3.66 * s * s * (3.0 - 2.0 * s)
    };
    let pass = |t: f64| passes_s.iter().map(|p| step(t, *p) - step(t, p + 10.0)).sum();
    let ego = EgoTrack {
        length_m: 4.7,
        x_m: time_s.iter().map(|t| 30.0 * t).collect(),
        y_m: time_s.iter().map(|&t| pass(t)).collect(),
        speed_mps: vec![30.0; n],
    };
    let recording = Recording::new(Road::PAPER, 20.0, time_s, vec![0; n], ego, Vec::new()).unwrap();
    let meta =
        DriveMeta::named(format!("{who}-{condition}"), who, condition, DrivenBy::Human).unwrap();
    Drive::from_recording(meta, &recording).unwrap()
}

#[test]
fn own_measures_of_whoever_and_of_whatever_ride_is_left_out_are_in_no_table() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    std::fs::write(file("participants.csv"), "participant\nP01\nP02\n").unwrap();
    let table = "participant,condition,tor_s\nP01,calm,1\nP01,sporty,2\nP02,calm,3\nP02,sporty,4\n";
    std::fs::write(file("measures.csv"), table).unwrap();
    let measured = |exclude: &str| {
        let design = format!(
            "[study]\ntitle = \"t\"\n[[condition]]\nid = \"calm\"\n[[condition]]\nid = \"sporty\"\n\
             [[measure]]\nid = \"tor_s\"\nunit = \"s\"\n[exclude]\n{exclude}"
        );
        std::fs::write(file("study.toml"), design).unwrap();
        let options = Measure {
            design: Some(file("study.toml")),
            participants: None,
            drives: Vec::new(),
            out: file("measurements.parquet"),
        };
        let outcome = options.run(Watch::unwatched()).unwrap();
        let means = read_own_measurements(&file("measurements_own.csv")).unwrap();
        let values: Vec<f64> = means.iter().map(|m| m.value).collect();
        (values, outcome.summary.last().cloned().unwrap())
    };
    assert_eq!(measured("").0, [1.0, 2.0, 3.0, 4.0]);
    let (values, said) = measured("people = { P01 = \"withdrew\" }");
    assert_eq!(values, [3.0, 4.0]);
    assert_eq!(said, "2 values left out by exclude.people");
    let (values, _) = measured("drives = { P02-calm = \"the rig failed\" }");
    assert_eq!(values, [1.0, 2.0, 4.0]);
}

#[test]
fn a_drive_of_which_too_little_is_comparable_is_no_log_without_lateral_positions() {
    let measures = ["lane_changes", "mean_velocity_mps", "leads_met"];
    let measures = measures.map(|name| objective::find(name).unwrap());
    let row = |who: &str, values: [Option<f64>; 3]| MeasuredDrive {
        meta: DriveMeta::named(format!("{who}-calm"), who, "calm", DrivenBy::Human).unwrap(),
        values: measures.iter().map(|m| m.name.to_owned()).zip(values).collect(),
        counted_s: None,
    };
    let rows = [
        row("P01", [None, Some(30.0), None]),
        row("P02", [None, None, Some(2.0)]),
        row("P03", [Some(4.0), Some(31.0), Some(3.0)]),
    ];
    let warned = |uncounted: &[usize]| {
        let uncounted = uncounted.iter().copied().collect();
        why_missing(&measures, &rows, &uncounted)
    };
    let of = |count: usize, name: &str| {
        let m = objective::find(name).unwrap();
        let title = m.title.to_lowercase();
        format!("{count} of 3 drives have no {title}: {}", m.why_missing)
    };
    let speed = of(1, "mean_velocity_mps");
    assert_eq!(warned(&[]), [of(2, "lane_changes"), speed.clone(), of(1, "leads_met")]);
    assert_eq!(warned(&[0]), [of(1, "lane_changes"), speed.clone()]);
    // What a longer drive has no more of is not cut.
    assert_eq!(warned(&[0, 1]), [speed]);
}

#[test]
fn lane_changes_of_a_long_drive_are_counted_over_the_time_of_the_persons_short_one() {
    let folder = tempfile::tempdir().unwrap();
    let drives = folder.path().join("drives");
    for made in [
        drive("P01", "own", 100.0, &[20.0]),
        drive("P01", "car", 200.0, &[20.0, 60.0, 120.0, 160.0]),
        drive("P02", "own", 200.0, &[20.0, 120.0]),
        drive("P02", "car", 200.0, &[20.0, 60.0, 120.0]),
    ] {
        write_drive(&drives, &made).unwrap();
    }
    let out = folder.path().join("measurements.parquet");
    let options =
        Measure { design: None, participants: None, drives: vec![drives], out: out.clone() };
    let outcome = options.run(Watch::unwatched()).unwrap();
    let counted: Vec<(String, Option<f64>, bool)> = read_measurements(&out)
        .unwrap()
        .into_iter()
        .map(|row| {
            let count = row.values["lane_changes"];
            (row.meta.drive.to_string(), count, row.counted_s.is_some())
        })
        .collect();
    let row = |drive: &str, count, cut| (drive.to_owned(), Some(count), cut);
    assert_eq!(
        counted,
        [
            row("P01-car", 4.0, true),
            row("P01-own", 2.0, true),
            row("P02-car", 6.0, false),
            row("P02-own", 4.0, false),
        ]
    );
    let said = outcome.warnings.iter().find(|w| w.contains("differ in length"));
    assert!(said.unwrap().starts_with("1 person has drives"), "{said:?}");
}
