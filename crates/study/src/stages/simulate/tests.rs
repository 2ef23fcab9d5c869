use super::*;
use crate::tables::variability::VariabilityRow;
use clap::Parser as _;
use maveric_domain::{Design, DriveId, Embedding, Variability};

#[derive(clap::Parser)]
struct Asked {
    #[command(flatten)]
    simulate: Simulate,
}

fn asked(more: &[&str]) -> Simulate {
    let fixed = "simulate --model m --conditions c --out o".split(' ');
    Asked::parse_from(fixed.chain(more.iter().copied())).simulate
}

fn row(participant: &str, condition: &str) -> ConditionRow {
    ConditionRow::new(
        ParticipantId::new(participant).unwrap(),
        condition.parse().unwrap(),
        Embedding::new(vec![0.0]).unwrap(),
    )
}

#[test]
fn without_a_wish_the_one_in_the_middle_has_logs_and_otherwise_those_who_are_asked_for() {
    let mut rows = Vec::new();
    for (who, score) in [
        ("P01", Some(50.0)),
        ("P02", None),
        ("P03", Some(20.0)),
        ("P04", Some(30.0)),
    ] {
        for (condition, moved) in [("mimic", 0.0), ("wild", 15.0)] {
            rows.push(ConditionRow {
                adb_hat: score.map(|s| s + moved),
                moved_points: Some(moved),
                ..row(who, condition)
            });
        }
    }
    let logged_of = |rows: &[ConditionRow], more: &[&str]| -> Vec<String> {
        let asked = asked(more);
        let logged = Logged::new(&asked, rows);
        let people = rows.iter().step_by(2).map(|row| &row.participant);
        people
            .filter(|who| logged.cover(who))
            .map(ToString::to_string)
            .collect()
    };
    let logged = |more: &[&str]| logged_of(&rows, more);
    assert_eq!(logged(&[]), ["P04"]);
    assert_eq!(logged(&["--logs", "P02"]), ["P02"]);
    assert_eq!(logged(&["--logs"]).len(), 4);
    let logs = LogChoice::Of("P99".to_owned());
    let refused = logs.check(rows.iter().map(|row| &row.participant));
    assert!(refused.unwrap_err().to_string().contains("P99"));
    assert_eq!(logged_of(&rows[2..4], &[]), ["P02"]);
    assert_eq!(logs::in_the_middle(&[]), None);
}

#[test]
fn who_varies_does_so_as_in_the_own_drive_and_nobody_else_does() {
    let text = "[study]\ntitle = \"t\"\n[people]\nlearn = { part = \"l\" }\n[style]\nscore = \"adb.total\"\n\
                [[condition]]\nid = \"alive\"\ncar = { dial = 0, vary = true }\n[[condition]]\nid = \"still\"\ncar = { dial = 0 }\n\
                [baseline]\nid = \"own\"\n";
    let study = DesignFile {
        path: None,
        design: Design::from_toml(text).unwrap(),
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("variability.csv");
    let drive = |condition: &str, speed_sd_mps| VariabilityRow {
        drive: DriveId::new(format!("P01-{condition}")).unwrap(),
        participant: ParticipantId::new("P01").unwrap(),
        condition: condition.parse().unwrap(),
        speed_sd_mps,
        speed_lag_s: Some(9.0),
        gap_log_sd: None,
        gap_lag_s: None,
        place_sd_m: None,
        place_lag_s: None,
        place_m: None,
    };
    let drives = [drive("other", Some(0.9)), drive("own", Some(0.4))];
    write_rows(TableName::Variability, &path, drives).unwrap();
    let given = ["--variability", path.to_str().unwrap()];
    let rows = [row("P01", "alive"), row("P01", "still")];
    let found = asked(&given).varying(Some(&study), &rows).unwrap();
    let sd = |v: &Variability| v.free_speed.map(|w| w.sd);
    assert_eq!(found[0].as_ref().and_then(sd), Some(0.4));
    assert_eq!(found[1], None);
    // Without a file, and for a stranger, by name.
    let error = asked(&[]).varying(Some(&study), &rows).unwrap_err();
    assert!(error.to_string().contains("condition alive"), "{error}");
    let error = asked(&given).varying(Some(&study), &[row("P02", "alive")]);
    assert!(error.unwrap_err().to_string().contains("participant P02"));
    assert_eq!(
        asked(&[]).varying(Some(&study), &rows[1..]).unwrap(),
        [None]
    );
}
