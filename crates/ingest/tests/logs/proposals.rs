//! Mappings that are proposed for a table: each was tried, and what was not found is named.

use super::mapped::{of_toml, settings};
use maveric_ingest::{IngestError, read_log, suggest_mapping};
use std::fmt::Write as _;

/// A minute at 10 Hz; `row` gives what stands behind the time.
fn table(header: &str, row: impl Fn(f64) -> String) -> String {
    let mut text = format!("{header}\n");
    for i in 0..600 {
        let t = f64::from(i) / 10.0;
        writeln!(text, "{t},{}", row(t)).unwrap();
    }
    text
}

/// The proposal for a table, with which drives of it were read again.
fn proposed(text: &str) -> Result<String, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("P01.csv");
    std::fs::write(&path, text).unwrap();
    let toml = suggest_mapping(&path).map_err(|error| {
        assert!(matches!(error, IngestError::NoProposal { .. }), "{error:?}");
        assert!(error.suggestion().is_some());
        error.to_string()
    })?;
    let drives = read_log(&path, &settings(of_toml(&toml).unwrap())).unwrap();
    assert!(!drives.is_empty(), "{toml}");
    Ok(toml)
}

fn speed(t: f64) -> f64 {
    25.0 + 3.0 * (0.3 * t).sin()
}

/// The way at that speed.
fn way(t: f64) -> f64 {
    25.0 * t - 10.0 * (0.3 * t).cos()
}

#[test]
fn signal_that_no_name_tells_is_named() {
    let cases = [
        ("t,a,gap", "a speed was not found"),
        ("t,speed,thw", "a vehicle ahead was not found"),
        ("t,speed,vehicle_id", "a position along the road was not found"),
        ("a,speed,gap", "a time was not found"),
    ];
    for (header, says) in cases {
        let refused = proposed(&table(header, |t| format!("{},{}", speed(t), 40))).unwrap_err();
        assert!(refused.contains(says), "{header}: {refused}");
        assert!(refused.contains("no mapping can be proposed for "), "{refused}");
    }
    let text = table("t,speed,gap", |t| format!("{},{}", speed(t), 40));
    assert!(proposed(&text).is_ok());
}

#[test]
fn column_of_words_is_no_signal_whatever_its_name() {
    // The speed is in a column of another name, and `speed` is a class.
    let row = |t: f64| format!("{},{},40", if t < 30.0 { "slow" } else { "fast" }, speed(t));
    let refused = proposed(&table("t,speed,b,gap", row)).unwrap_err();
    assert!(refused.contains("a speed was not found"), "{refused}");
    let toml = proposed(&table("t,speed,velocity,gap", row)).unwrap();
    assert!(toml.contains("ego_speed = \"velocity\"\n"), "{toml}");
}

#[test]
fn pair_has_no_groups_and_upward_speed_is_no_speed() {
    let row = |t: f64| format!("1,7,0.0,{},40", speed(t));
    let toml = proposed(&table("t,trial,vehicle_id,velocityZ,speed,gap", row)).unwrap();
    assert!(!toml.contains("groups"), "{toml}");
    assert!(toml.contains("ego_speed = \"speed\"\n"), "{toml}");
    let refused = proposed(&table("t,trial,vehicle_id,velocityZ,a,gap", row)).unwrap_err();
    assert!(refused.contains("a speed was not found"), "{refused}");
}

#[test]
fn units_and_position_that_no_name_tells_are_tried() {
    let row = |unit: f64, x: bool| {
        move |t: f64| {
            let (along, across) = if x { (way(t), 1.5) } else { (1.5, way(t)) };
            format!("{},{along},{across},40,25", unit * speed(t))
        }
    };
    for (unit, name) in [(1.0, "m/s"), (3.6, "km/h"), (2.236_936, "mph")] {
        for (is_x, along) in [(true, "x"), (false, "y")] {
            let text = table("t,speed,x,y,gap,lead_speed", row(unit, is_x));
            let toml = proposed(&text).unwrap();
            let unit = format!("\n# doubt: no name says the unit of speed.\nspeed = \"{name}\"\n");
            assert!(toml.contains(&unit), "{toml}");
            assert!(toml.contains(&format!("ego_x = \"{along}\"\n")), "{toml}");
        }
    }
    // Where ego changes lanes its positions stay, though the proposal has one lane.
    let row = |t: f64| {
        let side = if t < 30.0 { 0.0 } else { 3.66 };
        format!("{},{},{side},40,25", speed(t), way(t))
    };
    let toml = proposed(&table("t,speed_mps,x,y,gap,lead_speed", row)).unwrap();
    assert!(toml.contains("ego_x = \"x\"\n"), "{toml}");
    assert!(toml.contains("ego_y = \"y\"\n"), "{toml}");
    // Times in milliseconds are too far apart as seconds.
    let text = table("t,speed,gap", |t| format!("{},40", speed(t)));
    let in_ms = |line: &str| match line.split_once(',') {
        Some((t, rest)) if t != "t" => format!("{},{rest}\n", 1e3 * t.parse::<f64>().unwrap()),
        _ => format!("{line}\n"),
    };
    let toml = proposed(&text.lines().map(in_ms).collect::<String>()).unwrap();
    assert!(toml.contains("of time.\ntime = \"ms\"\n"), "{toml}");
}

#[test]
fn table_that_no_proposal_reads_is_refused_with_the_reason() {
    // Once a minute is no drive, and not one of milliseconds either.
    let text = "t,speed,gap\n0,20,40\n60,x,40\n120,20,40\n";
    let refused = proposed(text).unwrap_err();
    assert!(refused.contains("a speed was not found"), "{refused}");
    let refused = proposed(&text.replace('x', "20")).unwrap_err();
    assert!(refused.contains("it is refused: "), "{refused}");
}
